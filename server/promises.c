/* promises.c: see promises.h. */
#include "promises.h"

#include <stdlib.h>

bool promises_make(promise **list, const promise *made)
{
    promise *p = malloc(sizeof *p);
    if (p) {
        *p = *made;
        p->next = *list;
        *list = p;
    }
    return p != NULL;
}

static void take(promise **link)
{
    promise *taken = *link;
    *link = taken->next;
    free(taken);
}

bool promises_keep(promise **list, uint64_t request, uint64_t forest)
{
    for (promise **link = list; *link; link = &(*link)->next) {
        if ((*link)->request == request && (*link)->forest == forest) {
            take(link);
            return true;
        }
    }
    return false;
}

bool promises_break(promise **list, int64_t now_us, promise *broken)
{
    for (promise **link = list; *link; link = &(*link)->next) {
        if ((*link)->deadline_us <= now_us) {
            *broken = **link;
            take(link);
            return true;
        }
    }
    return false;
}

int64_t promises_due_us(const promise *list)
{
    int64_t due_us = INT64_MAX;
    for (; list; list = list->next) {
        due_us = list->deadline_us < due_us ? list->deadline_us : due_us;
    }
    return due_us;
}

void promises_free(promise **list)
{
    while (*list) {
        take(list);
    }
}
