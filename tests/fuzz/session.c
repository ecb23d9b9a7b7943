/* session.c: the daemon's sessions, with whatever several clients may send in whatever order: the bytes are decisions
 * of tests/unit/interleaving.h. */
#include "fuzz/fuzz.h"

#include "base/assert.h"
#include "base/rng.h"
#include "unit/interleaving.h"

enum { MOST_BYTES = 4096, SEEDS = 8, SEED_BYTES = 1024 };

void fuzz_run_session(const uint8_t *bytes, size_t size)
{
    if (size <= MOST_BYTES) {
        const interleaving seen = interleaving_of_bytes(bytes, size);
        ASSERT(!seen.broken);
    }
}

void fuzz_seed_session(void (*give)(const void *bytes, size_t size))
{
    for (uint64_t seed = 0; seed < SEEDS; seed++) {
        rng random = rng_seed(seed);
        uint8_t bytes[SEED_BYTES];
        for (int i = 0; i < SEED_BYTES; i++) {
            bytes[i] = (uint8_t)rng_u32(&random);
        }
        give(bytes, sizeof bytes);
    }
}
