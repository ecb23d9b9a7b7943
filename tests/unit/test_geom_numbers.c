/* test_geom_numbers.c: frames in whole numbers, and what they share with the frames they were made from. */
#include "check.h"

#include "base/assert.h"
#include "base/crc32c.h"
#include "base/rng.h"
#include "geom/delta_checksum.h"
#include "geom/quantised.h"
#include "unit/delta_fixture.h"

#include <stdlib.h>
#include <string.h>

/* All numbers of a frame in a row, heap. */
static uint16_t *all_numbers(const delta_fixture *f, const geom_quantised *from)
{
    const size_t a_strand = 3 * (size_t)f->hair.groom.info.points_per_strand;
    uint16_t *all = malloc(from->count * sizeof *all);
    ASSERT(all);
    for (uint32_t i = 0; i < from->patch_count; i++) {
        const geom_patch patch = geom_layout_patch(f->hair.layout, i);
        memcpy(all + patch.first_strand * a_strand, quantised_patch(from, i), patch.strands * a_strand * sizeof *all);
    }
    return all;
}

TEST(geom_numbers_kept_from_the_frame_before_are_those_made_anew)
{
    delta_fixture f;
    bool still[20];
    delta_fixture_init(&f, 18000, 8, 18, 12);
    for (uint32_t i = 0; i < geom_layout_patches(f.hair.layout); i++) {
        still[i] = i % 2 == 0;
    }
    delta_fixture_move(&f, 0.001f, still);
    geom_quantised *anew = NULL, *kept = NULL;
    CHECK_INT(geom_quantised_create(f.hair.layout, &anew, NULL), AWT_OK);
    CHECK_INT(geom_quantised_create(f.hair.layout, &kept, NULL), AWT_OK);
    uint32_t clamped = 0;
    const geom_quantise_def all = {.points = f.hair.points};
    const geom_quantise_def some = {.points = f.hair.points, .unchanged = still, .previous = f.base};
    CHECK_INT(geom_quantise(f.hair.layout, &all, anew, &clamped, NULL), AWT_OK);
    CHECK_INT(geom_quantise(f.hair.layout, &some, kept, &clamped, NULL), AWT_OK);
    uint16_t *numbers = all_numbers(&f, anew), *of_kept = all_numbers(&f, kept);
    CHECK_U64(geom_quantised_checksum(kept), geom_quantised_checksum(anew));
    CHECK(memcmp(of_kept, numbers, anew->count * sizeof *numbers) == 0);
    uint32_t checksum = delta_checksum_numbers(numbers, anew->count);
    CHECK_U64(checksum, crc32c(numbers, anew->count * 2)); /* on a host whose low byte is the first */
    CHECK_U64(geom_quantised_checksum(anew), delta_checksum(checksum, &f.hair.layout->box, 0));
    CHECK_INT(geom_quantise(f.hair.layout, &some, f.base, &clamped, NULL), AWT_OK); /* in place */
    CHECK_U64(geom_quantised_checksum(f.base), geom_quantised_checksum(anew));
    free(numbers);
    free(of_kept);
    geom_quantised_destroy(anew);
    geom_quantised_destroy(kept);
    delta_fixture_fini(&f);
}

/* A ring as the daemon keeps it: each frame shares what did not move with the one before, and is written over later.
 * Whatever is shared and written, each frame has the numbers of its own points. */
TEST(geom_frames_that_share_numbers_do_not_write_into_each_other)
{
    enum { RING = 4, FRAMES = 60 };
    delta_fixture f;
    geom_quantised *ring[RING] = {NULL}, *anew = NULL;
    uint32_t checksums[RING] = {0}, clamped = 0, shared = 0;
    bool still[20];
    rng random = rng_seed(77);
    delta_fixture_init(&f, 18000, 8, 18, 12);
    const uint32_t patches = geom_layout_patches(f.hair.layout);
    CHECK_INT(geom_quantised_create(f.hair.layout, &anew, NULL), AWT_OK);
    for (uint32_t n = 0; n < FRAMES; n++) {
        for (uint32_t i = 0; i < patches; i++) {
            still[i] = n % 7 == 6 || rng_u32(&random) % 3 > 0;
        }
        delta_fixture_move(&f, 0.0005f, still);
        geom_quantised **now = &ring[n % RING], *before = ring[(n + RING - 1) % RING];
        if (n % 13 == 12) { /* a frame that others share with goes, and comes again */
            geom_quantised_destroy(*now);
            *now = NULL;
        }
        if (!*now) {
            CHECK_INT(geom_quantised_create(f.hair.layout, now, NULL), AWT_OK);
        }
        const geom_quantise_def all = {.points = f.hair.points};
        const geom_quantise_def some = {
            .points = f.hair.points, .unchanged = before ? still : NULL, .previous = before};
        CHECK_INT(geom_quantise(f.hair.layout, &all, anew, &clamped, NULL), AWT_OK);
        CHECK_INT(geom_quantise(f.hair.layout, &some, *now, &clamped, NULL), AWT_OK);
        checksums[n % RING] = geom_quantised_checksum(anew);
        for (uint32_t k = 0; k < RING && ring[k]; k++) {
            uint16_t *numbers = all_numbers(&f, ring[k]);
            CHECK_U64(geom_quantised_checksum(ring[k]), checksums[k]);
            CHECK_U64(delta_checksum(delta_checksum_numbers(numbers, anew->count), &f.hair.layout->box, 0),
                      checksums[k]);
            free(numbers);
        }
        for (uint32_t i = 0; i < patches && before; i++) {
            shared += quantised_patch(before, i) == quantised_patch(*now, i);
        }
    }
    CHECK(shared > FRAMES);
    for (uint32_t k = 0; k < RING; k++) {
        geom_quantised_destroy(ring[k]);
    }
    geom_quantised_destroy(anew);
    delta_fixture_fini(&f);
}
