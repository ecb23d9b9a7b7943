/* test_geom_strangers.c: guides and bindings from strangers: cut short, damaged, lying about themselves. */
#include "check.h"

#include "base/hash.h"
#include "base/rng.h"
#include "geom/delta_checksum.h"
#include "geom/guides.h"
#include "geom/quantised.h"
#include "geom/receive.h"
#include "unit/groom_fixture.h"
#include "unit/guides_fixture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static awt_groom *small_groom(void)
{
    awt_groom_def def = awt_groom_def_default();
    awt_strands patch = groom_fixture_patch(24);
    def.points_per_strand = 5;
    awt_groom *groom = groom_fixture_build(&patch, &def);
    awt_strands_fini(&patch);
    return groom;
}

static awt_status receive(guides_fixture *f, int form, const void *bytes, size_t size, geom_strands *strands)
{
    if (form == GUIDES_MESHES) {
        return geom_receive_frame(f->binding, bytes, size, strands, NULL);
    }
    awt_status status =
        geom_read_guides_delta(f->reader, f->binding, bytes, size, &f->base_got, f->base_sequence, &f->got, NULL);
    return status == AWT_OK ? geom_guides_strands(f->binding, &f->got, strands, NULL) : status;
}

TEST(geom_guides_cut_short_or_damaged_do_no_harm)
{
    awt_groom *groom = small_groom();
    guides_fixture f;
    guides_fixture_init(&f, groom, NULL);
    rng random = rng_seed(43);
    for (int form = 0; form < GUIDES_FORMS; form++) {
        int read = 0;
        guides_fixture_encode(&f, form, NULL);
        unsigned char *copy = malloc(f.frame.size);
        for (size_t size = 12; size < f.frame.size; size++) { /* with a header that agrees */
            uint32_t length = (uint32_t)size;
            geom_strands strands = {0};
            unsigned char *cut = malloc(size);
            memcpy(cut, f.frame.bytes, size);
            memcpy(cut + 8, &length, 4);
            CHECK_INT(receive(&f, form, cut, size, &strands), AWT_BAD_FORMAT);
            free(cut);
        }
        for (int round = 0; round < 6000; round++) {
            geom_strands strands = {0};
            memcpy(copy, f.frame.bytes, f.frame.size);
            uint32_t from = round % 2 ? (uint32_t)f.frame.size * 2 / 3 : 0; /* the Draco data alone, half of the time */
            for (uint32_t flips = 1 + rng_u32(&random) % 4; flips > 0; flips--) {
                copy[from + rng_u32(&random) % ((uint32_t)f.frame.size - from)] = (unsigned char)rng_u32(&random);
            }
            bool taken = receive(&f, form, copy, f.frame.size, &strands) == AWT_OK;
            for (size_t i = 0; taken && i < (size_t)24 * 5 * 3; i++) {
                CHECK(isfinite(strands.positions[i]));
            }
            read += taken;
            geom_strands_fini(&strands);
        }
        CHECK(read > 0 && read < 6000);
        free(copy);
    }
    guides_fixture_fini(&f);
    awt_groom_destroy(groom);
}

/* The same id over other bytes, as a stranger would write it. */
static void sign(unsigned char *bytes, size_t size)
{
    uint64_t hash = HASH_SEED;
    for (size_t i = 16; i + 4 <= size; i += 4) {
        hash = hash_words(hash, bytes + i, 1);
    }
    memcpy(bytes + 8, &hash, sizeof hash);
}

static awt_status read_binding(const unsigned char *bytes, size_t size)
{
    geom_binding *binding = NULL;
    awt_error error = {0};
    unsigned char *copy = malloc(size ? size : 1);
    if (size > 0) {
        memcpy(copy, bytes, size);
    }
    awt_status status = geom_binding_read(copy, size, &binding, &error);
    CHECK((status == AWT_OK) == (binding != NULL));
    CHECK((status == AWT_OK) == (error.text[0] == '\0'));
    geom_binding_destroy(binding);
    free(copy);
    return status;
}

TEST(geom_bindings_cut_short_or_damaged_are_refused)
{
    awt_groom *groom = small_groom();
    guides_fixture f;
    guides_fixture_init(&f, groom, NULL);
    unsigned char *bytes = calloc(1, f.binding_size + 4);
    memcpy(bytes, f.binding_bytes, f.binding_size);
    CHECK_INT(read_binding(bytes, f.binding_size), AWT_OK);
    for (size_t size = 0; size < f.binding_size; size++) {
        CHECK_INT(read_binding(bytes, size), AWT_TRUNCATED);
    }
    CHECK_INT(read_binding(bytes, f.binding_size + 4), AWT_BAD_VALUE);
    for (size_t i = 0; i < f.binding_size; i++) {
        bytes[i] ^= 0x10;
        CHECK(read_binding(bytes, f.binding_size) != AWT_OK);
        bytes[i] ^= 0x10;
    }
    free(bytes);
    guides_fixture_fini(&f);
    awt_groom_destroy(groom);
}

/* A binding with numbers of a stranger's choice and the id that they make: refused, or whole and finite. */
TEST(geom_bindings_that_lie_do_no_harm)
{
    awt_groom *groom = small_groom();
    guides_fixture f;
    guides_fixture_init(&f, groom, NULL);
    rng random = rng_seed(44);
    const float wild[] = {NAN, INFINITY, 1e30f, -1e30f, 2e6f, 0, -1};
    unsigned char *bytes = malloc(f.binding_size);
    int read = 0;
    guides_fixture_encode(&f, GUIDES_MESHES, NULL);
    for (int round = 0; round < 3000; round++) {
        geom_binding *binding = NULL;
        memcpy(bytes, f.binding_bytes, f.binding_size);
        uint32_t words = round % 2 ? 8 : (uint32_t)(f.binding_size - 16) / 4; /* the counts, half of the time */
        unsigned char *word = bytes + 16 + 4 * (rng_u32(&random) % words);
        uint32_t value = rng_u32(&random) >> rng_u32(&random) % 32;
        if (rng_u32(&random) % 2) {
            memcpy(&value, &wild[rng_u32(&random) % 7], sizeof value);
        }
        memcpy(word, &value, sizeof value);
        sign(bytes, f.binding_size);
        if (geom_binding_read(bytes, f.binding_size, &binding, NULL) == AWT_OK) {
            /* a frame that says this id */
            char id[17];
            geom_strands strands = {0};
            uint64_t hash;
            memcpy(&hash, bytes + 8, sizeof hash);
            snprintf(id, sizeof id, "%016llx", (unsigned long long)hash);
            char *place = strstr((char *)f.frame.bytes + 20, "\"binding\":\"");
            CHECK(place != NULL);
            memcpy(place + strlen("\"binding\":\""), id, 16);
            if (geom_receive_frame(binding, f.frame.bytes, f.frame.size, &strands, NULL) == AWT_OK) {
                for (size_t i = 0; i < (size_t)strands.strand_count * strands.points_per_strand * 3; i++) {
                    CHECK(isfinite(strands.positions[i]));
                }
                read++;
            }
            geom_strands_fini(&strands);
        }
        geom_binding_destroy(binding);
    }
    CHECK(read > 0 && read < 3000);
    free(bytes);
    guides_fixture_fini(&f);
    awt_groom_destroy(groom);
}

/* Whole frames of numbers of a stranger's choice, with checksums that are right. */
TEST(geom_guides_of_any_numbers_are_finite)
{
    awt_groom *groom = small_groom();
    guides_fixture f;
    guides_fixture_init(&f, groom, NULL);
    rng random = rng_seed(45);
    for (int round = 0; round < 300; round++) {
        const geom_delta_def def = {.now = f.now, .sequence = 1, .head = awt_forest_head(f.forest)};
        geom_strands strands = {0};
        guides_fixture_encode(&f, GUIDES_WHOLE, NULL);
        CHECK_INT(f.now->patch_count, 1);
        uint16_t *numbers = f.now->patches[0]->numbers;
        for (size_t i = 0; i < f.now->count; i++) {
            numbers[i] = (uint16_t)(rng_u32(&random) >> (17 + (unsigned)round % 15));
        }
        f.now->checksum = delta_checksum(delta_checksum_numbers(numbers, f.now->count),
                                         &(draco_box){.bits = GUIDES_BITS}, f.binding->id);
        CHECK_INT(geom_encode_delta(f.layout, f.encoder, &def, &f.frame, NULL, NULL), AWT_OK);
        CHECK_INT(guides_fixture_receive(&f, GUIDES_WHOLE, &strands, NULL), AWT_OK);
        for (size_t i = 0; strands.positions && i < (size_t)24 * 5 * 3; i++) {
            CHECK(isfinite(strands.positions[i]));
        }
        geom_strands_fini(&strands);
    }
    guides_fixture_fini(&f);
    awt_groom_destroy(groom);
}
