/* test_memory_kept.c: no memory where forests are brought to the disk, and brought back. What was saved is not lost. */
#include "check.h"
#include "keeper.h"
#include "log.h"
#include "restore.h"
#include "unit/folder_fixture.h"
#include "unit/heap_seam.h"
#include "unit/server_fixture.h"
#include "upkeep.h"

#include <stdio.h>
#include <stdlib.h>

enum { KEEP_US = 1000000 };

static int64_t some_time_us(void)
{
    return 1;
}

/* A round is due, and done. */
static void keep_round(service *shared)
{
    fake_now_us += KEEP_US;
    upkeep_do(shared, fake_now_us);
    fake_work(shared, NULL);
}

static bool is_saved(const vault *place, uint64_t forest)
{
    size_t size = 0;
    unsigned char *bytes = vault_read(place, forest, &size);
    free(bytes);
    return bytes != NULL;
}

/* In its state directory `place`; the round in which allocation `k` finds no memory, and the next. False: none failed.
 */
static bool save(const vault *place, uint32_t k, uint64_t *forest)
{
    service shared;
    keeper *to = keeper_create(place, some_time_us);
    CHECK(to && fake_service_init(&shared, 0, 2, false));
    shared.forests.keeper = to;
    shared.options.keep_us = KEEP_US;
    shared.keep_due_us = fake_now_us + KEEP_US;
    fake_client *client = fake_client_open(&shared);
    *forest = fake_make_forest(&shared, client, 5).forest;
    heap_watch();
    heap_fail(k);
    heap_number(true);
    keep_round(&shared);
    const bool failed = heap_watch_end().failed;
    keeper_drain(to);
    CHECK_INT(is_saved(place, *forest) ? 0 : 1, upkeep_unkept(&shared)); /* it knows what is not there, */
    CHECK(failed || is_saved(place, *forest));
    keep_round(&shared);
    CHECK(keeper_drain(to)); /* and brings it */
    CHECK(is_saved(place, *forest));
    CHECK_INT(upkeep_unkept(&shared), 0);
    fake_client_destroy(client);
    service_fini(&shared);
    keeper_destroy(to);
    return failed;
}

TEST(server_without_memory_to_save_a_forest_saves_it_in_the_next_round)
{
    char state[FOLDER_PATH], error[256] = "";
    vault place;
    uint64_t forest = 0;
    uint32_t k = 1;
    folder_make(state);
    CHECK(vault_open(&place, state, error, sizeof error));
    log_set_level(LOG_ERROR);
    while (save(&place, k, &forest)) {
        CHECK(vault_remove(&place, forest));
        k++;
    }
    CHECK(k > 2);
    folder_remove(state);
}

/* It cannot be served, but it is still there, for people to bring back. */
TEST(server_without_memory_to_restore_a_forest_leaves_its_file)
{
    char state[FOLDER_PATH], error[256] = "", file[FOLDER_PATH + 40], aside[FOLDER_PATH + 48];
    vault place;
    uint64_t forest = 0;
    uint32_t refused = 0;
    folder_make(state);
    CHECK(vault_open(&place, state, error, sizeof error));
    save(&place, 0, &forest);
    snprintf(file, sizeof file, "%s/forests/%016llx.forest", state, (unsigned long long)forest);
    snprintf(aside, sizeof aside, "%s/forests/%016llx.bad", state, (unsigned long long)forest);
    bool failed = true;
    for (uint32_t k = 1; failed; k++) {
        service shared;
        keeper *to = keeper_create(&place, some_time_us);
        CHECK(to && fake_service_init(&shared, 0, 2, false));
        shared.forests.keeper = to;
        heap_watch();
        heap_fail(k);
        heap_number(true);
        restore_all(&shared, &place);
        heap_number(false);
        failed = heap_look().failed;
        const bool there = registry_ready_count(&shared.forests) == 1;
        CHECK(failed || there);
        service_fini(&shared);
        keeper_destroy(to);
        heap_watch_end();
        refused += !there;
        CHECK(is_saved(&place, forest) || rename(aside, file) == 0);
    }
    CHECK(refused > 3);
    folder_remove(state);
}
