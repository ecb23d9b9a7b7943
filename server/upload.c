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
    auth_sha256_init(&up->hash);
    return up;
}

upload *upload_of(unsigned char *bytes, size_t size)
{
    upload *up = calloc(1, sizeof *up);
    if (!up) {
        free(bytes);
        return NULL;
    }
    *up =
        (upload){.references = 1, .total = size, .received = size, .complete = true, .bytes = bytes, .capacity = size};
    return up;
}

upload *upload_hold(upload *up)
{
    up->references++;
    return up;
}

void upload_release(upload *up)
{
    if (up && --up->references == 0) {
        if (up->budget) {
            up->budget->used -= up->capacity;
        }
        free(up->bytes);
        free(up);
    }
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
    if (more > up->budget->greatest - up->budget->used) {
        return UPLOAD_OVER_BUDGET;
    }
    unsigned char *larger = capacity <= SIZE_MAX ? realloc(up->bytes, (size_t)capacity) : NULL;
    if (!larger) {
        return UPLOAD_NO_MEMORY;
    }
    up->bytes = larger;
    up->capacity = (size_t)capacity;
    up->budget->used += more;
    return UPLOAD_TAKEN;
}

upload_result upload_add(upload *up, uint64_t total, uint64_t offset, const uint8_t expected[AUTH_HASH_SIZE],
                         const unsigned char *piece, size_t size)
{
    if (up->complete || total != up->total || offset != up->received ||
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
        auth_sha256_add(&up->hash, piece, size);
        up->received += size;
    }
    if (up->received == total) {
        uint8_t hash[AUTH_HASH_SIZE];
        auth_sha256_done(&up->hash, hash);
        up->complete = auth_equal(hash, up->expected, sizeof hash);
        return up->complete ? UPLOAD_TAKEN : UPLOAD_WRONG_HASH;
    }
    return UPLOAD_TAKEN;
}
