/* crew.c: see crew.h.
 *
 * A hand waits until something comes or the next request is due, whichever is first. It watches the side whose turn it
 * is; the other side only while its answers are still to come, and a little longer, so that what the one costs does not
 * depend on how many connections the other has. */
#include "load/crew.h"

#include "load/wait.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { HAND_IDLE_NS = 50000000, HAND_DRAIN_NS = 5000000, DRAIN_MOST_S = 5, SHOW_NS = 100000000 };

/* The members of one side of one hand. Those that send come in the order of their phases, so that the next one due is
 * always the one after the last. */
typedef struct group {
    member **members; /* [count] heap */
    size_t count, capacity;
    size_t next; /* whose request is due next */
    bool over;   /* no more are due in this run */
} group;

typedef struct hand {
    load_run *run;
    group groups[LOAD_SIDES];
    struct pollfd *polls; /* [capacity of both groups] */
    uint32_t slice;
    pthread_t thread;
} hand;

struct crew {
    load_run *run;
    hand *hands; /* [count] */
    uint32_t count;
};

/* ---- its members ------------------------------------------------------------------------------------------------- */

crew *crew_create(load_run *run, uint32_t hands)
{
    crew *c = calloc(1, sizeof *c);
    if (!c || !(c->hands = calloc(hands, sizeof *c->hands))) {
        free(c);
        return NULL;
    }
    c->run = run;
    c->count = hands;
    for (uint32_t i = 0; i < hands; i++) {
        c->hands[i].run = run;
    }
    return c;
}

void crew_destroy(crew *c)
{
    for (uint32_t i = 0; c && i < c->count; i++) {
        for (int side = 0; side < LOAD_SIDES; side++) {
            group *g = &c->hands[i].groups[side];
            for (size_t k = 0; k < g->count; k++) {
                g->members[k]->face->leave(g->members[k]);
            }
            free(g->members);
        }
        free(c->hands[i].polls);
    }
    if (c) {
        free(c->hands);
        free(c);
    }
}

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

bool crew_add(crew *c, member *m)
{
    hand *least = &c->hands[0];
    for (uint32_t i = 1; i < c->count; i++) {
        if (c->hands[i].groups[m->side].count < least->groups[m->side].count) {
            least = &c->hands[i];
        }
    }
    group *g = &least->groups[m->side];
    if (!group_grow(least, g)) {
        return false;
    }
    group_insert(g, m);
    return true;
}

/* ---- one hand ---------------------------------------------------------------------------------------------------- */

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

static void *hand_run(void *argument)
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

/* ---- all hands --------------------------------------------------------------------------------------------------- */

static bool hand_ready(const hand *h)
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

bool crew_gather(crew *c, int64_t most_ns)
{
    const int64_t end_ns = wait_now_ns() + most_ns;
    for (uint32_t i = 0; i < c->count; i++) {
        while (!hand_ready(&c->hands[i])) {
            if (atomic_load(&c->run->failed)) {
                return false;
            }
            if (wait_now_ns() > end_ns) {
                book_error(&c->run->book, "the connections are not all in after %.0f s", (double)most_ns * 1e-9);
                return false;
            }
            hand_wait(&c->hands[i], true, true, wait_now_ns() + HAND_IDLE_NS);
        }
    }
    return !atomic_load(&c->run->failed);
}

static void begin(crew *c)
{
    for (uint32_t i = 0; i < c->count; i++) {
        for (int side = 0; side < LOAD_SIDES; side++) {
            group *g = &c->hands[i].groups[side];
            g->next = 0;
            g->over = false;
            for (size_t k = 0; k < g->count; k++) {
                g->members[k]->ticks = 0;
            }
        }
    }
    c->run->begin_ns = wait_now_ns();
}

bool crew_run(crew *c, void (*show)(load_run *run, int64_t at_ns))
{
    uint32_t started = 0;
    begin(c);
    while (started < c->count && pthread_create(&c->hands[started].thread, NULL, hand_run, &c->hands[started]) == 0) {
        started++;
    }
    if (started < c->count) {
        book_error(&c->run->book, "this machine gives no thread for hand %u", started + 1);
        atomic_store(&c->run->failed, true);
    }
    const int64_t length_ns = c->run->line.slices * c->run->line.slice_ns;
    for (int64_t at_ns = 0; at_ns < length_ns && !atomic_load(&c->run->failed);
         at_ns = wait_now_ns() - c->run->begin_ns) {
        show(c->run, at_ns);
        nanosleep(&(struct timespec){0, SHOW_NS}, NULL);
    }
    for (uint32_t i = 0; i < started; i++) {
        pthread_join(c->hands[i].thread, NULL);
    }
    return started == c->count;
}
