/* holdings.c: see holdings.h. */
#include "holdings.h"
#include "proto.h"

#include <stdlib.h>

enum { FIRST_ATTACHMENTS = 4 };

static void leave(const registry *forests, uint64_t forest, int64_t now_us)
{
    resident *r = registry_find(forests, forest);
    if (r) {
        r->holders--;
        r->left_us = now_us;
    }
}

void holdings_fini(holdings *h, const registry *forests, int64_t now_us)
{
    for (uint32_t i = 0; i < h->count; i++) {
        leave(forests, h->attachments[i].forest, now_us);
    }
    for (uint32_t i = 0; i < LIMIT_SESSION_UPLOADS; i++) {
        upload_release(h->uploads[i]);
    }
    free(h->attachments);
    *h = (holdings){0};
}

bool holdings_are_none(const holdings *h)
{
    bool none = h->count == 0;
    for (uint32_t i = 0; i < LIMIT_SESSION_UPLOADS; i++) {
        none = none && !h->uploads[i];
    }
    return none;
}

attachment *holdings_find(const holdings *h, uint64_t forest)
{
    for (uint32_t i = 0; i < h->count; i++) {
        if (h->attachments[i].forest == forest) {
            return &h->attachments[i];
        }
    }
    return NULL;
}

/* Forgets forests that have ended elsewhere. */
static void drop_stale(holdings *h, const registry *forests)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < h->count; i++) {
        if (registry_find(forests, h->attachments[i].forest)) {
            h->attachments[kept++] = h->attachments[i];
        }
    }
    h->count = kept;
}

static bool grow(holdings *h)
{
    const uint32_t capacity = h->capacity ? 2 * h->capacity : FIRST_ATTACHMENTS;
    attachment *larger = realloc(h->attachments, capacity * sizeof *larger);
    if (larger) {
        h->attachments = larger;
        h->capacity = capacity;
    }
    return larger != NULL;
}

int holdings_open(holdings *h, const registry *forests, resident *r, bool may_drive)
{
    attachment *found = holdings_find(h, r->handle);
    if (found) {
        found->may_drive = found->may_drive || may_drive;
        return 0;
    }
    if (h->count == h->capacity) {
        drop_stale(h, forests);
    }
    if (h->count >= LIMIT_SESSION_FORESTS) {
        return PROTO_ERROR_LIMIT;
    }
    if (h->count == h->capacity && !grow(h)) {
        return PROTO_ERROR_NO_MEMORY;
    }
    h->attachments[h->count++] = (attachment){.forest = r->handle, .may_drive = may_drive};
    r->holders++;
    return 0;
}

void holdings_close(holdings *h, const registry *forests, uint64_t forest, int64_t now_us)
{
    attachment *found = holdings_find(h, forest);
    if (found) {
        leave(forests, forest, now_us);
        *found = h->attachments[--h->count];
    }
}

uint32_t holdings_driven(const holdings *h, const registry *forests)
{
    uint32_t driven = 0;
    for (uint32_t i = 0; i < h->count; i++) {
        driven += h->attachments[i].may_drive && registry_find(forests, h->attachments[i].forest);
    }
    return driven;
}
