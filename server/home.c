/* home.c: see home.h. */
#include "home.h"
#include "base/assert.h"
#include "limits.h"
#include "service.h"

#include <stdlib.h>

bool homes_init(homes *all, uint32_t hot_count)
{
    *all = (homes){.list = calloc(hot_count + 1, sizeof *all->list)};
    if (!all->list) {
        return false;
    }
    for (uint32_t i = 0; i <= hot_count; i++) {
        if (!wake_init(&all->list[i].bell)) {
            while (i > 0) {
                wake_fini(&all->list[--i].bell);
            }
            free(all->list);
            *all = (homes){0};
            return false;
        }
    }
    all->hot_count = hot_count;
    homes_cold(all)->is_cold = true;
    return true;
}

void homes_fini(homes *all)
{
    for (uint32_t i = 0; all->list && i <= all->hot_count; i++) {
        wake_fini(&all->list[i].bell);
    }
    free(all->list);
    *all = (homes){0};
}

home *homes_cold(const homes *all)
{
    return &all->list[all->hot_count];
}

home *homes_hot(const homes *all)
{
    home *best = &all->list[0];
    for (uint32_t i = 1; i < all->hot_count && best->count >= LIMIT_HOT_SET; i++) {
        if (all->list[i].count < best->count) {
            best = &all->list[i];
        }
    }
    return best;
}

void home_ring(home *h, struct service *shared)
{
    if (h->asleep && !h->rung) {
        h->rung = true;
        h->next_rung = shared->to_ring;
        shared->to_ring = h;
    }
}

void home_tell(home *h, struct service *shared, home_link *link)
{
    if (link->listed) {
        return;
    }
    link->listed = true;
    link->next = NULL;
    *(h->last ? &h->last->next : &h->first) = link;
    h->last = link;
    h->told++;
    home_ring(h, shared);
}

void *home_take(home *h)
{
    home_link *link = h->first;
    if (!link) {
        return NULL;
    }
    h->first = link->next;
    h->last = h->first ? h->last : NULL;
    h->told--;
    link->listed = false;
    return link->owner;
}

void home_falls_asleep(home *h)
{
    ASSERT(h->told == 0);
    h->asleep = true;
    h->rung = false;
}

void home_wakes(home *h)
{
    h->asleep = false;
}
