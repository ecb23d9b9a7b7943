/* input.h: bytes from a socket, cut into messages.
 *
 * A header is shown to the caller before room is made for its payload; the caller takes it or has it skipped. Room
 * grows with the bytes that have come, up to the length that was announced and judged. */
#ifndef INPUT_H
#define INPUT_H

#include "proto.h"

typedef struct input {
    unsigned char *bytes; /* [capacity], heap */
    size_t capacity, begin, end;
    size_t skip;    /* bytes still to be thrown away */
    size_t payload; /* of the header that was taken */
    bool header_taken;
} input;

typedef enum input_event {
    INPUT_MORE,   /* nothing whole: bytes must come */
    INPUT_HEADER, /* a header: input_take or input_skip must follow */
    INPUT_MESSAGE /* the payload of the header that was taken: input_done must follow */
} input_event;

/* Frees; accepts a zeroed one. A zeroed input is empty. */
void input_fini(input *in);

/* Gives the buffer back if nothing is in it. */
void input_rest(input *in);

/* Room for the bytes that come next, at least one, in a buffer of at least `capacity`, which is PROTO_HEADER_SIZE or
 * more. Not while input_ready. 0: no memory. */
size_t input_room(input *in, size_t capacity, unsigned char **room);
/* So many came. */
void input_came(input *in, size_t size);

/* What is there. *payload is good until input_done. */
input_event input_next(input *in, proto_header *header, const unsigned char **payload);
void input_take(input *in, const proto_header *header);
void input_skip(input *in, const proto_header *header);
void input_done(input *in);

/* True if input_next would say more than INPUT_MORE. */
bool input_ready(const input *in);

#endif
