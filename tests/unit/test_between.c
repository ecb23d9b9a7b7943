/* test_between.c: frames whose time lies between two steps, and time that is passed over without one. */
#include "between.h"
#include "check.h"
#include "drawing.h"
#include "fixture.h"
#include "geom/read.h"

#include <math.h>

static const double zero[3] = {0, 0, 0};

enum { SWAY_US = 790000 };

/* The head shakes: at SWAY_US it turns fastest. */
static awt_motion shake(int64_t time_us)
{
    const double half_angle = 0.25 * sin((double)time_us * 8e-6);
    awt_motion m = {.time_us = time_us, .head.orientation = {0, sin(half_angle), 0, cos(half_angle)}};
    m.body.orientation[3] = 1;
    return m;
}

static void step(awt_forest *f, int64_t time_us)
{
    const awt_motion m = shake(time_us);
    CHECK_INT(awt_forest_move(f, &m, NULL), AWT_OK);
    CHECK_INT(awt_forest_advance(f, time_us, NULL, NULL), AWT_OK);
}

/* The centre lines of the forest as the drawing shows it. */
static void show(drawing *d, const awt_forest *f, uint64_t sequence, int64_t time_us, geom_strands *out)
{
    wishes wanted = {0};
    awt_error error = {0};
    picture *p = picture_create();
    wishes_add(&wanted, (view_name){.form = form_find(GEOM_STRANDS, 0, 0)});
    drawing_show(d, f, time_us);
    CHECK_INT(drawing_draw(d, f, sequence, &wanted, p, &error), AWT_OK);
    const view *v = picture_view(p, wanted.names[0]);
    CHECK_INT(geom_read_frame(v->glb.bytes, v->glb.size, out, &error), AWT_OK);
    CHECK_TEXT(error.text, "");
    CHECK_INT(out->time_us, time_us);
    picture_release(p);
}

TEST(between_steps_the_hair_is_between)
{
    awt_forest *f = fixture_forest(fixture_groom("short", 200), "short", zero, zero);
    drawing *d = NULL;
    geom_strands from = {0}, to = {0}, quarter = {0};
    CHECK_INT(drawing_create(awt_forest_groom(f), NULL, &d, NULL), AWT_OK);
    for (int64_t t = AWT_STEP_US; t <= SWAY_US; t += AWT_STEP_US) {
        step(f, t);
    }
    show(d, f, 1, SWAY_US, &from);
    drawing_hold(d, f);
    step(f, SWAY_US + AWT_STEP_US);
    CHECK_INT(drawing_show(d, f, SWAY_US + AWT_STEP_US), SWAY_US + AWT_STEP_US);
    show(d, f, 2, SWAY_US + AWT_STEP_US / 4, &quarter);
    show(d, f, 3, SWAY_US + AWT_STEP_US, &to);
    double moved = 0, error = 0;
    for (size_t i = 0; i < (size_t)to.strand_count * to.points_per_strand * 3; i++) {
        const double expected = from.positions[i] + 0.25 * (to.positions[i] - from.positions[i]);
        moved = fmax(moved, fabs((double)(to.positions[i] - from.positions[i])));
        error = fmax(error, fabs((double)quarter.positions[i] - expected));
    }
    CHECK(moved > 1e-3);
    CHECK(error < 0.1 * moved);
    CHECK(fabs(quarter.head.orientation[1] - (0.75 * from.head.orientation[1] + 0.25 * to.head.orientation[1])) < 1e-4);
    CHECK(fabs(from.head.orientation[1] - to.head.orientation[1]) > 1e-3);
    geom_strands_fini(&from);
    geom_strands_fini(&to);
    geom_strands_fini(&quarter);
    drawing_destroy(d);
    awt_forest_destroy(f);
}

TEST(between_two_steps_alone)
{
    awt_forest *f = fixture_forest(fixture_groom("short", 200), "short", zero, zero);
    drawing *d = NULL;
    CHECK_INT(drawing_create(awt_forest_groom(f), NULL, &d, NULL), AWT_OK);
    CHECK_INT(drawing_show(d, f, 5000), 0); /* nothing was held */
    drawing_hold(d, f);
    CHECK_INT(awt_forest_advance(f, 10000, NULL, NULL), AWT_OK);
    CHECK_INT(drawing_show(d, f, 5000), 5000);
    CHECK_INT(drawing_show(d, f, -1), 10000);
    CHECK_INT(awt_forest_advance(f, 20000, NULL, NULL), AWT_OK);
    CHECK_INT(drawing_show(d, f, 15000), 20000); /* what was held is two steps back */
    drawing_destroy(d);
    awt_forest_destroy(f);
}

TEST(between_keeps_what_is_alike_to_the_bit)
{
    const float unit[4] = {0.1f, 0.2f, 0.3f, 0.92736185f}, other[4] = {-0.1f, -0.2f, -0.3f, -0.92736185f};
    float out[4];
    between_mix(unit, unit, 0.3, 4, 1, out);
    CHECK_BYTES(out, unit, sizeof out);
    between_mix(unit, other, 0.5, 4, 1, out); /* the same turn, by the shorter way */
    for (int k = 0; k < 4; k++) {
        CHECK_NEAR(out[k], unit[k], 1e-6);
    }
}

TEST(skipped_time_carries_the_hair_rigidly_with_the_head)
{
    awt_forest *f = fixture_forest(fixture_groom("short", 200), "short", zero, zero);
    enum { NODES = 4096 };
    static awt_node before[NODES], after[NODES];
    const int64_t skipped_us = SWAY_US + 130000;
    for (int64_t t = AWT_STEP_US; t <= SWAY_US; t += AWT_STEP_US) {
        step(f, t);
    }
    const uint32_t count = awt_forest_nodes(f, before);
    const uint64_t sub_steps = awt_forest_sub_steps(f);
    const awt_motion there = shake(skipped_us);
    CHECK(count > 0 && count <= NODES);
    CHECK_INT(awt_forest_move(f, &there, NULL), AWT_OK);
    CHECK_INT(awt_forest_skip(f, SWAY_US - 1, NULL), AWT_BAD_TIME);
    CHECK_INT(awt_forest_skip(f, skipped_us, NULL), AWT_OK);
    CHECK_INT(awt_forest_time(f), skipped_us);
    CHECK_U64(awt_forest_sub_steps(f), sub_steps);
    CHECK_NEAR(awt_forest_head(f).orientation[1], there.head.orientation[1], 1e-12);
    CHECK_INT(awt_forest_nodes(f, after), count);
    for (uint32_t i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++) {
            CHECK_NEAR(after[i].position[k], before[i].position[k], 1e-5);
        }
    }
    awt_step_stats stats;
    CHECK_INT(awt_forest_advance(f, skipped_us + AWT_STEP_US, &stats, NULL), AWT_OK);
    CHECK_INT(stats.clamped_speeds, 0); /* no kick */
    awt_forest_destroy(f);
}
