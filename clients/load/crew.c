/* crew.c: see crew.h. */
#include "load/crew.h"

#include "load/hand.h"
#include "load/wait.h"

#include <stdlib.h>
#include <time.h>

enum { SHOW_NS = 100000000 };

struct crew {
    load_run *run;
    hand *hands; /* [count] */
    uint32_t count;
};

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
        hand_leave(&c->hands[i]);
    }
    if (c) {
        free(c->hands);
        free(c);
    }
}

bool crew_add(crew *c, member *m)
{
    hand *least = &c->hands[0];
    for (uint32_t i = 1; i < c->count; i++) {
        if (c->hands[i].groups[m->side].count < least->groups[m->side].count) {
            least = &c->hands[i];
        }
    }
    return hand_add(least, m);
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
            hand_gather(&c->hands[i]);
        }
    }
    return !atomic_load(&c->run->failed);
}

static void begin(crew *c)
{
    for (uint32_t i = 0; i < c->count; i++) {
        hand_begin(&c->hands[i]);
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
