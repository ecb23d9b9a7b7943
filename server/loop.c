/* loop.c: see loop.h. */
#include "loop.h"
#include "clock.h"
#include "log.h"

#include <stdlib.h>

enum { LOOP_FIRST_ROOM = 64 };

/* ---- seats ------------------------------------------------------------------------------------------------------- */

static bool make_room(loop *l, uint32_t room)
{
    if (room <= l->room) {
        return true;
    }
    connection **seated = realloc(l->seated, room * sizeof *seated);
    l->seated = seated ? seated : l->seated;
    struct pollfd *polled = realloc(l->polled, (room + 1) * sizeof *polled);
    l->polled = polled ? polled : l->polled;
    if (!seated || !polled || !deadlines_reserve(&l->waits, room)) {
        return false;
    }
    l->room = room;
    return true;
}

bool loop_init(loop *l, service *shared, homes *all, home *own)
{
    *l = (loop){.shared = shared, .all = all, .own = own};
    if (!make_room(l, LOOP_FIRST_ROOM)) {
        loop_fini(l);
        return false;
    }
    l->polled[0] = (struct pollfd){.fd = own->bell.ends[0], .events = POLLIN};
    return true;
}

void loop_fini(loop *l)
{
    free(l->seated);
    free(l->polled);
    deadlines_fini(&l->waits);
    *l = (loop){0};
}

/* False: no memory. */
static bool take_seat(loop *l, connection *c)
{
    if (l->count == l->room && !make_room(l, 2 * l->room)) {
        return false;
    }
    l->seated[l->count++] = c;
    connection_seat_of(c)->slot = l->count;
    l->polled[l->count] = (struct pollfd){.fd = -1};
    return true;
}

static void give_up_seat(loop *l, connection *c)
{
    connection_seat *seat = connection_seat_of(c);
    connection *last = l->seated[l->count - 1];
    l->polled[seat->slot] = l->polled[l->count];
    l->seated[seat->slot - 1] = last;
    connection_seat_of(last)->slot = seat->slot;
    l->count--;
    seat->slot = 0;
    deadlines_set(&l->waits, &seat->wait, INT64_MAX);
}

/* What the last turn left to wait for. */
static void keep_word(loop *l, connection *c)
{
    connection_seat *seat = connection_seat_of(c);
    int events = connection_events(c);
    int64_t wake_us = connection_wake_us(c);
    l->polled[seat->slot].fd = events < 0 ? -1 : connection_descriptor(c);
    l->polled[seat->slot].events = (short)(events < 0 ? 0 : events);
    if (wake_us != seat->wait.at_us) {
        deadlines_set(&l->waits, &seat->wait, wake_us);
    }
}

/* ---- turns ------------------------------------------------------------------------------------------------------- */

/* One that is over ends here, if nobody sends to it; else a turn follows. */
static void end_connection(loop *l, connection *c)
{
    service_lock(l->shared);
    bool closed = connection_close(c);
    service_unlock(l->shared);
    if (closed) {
        give_up_seat(l, c);
        connection_destroy(c);
    }
}

/* It moves where connections of its kind live, if nobody sends to it. */
static void move_connection(loop *l, connection *c)
{
    service_lock(l->shared);
    bool leaves = !l->all->stopping && connection_leave(c);
    if (leaves) {
        give_up_seat(l, c);
        connection_enter(c, l->own->is_cold ? homes_hot(l->all) : homes_cold(l->all));
    }
    service_unlock(l->shared);
}

static void give_turn(loop *l, connection *c, int revents)
{
    connection_turn(c, revents);
    keep_word(l, c);
    switch (connection_fate_of(c)) {
    case CONNECTION_STAYS:
        break;
    case CONNECTION_MOVES:
        move_connection(l, c);
        break;
    case CONNECTION_ENDS:
        end_connection(l, c);
        break;
    }
}

/* There is no memory for its seat. */
static void refuse_seat(loop *l, connection *c)
{
    service_lock(l->shared);
    connection_drop(c, "no memory");
    bool closed = connection_close(c); /* else it comes again */
    service_unlock(l->shared);
    if (closed) {
        connection_destroy(c);
    }
}

/* To those that poll named, `ready` at most. From the end: whoever goes, one that had its turn takes the seat. */
static void give_polled_turns(loop *l, int ready)
{
    for (uint32_t slot = l->count; slot > 0 && ready > 0; slot--) {
        if (l->polled[slot].revents) {
            ready--;
            give_turn(l, l->seated[slot - 1], l->polled[slot].revents);
        }
    }
}

/* To those that stand in the home's list now. */
static void give_told_turns(loop *l, uint32_t told)
{
    while (told-- > 0) {
        service_lock(l->shared);
        connection *c = home_take(l->own);
        const bool arrives = connection_seat_of(c)->slot == 0, late = arrives && l->all->stopping;
        if (late) {
            connection_end(c, "the daemon stops");
        }
        service_unlock(l->shared);
        if (arrives && !take_seat(l, c)) {
            refuse_seat(l, c);
            continue;
        }
        give_turn(l, c, 0);
    }
}

static void give_due_turns(loop *l)
{
    int64_t now_us = l->shared->options.clock_us();
    for (uint32_t n = l->waits.count; n > 0; n--) { /* nobody has two */
        const deadline *d = deadlines_first(&l->waits);
        if (!d || d->at_us > now_us) {
            return;
        }
        give_turn(l, d->owner, 0);
    }
}

/* ---- sleeping ---------------------------------------------------------------------------------------------------- */

/* The time at which there is something to do whatever poll says. */
static int64_t next_due_us(const loop *l, int64_t until_us)
{
    const deadline *first = deadlines_first(&l->waits);
    return first && first->at_us < until_us ? first->at_us : until_us;
}

/* False: there is work in the list, or the end has come. */
static bool fall_asleep(loop *l)
{
    service_lock(l->shared);
    const bool idle = l->own->told == 0 && l->all->stopping == l->stops;
    if (idle) {
        home_falls_asleep(l->own);
    }
    service_unlock(l->shared);
    return idle;
}

/* How many stand in the home's list. */
static uint32_t wake_up(loop *l)
{
    service_lock(l->shared);
    home_wakes(l->own);
    const uint32_t told = l->own->told;
    l->stops = l->all->stopping;
    service_unlock(l->shared);
    return told;
}

/* Sleeps until something happens; how many sockets poll named. */
static int look(loop *l, int64_t until_us)
{
    int64_t now_us = l->shared->options.clock_us(), due_us = next_due_us(l, until_us);
    const bool sockets = now_us >= l->look_from_us; /* else the bell alone */
    if (!sockets && l->look_from_us < due_us) {
        due_us = l->look_from_us;
    }
    const int patience_ms = fall_asleep(l) ? clock_poll_ms(now_us, due_us) : 0;
    int ready = poll(l->polled, 1 + (sockets ? l->count : 0), patience_ms);
    if (ready <= 0) { /* EINTR, or no memory for a moment: nobody has anything to say */
        return 0;
    }
    if (l->polled[0].revents) {
        wake_clear(&l->own->bell);
        ready--;
    }
    if (sockets && l->own->is_cold && l->count > LIMIT_HOT_SET) {
        l->look_from_us = l->shared->options.clock_us() + l->count * LIMIT_COLD_PAUSE_NS / 1000;
    }
    return sockets ? ready : 0;
}

/* False: the loop is to stop. */
static bool turn(loop *l, int64_t until_us)
{
    int ready = look(l, until_us);
    uint32_t told = wake_up(l);
    give_polled_turns(l, ready);
    give_told_turns(l, told);
    give_due_turns(l);
    return !l->stops;
}

/* ---- running ----------------------------------------------------------------------------------------------------- */

static void say_bye(loop *l)
{
    service_lock(l->shared);
    for (uint32_t i = 0; i < l->count; i++) {
        connection_end(l->seated[i], "the daemon stops");
    }
    service_unlock(l->shared);
}

/* Those to whom somebody sends just now have a turn when that is over. */
static void drop_all(loop *l)
{
    for (uint32_t i = l->count; i > 0; i--) {
        service_lock(l->shared);
        connection_drop(l->seated[i - 1], "the daemon stops");
        service_unlock(l->shared);
        end_connection(l, l->seated[i - 1]);
    }
}

void loop_run(loop *l)
{
    while (turn(l, INT64_MAX)) {
    }
    say_bye(l);
    int64_t until_us = l->shared->options.clock_us() + LIMIT_STOP_FLUSH_US;
    while (l->own->count > 0) { /* nobody comes any more: everyone who has entered is here or in the list */
        if (l->shared->options.clock_us() >= until_us) {
            drop_all(l);
            until_us = INT64_MAX;
        } else {
            turn(l, until_us);
        }
    }
}
