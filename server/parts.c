/* parts.c: see parts.h. */
#include "parts.h"

#include <stddef.h>

void parts_offer(parts_list *list, parts *offered)
{
    offered->next = offered->running = 0;
    offered->following = NULL;
    *(list->last ? &list->last->following : &list->first) = offered;
    list->last = offered;
}

/* All of its parts are taken. */
static void withdraw(parts_list *list, const parts *offered)
{
    parts *before = NULL;
    parts **at = &list->first;
    while (*at != offered) {
        before = *at;
        at = &before->following;
    }
    *at = offered->following;
    list->last = list->last == offered ? before : list->last;
}

parts *parts_take(parts_list *list, parts *from, uint32_t *index)
{
    parts *of = from ? from : list->first;
    if (!of || of->next == of->count) {
        return NULL;
    }
    *index = of->next++;
    of->running++;
    if (of->next == of->count) {
        withdraw(list, of);
    }
    return of;
}

bool parts_end(parts *of)
{
    of->running--;
    return of->running == 0 && of->next == of->count;
}
