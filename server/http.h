/* http.h: as much of HTTP/1.1 as a GET of one of three pages takes. Pure: bytes in, bytes out. No request's body is
 * read; every answer ends its connection. */
#ifndef SERVER_HTTP_H
#define SERVER_HTTP_H

#include <stdbool.h>
#include <stddef.h>

enum { HTTP_PATH = 64, HTTP_HEAD = 256 };

typedef struct http_request {
    bool head_only;       /* HEAD */
    char path[HTTP_PATH]; /* without the query */
} http_request;

enum { HTTP_MORE = 0 }; /* the head is not complete yet */

/* Reads a request's head from `size` bytes. HTTP_MORE, or the status that its answer has: 200 where the request is one
 * that this server understands (404 and the like are the caller's), else 400, 405, 414, or 505. */
int http_read(const char *bytes, size_t size, http_request *out);

/* Writes an answer's head for a body of so many bytes; its length. */
size_t http_write_head(int status, size_t body_size, char out[HTTP_HEAD]);

#endif
