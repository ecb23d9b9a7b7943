/* progress.c: see progress.h. */
#include "progress.h"

#include "socket.h"

#include <unistd.h>

enum { PROGRESS_WIDTH = 30, PROGRESS_TERMINAL_US = 66000, PROGRESS_LINE_US = 2000000 };

progress progress_begin(FILE *file, const char *label, bool silent)
{
    progress p = {.file = file, .label = label, .silent = silent, .terminal = isatty(fileno(file)) != 0};
    p.began_us = p.shown_us = socket_now_us();
    return p;
}

/* Minutes and seconds still to go, going by what the share done has taken; empty before that says anything. `before`
 * stands between them and what was said already. */
static void progress_left(const progress *p, double share, const char *before, char *text, size_t size)
{
    double taken_s = (double)(socket_now_us() - p->began_us) * 1e-6;
    text[0] = '\0';
    if (share > 0.001 && taken_s > 0.5) {
        int left_s = (int)(taken_s * (1 - share) / share + 0.5);
        snprintf(text, size, "%s%d:%02d left", before, left_s / 60, left_s % 60);
    }
}

void progress_show(progress *p, double share, const char *text)
{
    int64_t now_us = socket_now_us();
    bool due = now_us - p->shown_us >= (p->terminal ? PROGRESS_TERMINAL_US : PROGRESS_LINE_US);
    if (p->silent || !due) {
        return;
    }
    p->shown_us = now_us;
    char left[32];
    progress_left(p, share, text[0] || !p->terminal ? ", " : "", left, sizeof left);
    if (!p->terminal) {
        fprintf(p->file, "%s: %3.0f %%%s%s%s\n", p->label, share * 100, text[0] ? ", " : "", text, left);
        return;
    }
    char bar[PROGRESS_WIDTH + 1];
    int full = (int)(share * PROGRESS_WIDTH);
    for (int i = 0; i < PROGRESS_WIDTH; i++) {
        bar[i] = i < full ? '#' : '.';
    }
    bar[PROGRESS_WIDTH] = '\0';
    fprintf(p->file, "\r\033[K%s [%s] %s%s", p->label, bar, text, left);
    fflush(p->file);
    p->drawn = true;
}

void progress_hide(progress *p)
{
    if (p->drawn) {
        fputs("\r\033[K", p->file);
        fflush(p->file);
        p->drawn = false;
    }
}
