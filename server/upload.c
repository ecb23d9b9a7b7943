/* upload.c: see upload.h. */
#include "upload.h"

#include <stdlib.h>
#include <string.h>

enum { UPLOAD_FIRST_CAPACITY = 64 * 1024 };

upload *upload_create(uint32_t number, uint64_t total, const uint8_t expected[AUTH_HASH_SIZE], upload_budget *budget)
{
    upload *up = calloc(1, sizeof *up);
    if (!up) {
        return NULL;
    }
    up->references = 1;
    up->number = number;
    up->total = total;
    up->budget = budget;
    memcpy(up->expected, expected, AUTH_HASH_SIZE);
    return up;
}

upload *upload_of(unsigned char *bytes, size_t size)
{
    upload *up = calloc(1, sizeof *up);
    if (!up) {
        free(bytes);
        return NULL;
    }
    up->references = 1;
    up->total = up->received = size;
    up->bytes = bytes;
    up->capacity = size;
    atomic_init(&up->matches, true);
    return up;
}

upload *upload_hold(upload *up)
{
    up->references++;
    return up;
}

static void give_back(upload_budget *budget, uint64_t bytes)
{
    for (; budget; budget = budget->above) {
        budget->used -= bytes;
    }
}

void upload_release(upload *up)
{
    if (up && --up->references == 0) {
        give_back(up->budget, up->capacity);
        free(up->bytes);
        free(up);
    }
}

bool upload_is_complete(const upload *up)
{
    return up->received == up->total;
}

bool upload_matches(upload *up)
{
    if (!atomic_load_explicit(&up->matches, memory_order_relaxed)) {
        uint8_t found[AUTH_HASH_SIZE];
        auth_sha256 hash;
        auth_sha256_init(&hash);
        auth_sha256_add(&hash, up->bytes, (size_t)up->total);
        auth_sha256_done(&hash, found);
        atomic_store_explicit(&up->matches, auth_equal(found, up->expected, sizeof found), memory_order_relaxed);
    }
    return atomic_load_explicit(&up->matches, memory_order_relaxed);
}

/* Doubles, but never past the announced total, until `needed` bytes fit. */
static upload_result make_room(upload *up, uint64_t needed)
{
    if (needed <= up->capacity) {
        return UPLOAD_TAKEN;
    }
    uint64_t capacity = up->capacity ? up->capacity : UPLOAD_FIRST_CAPACITY;
    while (capacity < needed) {
        capacity *= 2;
    }
    capacity = capacity < up->total ? capacity : up->total;
    uint64_t more = capacity - up->capacity;
    for (const upload_budget *b = up->budget; b; b = b->above) {
        if (b->used > b->greatest || more > b->greatest - b->used) {
            return UPLOAD_OVER_BUDGET;
        }
    }
    unsigned char *larger = capacity <= SIZE_MAX ? realloc(up->bytes, (size_t)capacity) : NULL;
    if (!larger) {
        return UPLOAD_NO_MEMORY;
    }
    up->bytes = larger;
    up->capacity = (size_t)capacity;
    for (upload_budget *b = up->budget; b; b = b->above) {
        b->used += more;
    }
    return UPLOAD_TAKEN;
}

upload_result upload_add(upload *up, uint64_t total, uint64_t offset, const uint8_t expected[AUTH_HASH_SIZE],
                         const unsigned char *piece, size_t size)
{
    if (upload_is_complete(up) || total != up->total || offset != up->received ||
        memcmp(expected, up->expected, AUTH_HASH_SIZE) != 0) {
        return UPLOAD_OUT_OF_ORDER;
    }
    if (size > total - offset) {
        return UPLOAD_TOO_LONG;
    }
    upload_result room = make_room(up, offset + size);
    if (room != UPLOAD_TAKEN) {
        return room;
    }
    if (size > 0) {
        memcpy(up->bytes + offset, piece, size);
        up->received += size;
    }
    return UPLOAD_TAKEN;
}
