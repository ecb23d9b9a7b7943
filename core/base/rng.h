/* rng.h: a small seeded generator (PCG-XSH-RR, O'Neill 2014): the same seed gives the same numbers everywhere. */
#ifndef BASE_RNG_H
#define BASE_RNG_H

#include <stdint.h>

typedef struct rng {
    uint64_t state;
} rng;

static inline uint32_t rng_u32(rng *r)
{
    uint64_t old = r->state;
    r->state = old * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    uint32_t mixed = (uint32_t)(((old >> 18) ^ old) >> 27);
    uint32_t turn = (uint32_t)(old >> 59);
    return (mixed >> turn) | (mixed << ((32u - turn) & 31u));
}

static inline rng rng_seed(uint64_t seed)
{
    rng r = {seed + UINT64_C(1442695040888963407)};
    rng_u32(&r);
    r.state += seed;
    rng_u32(&r);
    return r;
}

/* In [0, 1), a multiple of 2^-24: exact in float and double alike. */
static inline double rng_unit(rng *r)
{
    return (double)(rng_u32(r) >> 8) * (1.0 / 16777216.0);
}

static inline double rng_between(rng *r, double least, double greatest)
{
    return least + (greatest - least) * rng_unit(r);
}

#endif
