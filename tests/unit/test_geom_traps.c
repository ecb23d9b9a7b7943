/* test_geom_traps.c: where others' encoders and decoders fail, and what keeps awtd out of it. Each trap has a test of
 * its name, here or elsewhere:
 *
 *   triangles beyond a third of the bytes     geom_hair_that_compresses_too_well_for_decoders_is_padded_for_them
 *   more points than three a triangle         geom_no_mesh_has_more_than_three_points_a_triangle
 *   NaN, infinity, 1e30                       geom_points_and_poses_that_are_not_finite_are_refused
 *   positions outside the box                 geom_points_outside_the_box_are_set_onto_it_and_counted
 *   no points at all                          geom_hair_of_no_strands_is_refused
 *   ribbons a quantisation step wide          geom_fewer_strands_are_wider_and_none_is_under_four_steps
 *   indices of more than 16 bits              geom_indices_stay_under_65536
 *   bounds of what went in, not came out      geom_min_and_max_are_those_of_the_decoded_positions_exactly
 *   a box that follows the frame              geom_hair_that_rests_decodes_to_the_same_bits_while_other_hair_moves
 *   a box that passes through text            geom_the_quantisation_box_passes_through_draco_unchanged
 *   the tagged coder on small patches         geom_small_patches_hold_the_same_integers_in_either_coding */
#include "check.h"

#include "geom/glb.h"
#include "geom/layout.h"
#include "unit/geom_fixture.h"

#include <string.h>

static const uint32_t per_strands[] = {2, 3, 4, 5, 16, 17, 32, 100, 255, 256};
enum { PER_STRANDS = sizeof per_strands / sizeof per_strands[0], LINE_KINDS = 2 };

TEST(geom_no_mesh_has_more_than_three_points_a_triangle)
{
    for (size_t i = 0; i < PER_STRANDS; i++) {
        geom_fixture f;
        geom_fixture_init(&f, 70, per_strands[i], 3);
        for (int kind = 0; kind < LINE_KINDS; kind++) {
            geom_fixture_layout(&f, &(geom_layout_def){.kind = (geom_kind)kind});
            for (uint32_t p = 0; p < f.layout->patch_count; p++) {
                CHECK(f.layout->meshes[p].vertices <= 3 * f.layout->meshes[p].triangles);
            }
        }
        geom_fixture_fini(&f);
    }
}

TEST(geom_hair_of_no_strands_is_refused)
{
    geom_fixture f;
    geom_layout *layout = NULL;
    geom_fixture_init(&f, 3, 4, 1);
    for (int kind = 0; kind < LINE_KINDS; kind++) {
        for (int level = GEOM_LEVEL_FULL; level <= GEOM_LEVEL_GUIDES; level++) {
            const geom_layout_def def = {.kind = (geom_kind)kind, .level = (geom_level)level};
            f.groom.info.strand_count = 0;
            CHECK_INT(geom_layout_create(&f.groom, &def, &layout, NULL), AWT_LIMIT);
            f.groom.info.strand_count = 3;
            f.groom.info.points_per_strand = 0;
            CHECK_INT(geom_layout_create(&f.groom, &def, &layout, NULL), AWT_LIMIT);
            f.groom.info.points_per_strand = 4;
        }
    }
    CHECK(layout == NULL);
    geom_fixture_fini(&f);
}

/* However the hair divides into trees; 65535 itself restarts a primitive. */
TEST(geom_indices_stay_under_65536)
{
    for (size_t i = 0; i < PER_STRANDS; i++) {
        geom_fixture f;
        geom_fixture_init(&f, 40000 / per_strands[i] + 1, per_strands[i], 1);
        for (int kind = 0; kind < LINE_KINDS; kind++) {
            geom_fixture_layout(&f, &(geom_layout_def){.kind = (geom_kind)kind});
            for (uint32_t p = 0; p < f.layout->patch_count; p++) {
                const draco_mesh *mesh = &f.layout->meshes[p];
                uint32_t greatest = 0;
                for (size_t k = 0; k < 3 * (size_t)mesh->triangles; k++) {
                    greatest = f.layout->indices[k] > greatest ? f.layout->indices[k] : greatest;
                }
                CHECK_INT(greatest, mesh->vertices - 1);
                CHECK(mesh->vertices <= GEOM_MAX_PATCH_VERTICES);
            }
        }
        geom_fixture_fini(&f);
    }
}

/* The coding of the positions of a frame's first patch: 0 tagged, 1 raw; -1: not found. */
static int coding_of(const geom_buffer *frame)
{
    enum { NO_PREDICTION = 0xfe };
    glb_frame glb;
    int coding = -1;
    if (glb_read(frame->bytes, frame->size, &glb, NULL) != AWT_OK) {
        return coding;
    }
    const unsigned char *at = glb.binary + glb.patches[0].offset;
    for (size_t i = 0; i + 12 < glb.patches[0].size && coding < 0; i++) {
        if (memcmp(at + i, DRACO_POSITION, sizeof DRACO_POSITION) == 0) {
            const unsigned char *next = at + i + sizeof DRACO_POSITION;
            next += *next == NO_PREDICTION ? 1 : 2; /* and its transform */
            coding = next[0] == 1 ? next[1] : -1;   /* compressed, and how */
        }
    }
    glb_frame_fini(&glb);
    return coding;
}

/* libdraco chooses between its two codings by size, we by kind: where they differ, positions do not. */
TEST(geom_small_patches_hold_the_same_integers_in_either_coding)
{
    int others = 0;
    for (uint32_t strands = 1; strands <= 24; strands++) {
        for (int kind = 0; kind < LINE_KINDS; kind++) {
            geom_fixture f;
            geom_strands own = {0}, stock = {0};
            geom_fixture_init(&f, strands, 7, 1);
            geom_fixture_layout(&f, &(geom_layout_def){.kind = (geom_kind)kind});
            geom_fixture_encode(&f, NULL);
            const int ours = coding_of(&f.frame);
            CHECK_INT(ours, kind == GEOM_RIBBON ? 0 : 1);
            CHECK_INT(geom_read_frame(f.frame.bytes, f.frame.size, &own, NULL), AWT_OK);
            geom_fixture_layout(&f, &(geom_layout_def){.kind = (geom_kind)kind, .stock = true});
            geom_fixture_encode(&f, NULL);
            const int theirs = coding_of(&f.frame);
            CHECK(theirs >= 0);
            others += theirs != ours;
            CHECK_INT(geom_read_frame(f.frame.bytes, f.frame.size, &stock, NULL), AWT_OK);
            if (own.positions && stock.positions) {
                CHECK(memcmp(own.positions, stock.positions, (size_t)strands * 21 * sizeof(float)) == 0);
            }
            geom_strands_fini(&own);
            geom_strands_fini(&stock);
            geom_fixture_fini(&f);
        }
    }
    CHECK(others > 0);
}
