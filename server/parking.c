/* parking.c: see parking.h. */
#include "parking.h"
#include "auth.h"

#include <stdlib.h>
#include <string.h>

typedef struct parked {
    struct parked *next;
    uint8_t token[PARKING_TOKEN_SIZE];
    holdings left;
    int64_t until_us;
} parked;

/* Unlinks the one that `link` leads to. */
static parked *unlink_at(parking *p, parked **link, parked *before)
{
    parked *gone = *link;
    *link = gone->next;
    p->last = p->last == gone ? before : p->last;
    p->count--;
    return gone;
}

static void give_up_first(parking *p, const registry *forests, int64_t now_us)
{
    parked *gone = unlink_at(p, &p->first, NULL);
    holdings_fini(&gone->left, forests, now_us);
    free(gone);
}

void parking_fini(parking *p, const registry *forests, int64_t now_us)
{
    while (p->first) {
        give_up_first(p, forests, now_us);
    }
}

void parking_leave(parking *p, const uint8_t token[PARKING_TOKEN_SIZE], holdings *left, const registry *forests,
                   int64_t now_us, int64_t until_us)
{
    parked *place = malloc(sizeof *place);
    if (!place) {
        holdings_fini(left, forests, now_us);
        return;
    }
    *place = (parked){.left = *left, .until_us = until_us};
    memcpy(place->token, token, sizeof place->token);
    *left = (holdings){0};
    if (p->count == LIMIT_PARKED) {
        give_up_first(p, forests, now_us);
    }
    *(p->last ? &p->last->next : &p->first) = place;
    p->last = place;
    p->count++;
}

bool parking_take(parking *p, const uint8_t token[PARKING_TOKEN_SIZE], holdings *out)
{
    parked **link = &p->first, *before = NULL;
    while (*link && !auth_equal((*link)->token, token, PARKING_TOKEN_SIZE)) {
        before = *link;
        link = &before->next;
    }
    if (!*link) {
        return false;
    }
    parked *found = unlink_at(p, link, before);
    *out = found->left;
    free(found);
    return true;
}

int64_t parking_due_us(const parking *p)
{
    return p->first ? p->first->until_us : INT64_MAX;
}

void parking_expire(parking *p, const registry *forests, int64_t now_us, int64_t grace_us)
{
    const bool slept = p->first && now_us - p->first->until_us > LIMIT_SLEPT_US;
    for (parked *left = slept ? p->first : NULL; left; left = left->next) {
        left->until_us = now_us + grace_us;
    }
    while (p->first && now_us >= p->first->until_us) {
        give_up_first(p, forests, now_us);
    }
}
