/* progress.h: how far something has come: a bar that redraws itself on a terminal, elsewhere a line now and then. */
#ifndef CLIENTS_PROGRESS_H
#define CLIENTS_PROGRESS_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

typedef struct progress {
    FILE *file;
    bool terminal, silent, drawn;
    const char *label;
    int64_t began_us, shown_us;
} progress;

/* `silent`: nothing is ever shown. `label` must outlive the progress. */
progress progress_begin(FILE *file, const char *label, bool silent);
/* Shows share (0 to 1) and `text` (may be empty), if it is time to: about 15 times a second on a terminal, every 2 s
 * elsewhere. */
void progress_show(progress *p, double share, const char *text);
/* Takes the bar off the terminal so that other lines can be written. */
void progress_hide(progress *p);

#endif
