/* hand.c: see hand.h.
 *
 * A hand waits until something comes or the next request is due, whichever is first. It watches the side whose turn it
 * is; the other side only while its answers are still to come, and a little longer, so that what the one costs does not
 * depend on how many connections the other has. */
#include "load/hand.h"

#include "load/wait.h"

#include <stdlib.h>

enum { HAND_IDLE_NS = 50000000, HAND_DRAIN_NS = 5000000, DRAIN_MOST_S = 5 };

/* ---- its members ------------------------------------------------------------------------------------------------- */

static bool group_grow(hand *h, group *g)
{
    if (g->count < g->capacity) {
        return true;
    }
    const size_t capacity = g->capacity ? 2 * g->capacity : 16;
    member **members = realloc(g->members, capacity * sizeof(member *));
    g->members = members ? members : g->members;
    const size_t all = h->groups[LOAD_DAEMON].capacity + h->groups[LOAD_BARE].capacity - g->capacity + capacity;
    struct pollfd *polls = realloc(h->polls, all * sizeof *polls);
    h->polls = polls ? polls : h->polls;
    g->capacity = members && polls ? capacity : g->capacity;
    return members && polls;
}

/* Behind those of its side that come earlier; those that send nothing come last. */
static void group_insert(group *g, member *m)
{
    size_t at = g->count++;
    for (; at > 0 && m->face->due && (!g->members[at - 1]->face->due || g->members[at - 1]->phase_ns > m->phase_ns);
         at--) {
        g->members[at] = g->members[at - 1];
    }
    g->members[at] = m;
}

bool hand_add(hand *h, member *m)
{
    group *g = &h->groups[m->side];
    if (!group_grow(h, g)) {
        return false;
    }
    group_insert(g, m);
    return true;
}

void hand_leave(hand *h)
{
    for (int side = 0; side < LOAD_SIDES; side++) {
        group *g = &h->groups[side];
        for (size_t k = 0; k < g->count; k++) {
            g->members[k]->face->leave(g->members[k]);
        }
        free(g->members);
    }
    free(h->polls);
}

bool hand_ready(const hand *h)
{
    for (int side = 0; side < LOAD_SIDES; side++) {
        for (size_t i = 0; i < h->groups[side].count; i++) {
            if (!h->groups[side].members[i]->ready) {
                return false;
            }
        }
    }
    return true;
}

void hand_begin(hand *h)
{
    for (int side = 0; side < LOAD_SIDES; side++) {
        group *g = &h->groups[side];
        g->next = 0;
        g->over = false;
        for (size_t k = 0; k < g->count; k++) {
            g->members[k]->ticks = 0;
        }
    }
}

/* ---- its work ---------------------------------------------------------------------------------------------------- */

static bool group_waits(const group *g)
{
    for (size_t i = 0; i < g->count; i++) {
        if (g->members[i]->waiting_count > 0) {
            return true;
        }
    }
    return false;
}

/* Sends what is due by now. When the next one is, from the run's begin; INT64_MAX: none is. */
static int64_t group_send(load_run *run, group *g, load_side side)
{
    while (!g->over && g->count > 0 && g->members[g->next]->face->due) {
        member *m = g->members[g->next];
        int64_t due_ns;
        uint32_t slice;
        if (!timeline_due(&run->line, side, m->phase_ns, m->period_ns, m->ticks, &due_ns, &slice)) {
            break;
        }
        const int64_t now_ns = wait_now_ns();
        if (run->begin_ns + due_ns > now_ns) {
            return due_ns;
        }
        m->ticks++;
        g->next++;
        if (g->next == g->count || !g->members[g->next]->face->due) {
            g->next = 0;
        }
        m->face->due(m, slice, run->begin_ns + due_ns, now_ns);
    }
    g->over = true;
    return INT64_MAX;
}

/* Where the load is closed, each side's first requests of its turn. */
static void group_begin(group *g, uint32_t slice)
{
    for (size_t i = 0; i < g->count; i++) {
        member *m = g->members[i];
        if (m->face->due && m->waiting_count == 0) {
            const int64_t now_ns = wait_now_ns();
            m->face->due(m, slice, now_ns, now_ns);
        }
    }
}

static void hand_tick(hand *h, uint32_t slice)
{
    for (int side = 0; side < LOAD_SIDES; side++) {
        for (size_t i = 0; i < h->groups[side].count; i++) {
            member *m = h->groups[side].members[i];
            if (m->face->tick) {
                m->face->tick(m, slice);
            }
        }
    }
}

/* Waits for the members of one side, or of both, and lets those have their turn for whom something came. */
static void hand_wait(hand *h, bool daemon, bool bare, int64_t until_ns)
{
    const group *groups = h->groups;
    const size_t counts[LOAD_SIDES] = {daemon ? groups[LOAD_DAEMON].count : 0, bare ? groups[LOAD_BARE].count : 0};
    size_t count = 0;
    for (int side = 0; side < LOAD_SIDES; side++) {
        for (size_t i = 0; i < counts[side]; i++) {
            const member *m = groups[side].members[i];
            h->polls[count++] = (struct pollfd){.fd = m->descriptor, .events = m->events};
        }
    }
    int ready = wait_poll(h->polls, (nfds_t)count, until_ns);
    for (size_t i = 0; i < count && ready > 0; i++) {
        if (h->polls[i].revents) {
            member *m = i < counts[0] ? groups[LOAD_DAEMON].members[i] : groups[LOAD_BARE].members[i - counts[0]];
            m->face->turn(m, h->polls[i].revents);
            ready--;
        }
    }
}

static void hand_begin_slice(hand *h, uint32_t slice)
{
    const timeline *line = &h->run->line;
    h->slice = slice;
    hand_tick(h, slice);
    if (h->run->plan->closed) {
        group_begin(&h->groups[timeline_side((load_mode)line->modes[slice])], slice);
    }
}

static int64_t least(int64_t a, int64_t b)
{
    return a < b ? a : b;
}

static void hand_slice(hand *h, int64_t at_ns)
{
    load_run *run = h->run;
    const timeline *line = &run->line;
    const load_side side = timeline_side((load_mode)line->modes[h->slice]);
    group *other = &h->groups[side == LOAD_DAEMON ? LOAD_BARE : LOAD_DAEMON];
    int64_t until_ns = least((h->slice + 1) * line->slice_ns, at_ns + HAND_IDLE_NS);
    for (int k = 0; k < LOAD_SIDES && !run->plan->closed; k++) {
        until_ns = least(until_ns, group_send(run, &h->groups[k], (load_side)k));
    }
    const bool both = at_ns - h->slice * line->slice_ns < line->slice_ns / 8 || group_waits(other);
    hand_wait(h, both || side == LOAD_DAEMON, both || side == LOAD_BARE, run->begin_ns + until_ns);
}

void *hand_run(void *argument)
{
    hand *h = argument;
    const timeline *line = &h->run->line;
    const int64_t end_ns = line->slices * line->slice_ns;
    wait_exactly();
    h->slice = UINT32_MAX;
    for (;;) {
        const int64_t at_ns = wait_now_ns() - h->run->begin_ns;
        const uint32_t slice = timeline_slice_at(line, at_ns);
        if (slice == line->slices || atomic_load(&h->run->failed)) {
            break;
        }
        if (slice != h->slice) {
            hand_begin_slice(h, slice);
        }
        hand_slice(h, at_ns);
    }
    while ((group_waits(&h->groups[LOAD_DAEMON]) || group_waits(&h->groups[LOAD_BARE])) &&
           wait_now_ns() - h->run->begin_ns < end_ns + DRAIN_MOST_S * INT64_C(1000000000)) {
        hand_wait(h, true, true, wait_now_ns() + HAND_DRAIN_NS);
    }
    return NULL;
}

void hand_gather(hand *h)
{
    hand_wait(h, true, true, wait_now_ns() + HAND_IDLE_NS);
}
