/* memory_acts.c: see memory_acts.h. */
#include "unit/memory_acts.h"

#include "unit/hair_file.h"
#include "unit/server_fixture.h"

#include <string.h>

enum { STRANDS = 12, WISPS = 4, TOP_WISPS = 2, STEP_US = 10000 };

/* ---- small things ------------------------------------------------------------------------------------------------ */

proto_message memory_create(uint64_t seed)
{
    proto_message message = fake_create(seed);
    message.as.create.strands = STRANDS;
    message.as.create.finest_wisps = WISPS;
    message.as.create.top_wisps = TOP_WISPS;
    message.as.create.progress = 1;
    return message;
}

proto_message memory_look(const talker *t, uint8_t kind, uint8_t level, uint8_t attributes)
{
    proto_message message = fake_query(t->forest, 0);
    message.as.query.latest = 1;
    message.as.query.kind = kind;
    message.as.query.level = level;
    message.as.query.attributes = attributes;
    return message;
}

bool memory_step(talker *t, int64_t time_us)
{
    proto_message motion = fake_motion(t->forest, (uint32_t)(time_us / STEP_US), time_us);
    motion.as.motion.head.position[0] *= 4; /* so that hair moves */
    talker_say(t, motion);
    return talker_ask(t, fake_query(t->forest, time_us));
}

static bool step_on(memory_scene *s)
{
    return memory_step(s->victim, s->time_us += STEP_US);
}

static proto_message about_forest(const talker *t, uint16_t type)
{
    proto_message message = {.type = type};
    message.as.destroy.forest = t->forest; /* the first field of each */
    return message;
}

static void destroy(talker *t, uint64_t forest)
{
    proto_message message = {.type = PROTO_DESTROY, .as.destroy.forest = forest};
    talker_ask(t, message);
}

static proto_message clock_of(const talker *t, clock_mode mode)
{
    proto_message message = about_forest(t, PROTO_SET_CLOCK);
    message.as.set_clock.mode = (uint8_t)mode;
    message.as.set_clock.rate = 1;
    return message;
}

static bool attach(talker *t)
{
    proto_message message = about_forest(t, PROTO_ATTACH);
    memcpy(message.as.attach.token, t->drive_token, sizeof t->drive_token);
    return talker_ask(t, message);
}

/* In, with a forest: the one that it had, or a new one. */
static bool is_ready(memory_scene *s)
{
    const bool was_there = wire_is_there(s->on, s->victim->number);
    if (!talker_come(s->victim)) {
        return false;
    }
    if (s->victim->forest != 0) {
        return was_there || (attach(s->victim) && talker_ask(s->victim, clock_of(s->victim, CLOCK_LOCK_STEP)));
    }
    s->time_us = 0;
    return talker_ask(s->victim, memory_create(1));
}

/* ---- what the victim does ---------------------------------------------------------------------------------------- */

static void do_enter(memory_scene *s)
{
    talker_come(s->victim);
}

static void do_create(memory_scene *s)
{
    (void)s; /* memory_act has done so */
}

static void do_look(memory_scene *s)
{
    talker *t = s->victim;
    step_on(s);
    for (uint8_t kind = 0; kind <= FORM_KIND_GREATEST; kind++) {
        talker_ask(t, memory_look(t, kind, 0, 0));
    }
    talker_ask(t, memory_look(t, GEOM_RIBBON, 2, 0));
    talker_ask(t, memory_look(t, GEOM_STRANDS, 1, 1));
    talker_ask(t, about_forest(t, PROTO_BINDING));
    step_on(s);
}

static void subscribe(talker *t, uint8_t kind, uint8_t deltas, uint32_t budget)
{
    proto_message message = about_forest(t, PROTO_SUBSCRIBE);
    message.as.subscribe.kind = kind;
    message.as.subscribe.credit = 2;
    message.as.subscribe.deltas = deltas;
    message.as.subscribe.budget = budget;
    t->subscription = 0;
    talker_ask(t, message);
}

/* A few frames by subscription, acknowledged. */
static void watch(memory_scene *s, uint8_t kind, uint8_t deltas, uint32_t budget)
{
    talker *t = s->victim;
    subscribe(t, kind, deltas, budget);
    for (int n = 0; n < 3; n++) {
        step_on(s);
        if (t->subscription == 0) {
            continue;
        }
        proto_message credit = {.type = PROTO_CREDIT, .as.credit.subscription = t->subscription};
        credit.as.credit.frames = 1;
        credit.as.credit.have = deltas ? t->sequence : 0;
        talker_say(t, credit);
    }
    if (t->subscription != 0) {
        proto_message end = {.type = PROTO_UNSUBSCRIBE, .as.unsubscribe.subscription = t->subscription};
        talker_say(t, end);
    }
}

static void do_watch_strands(memory_scene *s)
{
    watch(s, GEOM_STRANDS, 1, 0);
    watch(s, GEOM_RIBBON, 0, 1500);
}

static void do_watch_guides(memory_scene *s)
{
    watch(s, GEOM_GUIDES, 1, 0);
}

static void do_params(memory_scene *s)
{
    talker *t = s->victim;
    proto_message message = about_forest(t, PROTO_SET_PARAMS);
    message.as.set_params.params.count = 1;
    message.as.set_params.params.items[0].name = proto_str_of("wind_x");
    message.as.set_params.params.items[0].value = 2;
    talker_ask(t, message);
    step_on(s);
}

static void do_many(memory_scene *s)
{
    talker *t = s->victim;
    proto_message message = {.type = PROTO_STEP_MANY};
    message.as.step_many.deadline_us = 20000;
    message.as.step_many.kind = GEOM_GUIDES;
    message.as.step_many.forests.count = 1;
    message.as.step_many.forests.items[0] = (struct proto_step_request){t->forest, s->time_us += STEP_US};
    talker_ask(t, message);
}

static void do_free(memory_scene *s)
{
    talker *t = s->victim;
    talker_ask(t, clock_of(t, CLOCK_FREE));
    subscribe(t, GEOM_GUIDES, 0, 0);
    for (int n = 0; n < 4; n++) {
        wire_pass(s->on, 1500 * STEP_US / 1000);
        talker_ask(t, memory_look(t, GEOM_STRANDS, 0, 0));
    }
    talker_ask(t, clock_of(t, CLOCK_LOCK_STEP));
    s->time_us += 10 * STEP_US;
    step_on(s);
}

static void do_restore(memory_scene *s)
{
    talker *t = s->victim;
    const uint64_t own = t->forest;
    uint8_t token[16];
    memcpy(token, t->drive_token, sizeof token);
    proto_message restore = {.type = PROTO_RESTORE, .as.restore.upload = 1};
    proto_message drop = {.type = PROTO_UPLOAD, .as.upload.upload = 1};
    if (talker_ask(t, about_forest(t, PROTO_SNAPSHOT)) && talker_upload(t, 1, t->state, t->state_size) &&
        talker_ask(t, restore)) {
        destroy(t, t->forest);
    }
    talker_ask(t, drop);
    t->forest = own;
    memcpy(t->drive_token, token, sizeof token);
}

static void do_upload(memory_scene *s)
{
    unsigned char hair[HAIR_FILE_SIZE];
    talker *t = s->victim;
    const uint64_t own = t->forest;
    uint8_t token[16];
    memcpy(token, t->drive_token, sizeof token);
    hair_file_write(hair);
    const proto_message message = hair_file_create(2, 3);
    if (talker_upload(t, 2, hair, sizeof hair) &&
        talker_upload(t, 3, hair_file_hierarchy, strlen(hair_file_hierarchy)) && talker_ask(t, message)) {
        destroy(t, t->forest);
    }
    t->forest = own;
    memcpy(t->drive_token, token, sizeof token);
}

static void do_ask_about(memory_scene *s)
{
    static const uint16_t types[] = {PROTO_PING, PROTO_STATS, PROTO_LIST, PROTO_LIST_STYLES};
    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++) {
        talker_ask(s->victim, (proto_message){.type = types[i]});
    }
}

/* Is cut off, and takes up what it held. */
static void do_resume(memory_scene *s)
{
    talker *t = s->victim;
    proto_message resume = {.type = PROTO_RESUME};
    memcpy(resume.as.resume.session, t->session, sizeof t->session);
    wire_cut(s->on, s->victim->number);
    if (talker_come(t) && !talker_ask(t, resume)) {
        attach(t); /* there was no memory to keep it for who comes back */
    }
}

static void (*const acts[])(memory_scene *) = {do_enter,        do_create, do_look,      do_watch_strands,
                                               do_watch_guides, do_params, do_many,      do_free,
                                               do_restore,      do_upload, do_ask_about, do_resume};
_Static_assert(sizeof acts / sizeof acts[0] == MEMORY_ACTS, "all are counted");

void memory_act(memory_scene *s, int act)
{
    if (act == 0 || is_ready(s)) {
        acts[act](s);
    }
}
