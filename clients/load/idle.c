/* idle.c: see idle.h. They come a batch at a time, so that none waits long in the daemon's backlog; then a thread
 * answers for them if the daemon asks whether they are there. */
#include "load/idle.h"

#include "awtlink.h"
#include "base/version.h"
#include "load/wait.h"
#include "progress.h"

#include <pthread.h>
#include <stdlib.h>

enum { IDLE_BATCH = 64, IDLE_TURN_NS = 200000000 };
#define IDLE_BATCH_NS INT64_C(20000000000)

struct idle {
    load_run *run;
    awtlink **links; /* [count]; NULL: has ended */
    struct pollfd *polls;
    uint32_t count;
    pthread_t thread;
    bool opened, running; /* all are there; their thread is */
    atomic_bool stop;
};

/* Before all are there it only means that the daemon takes no more. */
static void idle_drop(idle *i, uint32_t at, const char *why)
{
    if (i->opened) {
        book_error(&i->run->book, "an idle connection: %s", why);
    }
    snprintf(i->run->idle_end, sizeof i->run->idle_end, "%s", why);
    awtlink_close(i->links[at]);
    i->links[at] = NULL;
}

/* Takes whatever comes for link `at`; nothing but the end is of interest. */
static void idle_turn(idle *i, uint32_t at)
{
    awtclient_error error = {0};
    proto_message message;
    do {
        awtlink_pump(i->links[at], awtclient_now_us(), &error);
        while (awtlink_next(i->links[at], &message, &error)) {
        }
    } while (error.code == 0 && awtlink_pending(i->links[at]));
    if (error.code != 0) {
        idle_drop(i, at, error.text);
    }
}

static struct pollfd idle_entry(const awtlink *link)
{
    const unsigned wanted = link ? awtlink_wanted(link) : 0;
    return (struct pollfd){.fd = link ? awtlink_descriptor(link) : -1,
                           .events =
                               (short)((wanted & AWTLINK_READ ? POLLIN : 0) | (wanted & AWTLINK_WRITE ? POLLOUT : 0))};
}

/* Waits for links from `first` on, until a time, and lets them have their turn. */
static void idle_poll(idle *i, uint32_t first, int64_t until_ns)
{
    for (uint32_t k = first; k < i->count; k++) {
        i->polls[k] = idle_entry(i->links[k]);
    }
    int ready = wait_poll(i->polls + first, i->count - first, until_ns);
    for (uint32_t k = first; k < i->count && ready > 0; k++) {
        if (i->polls[k].revents) {
            idle_turn(i, k);
            ready--;
        }
    }
}

/* Those that have ended are not waited for. */
static bool idle_all_in(const idle *i, uint32_t first)
{
    for (uint32_t k = first; k < i->count; k++) {
        if (i->links[k] && !awtlink_ready(i->links[k])) {
            return false;
        }
    }
    return true;
}

/* Opens so many more and waits until they are in. False: not all of them got there. */
static bool idle_batch(idle *i, uint32_t count)
{
    awtclient_error error = {0};
    const load_plan *p = i->run->plan;
    const awtclient_options options = {
        .address = p->address, .token_file = p->token_file, .name = "awt-load " AWTD_VERSION};
    const uint32_t first = i->count;
    const int64_t end_ns = wait_now_ns() + IDLE_BATCH_NS;
    while (i->count < first + count) {
        awtlink *link = awtlink_open(&options, awtclient_now_us(), &error);
        if (!link) {
            snprintf(i->run->idle_end, sizeof i->run->idle_end, "%s", error.text);
            return false;
        }
        i->links[i->count++] = link;
    }
    while (!idle_all_in(i, first) && wait_now_ns() < end_ns) {
        idle_poll(i, first, wait_now_ns() + IDLE_TURN_NS);
    }
    uint32_t in = 0;
    for (uint32_t k = first; k < i->count; k++) {
        in += i->links[k] && awtlink_ready(i->links[k]);
    }
    return in == count;
}

static void *idle_run(void *argument)
{
    idle *i = argument;
    while (!atomic_load(&i->stop)) {
        idle_poll(i, 0, wait_now_ns() + IDLE_TURN_NS);
    }
    return NULL;
}

static bool idle_start(idle *i)
{
    i->opened = true;
    i->running = pthread_create(&i->thread, NULL, idle_run, i) == 0;
    if (!i->running) {
        book_error(&i->run->book, "this machine gives no thread for the idle connections");
    }
    return i->running;
}

idle *idle_open(load_run *run, uint32_t count, uint32_t *held)
{
    idle *i = calloc(1, sizeof *i);
    progress shown = progress_begin(stderr, "idle", run->plan->quiet);
    *held = 0;
    if (!i || !(i->links = calloc(count + 1, sizeof(awtlink *))) || !(i->polls = calloc(count + 1, sizeof *i->polls))) {
        book_error(&run->book, "not enough memory for %u idle connections", count);
        idle_close(i);
        return NULL;
    }
    i->run = run;
    bool good = count > 0;
    while (good && i->count < count) {
        good = idle_batch(i, count - i->count < IDLE_BATCH ? count - i->count : IDLE_BATCH);
        progress_show(&shown, (double)i->count / count, "");
    }
    progress_hide(&shown);
    for (uint32_t k = 0; k < i->count; k++) {
        *held += i->links[k] && awtlink_ready(i->links[k]);
    }
    if (*held == 0) {
        book_error(&run->book, "no idle connection was let in: %s", run->idle_end);
    }
    if (*held == 0 || !idle_start(i)) {
        idle_close(i);
        return NULL;
    }
    return i;
}

void idle_close(idle *i)
{
    if (i && i->running) {
        atomic_store(&i->stop, true);
        pthread_join(i->thread, NULL);
    }
    for (uint32_t k = 0; i && i->links && k < i->count; k++) {
        awtlink_close(i->links[k]);
    }
    if (i) {
        free(i->links);
        free(i->polls);
        free(i);
    }
}
