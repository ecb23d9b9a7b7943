/* capacity_heads.c: what a second of a head costs where there are several: see capacity.h.
 *
 * A worker takes its heads by turns, a frame of one after a frame of another, so that each finds the caches full of the
 * others' hair: a step and a frame cost more than in a run by themselves. Here they are stepped and drawn as by a
 * worker: 100 steps a second, and 60 frames that lie between two of them. */
#include "bench/capacity.h"

#include "base/error.h"
#include "drawing.h"

#include <stdlib.h>

enum { RUN_IN_FRAMES = 6 }; /* drawn before anything is counted */

static const int64_t SECOND_US = 1000000;

typedef struct head {
    awt_forest *forest;
    drawing *draws;
    picture *drawn;
    uint64_t sequence;
} head;

/* The heads, and what they have cost since the counting began. */
typedef struct heads {
    const capacity_pass *pass;
    wishes wanted;
    head list[CAPACITY_MAX_HEADS];
    uint32_t count;
    double step_ms, frame_ms;
    uint32_t steps, frames;
} heads;

static awt_motion motion_of(const capacity_pass *pass, int64_t time_us)
{
    motion_sample pose = motion_at(pass->clip, time_us);
    return (awt_motion){.time_us = time_us, .head = pose.head, .body = pose.body};
}

static awt_status add_head(heads *h, awt_error *error)
{
    head *added = &h->list[h->count++];
    awt_forest_def def = awt_forest_def_default(h->pass->groom);
    def.params = h->pass->params;
    def.start = motion_of(h->pass, 0);
    awt_status status = awt_forest_create(h->pass->groom, &def, &added->forest, error);
    status = status == AWT_OK ? drawing_create(h->pass->groom, NULL, &added->draws, error) : status;
    added->drawn = picture_create();
    return status == AWT_OK && !added->drawn ? error_set(error, AWT_NO_MEMORY, NULL) : status;
}

static void remove_heads(heads *h)
{
    for (uint32_t k = 0; k < h->count; k++) {
        picture_release(h->list[k].drawn);
        drawing_destroy(h->list[k].draws);
        awt_forest_destroy(h->list[k].forest);
    }
}

/* Steps to the first one that is not before `time_us`; what is held before the last of them counts to the frame. */
static awt_status step_to(heads *h, head *of, int64_t time_us, bool seen, awt_error *error)
{
    awt_status status = AWT_OK;
    while (status == AWT_OK && awt_forest_time(of->forest) < time_us) {
        const int64_t end_us = awt_forest_time(of->forest) + AWT_STEP_US;
        const awt_motion pose = motion_of(h->pass, end_us);
        const double begin = bench_thread_ms();
        if (seen && end_us > time_us) {
            drawing_hold(of->draws, of->forest);
        }
        const double between = bench_thread_ms();
        awt_step_stats stats;
        status = awt_forest_move(of->forest, &pose, error);
        status = status == AWT_OK ? awt_forest_advance(of->forest, end_us, &stats, error) : status;
        h->frame_ms += between - begin;
        h->step_ms += bench_thread_ms() - between;
        h->steps++;
    }
    return status;
}

static awt_status draw(heads *h, head *of, int64_t time_us, awt_error *error)
{
    const double begin = bench_thread_ms();
    drawing_show(of->draws, of->forest, time_us);
    picture_renew(of->drawn);
    const awt_status status = drawing_draw(of->draws, of->forest, ++of->sequence, &h->wanted, of->drawn, error);
    h->frame_ms += bench_thread_ms() - begin;
    h->frames++;
    return status;
}

static awt_status run(heads *h, awt_error *error)
{
    awt_status status = AWT_OK;
    const int64_t first = h->pass->begin_us * ENCODE_FRAME_RATE / SECOND_US;
    const int64_t last = h->pass->end_us * ENCODE_FRAME_RATE / SECOND_US;
    for (int64_t n = 1; n <= last && status == AWT_OK; n++) {
        const int64_t time_us = n * SECOND_US / ENCODE_FRAME_RATE;
        const bool seen = n > first - RUN_IN_FRAMES;
        for (uint32_t k = 0; k < h->count && status == AWT_OK; k++) {
            status = step_to(h, &h->list[k], time_us, seen, error);
            status = status == AWT_OK && seen ? draw(h, &h->list[k], time_us, error) : status;
        }
        if (n == first) {
            h->step_ms = h->frame_ms = 0;
            h->steps = h->frames = 0;
        }
    }
    return status;
}

awt_status capacity_measure_heads(const capacity_pass *pass, capacity_head *out, awt_error *error)
{
    heads h = {.pass = pass};
    awt_status status = AWT_OK;
    wishes_add(&h.wanted, (view_name){.form = form_find((uint8_t)pass->kind, (uint8_t)pass->level, 0)});
    while (h.count < pass->heads && status == AWT_OK) {
        status = add_head(&h, error);
    }
    status = status == AWT_OK ? run(&h, error) : status;
    remove_heads(&h);
    if (status == AWT_OK) {
        *out = (capacity_head){.step_ms = h.step_ms / h.steps, .frame_ms = h.frame_ms / h.frames};
    }
    return status;
}
