/* guides_fixture.c: see guides_fixture.h. */
#include "unit/guides_fixture.h"

#include "base/assert.h"
#include "check.h"
#include "unit/fixture.h"

#include <math.h>
#include <stdlib.h>

static const double nowhere[3] = {0, 0, 0};

static void take(guides_fixture *f)
{
    awt_forest_guides(f->forest, f->centres, f->frames);
    awt_groom_strands(f->groom, f->centres, f->frames, f->scratch, f->points);
}

void guides_fixture_init(guides_fixture *f, const awt_groom *groom, const char *style)
{
    *f = (guides_fixture){.groom = groom};
    awt_groom_get_info(groom, &f->info);
    if (style) {
        f->forest = fixture_forest(groom, style, nowhere, nowhere);
    } else {
        awt_forest_def def = awt_forest_def_default(groom);
        CHECK_INT(awt_forest_create(groom, &def, &f->forest, NULL), AWT_OK);
    }
    f->centres = calloc(f->info.finest_nodes, 3 * sizeof(float));
    f->frames = calloc(f->info.finest_nodes, 4 * sizeof(float));
    f->scratch = calloc(awt_groom_strand_scratch(groom), sizeof(float));
    f->points = calloc((size_t)f->info.strand_count * f->info.points_per_strand, 3 * sizeof(float));
    CHECK_INT(geom_binding_write(groom, NULL, 0, &f->binding_size, NULL), AWT_OK);
    f->binding_bytes = malloc(f->binding_size);
    ASSERT(f->forest && f->centres && f->frames && f->scratch && f->points && f->binding_bytes);
    CHECK_INT(geom_binding_write(groom, f->binding_bytes, f->binding_size, &f->binding_size, NULL), AWT_OK);
    CHECK_INT(geom_binding_read(f->binding_bytes, f->binding_size, &f->binding, NULL), AWT_OK);
    ASSERT(f->binding);
    for (int form = 0; form < GUIDES_FORMS; form++) {
        const geom_layout_def def = {.kind = GEOM_GUIDES, .bound = form == 1};
        CHECK_INT(geom_layout_create(groom, &def, &f->layouts[form], NULL), AWT_OK);
        ASSERT(f->layouts[form]);
        CHECK_INT(geom_scratch_create(f->layouts[form], &f->scratches[form], NULL), AWT_OK);
        ASSERT(f->scratches[form]);
    }
    take(f);
}

void guides_fixture_fini(guides_fixture *f)
{
    awt_forest_destroy(f->forest);
    free(f->centres);
    free(f->frames);
    free(f->scratch);
    free(f->points);
    free(f->binding_bytes);
    geom_binding_destroy(f->binding);
    for (int form = 0; form < GUIDES_FORMS; form++) {
        geom_scratch_destroy(f->scratches[form]);
        geom_layout_destroy(f->layouts[form]);
    }
    geom_buffer_fini(&f->frame);
    *f = (guides_fixture){0};
}

void guides_fixture_move(guides_fixture *f, const char *clip, int64_t time_us)
{
    fixture_advance(f->forest, fixture_clip(clip), time_us, nowhere, nowhere, NULL);
    take(f);
}

void guides_fixture_encode(guides_fixture *f, int form, geom_frame_stats *stats)
{
    awt_error error = {0};
    const geom_frame_def def = {.points = f->centres,
                                .frames = f->frames,
                                .head = awt_forest_head(f->forest),
                                .time_us = awt_forest_time(f->forest)};
    CHECK_INT(geom_encode(f->layouts[form], f->scratches[form], &def, &f->frame, stats, &error), AWT_OK);
    CHECK_TEXT(error.text, "");
}

void guides_fixture_compare(const guides_fixture *f, double *greatest_m, double *mean_m)
{
    const size_t points = (size_t)f->info.strand_count * f->info.points_per_strand;
    geom_strands back = {0};
    awt_error error = {0};
    *greatest_m = *mean_m = INFINITY;
    CHECK_INT(geom_receive_frame(f->binding, f->frame.bytes, f->frame.size, &back, &error), AWT_OK);
    CHECK_TEXT(error.text, "");
    CHECK_INT(back.strand_count, f->info.strand_count);
    CHECK_INT(back.points_per_strand, f->info.points_per_strand);
    if (back.positions) {
        double greatest = 0, sum = 0;
        for (size_t i = 0; i < 3 * points; i += 3) {
            double square = 0;
            for (size_t k = i; k < i + 3; k++) {
                const double way = (double)back.positions[k] - (double)f->points[k];
                square += way * way;
            }
            greatest = fmax(greatest, sqrt(square));
            sum += sqrt(square);
        }
        *greatest_m = greatest;
        *mean_m = sum / (double)points;
    }
    geom_strands_fini(&back);
}
