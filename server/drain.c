/* drain.c: see drain.h. */
#include "drain.h"
#include "log.h"
#include "session.h"
#include "upkeep.h"

#include <time.h>

enum { WAIT_NS = 2000000 };

static void wait_a_little(void)
{
    nanosleep(&(struct timespec){.tv_nsec = WAIT_NS}, NULL);
}

static void say_goaway(service *shared, int64_t grace_us)
{
    proto_message message = {.type = PROTO_GOAWAY};
    message.as.goaway.grace_ms = (uint32_t)(grace_us / 1000);
    message.as.goaway.reason = proto_str_of("the daemon stops; connect anew, and RESUME or ATTACH");
    service_lock(shared);
    for (uint32_t i = 0; i < shared->sessions.capacity; i++) {
        session *s = handle_at(&shared->sessions, i);
        if (s && s->state == SESSION_OPEN) {
            session_send(s, &message);
        }
    }
    service_unlock(shared);
}

static uint32_t count_sessions(service *shared)
{
    service_lock(shared);
    const uint32_t count = shared->counters.sessions;
    service_unlock(shared);
    return count;
}

void drain_clients(service *shared, int64_t grace_us, bool (*hurried)(void))
{
    const int64_t until_us = shared->options.clock_us() + grace_us;
    say_goaway(shared, grace_us);
    while (count_sessions(shared) > 0 && shared->options.clock_us() < until_us && !hurried()) {
        wait_a_little();
    }
    service_lock(shared);
    shared->stopping = true;
    service_unlock(shared);
}

static bool all_kept(service *shared)
{
    service_lock(shared);
    const bool kept = upkeep_kept_all(shared);
    service_unlock(shared);
    return kept;
}

/* One round of bringing all to the disk. How many the keeper did not get: there is more room when it has written. */
static uint32_t keep_once(service *shared, bool *clean)
{
    service_lock(shared);
    upkeep_keep_all(shared);
    service_unlock(shared);
    while (!all_kept(shared)) {
        wait_a_little();
    }
    *clean = keeper_drain(shared->options.keeper);
    service_lock(shared);
    const uint32_t left = upkeep_unkept(shared);
    service_unlock(shared);
    return left;
}

bool drain_forests(service *shared)
{
    keeper *k = shared->options.keeper;
    if (!k) {
        return true;
    }
    bool clean = true;
    uint32_t before = UINT32_MAX, left = keep_once(shared, &clean);
    while (left > 0 && left < before) { /* as long as it becomes fewer */
        before = left;
        left = keep_once(shared, &clean);
    }
    clean = clean && left == 0;
    const keeper_counts counts = keeper_count(k);
    log_write(clean ? LOG_INFO : LOG_ERROR, clean ? "forests saved" : "forests not all saved",
              "written=%llu failed=%llu", (unsigned long long)counts.written, (unsigned long long)counts.failed);
    return clean;
}
