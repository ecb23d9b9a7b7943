/* test_hanging.c: what hangs on a tree goes towards rest by the same bits, LANES sections at once or one by one. */
#include "check.h"
#include "fixture.h"

#include "base/lanes.h"
#include "base/rng.h"
#include "sim/embed.h"
#include "sim/hanging.h"

#include <string.h>

static quat turn_by_chance(rng *chance)
{
    float part[4];
    for (int k = 0; k < 4; k++) {
        part[k] = (float)rng_between(chance, -0.5, 0.5);
    }
    return quat_unit((quat){part[0], part[1], part[2], part[3]});
}

/* Section i of all that hangs on GC `top`, as embed.h says it, one after the other. */
static void section_relax(awt_forest *f, uint32_t top, uint32_t i, quat turn, float share)
{
    const awt_groom *groom = f->groom;
    const uint32_t sections = groom->info.sections;
    const mat3 turned = mat3_of_quat(turn);
    uint32_t lo = top, hi = top + 1;
    while (groom_descend(groom, &lo, &hi)) {
        for (uint32_t s = lo; s < hi; s++) {
            const uint32_t n = s * sections + i;
            vec3 rest = vec3_sub(groom->rest_position[n], groom->rest_position[groom->gc_super[s] * sections + i]);
            f->offset[n] = vec3_lerp(f->offset[n], mat3_apply(turned, rest), share);
        }
    }
    for (uint32_t s = lo; s < hi; s++) {
        const uint32_t n = (s - groom_finest_first(groom)) * sections + i;
        f->frame[n] = quat_blend(f->frame[n], quat_mul(turn, groom->rest_frame[n]), share);
    }
}

static void unsettle(awt_forest *f, rng *chance)
{
    const awt_groom *groom = f->groom;
    for (uint32_t n = 0; n < groom->gc_count * groom->info.sections; n++) {
        f->offset[n].x += (float)rng_between(chance, 0.0, 0.01);
        f->offset[n].z -= (float)rng_between(chance, 0.0, 0.01);
    }
    for (uint32_t n = 0; n < groom->info.finest_nodes; n++) {
        f->frame[n] = turn_by_chance(chance);
    }
}

static void check_style(const char *style, const quat *turn, rng *chance)
{
    const double zero[3] = {0, 0, 0};
    const awt_groom *groom = fixture_groom(style, 1000);
    awt_forest *side = fixture_forest(groom, style, zero, zero), *one = fixture_forest(groom, style, zero, zero);
    const uint32_t sections = side->groom->info.sections;
    const size_t nodes = (size_t)side->groom->gc_count * sections, finest = side->groom->info.finest_nodes;
    unsettle(side, chance);
    memcpy(one->offset, side->offset, nodes * sizeof *one->offset);
    memcpy(one->frame, side->frame, finest * sizeof *one->frame);
    for (uint32_t t = 0; t < side->groom->info.wisp_count[0]; t++) {
        const tree *tr = &side->trees[t];
        CHECK_INT(hanging_is_even(side, tr), sections >= LANES);
        if (sections < LANES) {
            continue;
        }
        CHECK(!hanging_relax(side, tr, turn, 0.125f));
        for (uint32_t i = 1; i < sections; i++) {
            section_relax(one, t, i, turn[i], 0.125f);
        }
    }
    CHECK(memcmp(one->offset, side->offset, nodes * sizeof *one->offset) == 0);
    CHECK(memcmp(one->frame, side->frame, finest * sizeof *one->frame) == 0);
    if (sections >= LANES) {
        hanging_relax(side, &side->trees[0], turn, 1.0f);
        CHECK(hanging_relax(side, &side->trees[0], turn, 0.125f));
    }
    awt_forest_destroy(side);
    awt_forest_destroy(one);
}

TEST(hanging_sections_side_by_side_get_the_bits_of_one_by_one)
{
    rng chance = rng_seed(3);
    quat turn[AWT_MAX_SECTIONS];
    for (uint32_t i = 0; i < AWT_MAX_SECTIONS; i++) {
        turn[i] = turn_by_chance(&chance);
    }
    for (size_t s = 0; s < awt_style_count(); s++) {
        check_style(awt_style_at(s)->name, turn, &chance);
    }
}
