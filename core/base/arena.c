/* arena.c: see arena.h. */
#include "base/arena.h"

#include <stdint.h>
#include <stdlib.h>

arena arena_counting(void)
{
    return (arena){.size = SIZE_MAX};
}

bool arena_init(arena *a, size_t size)
{
    *a = (arena){0};
    if (size > SIZE_MAX - 2 * ARENA_ALIGNMENT) {
        return false;
    }
    size_t rounded = (size + ARENA_ALIGNMENT - 1) / ARENA_ALIGNMENT * ARENA_ALIGNMENT;
    a->block = calloc(1, rounded + ARENA_ALIGNMENT);
    if (!a->block) {
        return false;
    }
    size_t past = (uintptr_t)a->block % ARENA_ALIGNMENT;
    a->base = (unsigned char *)a->block + (past ? ARENA_ALIGNMENT - past : 0);
    a->size = rounded;
    return true;
}

arena arena_over(void *block, size_t size)
{
    size_t past = (uintptr_t)block % ARENA_ALIGNMENT, skipped = past ? ARENA_ALIGNMENT - past : 0;
    return (arena){.base = (unsigned char *)block + skipped, .size = size - skipped};
}

void arena_fini(arena *a)
{
    free(a->block);
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
