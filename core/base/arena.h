/* arena.h: one block of memory handed out from its front, freed as a whole.
 *
 * Sizes are never computed apart from the layout: a counting arena (no block behind it) runs the same layout
 * function first and says how much the real one needs, so that the two cannot disagree. */
#ifndef BASE_ARENA_H
#define BASE_ARENA_H

#include <stdbool.h>
#include <stddef.h>

enum { ARENA_ALIGNMENT = 64 }; /* a cache line */

typedef struct arena {
    void *block;         /* from the heap */
    unsigned char *base; /* its first aligned byte; NULL: counting only */
    size_t size, used;
    bool overflowed; /* some request did not fit, or its size overflowed */
} arena;

/* An arena that only counts: every push returns NULL, `used` is what a real one needs. */
arena arena_counting(void);
/* Takes a block of `size` bytes from the heap, zeroed (lazily where the system can: what is never touched costs only
 * addresses). False: no memory. */
bool arena_init(arena *a, size_t size);
/* An arena in memory of the caller's, `size` bytes, ARENA_ALIGNMENT or more: up to that many of them go to alignment.
 * Not for arena_fini. */
arena arena_over(void *block, size_t size);
/* Accepts a zeroed arena. */
void arena_fini(arena *a);
/* `count` elements of `element` bytes, aligned to a cache line, zeroed; NULL where they do not fit (and
 * `overflowed` is set) or where the arena only counts. Never NULL for count 0 of a real arena that has not overflowed.
 */
void *arena_push(arena *a, size_t count, size_t element);

/* Scratch discipline: everything pushed after the mark goes with release. Released memory is not zeroed again. */
static inline size_t arena_mark(const arena *a)
{
    return a->used;
}

static inline void arena_release(arena *a, size_t mark)
{
    a->used = mark;
}

#define ARENA_PUSH(a, type, count) ((type *)arena_push((a), (count), sizeof(type)))

#endif
