/* hash.h: FNV-1a over 64-bit little-endian words, for state hashes and golden tests (not for strangers' bytes). */
#ifndef BASE_HASH_H
#define BASE_HASH_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#define HASH_SEED UINT64_C(14695981039346656037)

static inline uint64_t hash_u64(uint64_t hash, uint64_t value)
{
    hash = (hash ^ value) * UINT64_C(1099511628211);
    return hash ^ (hash >> 32);
}

/* `count` 32-bit values (floats by their bits). */
static inline uint64_t hash_words(uint64_t hash, const void *words, size_t count)
{
    const unsigned char *bytes = words;
    for (size_t i = 0; i < count; i++) {
        uint32_t word;
        memcpy(&word, bytes + 4 * i, sizeof word);
        hash = hash_u64(hash, word);
    }
    return hash;
}

#endif
