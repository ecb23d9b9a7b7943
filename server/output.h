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

/* What goes to the socket next; the output is not empty. Number of pieces, which stay good, whatever is added, until
 * output_took. One sender at a time. */
size_t output_gather(output *out, struct iovec pieces[LIMIT_OUTPUT_GATHER], int64_t now_us);
/* So many bytes of that went out. */
void output_took(output *out, size_t sent, int64_t now_us);

#endif
