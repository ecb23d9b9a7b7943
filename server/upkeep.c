/* upkeep.c: see upkeep.h. */
#include "upkeep.h"
#include "log.h"
#include "making.h"
#include "turns.h"

#include <string.h>

static int64_t least(int64_t a, int64_t b)
{
    return a < b ? a : b;
}

int64_t upkeep_due_us(const service *shared)
{
    return least(least(making_due_us(shared), parking_due_us(&shared->parked)),
                 least(shared->forests_due_us, shared->keep_due_us));
}

static void end_forest(service *shared, resident *r)
{
    char quoted[LOG_QUOTED];
    log_write(LOG_INFO, "forest ended", "name=%s why=\"nobody has had it open for long\"",
              log_quote(r->name, strlen(r->name), quoted));
    forest_inputs_free(registry_destroy(&shared->forests, r)); /* whoever waited for it is gone */
}

/* Forests are looked at so often that each ends not much later than it should. Those who slept through a look could not
 * open any meanwhile. */
static void end_left_forests(service *shared, int64_t now_us)
{
    const int64_t grace_us = shared->options.forest_grace_us;
    if (now_us < shared->forests_due_us) {
        return;
    }
    const bool slept = now_us - shared->forests_due_us > LIMIT_SLEPT_US;
    shared->forests_due_us = now_us + LIMIT_FOREST_LOOK_US;
    for (resident *r = shared->forests.first, *next; r; r = next) {
        next = r->next;
        r->left_us = slept ? now_us : r->left_us;
        if (r->ready && !r->doomed && r->holders == 0 && now_us - r->left_us >= grace_us) {
            end_forest(shared, r);
        }
    }
}

/* What did not get to the disk, or from it, is to be tried again: once, for it may be lost again at once. */
static void keep_lost(service *shared)
{
    keeper *k = shared->forests.keeper;
    for (uint32_t n = k ? keeper_count(k).lost : 0; n > 0; n--) {
        const uint64_t handle = keeper_take_lost(k);
        resident *r = registry_find(&shared->forests, handle);
        if (r) {
            r->keep_lost = true;
        } else if (handle != 0) {
            keeper_remove(k, handle);
        }
    }
}

void upkeep_keep_all(service *shared)
{
    keep_lost(shared);
    for (resident *r = shared->forests.first; r; r = r->next) {
        turns_keep(&shared->forests, r);
    }
}

bool upkeep_kept_all(const service *shared)
{
    for (const resident *r = shared->forests.first; r; r = r->next) {
        if (r->keep_due || (r->busy && r->work.keeper)) {
            return false;
        }
    }
    return true;
}

uint32_t upkeep_unkept(const service *shared)
{
    uint32_t count = 0;
    for (const resident *r = shared->forests.first; r; r = r->next) {
        count += r->ready && !r->doomed && r->keep_lost;
    }
    return count;
}

static void keep_round(service *shared, int64_t now_us)
{
    if (now_us >= shared->keep_due_us) {
        shared->keep_due_us = now_us + shared->options.keep_us;
        upkeep_keep_all(shared);
    }
}

void upkeep_do(service *shared, int64_t now_us)
{
    making_tell(shared, now_us);
    parking_expire(&shared->parked, &shared->forests, now_us, shared->options.resume_grace_us);
    end_left_forests(shared, now_us);
    keep_round(shared, now_us);
}
