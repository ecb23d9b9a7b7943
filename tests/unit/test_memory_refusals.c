/* test_memory_refusals.c: who finds no memory, in one place: all of these went wrong once. (test_out_of_memory.c looks
 * everywhere.) */
#include "check.h"
#include "shown_hair.h"
#include "unit/heap_seam.h"
#include "unit/invariant_fixture.h"
#include "unit/memory_acts.h"

#include "awt.h"

#include <string.h>

static wire on;
static talker who;

static void come(void)
{
    CHECK(wire_begin(&on, 2));
    talker_init(&who, &on, 0);
    CHECK(talker_come(&who));
}

TEST(server_create_that_finds_no_memory_says_so_whatever_it_is_needed_for)
{
    uint32_t refused = 0;
    bool failed = true;
    for (uint32_t k = 1; failed; k++) {
        come();
        heap_watch();
        heap_fail(k);
        heap_number(true);
        const bool made = talker_ask(&who, memory_create(1));
        failed = heap_watch_end().failed;
        CHECK(failed || made);
        CHECK(made || !wire_is_there(&on, 0) || who.code == PROTO_ERROR_NO_MEMORY);
        CHECK_TEXT(who.broken ? who.broken : "", "");
        refused += !made;
        wire_end(&on);
    }
    CHECK(refused > 10);
}

TEST(server_subscribe_that_finds_no_memory_is_not_told_of_a_limit)
{
    proto_message subscribe = {.type = PROTO_SUBSCRIBE};
    come();
    CHECK(talker_ask(&who, memory_create(1)));
    subscribe.as.subscribe.forest = who.forest;
    heap_watch();
    heap_fail(1);
    heap_number(true);
    CHECK(!talker_ask(&who, subscribe));
    CHECK(heap_watch_end().failed);
    CHECK_INT(who.code, PROTO_ERROR_NO_MEMORY);
    CHECK(talker_ask(&who, subscribe));
    wire_end(&on);
}

/* What tinygltf takes, it takes of what was set aside for it: it would end the process where it finds none. */
TEST(layouts_that_find_no_memory_are_refused_and_say_so)
{
    awt_groom *groom = small_groom("short", 1);
    for (int kind = GEOM_RIBBON; kind <= GEOM_GUIDES; kind++) {
        const geom_layout_def def = {.kind = (geom_kind)kind};
        uint32_t refused = 0;
        bool failed = true;
        for (uint32_t k = 1; failed; k++) {
            geom_layout *layout = NULL;
            awt_error error = {0};
            heap_watch();
            heap_fail(k);
            heap_number(true);
            const awt_status status = geom_layout_create(groom, &def, &layout, &error);
            heap_number(false);
            geom_layout_destroy(layout);
            const heap_seen seen = heap_watch_end();
            failed = seen.failed;
            refused += status != AWT_OK;
            CHECK_INT(seen.blocks, 0);
            CHECK(status == AWT_OK || (failed && status == AWT_NO_MEMORY && error.status == status && error.text[0]));
        }
        CHECK(refused > 10);
    }
    awt_groom_destroy(groom);
}

/* An instant between two steps is shown as soon as there is memory to hold the first. */
TEST(hair_between_steps_is_shown_again_once_there_is_memory)
{
    awt_groom *groom = small_groom("long", 2);
    const awt_params params = small_params("long");
    const wild w = wild_make(31, 1.0);
    bool failed = true;
    for (uint32_t k = 1; failed; k++) {
        awt_forest *f = small_forest(groom, &params);
        shown_hair *hair = NULL;
        heap_watch();
        CHECK_INT(shown_hair_create(groom, &hair, NULL), AWT_OK);
        heap_fail(k);
        for (int64_t n = 0; n < 2; n++) {
            const int64_t half_us = n * AWT_STEP_US + AWT_STEP_US / 2;
            heap_number(n == 0);
            shown_hair_hold(hair, f);
            heap_number(false);
            wild_advance(f, &w, (n + 1) * AWT_STEP_US, NULL);
            failed = heap_look().failed;
            CHECK_INT(shown_hair_show(hair, f, half_us), n == 0 && failed ? AWT_STEP_US : half_us);
        }
        shown_hair_destroy(hair);
        CHECK_INT(heap_watch_end().blocks, 0);
        awt_forest_destroy(f);
        CHECK(k < 10);
    }
    awt_groom_destroy(groom);
}
