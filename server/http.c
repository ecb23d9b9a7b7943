/* http.c: see http.h. */
#include "http.h"

#include <stdio.h>
#include <string.h>

enum { METHOD = 16 };

/* The length of the head with the empty line that ends it; 0: it has not ended. */
static size_t head_size(const char *bytes, size_t size)
{
    for (size_t i = 0; i + 4 <= size; i++) {
        if (memcmp(bytes + i, "\r\n\r\n", 4) == 0) {
            return i + 4;
        }
    }
    return 0;
}

/* Only what is printable stands in a head, but for the line ends; and those are whole. */
static bool is_plain(const char *bytes, size_t size)
{
    for (size_t i = 0; i < size; i++) {
        const unsigned char c = (unsigned char)bytes[i];
        const bool ends = c == '\r' ? i + 1 < size && bytes[i + 1] == '\n' : c == '\n' && i > 0 && bytes[i - 1] == '\r';
        if ((c < 0x20 && c != '\t' && !ends) || c == 0x7f) {
            return false;
        }
    }
    return true;
}

/* Copies up to the next blank of the first line, and moves `at` behind it. False: there is none, or no room. */
static bool take_word(const char **at, const char *end, char *out, size_t out_size)
{
    const char *blank = memchr(*at, ' ', (size_t)(end - *at));
    const size_t length = blank ? (size_t)(blank - *at) : 0;
    if (!blank || length == 0 || length >= out_size) {
        return false;
    }
    memcpy(out, *at, length);
    out[length] = '\0';
    *at = blank + 1;
    return true;
}

static bool is_version(const char *at, const char *end)
{
    return end - at == 8 && memcmp(at, "HTTP/1.", 7) == 0 && at[7] >= '0' && at[7] <= '9';
}

int http_read(const char *bytes, size_t size, http_request *out)
{
    const size_t head = head_size(bytes, size);
    *out = (http_request){0};
    if (head == 0) {
        return HTTP_MORE;
    }
    const char *at = bytes, *end = memchr(bytes, '\r', head);
    char method[METHOD], target[1024];
    if (!is_plain(bytes, head) || !take_word(&at, end, method, sizeof method)) {
        return 400;
    }
    if (!memchr(at, ' ', (size_t)(end - at))) {
        return 400;
    }
    if (!take_word(&at, end, target, sizeof target)) {
        return *at == ' ' ? 400 : 414;
    }
    target[strcspn(target, "?")] = '\0';
    if (target[0] != '/') {
        return 400;
    }
    if (!is_version(at, end)) {
        return end - at >= 5 && memcmp(at, "HTTP/", 5) == 0 ? 505 : 400;
    }
    out->head_only = strcmp(method, "HEAD") == 0;
    if (!out->head_only && strcmp(method, "GET") != 0) {
        return 405;
    }
    /* a longer path is none of ours: cut, it is none either */
    snprintf(out->path, sizeof out->path, "%.*s", HTTP_PATH - 1, target);
    return 200;
}

static const char *reason(int status)
{
    switch (status) {
    case 200:
        return "OK";
    case 404:
        return "Not Found";
    case 405:
        return "Method Not Allowed";
    case 414:
        return "URI Too Long";
    case 431:
        return "Request Header Fields Too Large";
    case 503:
        return "Service Unavailable";
    case 505:
        return "HTTP Version Not Supported";
    default:
        return "Bad Request";
    }
}

size_t http_write_head(int status, size_t body_size, char out[HTTP_HEAD])
{
    int length = snprintf(out, HTTP_HEAD,
                          "HTTP/1.1 %d %s\r\nContent-Type: text/plain; version=0.0.4; charset=utf-8\r\n"
                          "Content-Length: %zu\r\nCache-Control: no-store\r\n%sConnection: close\r\n\r\n",
                          status, reason(status), body_size, status == 405 ? "Allow: GET, HEAD\r\n" : "");
    return (size_t)length;
}
