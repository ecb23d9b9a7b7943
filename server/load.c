/* load.c: see load.h. */
#include "load.h"

#include <stdlib.h>

#define MEAN_WEIGHT 0.3 /* of the newest look */
#define ROOM 0.85       /* of the capacity: below, what was lowered rises again */

/* What encoding costs so many levels down: points of the fifth and of the guides, and what each frame costs anyhow. */
static const double LEVEL_COST[LOAD_COARSER_GREATEST + 1] = {1, 0.3, 0.15};

static double factor(const load_measures *m)
{
    return LEVEL_COST[m->coarser] / (double)(m->thin ? m->thin : 1);
}

void load_meter_take(load_meter *m, const load_measures *in_force, int64_t span_us)
{
    const double span = (double)(span_us > 0 ? span_us : 1);
    const double step = (double)m->step_us / span, encode = (double)m->encode_us / span / factor(in_force);
    m->step_share += MEAN_WEIGHT * (step - m->step_share);
    m->encode_share += MEAN_WEIGHT * (encode - m->encode_share);
    m->step_us = m->encode_us = 0;
}

static int by_importance(const void *a, const void *b)
{
    const float x = ((const load_forest *)a)->importance, y = ((const load_forest *)b)->importance;
    return x < y ? -1 : x > y;
}

static double cost_of(const load_forest *f)
{
    return f->step_share + f->encode_share * factor(&f->measures);
}

/* Lowers one forest after the other to that, the least important first, until the cost is within the bound. */
static double lower(load_forest *forests, uint32_t count, load_measures to, double cost, double bound)
{
    for (uint32_t i = 0; i < count && cost > bound; i++) {
        if (forests[i].streams) {
            cost -= cost_of(&forests[i]);
            forests[i].measures = to;
            cost += cost_of(&forests[i]);
        }
    }
    return cost;
}

load_verdict load_decide(load_forest *forests, uint32_t count, double capacity)
{
    static const load_measures stages[] = {
        {2, 0}, {LOAD_THIN_GREATEST, 0}, {LOAD_THIN_GREATEST, 1}, {LOAD_THIN_GREATEST, LOAD_COARSER_GREATEST}};
    double cost = 0, bound = capacity;
    qsort(forests, count, sizeof *forests, by_importance);
    for (uint32_t i = 0; i < count; i++) {
        bound = forests[i].measures.thin > 1 ? capacity * ROOM : bound;
        forests[i].measures = (load_measures){1, 0};
        cost += cost_of(&forests[i]);
    }
    for (size_t k = 0; k < sizeof stages / sizeof stages[0]; k++) {
        cost = lower(forests, count, stages[k], cost, bound);
    }
    return (load_verdict){.cost = cost, .capacity = capacity, .full = cost > bound};
}
