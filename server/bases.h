/* bases.h: which frames a receiver is known to hold, so that deltas can be made against them.
 *
 * A receiver keeps the newest LIMIT_DELTA_BASES frames that it acknowledged, and may drop those before the base that
 * the last FRAME named. So a base is one of the frames sent last, acknowledged, and not before the last base named. */
#ifndef BASES_H
#define BASES_H

#include "limits.h"

#include <stdbool.h>
#include <stdint.h>

typedef struct sent_frame {
    uint64_t sequence; /* 0: none */
    int form;
    bool held; /* acknowledged */
} sent_frame;

/* Zeroed: nothing was sent. */
typedef struct bases {
    sent_frame sent[LIMIT_DELTA_BASES];
    uint32_t next;  /* place of the oldest, which the next one takes */
    uint64_t named; /* the last base named; 0: none */
} bases;

/* A frame goes out, as a delta against `base`, or whole: 0. Sequences rise. */
void bases_sent(bases *b, uint64_t sequence, int form, uint64_t base);

/* The receiver has that frame; 0: it has none any more. One that is too old to be known is passed over. False: it was
 * never sent, and nothing has changed. */
bool bases_acknowledge(bases *b, uint64_t sequence);

/* The frames of a form that may be bases, the newest first: `n` counts from 0. 0: no more. */
uint64_t bases_at(const bases *b, int form, uint32_t n);

#endif
