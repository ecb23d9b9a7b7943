/* heap_seam.c: see heap_seam.h. */
#include "unit/heap_seam.h"

#include <errno.h>
#include <stdlib.h>
#if defined(__GLIBC__)
#include <malloc.h>
#define BYTES_OF(block) ((int64_t)malloc_usable_size(block))
#else
#define BYTES_OF(block) INT64_C(0)
#endif

static _Thread_local struct {
    bool watched, numbered;
    uint32_t failing;
    heap_seen seen;
} seam;

/* An allocation is asked for. True: it is to fail. */
static bool ask(void)
{
    if (!seam.watched) {
        return false;
    }
    seam.seen.calls++;
    const bool fails = seam.numbered && ++seam.seen.allocations == seam.failing;
    seam.seen.failed = seam.seen.failed || fails;
    if (fails) {
        errno = ENOMEM;
    }
    return fails;
}

/* A block was taken (sign 1), or is given back (-1). Accepts NULL. */
static void account(void *block, int sign)
{
    if (seam.watched && block) {
        seam.seen.blocks += sign;
        seam.seen.bytes += sign * BYTES_OF(block);
        seam.seen.most_bytes = seam.seen.bytes > seam.seen.most_bytes ? seam.seen.bytes : seam.seen.most_bytes;
    }
}

#define TAKING(name, parameters, arguments)                   \
    void *__real_##name parameters;                           \
    void *__wrap_##name parameters;                           \
    void *__wrap_##name parameters                            \
    {                                                         \
        void *block = ask() ? NULL : __real_##name arguments; \
        account(block, 1);                                    \
        return block;                                         \
    }

TAKING(malloc, (size_t size), (size))
TAKING(calloc, (size_t count, size_t size), (count, size))
TAKING(aligned_alloc, (size_t alignment, size_t size), (alignment, size))

void *__real_realloc(void *block, size_t size);
void *__wrap_realloc(void *block, size_t size);
void *__wrap_realloc(void *block, size_t size)
{
    if (ask()) {
        return NULL;
    }
    account(block, -1);
    void *larger = __real_realloc(block, size);
    account(larger ? larger : block, 1);
    return larger;
}

int __real_posix_memalign(void **block, size_t alignment, size_t size);
int __wrap_posix_memalign(void **block, size_t alignment, size_t size);
int __wrap_posix_memalign(void **block, size_t alignment, size_t size)
{
    const int failure = ask() ? ENOMEM : __real_posix_memalign(block, alignment, size);
    account(failure ? NULL : *block, 1);
    return failure;
}

void __real_free(void *block);
void __wrap_free(void *block);
void __wrap_free(void *block)
{
    seam.seen.calls += seam.watched;
    account(block, -1);
    __real_free(block);
}

void heap_watch(void)
{
    seam.numbered = false;
    seam.failing = 0;
    seam.seen = (heap_seen){0};
    seam.watched = true;
}

heap_seen heap_look(void)
{
    return seam.seen;
}

heap_seen heap_watch_end(void)
{
    seam.watched = false;
    return seam.seen;
}

void heap_number(bool numbered)
{
    seam.numbered = numbered;
}

void heap_fail(uint32_t number)
{
    seam.failing = number;
}
