/* groom_fixture.c: see groom_fixture.h. */
#include "groom_fixture.h"

#include <math.h>
#include <stdlib.h>
#include "base/assert.h"
#include "base/hash.h"
#include "base/rng.h"
#include "check.h"

/* ---- strands made by hand ---- */

awt_strands groom_fixture_strands(uint32_t strand_count, uint32_t points)
{
    awt_strands strands = {.strand_count = strand_count, .point_count = strand_count * points};
    strands.first_point = calloc((size_t)strand_count + 1, sizeof *strands.first_point);
    strands.positions = calloc((size_t)strand_count * points * 3, sizeof *strands.positions);
    ASSERT(strands.first_point && strands.positions);
    for (uint32_t s = 0; s <= strand_count; s++) {
        strands.first_point[s] = s * points;
    }
    return strands;
}

void groom_fixture_put(awt_strands *strands, uint32_t strand, uint32_t point, double x, double y, double z)
{
    float *p = strands->positions + 3 * (size_t)(strands->first_point[strand] + point);
    p[0] = (float)x, p[1] = (float)y, p[2] = (float)z;
}

/* A patch of curved strands of uneven length on top of the head. */
awt_strands groom_fixture_patch(uint32_t strand_count)
{
    awt_strands strands = groom_fixture_strands(strand_count, GROOM_FIXTURE_POINTS);
    rng r = rng_seed(5);
    for (uint32_t s = 0; s < strand_count; s++) {
        double x = rng_between(&r, -0.06, 0.06), z = rng_between(&r, -0.06, 0.06);
        double y = sqrt(AWT_HEAD_RADIUS_M * AWT_HEAD_RADIUS_M - x * x - z * z), length = rng_between(&r, 0.08, 0.12);
        for (uint32_t i = 0; i < GROOM_FIXTURE_POINTS; i++) {
            double t = length * i / (GROOM_FIXTURE_POINTS - 1);
            groom_fixture_put(&strands, s, i, x * (1.0 + 8.0 * t), y + 0.3 * t - 3.0 * t * t, z * (1.0 + 8.0 * t) - t);
        }
    }
    return strands;
}

awt_groom *groom_fixture_build(const awt_strands *strands, const awt_groom_def *def)
{
    awt_groom *groom = NULL;
    awt_error error;
    awt_status status = awt_groom_build(strands, def, NULL, NULL, &groom, &error);
    CHECK_TEXT(status == AWT_OK ? "built" : error.text, "built");
    return groom;
}

awt_groom *groom_fixture_build_patch(uint32_t strand_count, uint32_t levels, uint32_t top, uint32_t finest)
{
    awt_strands strands = groom_fixture_patch(strand_count);
    awt_groom_def def = awt_groom_def_default();
    def.levels = levels, def.top_wisps = top, def.finest_wisps = finest;
    awt_groom *groom = groom_fixture_build(&strands, &def);
    awt_strands_fini(&strands);
    return groom;
}

const groom_fixture_file groom_fixture_real[GROOM_FIXTURE_REAL] = {
    {"hair/sintel_16pt.v4.tfx", {.scale = 0}},
    {"hair/ratboy_mohawk.v4.tfx", {.scale = 0}},
    {"hair/yuksel_straight.hair", {.scale = 0}},
    {"hair/ponytail_tail.v3.tfx", {.scale = 0.01, .up = AWT_UP_Y, .head_radius = 10}},
    {"hair/ponytail_front_top.v3.tfx", {.scale = 0.01, .up = AWT_UP_Y, .head_radius = 10}},
};

awt_groom *groom_fixture_build_real(const groom_fixture_file *real, const char *path)
{
    size_t size = 0;
    unsigned char *bytes = check_read_file(path, &size);
    awt_strands strands = {0};
    awt_placement placement = real->placement;
    awt_groom_def def = awt_groom_def_default();
    awt_groom *groom = NULL;
    bool read = bytes && awt_strands_read(bytes, size, &strands, NULL) == AWT_OK &&
                awt_strands_place(&strands, &placement, NULL) == AWT_OK;
    CHECK(read);
    if (read) {
        def.head_radius_m = placement.head_radius_m;
        groom = groom_fixture_build(&strands, &def);
    }
    awt_strands_fini(&strands);
    free(bytes);
    return groom;
}

uint64_t groom_fixture_hash(const awt_groom *groom)
{
    const size_t points = (size_t)groom->info.strand_count * groom->info.points_per_strand;
    const size_t nodes = (size_t)groom->gc_count * groom->info.sections;
    uint64_t hash = hash_words(HASH_SEED, groom->gc_strand_count, groom->gc_count);
    hash = hash_words(hash, groom->gc_super, groom->gc_count);
    hash = hash_words(hash, groom->rest_position, 3 * nodes);
    hash = hash_words(hash, groom->rest_radius, nodes);
    hash = hash_words(hash, groom->rest_frame, 4 * (size_t)groom->info.finest_nodes);
    hash = hash_words(hash, groom->strand_offset, 3 * points);
    return hash_words(hash, &groom->mass_unit_kg, 1);
}

/* The strands as the groom evaluates them at rest. */
float *groom_fixture_rest(const awt_groom *groom)
{
    const size_t node = (size_t)groom_finest_first(groom) * groom->info.sections;
    float *points = calloc((size_t)groom->info.strand_count * groom->info.points_per_strand * 3, sizeof *points);
    float *scratch = calloc(awt_groom_strand_scratch(groom), sizeof *scratch);
    ASSERT(points && scratch);
    awt_groom_strands(groom, &groom->rest_position[node].x, &groom->rest_frame[0].x, scratch, points);
    free(scratch);
    return points;
}

/* ---- what holds of a groom ---- */

void groom_fixture_check_partition(const awt_groom *groom)
{
    const uint32_t levels = groom->info.levels;
    for (uint32_t level = 0; level < levels; level++) {
        uint32_t strands = 0;
        for (uint32_t g = groom->level_first[level]; g < groom->level_first[level + 1]; g++) {
            strands += groom->gc_strand_count[g];
            CHECK(groom->gc_strand_count[g] > 0);
            CHECK(groom->gc_tree[g] == groom->gc_tree[groom->gc_super[g]]);
            CHECK(g == groom->level_first[level] || groom->gc_tree[g] >= groom->gc_tree[g - 1]);
        }
        CHECK_INT(strands, groom->info.strand_count);
    }
    uint32_t next_sub = groom->level_first[1];
    for (uint32_t g = 0; g < groom_finest_first(groom); g++) {
        uint32_t strands = 0;
        CHECK_INT(groom->gc_sub_first[g], next_sub);
        CHECK(groom->gc_sub_count[g] > 0);
        for (uint32_t k = 0; k < groom->gc_sub_count[g]; k++, next_sub++) {
            CHECK_INT(groom->gc_super[next_sub], g);
            strands += groom->gc_strand_count[next_sub];
        }
        CHECK_INT(strands, groom->gc_strand_count[g]);
    }
    CHECK_INT(next_sub, levels > 1 ? groom->gc_count : groom->level_first[1]);
    for (uint32_t w = 0; w < groom->info.wisp_count[levels - 1]; w++) {
        CHECK_INT(groom->gc_strand_first[w + 1] - groom->gc_strand_first[w],
                  groom->gc_strand_count[groom_finest_first(groom) + w]);
    }
    CHECK_INT(groom->gc_strand_first[0], 0);
}

void groom_fixture_check_sound(const awt_groom *groom)
{
    const size_t nodes = (size_t)groom->gc_count * groom->info.sections;
    for (size_t node = 0; node < nodes; node++) {
        CHECK(vec3_finite(groom->rest_position[node]));
        CHECK(groom->rest_radius[node] >= 0.0005f && groom->rest_radius[node] < 10.0f);
    }
    for (size_t i = 0; i < groom->info.finest_nodes; i++) {
        quat q = groom->rest_frame[i];
        CHECK_NEAR(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w, 1.0, 1e-5);
    }
    for (size_t i = 0; i < 3 * (size_t)groom->info.strand_count * groom->info.points_per_strand; i++) {
        CHECK(isfinite(groom->strand_offset[i]));
    }
    groom_fixture_check_partition(groom);
}

/* Every input strand comes back once, point by point. */
void groom_fixture_check_strands(const awt_strands *strands, const awt_groom *groom, double tolerance_m)
{
    const uint32_t points = groom->info.points_per_strand;
    float *rest = groom_fixture_rest(groom);
    bool *found = calloc(strands->strand_count, sizeof *found);
    ASSERT(found);
    double worst = 0.0;
    for (uint32_t k = 0; k < groom->info.strand_count; k++) {
        double best = 1e30;
        uint32_t match = 0;
        for (uint32_t s = 0; s < strands->strand_count; s++) {
            double off = 0.0;
            for (uint32_t i = 0; i < points * 3 && off < best; i++) {
                double d = fabs((double)rest[(size_t)k * points * 3 + i] -
                                (double)strands->positions[(size_t)s * points * 3 + i]);
                off = d > off ? d : off;
            }
            if (off < best) {
                best = off;
                match = s;
            }
        }
        CHECK(!found[match]);
        found[match] = true;
        worst = best > worst ? best : worst;
    }
    CHECK_NEAR(worst, 0.0, tolerance_m);
    free(found);
    free(rest);
}
