/* deadlines.c: see deadlines.h. */
#include "deadlines.h"
#include "base/assert.h"

#include <stdlib.h>

void deadlines_fini(deadlines *all)
{
    free(all->heap);
    *all = (deadlines){0};
}

bool deadlines_reserve(deadlines *all, uint32_t count)
{
    if (count <= all->room) {
        return true;
    }
    deadline **larger = realloc(all->heap, count * sizeof *larger);
    if (!larger) {
        return false;
    }
    all->heap = larger;
    all->room = count;
    return true;
}

static void put(deadlines *all, deadline *d, uint32_t place)
{
    all->heap[place - 1] = d;
    d->place = place;
}

/* Towards the front while it is earlier than what stands there. */
static void rise(deadlines *all, deadline *d, uint32_t place)
{
    for (; place > 1 && d->at_us < all->heap[place / 2 - 1]->at_us; place /= 2) {
        put(all, all->heap[place / 2 - 1], place);
    }
    put(all, d, place);
}

/* Towards the back while one there is earlier. */
static void sink(deadlines *all, deadline *d, uint32_t place)
{
    while (place <= all->count / 2) {
        uint32_t next = 2 * place;
        if (next < all->count && all->heap[next]->at_us < all->heap[next - 1]->at_us) {
            next++;
        }
        if (d->at_us <= all->heap[next - 1]->at_us) {
            break;
        }
        put(all, all->heap[next - 1], place);
        place = next;
    }
    put(all, d, place);
}

static void settle(deadlines *all, deadline *d, uint32_t place)
{
    rise(all, d, place);
    sink(all, d, d->place);
}

static void take_out(deadlines *all, deadline *d)
{
    uint32_t place = d->place;
    deadline *last = all->heap[--all->count];
    d->place = 0;
    if (last != d) {
        settle(all, last, place);
    }
}

void deadlines_set(deadlines *all, deadline *d, int64_t at_us)
{
    d->at_us = at_us;
    if (at_us == INT64_MAX) {
        if (d->place) {
            take_out(all, d);
        }
        return;
    }
    if (!d->place) {
        ASSERT(all->count < all->room);
        d->place = ++all->count;
    }
    settle(all, d, d->place);
}

deadline *deadlines_first(const deadlines *all)
{
    return all->count > 0 ? all->heap[0] : NULL;
}
