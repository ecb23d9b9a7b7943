/* arena.c: see arena.h. */
#include "base/arena.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { ARENA_ALIGNMENT = 64 };

arena arena_counting(void)
{
    return (arena){.size = SIZE_MAX};
}

bool arena_init(arena *a, size_t size)
{
    *a = (arena){0};
    if (size > SIZE_MAX - ARENA_ALIGNMENT) {
        return false;
    }
    size_t rounded = (size + ARENA_ALIGNMENT - 1) / ARENA_ALIGNMENT * ARENA_ALIGNMENT;
    a->base = aligned_alloc(ARENA_ALIGNMENT, rounded ? rounded : ARENA_ALIGNMENT);
    if (!a->base) {
        return false;
    }
    memset(a->base, 0, rounded);
    a->size = rounded;
    return true;
}

void arena_fini(arena *a)
{
    free(a->base);
    *a = (arena){0};
}

void *arena_push(arena *a, size_t count, size_t element)
{
    size_t room = a->size - a->used;
    if (a->overflowed || (element && count > (SIZE_MAX - ARENA_ALIGNMENT) / element)) {
        a->overflowed = true;
        return NULL;
    }
    size_t bytes = (count * element + ARENA_ALIGNMENT - 1) / ARENA_ALIGNMENT * ARENA_ALIGNMENT;
    if (bytes > room) {
        a->overflowed = true;
        return NULL;
    }
    void *result = a->base ? a->base + a->used : NULL;
    a->used += bytes;
    return result;
}
