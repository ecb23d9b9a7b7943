/* test_parts.c: jobs that share their parts with whoever is free, and frames that are encoded so. */
#include "check.h"
#include "clock.h"
#include "parts.h"
#include "unit/geom_fixture.h"
#include "worker.h"

#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { JOBS = 20, PARTS = 50, HANDS = 4, STRANDS = 13000, POINTS = 16, TREES = 26 };

static void nobody_waits(void *context)
{
    (void)context;
}

static worker_pool *make_pool(unsigned workers)
{
    const worker_pool_def def = {
        .workers = workers, .greatest = JOBS, .clock_us = clock_monotonic_us, .wake = nobody_waits};
    worker_pool *pool = worker_pool_create(&def);
    CHECK(pool != NULL);
    return pool;
}

/* Has every job run, and waits for the end. */
static void run_all(worker_pool *pool, job *jobs, size_t stride, int count)
{
    for (int i = 0; i < count; i++) {
        worker_pool_submit(pool, (job *)(void *)((unsigned char *)jobs + (size_t)i * stride));
    }
    for (int done = 0; done < count;) {
        for (const job *j = worker_pool_take_done(pool); j; j = j->next) {
            done++;
        }
        nanosleep(&(struct timespec){.tv_nsec = 200000}, NULL);
    }
}

TEST(parts_are_taken_in_order_and_an_offer_without_any_is_gone)
{
    parts_list list = {NULL, NULL};
    parts first = {.count = 2}, second = {.count = 1};
    uint32_t index = 9;
    CHECK(parts_take(&list, NULL, &index) == NULL);
    parts_offer(&list, &first);
    parts_offer(&list, &second);
    CHECK(parts_take(&list, &second, &index) == &second); /* its own comes before what is older */
    CHECK_INT(index, 0);
    CHECK(parts_take(&list, &second, &index) == NULL);
    CHECK(parts_take(&list, NULL, &index) == &first);
    CHECK(!parts_end(&first)); /* one is left to take */
    CHECK(parts_take(&list, NULL, &index) == &first);
    CHECK_INT(index, 1);
    CHECK(parts_take(&list, NULL, &index) == NULL);
    parts_offer(&list, &second);
    CHECK(parts_take(&list, NULL, &index) == &second); /* nobody holds the list up */
    CHECK(parts_end(&first));
}

/* ---- threads ----------------------------------------------------------------------------------------------------- */

typedef struct shared_job {
    job work; /* first */
    const spread *helpers;
    atomic_int done[PARTS];
} shared_job;

/* Some take long, the last among them: whoever has it is still at it when there is nothing left to take. */
static void do_part(void *work, uint32_t index)
{
    if (index % 7 == 0) {
        nanosleep(&(struct timespec){.tv_nsec = 100000}, NULL);
    }
    atomic_fetch_add(&((shared_job *)work)->done[index], 1);
}

static void share(job *work)
{
    shared_job *s = (shared_job *)(void *)work;
    spread_run(s->helpers, do_part, s, PARTS);
    for (int i = 0; i < PARTS; i++) {
        CHECK_INT(atomic_load(&s->done[i]), 1); /* when it comes back all are done */
    }
}

TEST(parts_of_jobs_are_done_once_each_before_their_job_goes_on)
{
    for (unsigned workers = 1; workers <= HANDS; workers++) {
        shared_job *jobs = calloc(JOBS, sizeof *jobs);
        worker_pool *pool = make_pool(workers);
        CHECK_INT(worker_pool_spread(pool)->hands, workers);
        for (int i = 0; i < JOBS; i++) {
            jobs[i] = (shared_job){.work = {.run = share}, .helpers = worker_pool_spread(pool)};
        }
        run_all(pool, &jobs[0].work, sizeof *jobs, JOBS);
        worker_pool_destroy(pool);
        free(jobs);
    }
}

/* ---- frames ------------------------------------------------------------------------------------------------------ */

typedef struct frame_job {
    job work; /* first */
    geom_fixture *f;
    geom_scratch *scratch;
    geom_frame_def def;
    geom_buffer frame;
    geom_frame_stats stats;
    awt_status status;
    awt_error error;
} frame_job;

static void encode(job *work)
{
    frame_job *j = (frame_job *)(void *)work;
    j->status = geom_encode(j->f->layout, j->scratch, &j->def, &j->frame, &j->stats, &j->error);
}

static void check_frames(geom_kind kind)
{
    enum { FRAMES = 6 };
    geom_fixture f;
    geom_fixture_init(&f, STRANDS, POINTS, TREES);
    geom_fixture_layout(&f, &(geom_layout_def){.kind = kind});
    const uint32_t patches = geom_layout_patches(f.layout);
    CHECK(patches > 2 * 4); /* windows for three hands */
    bool *unchanged = calloc(patches, sizeof *unchanged);
    geom_fixture_encode(&f, NULL); /* what is kept is taken from */
    geom_buffer before = f.frame;
    f.frame = (geom_buffer){0};
    for (uint32_t i = 0; i < patches; i++) {
        const geom_patch p = geom_layout_patch(f.layout, i);
        unchanged[i] = i % 4 == 1;
        for (size_t k = 0; k < 3 * (size_t)POINTS * p.strands && !unchanged[i]; k++) {
            f.points[3 * (size_t)POINTS * p.first_strand + k] += 0.001f;
        }
    }
    geom_frame_stats stats;
    geom_fixture_encode(&f, &stats); /* alone, all of them */
    CHECK_INT(stats.encoded_patches, patches);
    worker_pool *pool = make_pool(HANDS);
    for (int with_kept = 0; with_kept < 2; with_kept++) {
        frame_job jobs[FRAMES];
        for (int i = 0; i < FRAMES; i++) {
            jobs[i] = (frame_job){.work = {.run = encode}, .f = &f, .def = geom_fixture_def(&f)};
            jobs[i].def.helpers = worker_pool_spread(pool);
            jobs[i].def.unchanged = with_kept ? unchanged : NULL;
            jobs[i].def.previous = with_kept ? &before : NULL;
            CHECK_INT(geom_scratch_create(f.layout, &jobs[i].scratch, NULL), AWT_OK);
            CHECK_INT(geom_scratch_widen(jobs[i].scratch, f.layout, HANDS, NULL), AWT_OK);
        }
        run_all(pool, &jobs[0].work, sizeof jobs[0], FRAMES);
        for (int i = 0; i < FRAMES; i++) {
            CHECK_INT(jobs[i].status, AWT_OK);
            CHECK(with_kept ? jobs[i].stats.encoded_patches < patches : jobs[i].stats.encoded_patches == patches);
            CHECK_U64(jobs[i].frame.size, f.frame.size);
            CHECK(jobs[i].frame.size == f.frame.size && memcmp(jobs[i].frame.bytes, f.frame.bytes, f.frame.size) == 0);
            geom_buffer_fini(&jobs[i].frame);
            geom_scratch_destroy(jobs[i].scratch);
        }
    }
    worker_pool_destroy(pool);
    geom_buffer_fini(&before);
    free(unchanged);
    geom_fixture_fini(&f);
}

TEST(frames_have_the_same_bytes_whoever_helps)
{
    check_frames(GEOM_RIBBON);
    check_frames(GEOM_STRANDS);
}

TEST(frames_that_several_encode_are_refused_for_their_first_bad_point)
{
    geom_fixture f;
    geom_fixture_init(&f, STRANDS, POINTS, TREES);
    worker_pool *pool = make_pool(HANDS);
    frame_job j = {.work = {.run = encode}, .f = &f, .def = geom_fixture_def(&f)};
    j.def.helpers = worker_pool_spread(pool);
    CHECK_INT(geom_scratch_create(f.layout, &j.scratch, NULL), AWT_OK);
    CHECK_INT(geom_scratch_widen(j.scratch, f.layout, HANDS, NULL), AWT_OK);
    f.points[3 * POINTS * 2600 + 7] = f.points[3 * POINTS * 12000 + 7] = NAN;
    run_all(pool, &j.work, sizeof j, 1);
    CHECK_INT(j.status, AWT_BAD_VALUE);
    unsigned first = 0, last = 0;
    CHECK_INT(sscanf(j.error.text, "a point or frame among strands %u to %u", &first, &last), 2);
    CHECK(first <= 2600 && last >= 2600);
    worker_pool_destroy(pool);
    geom_buffer_fini(&j.frame);
    geom_scratch_destroy(j.scratch);
    geom_fixture_fini(&f);
}
