/* openrequests.c: see openrequests.h. */
#include "openrequests.h"

#include <stdlib.h>

enum { FIRST_CAPACITY = 16 };

void openrequests_fini(openrequests *open)
{
    free(open->ring);
    *open = (openrequests){.ring = NULL};
}

static open_request *at(const openrequests *open, size_t number)
{
    return &open->ring[(open->first + number) % open->capacity];
}

/* Number of the open request; `count`: it is not open. */
static size_t find(const openrequests *open, uint64_t request)
{
    size_t number = 0;
    while (number < open->count && at(open, number)->request != request) {
        number++;
    }
    return number;
}

bool openrequests_reserve(openrequests *open)
{
    if (open->count < open->capacity) {
        return true;
    }
    const size_t capacity = open->capacity > 0 ? 2 * open->capacity : FIRST_CAPACITY;
    open_request *larger = capacity <= OPENREQUESTS_MAX ? malloc(capacity * sizeof *larger) : NULL;
    if (!larger) {
        return false;
    }
    for (size_t i = 0; i < open->count; i++) {
        larger[i] = *at(open, i);
    }
    free(open->ring);
    open->ring = larger;
    open->capacity = capacity;
    open->first = 0;
    return true;
}

void openrequests_add(openrequests *open, uint64_t request, uint16_t type)
{
    open->count++;
    *at(open, open->count - 1) = (open_request){request, type, INT64_MAX};
}

/* Those in front that have been answered leave. */
static void trim(openrequests *open)
{
    while (open->count > 0 && open->ring[open->first].request == 0) {
        open->first = (open->first + 1) % open->capacity;
        open->count--;
    }
}

void openrequests_remove(openrequests *open, uint64_t request)
{
    const size_t number = request != 0 ? find(open, request) : open->count;
    if (number < open->count) {
        at(open, number)->request = 0;
        trim(open);
    }
}

void openrequests_prolong(openrequests *open, uint64_t request)
{
    const size_t number = request != 0 ? find(open, request) : open->count;
    if (number < open->count) {
        const uint16_t type = at(open, number)->type;
        for (size_t i = number; i + 1 < open->count; i++) {
            *at(open, i) = *at(open, i + 1);
        }
        *at(open, open->count - 1) = (open_request){request, type, INT64_MAX};
        trim(open);
    }
}

void openrequests_stamp(openrequests *open, int64_t deadline_us)
{
    for (size_t i = open->count; i > 0 && at(open, i - 1)->deadline_us == INT64_MAX; i--) {
        at(open, i - 1)->deadline_us = deadline_us;
    }
}

const open_request *openrequests_first(const openrequests *open)
{
    return open->count > 0 ? &open->ring[open->first] : NULL;
}
