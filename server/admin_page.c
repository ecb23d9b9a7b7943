/* admin_page.c: see admin_page.h. */
#include "admin_page.h"
#include "clock.h"
#include "health.h"
#include "http.h"
#include "metrics_text.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Writes the page's text; its status. */
static int write_page(const char *path, FILE *to)
{
    if (strcmp(path, "/livez") == 0) {
        fputs("alive\n", to);
        return 200;
    }
    if (strcmp(path, "/readyz") == 0) {
        const char *unready = health_unready(clock_monotonic_us());
        fprintf(to, "%s\n", unready ? unready : "ready");
        return unready ? 503 : 200;
    }
    if (strcmp(path, "/metrics") == 0) {
        metrics_write(to);
        return 200;
    }
    fputs("there are /livez, /readyz and /metrics\n", to);
    return 404;
}

static int write_body(int status, const http_request *request, FILE *to)
{
    switch (status) {
    case 200:
        return write_page(request->path, to);
    case 405:
        fputs("GET and HEAD alone are understood\n", to);
        return status;
    case 414:
    case 431:
        fputs("the request is too long\n", to);
        return status;
    default:
        fputs("that is no HTTP/1.1 request\n", to);
        return status;
    }
}

/* Head and body in one piece of heap; NULL: no memory. */
static char *join(int status, const char *body, size_t body_size, bool head_only, size_t *size)
{
    char head[HTTP_HEAD];
    const size_t head_size = http_write_head(status, body_size, head);
    char *answer = malloc(head_size + body_size);
    if (answer) {
        memcpy(answer, head, head_size);
        memcpy(answer + head_size, body, body_size);
        *size = head_size + (head_only ? 0 : body_size);
    }
    return answer;
}

char *admin_page(const char *bytes, size_t size, bool full, int *status, size_t *answer_size)
{
    http_request request;
    char *body = NULL, *answer = NULL;
    size_t body_size = 0;
    *status = http_read(bytes, size, &request);
    if (*status == HTTP_MORE && !full) {
        return NULL;
    }
    FILE *to = open_memstream(&body, &body_size);
    if (to) {
        *status = write_body(*status == HTTP_MORE ? 431 : *status, &request, to);
    }
    if (to && fclose(to) == 0) {
        answer = join(*status, body, body_size, request.head_only, answer_size);
    }
    free(body);
    return answer;
}
