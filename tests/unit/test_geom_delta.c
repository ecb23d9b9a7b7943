/* test_geom_delta.c: deltas of strands: the frame that comes out is the very one that would have been sent whole. */
#include "check.h"

#include "base/crc32c.h"
#include "base/rng.h"
#include "base/trig.h"
#include "geom/cloud.h"
#include "geom/cloud_shim.h"
#include "geom/delta.h"
#include "geom/delta_checksum.h"
#include "geom/delta_format.h"
#include "geom/delta_glb.h"
#include "geom/layout.h"
#include "geom/quantised.h"
#include "geom/read.h"
#include "unit/delta_fixture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static geom_strands read_whole(delta_fixture *f)
{
    geom_strands back = {0};
    const geom_frame_def def = {.quantised = f->now, .head = geom_fixture_head, .time_us = f->time_us};
    CHECK_INT(geom_encode(f->hair.layout, f->hair.scratch, &def, &f->whole, NULL, NULL), AWT_OK);
    CHECK_INT(geom_read_frame(f->whole.bytes, f->whole.size, &back, NULL), AWT_OK);
    return back;
}

static void check_same(const geom_strands *a, const geom_strands *b)
{
    const size_t floats = (size_t)b->strand_count * b->points_per_strand * 3;
    CHECK_INT(a->kind, GEOM_STRANDS);
    CHECK_INT(a->strand_count, b->strand_count);
    CHECK_INT(a->points_per_strand, b->points_per_strand);
    CHECK_INT(a->patch_count, b->patch_count);
    CHECK_INT(a->triangle_count, b->triangle_count);
    CHECK(a->vertices == NULL);
    CHECK(a->time_us == b->time_us);
    CHECK(memcmp(&a->head, &b->head, sizeof a->head) == 0);
    CHECK(a->positions && b->positions && memcmp(a->positions, b->positions, floats * sizeof(float)) == 0);
    CHECK(a->widths && b->widths && memcmp(a->widths, b->widths, b->points_per_strand * sizeof(float)) == 0);
}

/* A chain of deltas, each on the frame that the one before it gave. */
static void check_chain(uint32_t strands, uint32_t per_strand, uint32_t trees, int bits, float reach_m)
{
    delta_fixture f;
    delta_fixture_init(&f, strands, per_strand, trees, bits);
    geom_strands base = read_whole(&f), out = {0};
    for (int round = 1; round <= 4; round++) {
        delta_fixture_move(&f, reach_m * (float)round, NULL);
        delta_fixture_encode(&f, NULL);
        CHECK_INT(delta_fixture_read(&f, &base, &out), AWT_OK);
        geom_strands whole = read_whole(&f);
        check_same(&out, &whole);
        geom_strands_fini(&whole);
        geom_strands swap = base;
        base = out;
        out = swap;
    }
    geom_strands_fini(&base);
    geom_strands_fini(&out);
    delta_fixture_fini(&f);
}

TEST(geom_deltas_give_the_frames_that_would_have_come_whole)
{
    const uint32_t per_strand[] = {2, 3, 16, 17, 100, 256};
    for (size_t i = 0; i < sizeof per_strand / sizeof per_strand[0]; i++) {
        check_chain(1, per_strand[i], 1, 12, 0.001f);
        check_chain(2, per_strand[i], 1, 12, 0.02f);
        check_chain(300, per_strand[i], 7, 12, 0.0005f);
    }
    for (int bits = GEOM_LEAST_BITS; bits <= GEOM_GREATEST_BITS; bits++) {
        check_chain(60, 16, 3, bits, 0.001f);
    }
    check_chain(5000, 16, 40, 12, 0.001f);
    check_chain(5000, 16, 40, 15, 0.4f); /* across the whole box, and beyond */
}

TEST(geom_whole_frames_are_the_same_from_points_and_from_numbers)
{
    delta_fixture f;
    delta_fixture_init(&f, 3000, 16, 10, 12);
    geom_frame_stats from_points = {0}, from_numbers = {0};
    geom_frame_def def = {.points = f.hair.points, .head = geom_fixture_head, .time_us = 7};
    f.hair.points[4] = 3; /* outside */
    uint32_t clamped = 0;
    const geom_quantise_def quantise = {.points = f.hair.points};
    CHECK_INT(geom_quantise(f.hair.layout, &quantise, f.now, &clamped, NULL), AWT_OK);
    CHECK_INT(clamped, 1);
    CHECK_INT(geom_encode(f.hair.layout, f.hair.scratch, &def, &f.hair.frame, &from_points, NULL), AWT_OK);
    def.points = NULL;
    def.quantised = f.now;
    CHECK_INT(geom_encode(f.hair.layout, f.hair.scratch, &def, &f.whole, &from_numbers, NULL), AWT_OK);
    CHECK(f.whole.size == f.hair.frame.size && memcmp(f.whole.bytes, f.hair.frame.bytes, f.whole.size) == 0);
    CHECK_INT(from_points.clamped_points, 1);
    CHECK_INT(from_numbers.encoded_patches, from_points.encoded_patches);
    delta_fixture_fini(&f);
}

/* What did not move is not sent, and comes out to the bit as it was: nothing shimmers. */
TEST(geom_deltas_leave_out_what_did_not_move)
{
    delta_fixture f;
    rng random = rng_seed(3);
    bool still[20];
    delta_fixture_init(&f, 18000, 8, 18, 12);
    const uint32_t patches = geom_layout_patches(f.hair.layout);
    geom_strands base = read_whole(&f), out = {0};
    delta_fixture_move(&f, 0.001f, NULL);
    delta_fixture_encode(&f, NULL);
    const size_t all = f.delta.size;
    for (int round = 0; round < 6; round++) {
        geom_frame_stats stats = {0};
        uint32_t moved = 0;
        delta_fixture_to_base(&f);
        for (uint32_t i = 0; i < patches; i++) {
            still[i] = round == 0 || rng_u32(&random) % 3 > 0;
            moved += !still[i];
        }
        delta_fixture_move(&f, 0.002f, still);
        delta_fixture_encode(&f, &stats);
        CHECK_INT(stats.encoded_patches, moved);
        CHECK(round > 0 || f.delta.size < 800); /* nothing moved */
        CHECK(f.delta.size < 1200 + all * 2 * (moved + 1) / patches);
        CHECK_INT(delta_fixture_read(&f, &base, &out), AWT_OK);
        const size_t a_strand = 8 * 3;
        for (uint32_t i = 0; i < patches && out.positions; i++) {
            geom_patch patch = geom_layout_patch(f.hair.layout, i);
            bool same =
                memcmp(out.positions + patch.first_strand * a_strand, base.positions + patch.first_strand * a_strand,
                       patch.strands * a_strand * sizeof(float)) == 0;
            CHECK(same == still[i]);
        }
    }
    geom_strands_fini(&base);
    geom_strands_fini(&out);
    delta_fixture_fini(&f);
}

TEST(geom_deltas_of_another_base_are_refused)
{
    delta_fixture f;
    awt_error error = {0};
    delta_fixture_init(&f, 300, 16, 7, 12);
    geom_strands base = read_whole(&f), out = {0};
    delta_fixture_move(&f, 0.001f, NULL);
    delta_fixture_encode(&f, NULL);
    CHECK_INT(geom_read_delta(f.reader, f.delta.bytes, f.delta.size, &base, f.base_sequence + 1, &out, &error),
              AWT_BAD_VALUE);
    CHECK(strstr(error.text, "for frame 41, not 42") != NULL);
    float *x = &base.positions[1000], kept = *x;
    *x += draco_box_step(&f.hair.layout->box);
    CHECK_INT(delta_fixture_read(&f, &base, &out), AWT_BAD_VALUE);
    *x = NAN;
    CHECK_INT(delta_fixture_read(&f, &base, &out), AWT_BAD_VALUE);
    *x = kept;
    geom_strands other = base;
    other.strand_count = 299;
    CHECK_INT(delta_fixture_read(&f, &other, &out), AWT_BAD_VALUE);
    other = base;
    other.kind = GEOM_RIBBON;
    CHECK_INT(delta_fixture_read(&f, &other, &out), AWT_BAD_VALUE);
    CHECK(out.positions == NULL);
    CHECK_INT(delta_fixture_read(&f, &base, &out), AWT_OK);
    geom_strands_fini(&base);
    geom_strands_fini(&out);
    delta_fixture_fini(&f);
}

/* Cut short, or damaged: refused, or the damage was to the pose and the time alone. Never other geometry. */
TEST(geom_deltas_cut_short_or_damaged_are_never_taken_for_other_hair)
{
    delta_fixture f;
    rng random = rng_seed(5);
    int refused = 0;
    delta_fixture_init(&f, 40, 8, 3, 12);
    geom_strands base = read_whole(&f), out = {0}, right = {0};
    delta_fixture_move(&f, 0.001f, NULL);
    delta_fixture_encode(&f, NULL);
    CHECK_INT(delta_fixture_read(&f, &base, &right), AWT_OK);
    const geom_buffer delta = f.delta;
    f.delta.bytes = malloc(delta.size);
    for (size_t size = 0; size < delta.size; size++) {
        unsigned char *cut = malloc(size ? size : 1);
        memcpy(cut, delta.bytes, size);
        for (int agrees = 0; agrees < 2; agrees++) { /* the second time its header says this length */
            if (agrees && size >= 12) {
                store_u32(cut + 8, (uint32_t)size);
            }
            CHECK(geom_read_delta(f.reader, cut, size, &base, f.base_sequence, &out, NULL) != AWT_OK);
        }
        free(cut);
    }
    for (int round = 0; round < 20000; round++) {
        memcpy(f.delta.bytes, delta.bytes, delta.size);
        for (uint32_t flips = 1 + rng_u32(&random) % 3; flips > 0; flips--) {
            const size_t from = round % 2 ? delta.size / 2 : 0;
            f.delta.bytes[from + rng_u32(&random) % (delta.size - from)] ^= (unsigned char)(1u << rng_u32(&random) % 8);
        }
        if (delta_fixture_read(&f, &base, &out) == AWT_OK) {
            CHECK(memcmp(out.positions, right.positions, 40 * 8 * 3 * sizeof(float)) == 0);
        } else {
            refused++;
        }
    }
    CHECK(refused > 15000 && refused < 20000);
    free(f.delta.bytes);
    f.delta = delta;
    geom_strands_fini(&base);
    geom_strands_fini(&out);
    geom_strands_fini(&right);
    delta_fixture_fini(&f);
}

/* Every field of the header and the table, and boxes in which numbers would not be numbers. */
TEST(geom_deltas_that_lie_are_refused)
{
    delta_fixture f;
    delta_fixture_init(&f, 40, 8, 3, 12);
    geom_strands base = read_whole(&f), out = {0};
    delta_fixture_move(&f, 0.001f, NULL);
    delta_fixture_encode(&f, NULL);
    delta_glb glb;
    CHECK_INT(delta_glb_read(f.delta.bytes, f.delta.size, &glb, NULL), AWT_OK);
    unsigned char *block = f.delta.bytes + (glb.block - f.delta.bytes);
    for (size_t at = 0; at < DELTA_HEADER_BYTES + DELTA_ENTRY_BYTES; at++) {
        const unsigned char kept = block[at];
        const bool named = at >= 16 && at < 24; /* the frame's own name: anything */
        for (int value = 0; value < 256; value++) {
            block[at] = (unsigned char)value;
            CHECK((delta_fixture_read(&f, &base, &out) == AWT_OK) == (value == kept || named));
        }
        block[at] = kept;
    }
    const float boxes[] = {NAN, INFINITY, -INFINITY, 1e30f, -1e30f, 0, -1, 1e-30f, 1e6f};
    for (size_t i = 0; i < sizeof boxes / sizeof boxes[0]; i++) {
        for (size_t at = 40; at < 56; at += 4) {
            const float kept = load_f32(block + at);
            store_f32(block + at, boxes[i]);
            CHECK(delta_fixture_read(&f, &base, &out) != AWT_OK);
            store_f32(block + at, kept);
        }
    }
    CHECK_INT(delta_fixture_read(&f, &base, &out), AWT_OK);
    geom_strands_fini(&base);
    geom_strands_fini(&out);
    delta_fixture_fini(&f);
}

TEST(geom_deltas_are_refused_where_they_cannot_be_made)
{
    delta_fixture f, other;
    awt_error error = {0};
    geom_quantised *none = NULL;
    delta_fixture_init(&f, 40, 8, 3, 12);
    delta_fixture_init(&other, 40, 8, 3, 12);
    geom_delta_def def = {.base = f.base, .now = other.now, .head = geom_fixture_head};
    CHECK_INT(geom_encode_delta(f.hair.layout, f.hair.scratch, &def, &f.delta, NULL, &error), AWT_BAD_VALUE);
    def.now = f.now;
    def.head.orientation[0] = NAN;
    CHECK_INT(geom_encode_delta(f.hair.layout, f.hair.scratch, &def, &f.delta, NULL, &error), AWT_BAD_VALUE);
    f.hair.points[17] = NAN;
    uint32_t clamped = 0;
    const geom_quantise_def quantise = {.points = f.hair.points};
    CHECK_INT(geom_quantise(f.hair.layout, &quantise, f.now, &clamped, &error), AWT_BAD_VALUE);
    CHECK(strstr(error.text, "not a finite number") != NULL);
    def.head = geom_fixture_head;
    CHECK_INT(geom_encode_delta(f.hair.layout, f.hair.scratch, &def, &f.delta, NULL, &error), AWT_BAD_VALUE);
    geom_fixture_layout(&f.hair, &(geom_layout_def){.kind = GEOM_RIBBON});
    CHECK_INT(geom_quantised_create(f.hair.layout, &none, &error), AWT_BAD_VALUE);
    CHECK(none == NULL);
    delta_fixture_fini(&f);
    delta_fixture_fini(&other);
}

/* ---- the numbers by themselves */

static bool read_cloud(cloud_reader *reader, const void *bytes, size_t size, uint32_t points, uint32_t components,
                       uint16_t *symbols)
{
    const cloud_source sources[RANS_LANES] = {[1] = {bytes, size, points}};
    reader->symbols[1] = symbols;
    return cloud_read(reader, sources, components, 15);
}

/* Stock libdraco decodes our clouds to the same numbers, and we decode its. */
TEST(geom_clouds_are_read_by_libdraco_and_libdracos_by_us)
{
    static cloud_reader reader;
    enum { POINTS = 4000 };
    const int greatest[] = {0, 1, 3, 40, 4000, 16383};
    cloud_writer *writer = NULL;
    static int16_t numbers[POINTS * 3], back[POINTS * 3];
    static uint16_t symbols[POINTS * 3];
    CHECK_INT(cloud_writer_create(POINTS * 3, 15, &writer, NULL), AWT_OK);
    rng random = rng_seed(9);
    for (size_t n = 0; n < 6; n++) {
        for (uint32_t components = 1; components <= 3; components++) {
            const size_t count = POINTS * (size_t)components;
            uint16_t *mine = cloud_writer_symbols(writer, 2);
            for (size_t i = 0; i < count; i++) {
                const int most = greatest[n] / (1 + (int)(rng_u32(&random) % 9));
                numbers[i] = (int16_t)((int)(rng_u32(&random) % (uint32_t)(2 * most + 1)) - most);
                mine[i] = (uint16_t)(numbers[i] < 0 ? -2 * numbers[i] - 1 : 2 * numbers[i]);
            }
            cloud_job jobs[RANS_LANES] = {[2] = {.points = POINTS, .components = components, .alphabet = 32768}};
            cloud_writer_run(writer, jobs, false);
            unsigned char *cloud = malloc(jobs[2].size);
            cloud_writer_put(writer, &jobs[2], 2, cloud);
            CHECK_INT(cloud_shim_decode(cloud, jobs[2].size, POINTS, components, back, NULL), AWT_OK);
            CHECK(memcmp(back, numbers, count * sizeof *back) == 0);
            CHECK(read_cloud(&reader, cloud, jobs[2].size, POINTS, components, symbols));
            CHECK(memcmp(symbols, mine, count * sizeof *mine) == 0);
            CHECK(!read_cloud(&reader, cloud, jobs[2].size - 1, POINTS, components, symbols));
            CHECK(!read_cloud(&reader, cloud, jobs[2].size, POINTS - 1, components, symbols));
            free(cloud);
            geom_buffer stock = {0};
            CHECK_INT(cloud_shim_encode(numbers, POINTS, components, &stock, NULL), AWT_OK);
            CHECK(memcmp(stock.bytes, "DRACO\2\3\0\0\0\0", 11) == 0);
            CHECK(n > 3 || jobs[2].size < stock.size + stock.size / 50 + 40); /* beyond, libdraco tags */
            if (stock.bytes[CLOUD_HEAD_BYTES] == SYMBOLS_RAW && stock.bytes[CLOUD_HEAD_BYTES - 1] == 1) {
                CHECK(read_cloud(&reader, stock.bytes, stock.size, POINTS, components, symbols));
                CHECK(memcmp(symbols, mine, count * sizeof *mine) == 0);
            }
            geom_buffer_fini(&stock);
        }
    }
    cloud_writer_destroy(writer);
}

/* Other counts of components, every carry, numbers all over their range, symbols that no encoder wrote. */
TEST(geom_changes_come_back_whatever_they_are)
{
    enum { STRANDS = 30, POINTS = 9, MOST = STRANDS * POINTS * DELTA_MAX_COMPONENTS };
    static uint16_t base[MOST], now[MOST], back[MOST], symbols[MOST + DELTA_BLOCK];
    static int16_t changes[MOST + DELTA_BLOCK + 4 * POINTS * DELTA_MAX_COMPONENTS];
    rng random = rng_seed(12);
    for (uint32_t components = 1; components <= DELTA_MAX_COMPONENTS; components++) {
        for (int bits = 1; bits <= DELTA_MAX_BITS; bits++) {
            const delta_shape shape = {STRANDS, POINTS, components, bits};
            const size_t count = delta_count(&shape);
            const uint32_t mask = (1u << bits) - 1;
            uint32_t all = 0;
            for (size_t i = 0; i < count; i++) {
                base[i] = (uint16_t)(rng_u32(&random) & mask);
                now[i] = (uint16_t)(rng_u32(&random) & mask);
            }
            uint16_t told;
            uint8_t carry = delta_make(&shape, base, now, changes, symbols, &told);
            for (size_t i = 0; i < count; i++) {
                all |= symbols[i];
            }
            CHECK_INT(all >> bits, 0);
            CHECK_INT(told, all);
            memset(back, 0xff, sizeof back);
            delta_apply(&shape, carry, symbols, base, changes, back);
            CHECK(memcmp(back, now, count * sizeof *now) == 0);
            for (size_t i = 0; i < count; i++) {
                symbols[i] = (uint16_t)rng_u32(&random);
            }
            for (uint8_t other = 0; other <= DELTA_PLAIN; other++) {
                delta_apply(&shape, other, symbols, base, changes, back);
                for (size_t i = 0; i < count; i++) {
                    CHECK(back[i] <= mask);
                }
            }
        }
    }
}

/* The worked example of proto/DELTAS.md. */
TEST(geom_changes_are_those_of_the_documents_example)
{
    const delta_shape shape = {1, 2, 3, 8};
    const uint16_t base[] = {10, 20, 30, 40, 50, 60}, now[] = {10, 20, 31, 44, 50, 65};
    const int residuals[] = {0, 0, 1, 4, 0, 4};
    int16_t changes[100];
    uint16_t symbols[DELTA_BLOCK], back[6], all;
    CHECK_INT(delta_make(&shape, base, now, changes, symbols, &all), 2);
    for (int i = 0; i < 6; i++) {
        CHECK_INT(symbols[i], residuals[i] < 0 ? -2 * residuals[i] - 1 : 2 * residuals[i]);
    }
    delta_apply(&shape, 2, symbols, base, changes, back);
    CHECK_BYTES(back, now, sizeof now);
}

/* The same bytes from every compiler and for every width of the machine's registers. */
TEST(geom_deltas_are_these_bytes)
{
    delta_fixture f;
    delta_fixture_init(&f, 2000, 16, 8, 12);
    delta_fixture_move(&f, 0.001f, NULL);
    delta_fixture_encode(&f, NULL);
    CHECK_U64(crc32c(f.delta.bytes, f.delta.size), UINT32_C(0x6859eb05));
    delta_fixture_fini(&f);
}
