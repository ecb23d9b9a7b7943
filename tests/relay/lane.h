/* lane.h: one direction of a relayed connection: pieces of bytes, each with the time at which it is due at the other
 * end. The order of a TCP stream is kept whatever the jitter. No socket and no clock: the caller says what time it is.
 */
#ifndef RELAY_LANE_H
#define RELAY_LANE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { LANE_PIECE = 4096 };

/* What a lane does to what goes through it. */
typedef struct lane_rules {
    int64_t delay_us;  /* of each piece */
    int64_t jitter_us; /* added to it: uniform from 0 to this */
    double rate;       /* bytes a second; 0: as fast as it goes */
    size_t queue;      /* bytes on the way at most, as a router holds them; >= LANE_PIECE */
} lane_rules;

typedef struct lane_piece {
    int64_t due_us;
    uint32_t size, sent;
    unsigned char bytes[LANE_PIECE];
} lane_piece;

/* A ring of pieces. Zeroed: empty, to be given rules by lane_init. */
typedef struct lane {
    lane_rules rules;
    lane_piece *pieces; /* heap, [capacity] */
    size_t capacity, first, count;
    int64_t free_us, last_due_us; /* when the link has sent what it holds; when its last piece is due */
    uint64_t random;              /* state of the jitter */
} lane;

/* False: no memory. */
bool lane_init(lane *self, const lane_rules *rules, uint64_t seed);
void lane_fini(lane *self);

/* Where up to LANE_PIECE bytes that came may be put; NULL: the lane is full. */
unsigned char *lane_room(lane *self);
/* They have been put there at that time; 0 < size <= LANE_PIECE. */
void lane_put(lane *self, size_t size, int64_t now_us);

/* What is due now and not yet sent; *size 0: nothing. */
const unsigned char *lane_due(const lane *self, int64_t now_us, size_t *size);
/* The first `size` bytes of it have gone. */
void lane_sent(lane *self, size_t size);

/* When the next piece is due; INT64_MAX: none is on its way. */
int64_t lane_next_us(const lane *self);

#endif
