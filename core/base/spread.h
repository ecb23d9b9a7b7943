/* spread.h: work in parts for whoever is free, so that who does the work needs to know nothing of threads. */
#ifndef BASE_SPREAD_H
#define BASE_SPREAD_H

#include <stddef.h>
#include <stdint.h>

/* One part: of `work`, number `index`. Parts are done in any order and at the same time: none may need another. */
typedef void (*spread_part)(void *work, uint32_t index);

typedef struct spread {
    uint32_t hands; /* threads that may take part at most, the caller's included; at least 1 */
    /* Does parts 0 .. count - 1, each once, and comes back when all are done. */
    void (*run)(void *context, spread_part part, void *work, uint32_t count);
    void *context;
} spread;

/* `over` NULL: the caller alone, in order. */
static inline void spread_run(const spread *over, spread_part part, void *work, uint32_t count)
{
    if (over && over->hands > 1 && count > 1) {
        over->run(over->context, part, work, count);
        return;
    }
    for (uint32_t index = 0; index < count; index++) {
        part(work, index);
    }
}

#endif
