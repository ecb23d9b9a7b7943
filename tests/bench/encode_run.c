/* encode_run.c: hair goes through a clip; every few frames each kind is encoded and decoded by us and by libdraco, one
 * after the other, so that whatever else the machine does meets both. */
#include "bench/bench.h"
#include "bench/encode.h"
#include "bench/encode_delta.h"

#include "base/error.h"
#include "clock.h"
#include "files.h"
#include "geom/draco_read.h"
#include "geom/draco_shim.h"
#include "geom/glb.h"
#include "geom/layout.h"
#include "geom/topology.h"
#include "progress.h"
#include "quantile.h"
#include "worker.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { MOST_FILE = 1 << 30, REPEATS = 3 };

/* ---- the hair */

typedef struct hair {
    awt_groom *groom;
    awt_forest *forest;
    awt_groom_info info;
    float *centres, *frames, *scratch, *points;
} hair;

static awt_status read_strands(const encode_plan *plan, awt_strands *strands, awt_groom_def *def, awt_error *error)
{
    char text[400];
    size_t size;
    awt_placement placement = {0};
    if (!plan->groom_file) {
        *def = awt_groom_def_of_style(plan->style);
        return awt_style_grow(plan->style, plan->strands, 1, strands, error);
    }
    *def = awt_groom_def_default();
    unsigned char *bytes = files_read(plan->groom_file, MOST_FILE, &size, text, sizeof text);
    if (!bytes) {
        return error_set(error, AWT_BAD_VALUE, "%s", text);
    }
    awt_status status = awt_strands_read(bytes, size, strands, error);
    free(bytes);
    if (status == AWT_OK) {
        status = awt_strands_place(strands, &placement, error);
        def->head_radius_m = placement.head_radius_m;
    }
    return status;
}

static awt_status make_hair(const encode_plan *plan, hair *h, awt_error *error)
{
    awt_strands strands = {0};
    awt_groom_def def;
    awt_status status = read_strands(plan, &strands, &def, error);
    def.points_per_strand = plan->points;
    if (status == AWT_OK) {
        status = awt_groom_build(&strands, &def, NULL, NULL, &h->groom, error);
    }
    awt_strands_fini(&strands);
    if (status != AWT_OK) {
        return status;
    }
    awt_groom_get_info(h->groom, &h->info);
    const size_t points = (size_t)h->info.strand_count * h->info.points_per_strand;
    h->centres = malloc(3 * (size_t)h->info.finest_nodes * sizeof(float));
    h->frames = malloc(4 * (size_t)h->info.finest_nodes * sizeof(float));
    h->scratch = malloc((awt_groom_strand_scratch(h->groom) + 1) * sizeof(float));
    h->points = malloc(3 * points * sizeof(float));
    if (!h->centres || !h->frames || !h->scratch || !h->points) {
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    awt_forest_def forest = awt_forest_def_default(h->groom);
    motion_sample pose = motion_at(&plan->clip, 0);
    if (!plan->groom_file) {
        forest.params = plan->style->params;
    }
    forest.start.head = pose.head;
    forest.start.body = pose.body;
    return awt_forest_create(h->groom, &forest, &h->forest, error);
}

static void free_hair(hair *h)
{
    awt_forest_destroy(h->forest);
    awt_groom_destroy(h->groom);
    free(h->centres);
    free(h->frames);
    free(h->scratch);
    free(h->points);
}

static awt_status move_hair(const encode_plan *plan, hair *h, int64_t time_us, awt_error *error)
{
    motion_sample pose = motion_at(&plan->clip, time_us);
    const awt_motion to = {.time_us = time_us, .head = pose.head, .body = pose.body};
    awt_status status = awt_forest_move(h->forest, &to, error);
    return status == AWT_OK ? awt_forest_advance(h->forest, time_us, NULL, error) : status;
}

/* ---- one kind */

/* Encoders, and what was measured of each frame. */
typedef struct subject {
    geom_layout *layout, *stock_layout;
    geom_scratch *scratch, *stock_scratch;
    geom_buffer frame, previous, kept, stock_frame;
    draco_reader *reader;
    float *points; /* of the layout's level */
    float *vertices;
    bool *unchanged;
    const spread *helpers; /* NULL: not measured */
    double *encode_ms[ENCODE_MOVINGS], *shared_ms, *stock_ms, *vertices_ms, *evaluate_ms, *decode_ms,
        *stock_decode_ms;                             /* [frames] */
    double bytes, stock_bytes, entropy_bits, error_m; /* sums, and the greatest */
    uint32_t done;
} subject;

/* Strand points of a frame. */
static size_t points_of(const subject *s)
{
    return (size_t)geom_layout_strands(s->layout) * s->layout->points_per_strand;
}

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

/* A layout that several hands encode nothing of together has no helpers. */
static awt_status take_helpers(subject *s, const spread *helpers, awt_error *error)
{
    if (s->layout->patch_count <= RANS_LANES) {
        return AWT_OK;
    }
    s->helpers = helpers;
    return geom_scratch_widen(s->scratch, s->layout, helpers->hands, error);
}

static awt_status make_subject(const hair *h, geom_kind kind, geom_level level, uint32_t frames, subject *s,
                               awt_error *error)
{
    awt_status status =
        geom_layout_create(h->groom, &(geom_layout_def){.kind = kind, .level = level}, &s->layout, error);
    if (status == AWT_OK) {
        status = geom_layout_create(h->groom, &(geom_layout_def){.kind = kind, .level = level, .stock = true},
                                    &s->stock_layout, error);
    }
    if (status == AWT_OK) {
        status = geom_scratch_create(s->layout, &s->scratch, error);
    }
    if (status == AWT_OK) {
        status = geom_scratch_create(s->stock_layout, &s->stock_scratch, error);
    }
    if (status != AWT_OK) {
        return status;
    }
    const geom_patch largest = {0, s->layout->largest_patch};
    status =
        draco_reader_create(layout_patch_vertices(s->layout, &largest),
                            topology_triangles(kind, largest.strands, h->info.points_per_strand), &s->reader, error);
    double **times[] = {&s->shared_ms,   &s->stock_ms,  &s->vertices_ms,
                        &s->evaluate_ms, &s->decode_ms, &s->stock_decode_ms};
    bool made = true;
    for (size_t k = 0; k < sizeof times / sizeof times[0]; k++) {
        made = (*times[k] = calloc(frames, sizeof(double))) && made;
    }
    for (size_t k = 0; k < ENCODE_MOVINGS; k++) {
        made = (s->encode_ms[k] = calloc(frames, sizeof(double))) && made;
    }
    s->unchanged = calloc(s->layout->patch_count, sizeof *s->unchanged);
    s->points = calloc(points_of(s), 3 * sizeof(float));
    s->vertices = calloc(points_of(s), 6 * sizeof(float));
    return status == AWT_OK && !(made && s->unchanged && s->points && s->vertices)
               ? error_set(error, AWT_NO_MEMORY, NULL)
               : status;
}

static void free_subject(subject *s)
{
    geom_scratch_destroy(s->scratch);
    geom_scratch_destroy(s->stock_scratch);
    geom_layout_destroy(s->layout);
    geom_layout_destroy(s->stock_layout);
    draco_reader_destroy(s->reader);
    geom_buffer *buffers[] = {&s->frame, &s->previous, &s->kept, &s->stock_frame};
    for (size_t k = 0; k < sizeof buffers / sizeof buffers[0]; k++) {
        geom_buffer_fini(buffers[k]);
    }
    for (size_t k = 0; k < ENCODE_MOVINGS; k++) {
        free(s->encode_ms[k]);
    }
    free(s->shared_ms);
    free(s->stock_ms);
    free(s->vertices_ms);
    free(s->evaluate_ms);
    free(s->points);
    free(s->decode_ms);
    free(s->stock_decode_ms);
    free(s->unchanged);
    free(s->vertices);
}

/* ---- one frame */

/* The least of a few times: what else the machine did is in none of them, one hopes. */
static awt_status time_encode(const geom_layout *layout, geom_scratch *scratch, const geom_frame_def *def, int repeats,
                              geom_buffer *out, geom_frame_stats *stats, double *ms, awt_error *error)
{
    awt_status status = AWT_OK;
    *ms = INFINITY;
    for (int n = 0; n < repeats && status == AWT_OK; n++) {
        double begin = bench_now_ms();
        status = geom_encode(layout, scratch, def, out, stats, error);
        *ms = fmin(*ms, bench_now_ms() - begin);
    }
    return status;
}

static awt_status time_own(subject *s, geom_frame_def *def, awt_error *error)
{
    geom_frame_stats stats = {0};
    geom_buffer swap = s->previous;
    s->previous = s->frame;
    s->frame = swap;
    def->measure = true;
    awt_status status = geom_encode(s->layout, s->scratch, def, &s->frame, &stats, error);
    s->entropy_bits += stats.entropy_bits;
    def->measure = false;
    for (int moving = ENCODE_ALL; moving < ENCODE_MOVINGS && status == AWT_OK; moving++) {
        for (uint32_t i = 0; i < s->layout->patch_count; i++) {
            s->unchanged[i] = moving == ENCODE_NONE || i % 4 != 0;
        }
        def->unchanged = moving == ENCODE_ALL ? NULL : s->unchanged;
        def->previous = s->done > 0 ? &s->previous : &s->frame;
        status = time_encode(s->layout, s->scratch, def, REPEATS, moving == ENCODE_ALL ? &s->frame : &s->kept, NULL,
                             &s->encode_ms[moving][s->done], error);
    }
    def->unchanged = NULL;
    if (status == AWT_OK && s->helpers) {
        def->helpers = s->helpers;
        status = time_encode(s->layout, s->scratch, def, REPEATS, &s->kept, NULL, &s->shared_ms[s->done], error);
        def->helpers = NULL;
    }
    s->bytes += (double)s->frame.size;
    if (s->layout->kind == GEOM_RIBBON) {
        uint32_t clamped = 0;
        double begin = bench_now_ms();
        ribbon_vertices(&s->layout->shape, s->points, geom_layout_strands(s->layout), s->vertices, &clamped);
        s->vertices_ms[s->done] = bench_now_ms() - begin;
    }
    return status;
}

/* Where a patch's vertices go. */
static float *vertices_of(subject *s, const glb_patch *patch)
{
    return s->vertices +
           (size_t)patch->first_strand * s->layout->points_per_strand * topology_vertices_a_point(s->layout->kind) * 3;
}

/* Patches number `first` and the next few by our reader. */
static bool decode_own(subject *s, const glb_frame *glb, uint32_t first)
{
    const draco_kind kind = {.indices = s->layout->indices};
    draco_source sources[RANS_LANES] = {{0}};
    for (uint32_t k = 0; k < RANS_LANES && first + k < glb->patch_count; k++) {
        const glb_patch *patch = &glb->patches[first + k];
        sources[k] = (draco_source){.bytes = glb->binary + patch->offset,
                                    .size = patch->size,
                                    .vertices = patch->vertices,
                                    .triangles = patch->triangles,
                                    .positions = vertices_of(s, patch)};
    }
    return draco_read(s->reader, &kind, sources);
}

/* All patches of our frame, by our reader or by libdraco. */
static awt_status time_decode(subject *s, bool stock, double *ms, awt_error *error)
{
    glb_frame glb;
    awt_status status = glb_read(s->frame.bytes, s->frame.size, &glb, error);
    double begin = bench_now_ms();
    for (uint32_t i = 0; status == AWT_OK && i < glb.patch_count; i += stock ? 1 : RANS_LANES) {
        const glb_patch *patch = &glb.patches[i];
        if (stock) {
            status = draco_shim_decode(glb.binary + patch->offset, patch->size, s->layout->indices, patch->vertices,
                                       patch->triangles, vertices_of(s, patch), error);
        } else if (!decode_own(s, &glb, i)) {
            status = error_set(error, AWT_BAD_FORMAT, "our reader refuses what our encoder wrote");
        }
    }
    *ms = bench_now_ms() - begin;
    glb_frame_fini(&glb);
    return status;
}

/* The greatest distance of a decoded point (of a ribbon: the middle of its edges) from the one that went in. */
static double greatest_error(const subject *s)
{
    const size_t points = points_of(s);
    const bool ribbon = s->layout->kind == GEOM_RIBBON;
    double greatest = 0;
    for (size_t i = 0; i < points; i++) {
        double square = 0;
        for (size_t k = 0; k < 3; k++) {
            double at = ribbon ? 0.5 * ((double)s->vertices[6 * i + k] + (double)s->vertices[6 * i + 3 + k])
                               : (double)s->vertices[3 * i + k];
            square += (at - (double)s->points[3 * i + k]) * (at - (double)s->points[3 * i + k]);
        }
        greatest = square > greatest ? square : greatest;
    }
    return sqrt(greatest);
}

static awt_status measure_frame(const hair *h, subject *s, int64_t time_us, awt_error *error)
{
    double begin = bench_now_ms();
    geom_layout_evaluate(s->layout, h->groom, NULL, h->centres, h->frames, h->scratch, s->points);
    s->evaluate_ms[s->done] = bench_now_ms() - begin;
    geom_frame_def def = {.points = s->points, .head = awt_forest_head(h->forest), .time_us = time_us};
    awt_status status = time_own(s, &def, error);
    if (status == AWT_OK) {
        status = time_encode(s->stock_layout, s->stock_scratch, &def, 1, &s->stock_frame, NULL, &s->stock_ms[s->done],
                             error);
        s->stock_bytes += (double)s->stock_frame.size;
    }
    if (status == AWT_OK) {
        status = time_decode(s, true, &s->stock_decode_ms[s->done], error);
    }
    if (status == AWT_OK) {
        status = time_decode(s, false, &s->decode_ms[s->done], error);
    }
    if (status == AWT_OK) {
        s->error_m = fmax(s->error_m, greatest_error(s));
        s->done++;
    }
    return status;
}

/* ---- all of it */

static double median(double *values, uint32_t count)
{
    quantile_sort(values, count);
    return quantile_at(values, count, 0.5);
}

static void fill_rows(subject *s, encode_row *rows)
{
    const size_t points = points_of(s);
    const double all = (double)points * s->done;
    encode_row row = {.kind = s->layout->kind,
                      .level = s->layout->level.level,
                      .quantisation_bits = s->layout->box.bits,
                      .patches = s->layout->patch_count,
                      .points = points,
                      .stock_encode_ms = median(s->stock_ms, s->done),
                      .shared_encode_ms = s->helpers ? median(s->shared_ms, s->done) : 0,
                      .evaluate_ms = median(s->evaluate_ms, s->done),
                      .vertices_ms = median(s->vertices_ms, s->done),
                      .bytes_per_point = s->bytes / all,
                      .stock_bytes_per_point = s->stock_bytes / all,
                      .entropy_bits_per_point = s->entropy_bits / all,
                      .max_error_mm = s->error_m * 1e3,
                      .decode_ms = median(s->decode_ms, s->done),
                      .stock_decode_ms = median(s->stock_decode_ms, s->done),
                      .scratch_bytes = geom_scratch_bytes(s->scratch)};
    for (int moving = ENCODE_ALL; moving < ENCODE_MOVINGS; moving++) {
        row.moving = (encode_moving)moving;
        row.encode_ms = median(s->encode_ms[moving], s->done);
        rows[moving] = row;
    }
}

static awt_status measure_all(const encode_plan *plan, hair *h, subject subjects[ENCODE_SUBJECTS],
                              delta_subject *deltas, guides_subject *guides, awt_error *error)
{
    progress bar = progress_begin(stderr, "encoding", false);
    const uint32_t frames = plan->frames * plan->stride;
    awt_status status = plan->begin_us > 0 ? move_hair(plan, h, plan->begin_us, error) : AWT_OK;
    for (uint32_t n = 1; n <= frames && status == AWT_OK; n++) {
        const int64_t time_us = plan->begin_us + (int64_t)n * 1000000 / ENCODE_FRAME_RATE;
        status = move_hair(plan, h, time_us, error);
        const bool measured = n % plan->stride == 0;
        if (status == AWT_OK) {
            const awt_pose head = awt_forest_head(h->forest);
            awt_forest_guides(h->forest, h->centres, h->frames);
            awt_groom_strands(h->groom, h->centres, h->frames, h->scratch, h->points);
            status = delta_subject_frame(deltas, h->points, &head, time_us, measured, error);
        }
        for (int k = 0; k < ENCODE_SUBJECTS && measured && status == AWT_OK; k++) {
            status = measure_frame(h, &subjects[k], time_us, error);
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
    hair h = {0};
    subject subjects[ENCODE_SUBJECTS] = {{0}};
    delta_subject *deltas = NULL;
    guides_subject guides = {0};
    awt_error error = {0};
    worker_pool *pool = plan->hands > 1 ? make_pool(plan->hands - 1) : NULL;
    const spread helpers = pool ? of_hands(pool, plan->hands) : (spread){.hands = 1};
    awt_status status = make_hair(plan, &h, &error);
    if (status == AWT_OK && plan->hands > 1 && !pool) {
        status = error_set(&error, AWT_NO_MEMORY, NULL);
    }
    if (status == AWT_OK) {
        status = guides_subject_init(&guides, h.groom, plan->frames, &error);
    }
    for (int k = 0; k < ENCODE_SUBJECTS && status == AWT_OK; k++) {
        status = make_subject(&h, k % 2 ? GEOM_STRANDS : GEOM_RIBBON, (geom_level)(k / 2), plan->frames, &subjects[k],
                              &error);
        status = status == AWT_OK && pool ? take_helpers(&subjects[k], &helpers, &error) : status;
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
            fill_rows(&subjects[k], rows + k * ENCODE_MOVINGS);
        }
        free_subject(&subjects[k]);
    }
    if (status == AWT_OK) {
        guides_rows(&guides, of_guides);
        *binding_bytes = guides.binding_bytes;
    }
    guides_subject_fini(&guides);
    free_hair(&h);
    worker_pool_destroy(pool);
    if (status != AWT_OK) {
        fprintf(stderr, "awt-bench encode: %s\n", error.text);
    }
    return status == AWT_OK;
}
