/* encode_run.c: hair goes through a clip; every few frames each kind of them is measured. */
#include "bench/bench.h"
#include "bench/encode.h"
#include "bench/encode_delta.h"
#include "bench/encode_subject.h"

#include "base/error.h"
#include "clock.h"
#include "progress.h"
#include "worker.h"

#include <stdio.h>

static void nobody_waits(void *context)
{
    (void)context;
}

/* The daemon's own workers: beside the thread that measures. */
static worker_pool *make_pool(unsigned workers)
{
    return worker_pool_create(
        &(worker_pool_def){.workers = workers, .greatest = 1, .clock_us = clock_monotonic_us, .wake = nobody_waits});
}

static spread of_hands(worker_pool *pool, uint32_t hands)
{
    spread all = *worker_pool_spread(pool);
    all.hands = hands;
    return all;
}

/* ---- all of it */

static awt_status measure_all(const encode_plan *plan, encode_hair *h, encode_subject subjects[ENCODE_SUBJECTS],
                              delta_subject *deltas, guides_subject *guides, awt_error *error)
{
    progress bar = progress_begin(stderr, "encoding", false);
    const uint32_t frames = plan->frames * plan->stride;
    awt_status status = plan->begin_us > 0 ? encode_hair_move(plan, h, plan->begin_us, error) : AWT_OK;
    for (uint32_t n = 1; n <= frames && status == AWT_OK; n++) {
        const int64_t time_us = plan->begin_us + (int64_t)n * 1000000 / ENCODE_FRAME_RATE;
        status = encode_hair_move(plan, h, time_us, error);
        const bool measured = n % plan->stride == 0;
        if (status == AWT_OK) {
            const awt_pose head = awt_forest_head(h->forest);
            awt_forest_guides(h->forest, h->centres, h->frames);
            awt_groom_strands(h->groom, h->centres, h->frames, h->scratch, h->points);
            status = delta_subject_frame(deltas, h->points, &head, time_us, measured, error);
        }
        for (int k = 0; k < ENCODE_SUBJECTS && measured && status == AWT_OK; k++) {
            status = encode_subject_measure(h, &subjects[k], time_us, error);
        }
        if (status == AWT_OK) {
            status = guides_measure(guides, h->forest, h->centres, h->frames, h->points, measured, error);
        }
        progress_show(&bar, (double)n / frames, "");
    }
    progress_hide(&bar);
    return status;
}

bool encode_measure(const encode_plan *plan, encode_row rows[ENCODE_ROWS], guides_row of_guides[GUIDES_KINDS],
                    size_t *binding_bytes)
{
    encode_hair h = {0};
    encode_subject subjects[ENCODE_SUBJECTS] = {{0}};
    delta_subject *deltas = NULL;
    guides_subject guides = {0};
    awt_error error = {0};
    worker_pool *pool = plan->hands > 1 ? make_pool(plan->hands - 1) : NULL;
    const spread helpers = pool ? of_hands(pool, plan->hands) : (spread){.hands = 1};
    awt_status status = encode_hair_make(plan, &h, &error);
    if (status == AWT_OK && plan->hands > 1 && !pool) {
        status = error_set(&error, AWT_NO_MEMORY, NULL);
    }
    if (status == AWT_OK) {
        status = guides_subject_init(&guides, h.groom, plan->frames, &error);
    }
    for (int k = 0; k < ENCODE_SUBJECTS && status == AWT_OK; k++) {
        status = encode_subject_make(&h, k % 2 ? GEOM_STRANDS : GEOM_RIBBON, (geom_level)(k / 2), plan->frames,
                                     &subjects[k], &error);
        status = status == AWT_OK && pool ? encode_subject_share(&subjects[k], &helpers, &error) : status;
    }
    if (status == AWT_OK) {
        status = delta_subject_create(h.groom, plan->frames, &deltas, &error);
    }
    if (status == AWT_OK) {
        status = measure_all(plan, &h, subjects, deltas, &guides, &error);
    }
    if (status == AWT_OK) {
        delta_subject_rows(deltas, rows + ENCODE_WHOLE_ROWS);
    }
    delta_subject_destroy(deltas);
    for (int k = 0; k < ENCODE_SUBJECTS; k++) {
        if (status == AWT_OK) {
            encode_subject_rows(&subjects[k], rows + k * ENCODE_MOVINGS);
        }
        encode_subject_free(&subjects[k]);
    }
    if (status == AWT_OK) {
        guides_rows(&guides, of_guides);
        *binding_bytes = guides.binding_bytes;
    }
    guides_subject_fini(&guides);
    encode_hair_free(&h);
    worker_pool_destroy(pool);
    if (status != AWT_OK) {
        fprintf(stderr, "awt-bench encode: %s\n", error.text);
    }
    return status == AWT_OK;
}
