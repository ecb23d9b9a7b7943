/* test_http.c: which requests the operator's address understands, and what it answers. */
#include "admin_page.h"
#include "check.h"
#include "http.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int read_text(const char *text, http_request *request)
{
    return http_read(text, strlen(text), request);
}

TEST(http_reads_what_a_get_says)
{
    http_request r;
    CHECK_INT(read_text("GET /metrics?x=1 HTTP/1.1\r\nHost: a\r\n\r\n", &r), 200);
    CHECK_TEXT(r.path, "/metrics");
    CHECK(!r.head_only);
    CHECK_INT(read_text("HEAD / HTTP/1.0\r\n\r\n", &r), 200);
    CHECK(r.head_only);
    CHECK_TEXT(r.path, "/");
}

TEST(http_waits_for_the_whole_head)
{
    static const char text[] = "GET /livez HTTP/1.1\r\nHost: a\r\n\r\n";
    http_request r;
    for (size_t size = 0; size + 1 < sizeof text; size++) {
        char *exact = malloc(size ? size : 1);
        memcpy(exact, text, size);
        CHECK_INT(http_read(exact, size, &r), HTTP_MORE);
        free(exact);
    }
    CHECK_INT(http_read(text, sizeof text - 1, &r), 200);
}

TEST(http_refuses_what_is_no_request)
{
    static const struct {
        const char *text;
        int status;
    } wrong[] = {{"\r\n\r\n", 400},
                 {"GET\r\n\r\n", 400},
                 {"GET /\r\n\r\n", 400},
                 {"GET  / HTTP/1.1\r\n\r\n", 400},
                 {"GET / HTTP/1.1 \r\n\r\n", 505},
                 {"GET / HTTP/2.0\r\n\r\n", 505},
                 {"GET / SPDY/1.1\r\n\r\n", 400},
                 {"GET livez HTTP/1.1\r\n\r\n", 400},
                 {"GET http://a/livez HTTP/1.1\r\n\r\n", 400},
                 {"GET / HTTP/1.1\r\nA: \x01\r\n\r\n", 400},
                 {"GET / HTTP/1.1\nHost: a\r\n\r\n", 400},
                 {"GET / HTTP/1.1\rHost: a\r\n\r\n", 400},
                 {"GETGETGETGETGETGETGET / HTTP/1.1\r\n\r\n", 400},
                 {"POST /metrics HTTP/1.1\r\n\r\n", 405},
                 {"get / HTTP/1.1\r\n\r\n", 405}};
    http_request r;
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        CHECK_INT(read_text(wrong[i].text, &r), wrong[i].status);
    }
    char target[1400];
    snprintf(target, sizeof target, "GET /%01200d HTTP/1.1\r\n\r\n", 0);
    CHECK_INT(read_text(target, &r), 414);
}

/* The answer to a request; its end is marked, it is freed by the next call. */
static const char *page(const char *request, bool full, int *status)
{
    static char *text;
    size_t size = 0;
    free(text);
    char *answer = admin_page(request, strlen(request), full, status, &size);
    text = calloc(1, size + 1);
    if (answer) {
        memcpy(text, answer, size);
    }
    free(answer);
    return text;
}

TEST(http_answers_with_a_page_of_the_length_it_says)
{
    int status = -1;
    const char *text = page("GET /livez HTTP/1.1\r\nHost: a\r\n\r\n", false, &status);
    CHECK_INT(status, 200);
    CHECK(strncmp(text, "HTTP/1.1 200 OK\r\n", 17) == 0);
    CHECK(strstr(text, "\r\nContent-Length: 6\r\n") && strstr(text, "\r\nConnection: close\r\n"));
    CHECK_TEXT(strstr(text, "\r\n\r\n"), "\r\n\r\nalive\n");
    text = page("HEAD /livez HTTP/1.1\r\nHost: a\r\n\r\n", false, &status);
    CHECK(strstr(text, "\r\nContent-Length: 6\r\n") != NULL);
    CHECK_TEXT(strstr(text, "\r\n\r\n"), "\r\n\r\n");
    page("GET /livez2 HTTP/1.1\r\n\r\n", false, &status);
    CHECK_INT(status, 404);
    text = page("PUT /livez HTTP/1.1\r\n\r\n", false, &status);
    CHECK_INT(status, 405);
    CHECK(strstr(text, "\r\nAllow: GET, HEAD\r\n") != NULL);
}

TEST(http_request_that_fills_its_room_is_refused)
{
    int status = -1;
    CHECK_TEXT(page("GET /livez HTTP/1.1\r\n", false, &status), "");
    CHECK_INT(status, 0);
    CHECK(strncmp(page("GET /livez HTTP/1.1\r\n", true, &status), "HTTP/1.1 431 ", 13) == 0);
}
