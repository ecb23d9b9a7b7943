/* test_geom_guides_delta.c: guides as numbers, whole and against a base: the sections that come out are those that the
 * writer made the numbers of. */
#include "check.h"

#include "base/rng.h"
#include "geom/delta.h"
#include "geom/delta_format.h"
#include "geom/delta_glb.h"
#include "geom/guides.h"
#include "geom/quantised.h"
#include "unit/fixture.h"
#include "unit/guides_fixture.h"

#include <stdlib.h>
#include <string.h>

static awt_status read_numbers(guides_fixture *f, const geom_guides *base, uint64_t sequence, geom_guides *out)
{
    awt_error error = {0};
    awt_status status =
        geom_read_guides_delta(f->reader, f->binding, f->frame.bytes, f->frame.size, base, sequence, out, &error);
    CHECK((status == AWT_OK) == (error.text[0] == '\0'));
    return status;
}

/* The sections of the fixture's hair as its numbers have them, patch by patch. */
static void check_rebuilt(guides_fixture *f, const geom_guides *got)
{
    const uint32_t sections = f->binding->sections;
    int16_t *turns = calloc(f->info.finest_nodes, 3 * sizeof *turns);
    uint16_t *numbers = calloc(f->info.finest_nodes, GUIDES_COMPONENTS * sizeof *numbers);
    vec3 *centres = calloc(f->info.finest_nodes, sizeof *centres);
    quat *frames = calloc(f->info.finest_nodes, sizeof *frames);
    for (uint32_t i = 0; i < geom_layout_patches(f->layout); i++) {
        const geom_patch patch = geom_layout_patch(f->layout, i);
        const guides_part part = {patch.first_strand, patch.strands};
        const size_t first = (size_t)part.first_wisp * sections, count = (size_t)part.wisps * sections;
        CHECK(guides_turns(f->binding, part, (const quat *)(const void *)f->frames + first, turns + 3 * first));
        guides_bind(f->binding, part, (const vec3 *)(const void *)f->centres + first, turns + 3 * first,
                    numbers + GUIDES_COMPONENTS * first, centres + first);
        guides_frames(f->binding, part, turns + 3 * first, frames + first);
        for (uint32_t w = 0; w < part.wisps;) { /* a patch is whole trees, or a piece of one */
            w += guides_together(f->binding, part.first_wisp + w);
            CHECK(w <= part.wisps);
        }
        CHECK(count > 0);
        CHECK(memcmp(numbers + GUIDES_COMPONENTS * first, quantised_patch(f->now, i),
                     count * GUIDES_COMPONENTS * sizeof *numbers) == 0);
    }
    const size_t all = f->info.finest_nodes;
    CHECK(memcmp(numbers, got->numbers, all * GUIDES_COMPONENTS * sizeof *numbers) == 0);
    CHECK(memcmp(centres, got->centres, all * sizeof *centres) == 0);
    CHECK(memcmp(frames, got->frames, all * sizeof *frames) == 0);
    free(turns);
    free(numbers);
    free(centres);
    free(frames);
}

/* Whole and against the frame before, in motion and at rest. */
static void check_chain(const char *style, uint32_t strands, const char *clip)
{
    guides_fixture f;
    guides_fixture_init(&f, fixture_groom(style, strands), style);
    for (int n = 0; n < 8; n++) {
        size_t sizes[GUIDES_FORMS];
        guides_fixture_move(&f, clip, INT64_C(1200000) + n * INT64_C(16667) + (n / 4) * INT64_C(400000));
        for (int form = GUIDES_WHOLE; form < GUIDES_FORMS; form++) {
            guides_fixture_encode(&f, form, NULL);
            sizes[form] = f.frame.size;
            CHECK_INT(read_numbers(&f, form == GUIDES_DELTA ? &f.base_got : NULL, f.base_sequence, &f.got), AWT_OK);
            CHECK(f.got.time_us == awt_forest_time(f.forest));
            CHECK_INT(f.got.patch_count, geom_layout_patches(f.layout));
            check_rebuilt(&f, &f.got);
        }
        CHECK(sizes[GUIDES_DELTA] < sizes[GUIDES_WHOLE] + sizes[GUIDES_WHOLE] / 16); /* the count of bits is rough */
        guides_fixture_keep(&f);
    }
    guides_fixture_encode(&f, GUIDES_DELTA, NULL); /* nothing moved */
    CHECK(f.frame.size < 800);
    CHECK_INT(read_numbers(&f, &f.base_got, f.base_sequence, &f.got), AWT_OK);
    check_rebuilt(&f, &f.got);
    guides_fixture_fini(&f);
}

TEST(geom_guides_as_numbers_are_those_that_the_writer_made)
{
    check_chain("long", 2000, "lean");
    check_chain("short-curly", 2000, "shake");
    check_chain("long-curly", 10000, "lean"); /* more than one patch */
}

TEST(geom_guides_of_another_base_are_refused)
{
    guides_fixture f;
    geom_guides out = {0};
    guides_fixture_init(&f, fixture_groom("long", 2000), "long");
    guides_fixture_move(&f, "lean", 1500000);
    guides_fixture_encode(&f, GUIDES_DELTA, NULL);
    CHECK_INT(read_numbers(&f, &f.base_got, f.base_sequence + 1, &out), AWT_BAD_VALUE);
    CHECK_INT(read_numbers(&f, NULL, f.base_sequence, &out), AWT_BAD_VALUE);
    f.base_got.numbers[777] ^= 1;
    CHECK_INT(read_numbers(&f, &f.base_got, f.base_sequence, &out), AWT_BAD_VALUE);
    f.base_got.numbers[777] ^= 1;
    geom_guides other = f.base_got;
    other.wisps--;
    CHECK_INT(read_numbers(&f, &other, f.base_sequence, &out), AWT_BAD_VALUE);
    other = f.base_got;
    other.numbers = NULL; /* as of a frame for any viewer */
    CHECK_INT(read_numbers(&f, &other, f.base_sequence, &out), AWT_BAD_VALUE);
    CHECK(out.centres == NULL);
    CHECK_INT(read_numbers(&f, &f.base_got, f.base_sequence, &out), AWT_OK);
    guides_fixture_encode(&f, GUIDES_WHOLE, NULL); /* whatever base is here */
    CHECK_INT(read_numbers(&f, &other, 12345, &out), AWT_OK);
    geom_guides_fini(&out);
    guides_fixture_fini(&f);
}

/* Refused, or the damage was to the pose and the time alone. Never other hair. */
TEST(geom_guides_as_numbers_that_are_damaged_are_never_taken_for_other_hair)
{
    guides_fixture f;
    rng random = rng_seed(46);
    guides_fixture_init(&f, fixture_groom("short", 200), "short");
    guides_fixture_move(&f, "shake", 1500000);
    for (int form = GUIDES_WHOLE; form < GUIDES_FORMS; form++) {
        geom_guides right = {0};
        int refused = 0;
        guides_fixture_encode(&f, form, NULL);
        CHECK_INT(read_numbers(&f, &f.base_got, f.base_sequence, &right), AWT_OK);
        const size_t size = f.frame.size;
        unsigned char *kept = malloc(size);
        memcpy(kept, f.frame.bytes, size);
        for (int round = 0; round < 4000; round++) {
            const size_t from = round % 2 ? size / 2 : 0;
            for (uint32_t flips = 1 + rng_u32(&random) % 3; flips > 0; flips--) {
                f.frame.bytes[from + rng_u32(&random) % (size - from)] ^= (unsigned char)(1u << rng_u32(&random) % 8);
            }
            if (read_numbers(&f, &f.base_got, f.base_sequence, &f.got) == AWT_OK) {
                CHECK(memcmp(f.got.numbers, right.numbers, f.now->count * sizeof *right.numbers) == 0);
            } else {
                refused++;
            }
            memcpy(f.frame.bytes, kept, size);
        }
        CHECK(refused > 3000 && refused < 4000);
        free(kept);
        geom_guides_fini(&right);
    }
    guides_fixture_fini(&f);
}

/* Every field of the header and the table. */
TEST(geom_guides_as_numbers_that_lie_are_refused)
{
    guides_fixture f;
    guides_fixture_init(&f, fixture_groom("short", 200), "short");
    guides_fixture_move(&f, "shake", 1400000); /* at rest all numbers are 0 */
    guides_fixture_encode(&f, GUIDES_DELTA, NULL);
    CHECK_INT(read_numbers(&f, &f.base_got, f.base_sequence, &f.got), AWT_OK);
    guides_fixture_keep(&f);
    guides_fixture_move(&f, "shake", 1500000);
    for (int form = GUIDES_WHOLE; form < GUIDES_FORMS; form++) {
        delta_glb glb;
        guides_fixture_encode(&f, form, NULL);
        CHECK_INT(delta_glb_read(f.frame.bytes, f.frame.size, &glb, NULL), AWT_OK);
        unsigned char *block = f.frame.bytes + (glb.block - f.frame.bytes);
        for (size_t at = 0; at < DELTA_HEADER_BYTES + DELTA_ENTRY_BYTES; at++) {
            const unsigned char kept = block[at];
            const bool named = at >= 16 && at < 24; /* the frame's own name: anything */
            const bool flag = at == DELTA_HEADER_BYTES + 13 && form == GUIDES_WHOLE; /* all is against 0 */
            for (int value = 0; value < 256; value++) {
                block[at] = (unsigned char)value;
                const bool taken = read_numbers(&f, &f.base_got, f.base_sequence, &f.got) == AWT_OK;
                CHECK(taken == (value == kept || named || (flag && value < 2)));
            }
            block[at] = kept;
        }
    }
    guides_fixture_fini(&f);
}

TEST(geom_guides_as_numbers_are_refused_where_they_cannot_be_made)
{
    guides_fixture f;
    geom_layout *strands = NULL;
    geom_scratch *scratch = NULL;
    geom_quantised *numbers = NULL;
    guides_fixture_init(&f, fixture_groom("short", 200), "short");
    guides_fixture_encode(&f, GUIDES_WHOLE, NULL);
    geom_delta_def def = {.now = f.now, .base_sequence = 3, .sequence = 4, .head = awt_forest_head(f.forest)};
    CHECK_INT(geom_encode_delta(f.layout, f.encoder, &def, &f.frame, NULL, NULL), AWT_BAD_VALUE);
    def.base = f.base;
    CHECK_INT(geom_encode_delta(f.layout, f.encoder, &def, &f.frame, NULL, NULL), AWT_OK);
    def.base_sequence = 0; /* which would say that it is whole */
    CHECK_INT(geom_encode_delta(f.layout, f.encoder, &def, &f.frame, NULL, NULL), AWT_BAD_VALUE);
    const geom_frame_def frame = {
        .points = f.centres, .frames = f.frames, .quantised = f.now, .head = awt_forest_head(f.forest)};
    CHECK_INT(geom_encode(f.layout, f.encoder, &frame, &f.frame, NULL, NULL), AWT_BAD_VALUE);
    CHECK_INT(geom_layout_create(f.groom, &(geom_layout_def){.kind = GEOM_STRANDS}, &strands, NULL), AWT_OK);
    CHECK_INT(geom_scratch_create(strands, &scratch, NULL), AWT_OK);
    CHECK_INT(geom_quantised_create(strands, &numbers, NULL), AWT_OK);
    const geom_quantise_def quantise = {.points = f.points};
    uint32_t clamped = 0;
    CHECK_INT(geom_quantise(strands, &quantise, numbers, &clamped, NULL), AWT_OK);
    CHECK_INT(geom_quantise(strands, &quantise, f.now, &clamped, NULL), AWT_BAD_VALUE);
    def = (geom_delta_def){.now = numbers, .head = awt_forest_head(f.forest)}; /* strands do not come whole so */
    CHECK_INT(geom_encode_delta(strands, scratch, &def, &f.frame, NULL, NULL), AWT_BAD_VALUE);
    geom_quantised_destroy(numbers);
    geom_scratch_destroy(scratch);
    geom_layout_destroy(strands);
    guides_fixture_fini(&f);
}

/* A tree of more sections than a patch has room for is cut where layout.c cuts it. */
TEST(geom_guides_of_a_large_tree_are_bound_piece_by_piece)
{
    enum { WISPS = 3000, SECTIONS = 16, ROOM = GEOM_PATCH_POINTS / SECTIONS };
    static uint32_t tree[WISPS];
    for (uint32_t w = 0; w < WISPS; w++) {
        tree[w] = w < 5 ? 0 : w < 2500 ? 1 : 2;
    }
    const geom_binding binding = {.wisps = WISPS, .sections = SECTIONS, .tree = tree};
    CHECK_INT(guides_together(&binding, 0), 5);
    CHECK_INT(guides_together(&binding, 5), ROOM);
    CHECK_INT(guides_together(&binding, 5 + ROOM), ROOM);
    CHECK_INT(guides_together(&binding, 5 + 2 * ROOM), 2500 - 5 - 2 * ROOM);
    CHECK_INT(guides_together(&binding, 2500), 500);
    CHECK_INT(guides_together(&binding, WISPS - 1), 1);
}

/* At rest changes are none, in motion rounding is as large in both frames and larger in their difference. */
TEST(geom_plain_numbers_are_said_the_shorter_way)
{
    enum { COUNT = 600, MASK = (1 << GUIDES_BITS) - 1 };
    const delta_shape shape = {10, 10, GUIDES_COMPONENTS, GUIDES_BITS};
    static uint16_t base[COUNT], now[COUNT], back[COUNT], symbols[COUNT + DELTA_BLOCK];
    rng random = rng_seed(47);
    for (int reach = 9; reach <= MASK / 2; reach *= 3) {
        for (int still = 0; still < 2; still++) {
            uint16_t all, told = 0;
            for (size_t i = 0; i < COUNT; i++) {
                const int number = (int)(rng_u32(&random) % (uint32_t)(2 * reach + 1)) - reach;
                const int other = (int)(rng_u32(&random) % (uint32_t)(2 * reach + 1)) - reach;
                base[i] = (uint16_t)(number & MASK);
                now[i] = (uint16_t)((still ? number + other / 9 : other) & MASK);
            }
            const bool whole = delta_make_plain(&shape, base, now, symbols, &all);
            CHECK(whole == !still);
            for (size_t i = 0; i < COUNT; i++) {
                told |= symbols[i];
            }
            CHECK_INT(all, told);
            delta_apply(&shape, DELTA_PLAIN, symbols, whole ? NULL : base, NULL, back);
            CHECK_BYTES(back, now, sizeof now);
            CHECK(delta_make_plain(&shape, NULL, now, symbols, &all));
            delta_apply(&shape, DELTA_PLAIN, symbols, NULL, NULL, back);
            CHECK_BYTES(back, now, sizeof now);
        }
    }
}
