/* test_record.c: a recording runs again to the same bits, and says where it does not. */
#include "check.h"
#include "fixture.h"

#include "base/bytes.h"
#include "base/crc32c.h"
#include "base/rng.h"

#include <stdlib.h>
#include <string.h>

static const double zero[3] = {0, 0, 0};
enum { STRANDS = 150, STEPS = 120, HEADER = 16, RECORD_HEAD = 5, RECORD_CRC = 4 }; /* record.c */

typedef struct recording {
    unsigned char *data;
    size_t size;
    size_t writes;
} recording;

static void recording_grow(void *context, const void *bytes, size_t size)
{
    recording *r = context;
    r->data = realloc(r->data, r->size + size);
    memcpy(r->data + r->size, bytes, size);
    r->size += size;
    r->writes++;
}

static size_t records_begin(const recording *r)
{
    return HEADER + (size_t)load_u64(r->data + 8);
}

static size_t record_end(const recording *r, size_t at)
{
    return at + RECORD_HEAD + load_u32(r->data + at + 1) + RECORD_CRC;
}

static void record_repair(const recording *r, size_t at)
{
    size_t crc = record_end(r, at) - RECORD_CRC;
    store_u32(r->data + crc, crc32c(r->data + at, crc - at));
}

/* Begins in the middle of a lean; parameters change on the way, and some inputs are refused. */
static uint64_t record_lean(recording *out)
{
    awt_forest *f = fixture_forest(fixture_groom("long", STRANDS), "long", zero, zero);
    for (int n = 1; n <= 100; n++) {
        fixture_advance(f, fixture_clip("lean"), (int64_t)n * AWT_STEP_US, zero, zero, NULL);
    }
    awt_recorder recorder = {f, recording_grow, out};
    CHECK_INT(awt_recorder_begin(&recorder, NULL), AWT_OK);
    for (int n = 101; n <= 100 + STEPS; n++) {
        int64_t time_us = (int64_t)n * AWT_STEP_US;
        awt_motion m = fixture_motion(fixture_clip("lean"), time_us, zero, zero);
        CHECK_INT(awt_recorder_move(&recorder, &m, NULL), AWT_OK);
        CHECK_INT(awt_recorder_move(&recorder, &m, NULL), AWT_BAD_TIME);
        if (n % 50 == 0) {
            awt_params params = awt_forest_params(f);
            params.wind_x = (float)n * 0.01f;
            CHECK_INT(awt_recorder_set_params(&recorder, &params, NULL), AWT_OK);
            params.drag = -1;
            CHECK_INT(awt_recorder_set_params(&recorder, &params, NULL), AWT_BAD_VALUE);
        }
        awt_step_stats stats;
        CHECK_INT(awt_recorder_advance(&recorder, time_us, &stats, NULL), AWT_OK);
        CHECK_INT(stats.steps, 1);
    }
    CHECK_INT(awt_recorder_advance(&recorder, 0, NULL, NULL), AWT_BAD_TIME);
    uint64_t hash = awt_forest_hash(f);
    awt_forest_destroy(f);
    return hash;
}

/* Runs until the end or the first error; the bytes in memory of just their size. */
static awt_status replay_all(const unsigned char *data, size_t size, uint64_t *steps, uint64_t *hash, awt_error *error)
{
    unsigned char *exact = malloc(size ? size : 1);
    memcpy(exact, data, size);
    awt_replay *replay;
    *steps = 0;
    awt_status status = awt_replay_create(exact, size, &replay, error);
    bool more = status == AWT_OK;
    while (status == AWT_OK && more) {
        status = awt_replay_next(replay, &more, error);
    }
    if (replay) {
        *steps = awt_replay_steps(replay);
        *hash = awt_forest_hash(awt_replay_forest(replay));
    }
    awt_replay_destroy(replay);
    free(exact);
    return status;
}

TEST(a_recording_runs_again_to_the_same_bits)
{
    recording r = {0};
    uint64_t recorded = record_lean(&r), hash = 0, steps = 0;
    awt_error error = {0};
    CHECK_INT(r.writes, 1 + 2 * STEPS + 2); /* only what was taken: poses and advances, and parameters twice */
    CHECK_INT(replay_all(r.data, r.size, &steps, &hash, &error), AWT_OK);
    CHECK_TEXT(error.text, "");
    CHECK_INT(steps, STEPS);
    CHECK_U64(hash, recorded);
    free(r.data);
}

TEST(a_replay_names_the_first_step_that_differs)
{
    recording r = {0};
    record_lean(&r);
    size_t at = records_begin(&r);
    for (int k = 0; k < 2 * 20; k++) { /* the pose of step 21 */
        at = record_end(&r, at);
    }
    r.data[at + RECORD_HEAD + 9] ^= 1; /* the last bit of where the head is */
    record_repair(&r, at);
    uint64_t steps, hash;
    awt_error error;
    CHECK_INT(replay_all(r.data, r.size, &steps, &hash, &error), AWT_BAD_VALUE);
    CHECK_INT(steps, 20);
    CHECK(strncmp(error.text, "step 21,", 8) == 0);
    free(r.data);
}

TEST(a_recording_cut_anywhere_replays_as_far_as_it_goes)
{
    recording r = {0};
    record_lean(&r);
    uint64_t steps, hash;
    awt_error error;
    for (size_t size = 0; size < records_begin(&r); size += 9973) {
        CHECK(replay_all(r.data, size, &steps, &hash, &error) != AWT_OK);
    }
    uint64_t least = 0;
    for (size_t size = records_begin(&r); size < r.size; size += 997) {
        size_t at = records_begin(&r);
        while (at < size) {
            at = record_end(&r, at);
        }
        CHECK_INT(replay_all(r.data, size, &steps, &hash, &error), at == size ? AWT_OK : AWT_TRUNCATED);
        CHECK(steps >= least);
        least = steps;
    }
    CHECK(least > STEPS / 2);
    CHECK_INT(replay_all(r.data, r.size - 1, &steps, &hash, &error), AWT_TRUNCATED); /* within the checksum */
    CHECK_INT(steps, STEPS - 1);
    free(r.data);
}

TEST(damaged_and_foreign_recordings_are_refused)
{
    recording r = {0};
    record_lean(&r);
    uint64_t steps, hash;
    awt_error error;
    const size_t first = records_begin(&r), second = record_end(&r, first);
    r.data[first + RECORD_HEAD] ^= 4;
    CHECK_INT(replay_all(r.data, r.size, &steps, &hash, &error), AWT_BAD_VALUE);
    CHECK(strstr(error.text, "damaged") != NULL);
    r.data[first + RECORD_HEAD] ^= 4;

    r.data[first] = 9; /* an operation that there is not */
    record_repair(&r, first);
    CHECK_INT(replay_all(r.data, r.size, &steps, &hash, &error), AWT_OTHER_VERSION);
    r.data[first] = 3; /* a pose that says it is an advance */
    record_repair(&r, first);
    CHECK(replay_all(r.data, r.size, &steps, &hash, &error) != AWT_OK);
    r.data[first] = 1;
    record_repair(&r, first);

    store_u32(r.data + first + 1, 0xffffffffu);
    CHECK_INT(replay_all(r.data, r.size, &steps, &hash, &error), AWT_BAD_VALUE);
    store_u32(r.data + first + 1, (uint32_t)(second - first - RECORD_HEAD - RECORD_CRC));

    store_u64(r.data + 8, UINT64_MAX); /* the snapshot's size */
    CHECK_INT(replay_all(r.data, r.size, &steps, &hash, &error), AWT_TRUNCATED);
    r.data[0] = 'B';
    CHECK_INT(replay_all(r.data, r.size, &steps, &hash, &error), AWT_BAD_FORMAT);
    CHECK_INT(replay_all(r.data, 0, &steps, &hash, &error), AWT_BAD_FORMAT);
    free(r.data);
}

TEST(changed_records_with_fitting_checksums_break_nothing)
{
    recording r = {0}, changed;
    record_lean(&r);
    changed = (recording){malloc(r.size), r.size, 0};
    rng random = rng_seed(3);
    uint64_t steps, hash;
    const size_t begin = records_begin(&r);
    for (int n = 0; n < 100; n++) {
        memcpy(changed.data, r.data, r.size);
        size_t at = begin;
        for (uint32_t skip = rng_u32(&random) % 12; skip > 0; skip--) {
            at = record_end(&r, at);
        }
        size_t within = record_end(&r, at) - at - RECORD_HEAD - RECORD_CRC;
        changed.data[at + RECORD_HEAD + rng_u32(&random) % within] ^= (unsigned char)(1u << rng_u32(&random) % 8);
        record_repair(&changed, at);
        awt_error error = {0};
        CHECK(replay_all(changed.data, record_end(&r, at), &steps, &hash, &error) == AWT_OK || error.text[0] != '\0');
    }
    free(r.data), free(changed.data);
}
