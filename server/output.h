/* output.h: what a connection still has to send, in order: small messages that it owns, and frames that it shares.
 *
 * A FRAME's own fields are encoded when its first byte goes out, so that its age and the last frame's writing time are
 * true then. Several messages go out in one call, a frame alone. */
#ifndef OUTPUT_H
#define OUTPUT_H

#include "net.h"
#include "picture.h"

typedef struct output_segment output_segment;

typedef struct output {
    output_segment *first, *last;
    size_t segments, bytes; /* unsent; a frame counts with its GLB */
    size_t sent;            /* of the first segment */
    int64_t begun_us;       /* when the first segment's first byte went out */
    uint32_t last_write_us; /* first byte to last of the last frame sent; 0: none */
    uint64_t frames_sent, bytes_sent;
} output;

/* Frees; accepts a zeroed one. A zeroed output is empty. */
void output_fini(output *out);
/* Throws away what is unsent. */
void output_discard(output *out);

/* False: no memory. */
bool output_add_message(output *out, const proto_message *message);
/* A view of a picture; takes the reference. False: no memory. */
bool output_add_picture(output *out, picture *shown, const view *v, const delivery *to);

/* Sends until all is sent (NET_DONE), the socket takes no more (NET_LATER), `most` bytes went out (NET_DONE, and not
 * empty), or the connection is broken (NET_FAILED). */
net_result output_write(output *out, int fd, size_t most, int64_t (*clock_us)(void));

#endif
