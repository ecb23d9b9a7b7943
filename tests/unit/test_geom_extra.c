/* test_geom_extra.c: attributes beside the position: that they are those of the strands, in every decoder's eyes, and
 * that frames are what they were without them. */
#include "check.h"

#include "geom/draco_shim.h"
#include "geom/extras.h"
#include "geom/glb.h"
#include "geom/read.h"
#include "unit/fixture.h"
#include "unit/geom_fixture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A style's hair at rest. */
typedef struct rest_hair {
    const awt_groom *groom;
    geom_layout *layout;
    geom_scratch *scratch;
    float *points; /* of the layout's level */
    geom_buffer frame;
} rest_hair;

static void rest_hair_of(rest_hair *h, const awt_groom *groom, const geom_layout_def *def)
{
    *h = (rest_hair){.groom = groom};
    const size_t first = (size_t)groom_finest_first(h->groom) * h->groom->info.sections;
    float *scratch = malloc(awt_groom_strand_scratch(h->groom) * sizeof *scratch);
    awt_error error = {0};
    CHECK_INT(geom_layout_create(h->groom, def, &h->layout, &error), AWT_OK);
    CHECK_TEXT(error.text, "");
    CHECK_INT(geom_scratch_create(h->layout, &h->scratch, NULL), AWT_OK);
    h->points = calloc((size_t)geom_layout_strands(h->layout) * h->layout->points_per_strand, 3 * sizeof(float));
    CHECK(scratch && h->points);
    geom_layout_evaluate(h->layout, h->groom, NULL, &h->groom->rest_position[first].x, &h->groom->rest_frame[0].x,
                         scratch, h->points);
    const geom_frame_def frame = {.points = h->points, .head = geom_fixture_head};
    CHECK_INT(geom_encode(h->layout, h->scratch, &frame, &h->frame, NULL, &error), AWT_OK);
    CHECK_TEXT(error.text, "");
    free(scratch);
}

static void rest_hair_init(rest_hair *h, const geom_layout_def *def)
{
    rest_hair_of(h, fixture_groom("long", 2000), def);
}

static void rest_hair_fini(rest_hair *h)
{
    geom_buffer_fini(&h->frame);
    geom_scratch_destroy(h->scratch);
    geom_layout_destroy(h->layout);
    free(h->points);
}

/* The same positions with attributes as without, every kind and every choice of them. */
TEST(geom_attributes_change_no_position)
{
    for (int n = 0; n < 2 * (GEOM_ATTRIBUTES_ALL + 1); n++) {
        const geom_kind kind = n & 1 ? GEOM_STRANDS : GEOM_RIBBON;
        rest_hair plain, asked;
        geom_strands without = {0}, with = {0};
        awt_error error = {0};
        rest_hair_init(&plain, &(geom_layout_def){.kind = kind, .level = GEOM_LEVEL_FIFTH});
        rest_hair_init(&asked,
                       &(geom_layout_def){.kind = kind, .level = GEOM_LEVEL_FIFTH, .attributes = (uint32_t)n / 2});
        CHECK_INT(geom_read_frame(plain.frame.bytes, plain.frame.size, &without, NULL), AWT_OK);
        CHECK_INT(geom_read_frame(asked.frame.bytes, asked.frame.size, &with, &error), AWT_OK);
        CHECK_TEXT(error.text, "");
        CHECK_INT(without.attributes, 0);
        CHECK_INT(with.attributes, n / 2);
        const size_t size = (size_t)without.strand_count * without.points_per_strand * 3 * sizeof(float);
        CHECK(with.positions && without.positions && memcmp(with.positions, without.positions, size) == 0);
        geom_strands_fini(&without);
        geom_strands_fini(&with);
        rest_hair_fini(&plain);
        rest_hair_fini(&asked);
    }
}

/* The poles, the sides, and equal areas: half of the head lies within 1/2 sqrt(1/2) of the crown. */
TEST(geom_root_places_are_lamberts_projection)
{
    const float r = 0.1f, ring = 0.35355339f;
    const float roots[][5] = {{0, r, 0, 0.5f, 0.5f},
                              {r, 0, 0, 0.5f + ring, 0.5f},
                              {-r, 0, 0, 0.5f - ring, 0.5f},
                              {0, 0, r, 0.5f, 0.5f + ring},
                              {0, 0, 0, 0.5f, 0.5f}};
    for (size_t i = 0; i < sizeof roots / sizeof roots[0]; i++) {
        float uv[2];
        extras_root_uv(roots[i], uv);
        CHECK_NEAR(uv[0], roots[i][3], 1e-6);
        CHECK_NEAR(uv[1], roots[i][4], 1e-6);
    }
    const float under[3] = {1e-6f, -r, 0};
    float uv[2];
    extras_root_uv(under, uv);
    CHECK_NEAR(uv[0], 1, 1e-6);
}

TEST(geom_attributes_are_refused_where_there_are_none)
{
    geom_fixture f;
    geom_layout *layout = NULL;
    geom_fixture_init(&f, 30, 4, 2);
    const geom_layout_def stock = {.attributes = GEOM_ATTRIBUTE_WIDTH, .stock = true};
    const geom_layout_def guides = {.attributes = GEOM_ATTRIBUTE_WIDTH, .kind = GEOM_GUIDES};
    const geom_layout_def unknown = {.attributes = GEOM_ATTRIBUTES_ALL + 1};
    const geom_layout_def colour = {.colour = {0.5f, NAN, 0}};
    CHECK_INT(geom_layout_create(&f.groom, &stock, &layout, NULL), AWT_BAD_VALUE);
    CHECK_INT(geom_layout_create(&f.groom, &guides, &layout, NULL), AWT_BAD_VALUE);
    CHECK_INT(geom_layout_create(&f.groom, &unknown, &layout, NULL), AWT_BAD_VALUE);
    CHECK_INT(geom_layout_create(&f.groom, &colour, &layout, NULL), AWT_BAD_VALUE);
    CHECK(layout == NULL);
    geom_fixture_fini(&f);
}

/* Beside the frame, for every vertex: strand within the patch, u, v, width, before quantisation. */
static void write_values(const rest_hair *h, const char *folder, const char *name)
{
    const uint32_t a_point = h->layout->kind == GEOM_RIBBON ? 2 : 1, per_strand = h->layout->points_per_strand;
    const size_t vertices = (size_t)geom_layout_strands(h->layout) * per_strand * a_point;
    float *values = malloc(4 * vertices * sizeof *values), *at = values;
    CHECK(values != NULL);
    for (uint32_t p = 0; p < geom_layout_patches(h->layout); p++) {
        const geom_patch patch = geom_layout_patch(h->layout, p);
        for (uint32_t s = 0; s < patch.strands; s++) {
            for (uint32_t v = 0; v < per_strand * a_point; v++, at += 4) {
                at[0] = (float)s;
                extras_root_uv(h->points + 3 * (size_t)(patch.first_strand + s) * per_strand, at + 1);
                at[3] = 2 * h->layout->half_width[v / a_point];
            }
        }
    }
    check_write_file(folder, name, ".extra.f32", values, 4 * vertices * sizeof *values);
    free(values);
}

/* Grown hair of that colour, built, and come back from a snapshot. */
static awt_forest *coloured_forest(const float *colour, awt_groom **groom)
{
    awt_strands strands = {0};
    awt_groom *grown = NULL;
    awt_forest *made = NULL, *back = NULL;
    size_t size = 0;
    CHECK_INT(awt_style_grow(awt_style_find("short"), 300, 1, &strands, NULL), AWT_OK);
    memcpy(strands.colour, colour, sizeof strands.colour);
    const awt_groom_def def = awt_groom_def_default();
    CHECK_INT(awt_groom_build(&strands, &def, NULL, NULL, &grown, NULL), AWT_OK);
    const awt_forest_def start = awt_forest_def_default(grown);
    CHECK_INT(awt_forest_create(grown, &start, &made, NULL), AWT_OK);
    CHECK_INT(awt_forest_snapshot(made, NULL, 0, &size, NULL), AWT_OK);
    unsigned char *bytes = malloc(size);
    CHECK(bytes && awt_forest_snapshot(made, bytes, size, &size, NULL) == AWT_OK);
    CHECK_INT(awt_snapshot_restore(bytes, size, groom, &back, NULL), AWT_OK);
    free(bytes);
    awt_forest_destroy(made);
    awt_groom_destroy(grown);
    awt_strands_fini(&strands);
    return back;
}

/* Does the frame's first chunk, which is text, have that in it? */
static bool frame_says(const geom_buffer *frame, const char *text)
{
    const size_t length = strlen(text);
    for (size_t i = 0; i + length <= frame->size; i++) {
        if (memcmp(frame->bytes + i, text, length) == 0) {
            return true;
        }
    }
    return false;
}

TEST(geom_material_has_the_colour_of_the_strands)
{
    static const struct {
        float colour[3];
        const char *text;
    } cases[] = {{{0.5f, 0.25f, 0.125f}, "\"baseColorFactor\":[0.5,0.25,0.125,1.0]"},
                 {{0, 0, 0}, "\"baseColorFactor\":[0.1299"}};
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        awt_groom *groom = NULL;
        awt_forest *forest = coloured_forest(cases[k].colour, &groom);
        rest_hair h;
        rest_hair_of(&h, groom, &(geom_layout_def){.kind = GEOM_STRANDS});
        CHECK(frame_says(&h.frame, cases[k].text));
        rest_hair_fini(&h);
        awt_forest_destroy(forest);
        awt_groom_destroy(groom);
    }
}

TEST(geom_attributes_for_other_readers)
{
    const char *folder = getenv("AWT_FRAMES");
    if (!folder) {
        check_skip("AWT_FRAMES names no folder to write frames to, for tests/node/check_others.mjs");
        return;
    }
    for (int n = 0; n < 4; n++) {
        const geom_kind kind = n & 1 ? GEOM_STRANDS : GEOM_RIBBON;
        char name[64];
        rest_hair h;
        rest_hair_init(&h, &(geom_layout_def){.kind = kind,
                                              .level = n < 2 ? GEOM_LEVEL_FULL : GEOM_LEVEL_GUIDES,
                                              .attributes = GEOM_ATTRIBUTES_ALL,
                                              .colour = {0.4f, 0.3f, 0.1f}});
        snprintf(name, sizeof name, "attributes-%d.glb", n);
        check_write_file(folder, name, "", h.frame.bytes, h.frame.size);
        write_values(&h, folder, name);
        rest_hair_fini(&h);
    }
}
