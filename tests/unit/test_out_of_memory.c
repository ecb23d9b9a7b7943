/* test_out_of_memory.c: the daemon finds no memory, once, at each place where it asks for some, in all that a client
 * can have it do. That client gets a numbered error, or is let go; nothing is lost; another one's hair keeps its bits;
 * and afterwards everything works. */
#include "check.h"
#include "unit/heap_seam.h"
#include "unit/memory_acts.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FORESTS = 6, STEP_US = 10000, LATER_STEPS = 4 };

/* Who is harmed, who is not, who comes later, and who sees the victim's hair anew. */
enum { VICTIM, OTHER, LATER, TALKERS };

/* What came of it. */
typedef struct outcome {
    uint32_t allocations;        /* that the daemon asked for on the victim's account */
    bool failed, began;          /* one failed; the daemon began at all */
    int act;                     /* in which it failed */
    uint16_t code, about;        /* of the first ERROR that the victim got */
    uint32_t other[MEMORY_ACTS]; /* the other one's hair after each act */
    uint32_t later;              /* the later one's */
    int64_t blocks;              /* left at the end */
    const char *broken;
} outcome;

static wire on;
static talker who[TALKERS];

static void expect(outcome *out, bool holds, const char *otherwise)
{
    if (!holds && !out->broken) {
        out->broken = otherwise;
    }
}

/* Comes in, makes a forest and steps it. */
static void begin_other(talker *t, uint64_t seed, outcome *out)
{
    expect(out, talker_come(t) && talker_ask(t, memory_create(seed)), "somebody else could not begin");
}

/* Another forest of the victim's state shows the same, in every form. */
static void compare(memory_scene *s, outcome *out)
{
    talker *t = s->victim;
    proto_message snapshot = {.type = PROTO_SNAPSHOT}, restore = {.type = PROTO_RESTORE, .as.restore.upload = 1};
    uint32_t sums[2] = {0};
    snapshot.as.snapshot.forest = t->forest;
    expect(out, memory_step(t, s->time_us + STEP_US), "the victim's forest steps no more"); /* takes what waits */
    expect(out, talker_ask(t, snapshot), "the victim's forest gives no state");
    for (int round = 0; round < 2; round++) {
        if (round == 1) {
            expect(out, talker_upload(t, 1, t->state, t->state_size) && talker_ask(t, restore),
                   "the victim's forest cannot be restored");
        }
        t->sum = 0;
        expect(out, memory_step(t, s->time_us + 2 * STEP_US), "the victim's forest steps no more");
        for (uint8_t kind = 0; kind <= FORM_KIND_GREATEST; kind++) {
            expect(out, talker_ask(t, memory_look(t, kind, 0, 0)), "the victim's forest cannot be looked at");
        }
        expect(out, talker_ask(t, memory_look(t, GEOM_STRANDS, 1, 1)), "the victim's forest cannot be looked at");
        sums[round] = t->sum;
    }
    expect(out, sums[0] == sums[1], "the victim's forest does not look as its state says");
}

static void play(memory_scene *s, outcome *out)
{
    begin_other(&who[OTHER], 5, out);
    for (int act = 0; act < MEMORY_ACTS; act++) {
        const bool before = heap_look().failed;
        heap_number(true);
        memory_act(s, act);
        heap_number(false);
        out->act = heap_look().failed && !before ? act : out->act;
        who[OTHER].sum = 0;
        expect(out, memory_step(&who[OTHER], (act + 1) * STEP_US), "somebody else got no answer");
        out->other[act] = who[OTHER].sum;
    }
    memory_act(s, 1); /* comes back, where it was let go last */
    compare(s, out);
    begin_other(&who[LATER], 6, out);
    for (int n = 1; n <= LATER_STEPS; n++) {
        expect(out, memory_step(&who[LATER], n * STEP_US), "who came later got no answer");
    }
    out->later = who[LATER].sum;
}

/* The whole of it, where allocation number `failing` (0: none) finds no memory. */
static outcome run(uint32_t failing)
{
    outcome out = {.act = -1};
    memory_scene s = {.on = &on, .victim = &who[VICTIM]};
    for (int i = 0; i < TALKERS; i++) {
        talker_init(&who[i], &on, i);
    }
    heap_watch();
    heap_fail(failing);
    heap_number(true);
    out.began = wire_begin(&on, FORESTS);
    heap_number(false);
    if (out.began) {
        play(&s, &out);
        heap_number(true);
        wire_end(&on);
    }
    const heap_seen seen = heap_watch_end();
    for (int i = 0; i < TALKERS; i++) {
        expect(&out, !who[i].broken, who[i].broken);
    }
    out.allocations = seen.allocations;
    out.failed = seen.failed;
    out.blocks = seen.blocks;
    out.code = who[VICTIM].code;
    out.about = who[VICTIM].about;
    return out;
}

/* Of what the victim may be told, at first. */
static bool is_sensible(const outcome *out)
{
    return out->code == 0 || out->code == PROTO_ERROR_NO_MEMORY ||
           (out->code == PROTO_ERROR_NO_SESSION && out->about == PROTO_RESUME); /* it was not kept for its return */
}

static void check(const outcome *out, const outcome *well, uint32_t failing)
{
    const bool good =
        out->failed && !out->broken && out->blocks == well->blocks && is_sensible(out) &&
        (!out->began || (memcmp(out->other, well->other, sizeof out->other) == 0 && out->later == well->later));
    if (!good) {
        printf("   allocation %lu, act %d: %s\n", (unsigned long)failing, out->act,
               proto_type_name(out->about) ? proto_type_name(out->about) : "");
    }
    CHECK(out->failed);
    CHECK_TEXT(out->broken ? out->broken : "", "");
    CHECK_INT(out->blocks, well->blocks);
    CHECK(is_sensible(out));
    if (!is_sensible(out)) {
        CHECK_INT(out->code, PROTO_ERROR_NO_MEMORY);
    }
    CHECK(!out->began || memcmp(out->other, well->other, sizeof out->other) == 0);
    CHECK(!out->began || out->later == well->later);
}

/* AWT_ALLOCATIONS: which, by their distance (make soak: 1, all of them). */
TEST(server_without_memory_once_says_so_and_goes_on)
{
    enum { DISTANCE = 19 };
    const char *asked = getenv("AWT_ALLOCATIONS");
    const uint32_t distance = asked ? (uint32_t)strtoul(asked, NULL, 10) : DISTANCE;
    run(0); /* what is made once and kept */
    const outcome well = run(0), again = run(0);
    CHECK_TEXT(well.broken ? well.broken : "", "");
    CHECK_INT(well.blocks, 0);
    CHECK_INT(well.code, 0);
    CHECK_INT(again.allocations, well.allocations);
    CHECK(well.allocations > 500 && !well.failed);
    uint32_t tried = 0, told = 0;
    for (uint32_t k = 1; k <= well.allocations; k += distance) {
        const outcome out = run(k);
        check(&out, &well, k);
        tried++;
        told += out.code != 0;
    }
    printf("   %lu of %lu allocations failed, %lu times the client was told\n", (unsigned long)tried,
           (unsigned long)well.allocations, (unsigned long)told);
    CHECK(told > 0);
}
