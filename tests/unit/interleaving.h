/* interleaving.h: the daemon's protocol logic against several clients at once, in memory, one decision after another:
 * who connects, what is sent, how many of its bytes arrive, when a worker runs, when a connection is cut, at any byte.
 *
 * Decisions come from a seed or from a fuzzer's bytes; the same ones give the same conversation to the byte. What must
 * hold whatever is decided is checked all along: each request is answered once, by its own id; nobody gets a frame
 * without credit, or an older one after a newer; and when all have gone nothing of theirs is left. */
#ifndef INTERLEAVING_H
#define INTERLEAVING_H

#include <stddef.h>
#include <stdint.h>

typedef struct interleaving {
    const char *broken; /* what did not hold; NULL: everything did */
    uint64_t hash;      /* of all that the daemon sent, to whom and in which order */
    uint32_t sent, answers, errors, frames, cuts;
    uint32_t restored, many, clocks; /* of the answers, those to RESTORE, STEP_MANY and SET_CLOCK */
} interleaving;

/* So many decisions, taken from the seed. */
interleaving interleaving_of_seed(uint64_t seed, uint32_t decisions);
/* Decisions until the bytes have run out. */
interleaving interleaving_of_bytes(const uint8_t *bytes, size_t size);

#endif
