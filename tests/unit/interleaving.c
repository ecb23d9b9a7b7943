/* interleaving.c: see interleaving.h. */
#include "interleaving.h"
#include "interleaving_actor.h"

#include "base/assert.h"
#include "base/hash.h"
#include "upkeep.h"

#include <stdlib.h>

enum { ACTORS = 4, FORESTS_MOST = 8, END_TURNS = 200, GRACE_US = 500000, QUIET_US = 2000000 };

/* ---- decisions --------------------------------------------------------------------------------------------------- */

static uint32_t from_seed(void *context, uint32_t below)
{
    return rng_u32(context) % below;
}

typedef struct byte_source {
    const uint8_t *bytes;
    size_t size, at;
} byte_source;

/* Behind the last byte every decision is 0. */
static uint32_t from_bytes(void *context, uint32_t below)
{
    byte_source *source = context;
    uint32_t value = 0;
    for (uint32_t bits = 1; bits < below && source->at < source->size; bits <<= 8) {
        value = value << 8 | source->bytes[source->at++];
        if (bits > UINT32_MAX >> 8) {
            break;
        }
    }
    return value % below;
}

/* ---- one conversation -------------------------------------------------------------------------------------------- */

/* Whoever is chosen connects, says something, has bytes arrive, is congested or not, or is cut off. */
static void let_act(stage *s, actor *who)
{
    const uint32_t n = s->decide(s->context, 64);
    if (n == 0 || actor_is_refused(who)) {
        actor_cut(who);
    } else if (n == 1) {
        actor_say_garbage(who);
    } else if (n == 5) {
        session_tick(&who->talk);
    } else if (n < 5) {
        actor_congest(who, n == 2);
    } else if (n < 16) {
        actor_hear(who, 1 + s->decide(s->context, 64));
    } else if (n < 32) {
        actor_hear(who, SIZE_MAX);
    } else {
        actor_say(who);
    }
}

static void decide_once(stage *s, actor *actors)
{
    switch (s->decide(s->context, 8)) {
    case 0:
        stage_work(s);
        break;
    case 1:
        fake_now_us += 1000 * (int64_t)s->decide(s->context, 200);
        upkeep_do(s->shared, fake_now_us);
        break;
    default: {
        actor *who = &actors[s->decide(s->context, ACTORS)];
        if (actor_is_there(who)) {
            let_act(s, who);
        } else {
            actor_connect(who, s);
        }
    }
    }
}

/* Everything that was sent arrives and is done: nobody may still wait. */
static void settle(stage *s, actor *actors)
{
    for (int turn = 0; turn < END_TURNS; turn++) {
        for (int i = 0; i < ACTORS; i++) {
            if (actor_is_there(&actors[i])) {
                actor_congest(&actors[i], false);
                actor_hear(&actors[i], SIZE_MAX);
            }
        }
        if (!stage_work(s) && turn > 0) {
            break;
        }
    }
    for (int i = 0; i < ACTORS; i++) {
        actor_expect_nothing(&actors[i]);
    }
}

static interleaving play(stage *s, bool (*goes_on)(void *context))
{
    service shared = {0};
    actor *actors = calloc(ACTORS, sizeof *actors);
    s->shared = &shared;
    s->seen.hash = HASH_SEED;
    fake_now_us = 1000000;
    const bool auth = s->decide(s->context, 2);
    ASSERT(actors && fake_service_init(&shared, 0, FORESTS_MOST, auth));
    shared.options.resume_grace_us = GRACE_US;
    shared.options.quiet_us = QUIET_US;
    while (!s->seen.broken && goes_on(s->context)) {
        decide_once(s, actors);
    }
    if (!s->seen.broken) {
        settle(s, actors);
    }
    for (int i = 0; i < ACTORS; i++) {
        actor_cut(&actors[i]);
    }
    while (stage_work(s)) {
    }
    fake_now_us += GRACE_US; /* nobody comes back */
    upkeep_do(&shared, fake_now_us);
    stage_expect(s, shared.counters.sessions == 0, "a session is left behind");
    stage_expect(s, shared.uploads.used == 0, "bytes of an upload are left behind");
    for (const resident *r = shared.forests.first; r; r = r->next) {
        stage_expect(s, r->subscription_count == 0, "a subscription is left behind");
    }
    service_fini(&shared);
    free(actors);
    return s->seen;
}

typedef struct seeded {
    rng random; /* first: from_seed is given this */
    uint32_t left;
} seeded;

static bool seed_goes_on(void *context)
{
    seeded *from = context;
    return from->left-- > 0;
}

interleaving interleaving_of_seed(uint64_t seed, uint32_t decisions)
{
    seeded from = {rng_seed(seed), decisions};
    stage s = {.decide = from_seed, .context = &from};
    return play(&s, seed_goes_on);
}

static bool bytes_go_on(void *context)
{
    const byte_source *source = context;
    return source->at < source->size;
}

interleaving interleaving_of_bytes(const uint8_t *bytes, size_t size)
{
    byte_source source = {bytes, size, 0};
    stage s = {.decide = from_bytes, .context = &source};
    return play(&s, bytes_go_on);
}
