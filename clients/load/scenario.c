/* scenario.c: see scenario.h. */
#include "load/scenario.h"

#include "load/bare.h"
#include "load/caller.h"

enum { STALL_EVERY = 10, SPARE_DESCRIPTORS = 32 };

static bool add(crew *c, member *m)
{
    if (m && !crew_add(c, m)) {
        m->face->leave(m);
        return false;
    }
    return m != NULL;
}

static int64_t period_of(const load_run *run)
{
    return (int64_t)(1e9 / run->plan->rate);
}

/* The first of `count` senders' requests, spread evenly over their period. */
static int64_t phase_of(int64_t period_ns, uint32_t index, uint32_t count)
{
    return (int64_t)((double)period_ns * index / count);
}

static bool fill_askers(load_run *run, crew *c)
{
    const load_plan *p = run->plan;
    const int64_t period_ns = period_of(run);
    bool good = true;
    for (uint32_t i = 0; good && i < p->connections; i++) {
        const int64_t phase_ns = phase_of(period_ns, i, p->connections);
        good = add(c, caller_asker_create(run, i % p->forests, phase_ns, period_ns)) &&
               (!run->floor || add(c, bare_asker_create(run, i % p->forests, phase_ns, period_ns)));
    }
    return good;
}

static bool fill_visitors(load_run *run, crew *c)
{
    const load_plan *p = run->plan;
    const int64_t period_ns = period_of(run);
    bool good = true;
    for (uint32_t i = 0; good && i < p->connections; i++) {
        const int64_t phase_ns = phase_of(period_ns, i, p->connections);
        good = add(c, caller_visitor_create(run, i % p->forests, phase_ns, period_ns)) &&
               (!run->floor || add(c, bare_visitor_create(run, phase_ns, period_ns)));
    }
    return good;
}

/* Viewers of a head that read at all times. */
static uint32_t readers_of(const load_plan *p, uint32_t head)
{
    uint32_t count = 0;
    for (uint32_t i = head; i < p->connections; i += p->forests) {
        count += !(p->pairs > 0 && i % STALL_EVERY == 0);
    }
    return count;
}

static bool fill_drivers(load_run *run, crew *c)
{
    const load_plan *p = run->plan;
    const int64_t period_ns = period_of(run);
    bool good = true;
    for (uint32_t i = 0; good && i < p->forests; i++) {
        const int64_t phase_ns = phase_of(period_ns, i, p->forests);
        const uint32_t viewers = readers_of(p, i);
        good = add(c, caller_driver_create(run, i, viewers, phase_ns, period_ns)) &&
               (!run->floor || add(c, bare_driver_create(run, i, viewers, phase_ns, period_ns)));
    }
    return good;
}

static bool fill_viewers(load_run *run, crew *c)
{
    const load_plan *p = run->plan;
    bool good = true;
    for (uint32_t i = 0; good && i < p->connections; i++) {
        const bool stalls = p->pairs > 0 && i % STALL_EVERY == 0;
        good = add(c, caller_viewer_create(run, i % p->forests, stalls)) &&
               (!run->floor || stalls || add(c, bare_viewer_create(run, i % p->forests)));
    }
    return good;
}

bool scenario_fill(load_run *run, crew *c)
{
    const load_plan *p = run->plan;
    if (p->scenario == LOAD_CHURN) {
        return fill_visitors(run, c);
    }
    if (!load_scenario_streams(p->scenario)) {
        return fill_askers(run, c);
    }
    return fill_drivers(run, c) && fill_viewers(run, c) &&
           (p->scenario != LOAD_MIXED || add(c, caller_maker_create(run)));
}

uint32_t scenario_descriptors(const load_run *run)
{
    const load_plan *p = run->plan;
    const uint32_t each = p->connections + (load_scenario_streams(p->scenario) ? p->forests + 1 : 0);
    return each * (run->floor ? 2 : 1) + SPARE_DESCRIPTORS;
}
