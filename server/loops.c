/* loops.c: see loops.h. */
#include "loops.h"
#include "thread.h"

#include <stdlib.h>

static void *loop_main(void *argument)
{
    loop_run(argument);
    return NULL;
}

static bool start_loop(loops *all, home *own)
{
    loop *l = &all->list[all->running];
    if (!loop_init(l, all->shared, &all->homes, own)) {
        return false;
    }
    if (!thread_start(&all->threads[all->running], loop_main, l)) {
        loop_fini(l);
        return false;
    }
    all->running++;
    return true;
}

bool loops_start(loops *all, service *shared, uint32_t hot_count)
{
    const uint32_t count = hot_count + 1;
    *all = (loops){.shared = shared, .list = calloc(count, sizeof *all->list)};
    all->threads = calloc(count, sizeof *all->threads);
    bool started = all->list && all->threads && homes_init(&all->homes, hot_count);
    for (uint32_t i = 0; started && i < count; i++) {
        started = start_loop(all, &all->homes.list[i]);
    }
    if (!started) {
        loops_stop(all);
        loops_fini(all);
    }
    return started;
}

void loops_add(loops *all, connection *c)
{
    service_lock(all->shared);
    home *hot = homes_hot(&all->homes);
    connection_enter(c, hot->count < LIMIT_HOT_NEWCOMERS ? hot : homes_cold(&all->homes));
    service_unlock(all->shared);
}

void loops_stop(loops *all)
{
    service_lock(all->shared);
    all->homes.stopping = true;
    for (uint32_t i = 0; i < all->running; i++) {
        home_ring(&all->homes.list[i], all->shared);
    }
    service_unlock(all->shared);
    for (; all->running > 0; all->running--) {
        pthread_join(all->threads[all->running - 1], NULL);
        loop_fini(&all->list[all->running - 1]);
    }
}

void loops_fini(loops *all)
{
    homes_fini(&all->homes);
    free(all->list);
    free(all->threads);
    *all = (loops){0};
}
