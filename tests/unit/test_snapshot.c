/* test_snapshot.c: snapshots go on to the bit, say all they hold once, and refuse whatever was not written by us. */
#include "check.h"
#include "fixture.h"

#include "base/bytes.h"
#include "base/crc32c.h"
#include "base/rng.h"
#include "sim/state.h"

#include <math.h>
#include <stdlib.h>

static const double zero[3] = {0, 0, 0};
enum { STRANDS = 1000, FEW_STRANDS = 150 };
enum { TABLE_AT = 16, ENTRY_SIZE = 24 }; /* sections.h */

typedef struct bytes {
    unsigned char *data;
    size_t size;
} bytes;

static bytes snapshot_of(const awt_forest *f)
{
    bytes b = {0};
    CHECK_INT(awt_forest_snapshot(f, NULL, 0, &b.size, NULL), AWT_OK);
    b.data = malloc(b.size);
    size_t again = 0;
    CHECK_INT(awt_forest_snapshot(f, b.data, b.size, &again, NULL), AWT_OK);
    CHECK_INT(again, b.size);
    return b;
}

/* ---- the vessel, from the outside ------------------------------------------------------------------------------- */

static unsigned char *entry_at(const bytes *b, uint32_t k)
{
    return b->data + TABLE_AT + ENTRY_SIZE * (size_t)k;
}

static uint32_t section_count(const bytes *b)
{
    return load_u32(b->data + 12);
}

static bytes section(const bytes *b, const char *name)
{
    for (uint32_t k = 0; k < section_count(b); k++) {
        const unsigned char *entry = entry_at(b, k);
        if (memcmp(entry, name, 4) == 0) {
            return (bytes){b->data + load_u64(entry + 8), (size_t)load_u64(entry + 16)};
        }
    }
    CHECK_TEXT("no such section", name);
    return (bytes){0};
}

/* Makes the checksums fit what was changed. */
static void repair(const bytes *b)
{
    for (uint32_t k = 0; k < section_count(b); k++) {
        unsigned char *entry = entry_at(b, k);
        store_u32(entry + 4, crc32c(b->data + load_u64(entry + 8), (size_t)load_u64(entry + 16)));
    }
    size_t table_end = TABLE_AT + ENTRY_SIZE * (size_t)section_count(b);
    store_u32(b->data + table_end, crc32c(b->data, table_end));
}

/* ---- motion in which everything that a snapshot holds is in use -----------------------------------------------------
 */

/* A lean, which begins after a second at rest, and beside it a ball with a frame of its own. */
static awt_motion lean_at(int64_t time_us)
{
    int64_t rolling_us = time_us > 1000000 ? time_us - 1000000 : 0;
    awt_motion m = fixture_motion(fixture_clip("lean"), time_us, zero, zero);
    m.collider_count = 1;
    m.colliders[0].id = 77;
    m.colliders[0].pose = (awt_pose){{0.3 + (double)rolling_us * 1e-8, 0.05, 0}, {0, 0, 0, 1}};
    return m;
}

static awt_forest *forest_with_ball(const awt_groom *groom, const char *style)
{
    awt_forest_def def = awt_forest_def_default(groom);
    def.params = awt_style_find(style)->params;
    def.colliders[def.collider_count++] =
        (awt_collider){.id = 77, .frame = AWT_FRAME_OWN, .radius_a = 0.05f, .radius_b = 0.05f};
    def.start = lean_at(0);
    awt_forest *f = NULL;
    CHECK_INT(awt_forest_create(groom, &def, &f, NULL), AWT_OK);
    return f;
}

/* To step `steps`, poses given `ahead` steps before they are reached. */
static void play_to(awt_forest *f, int *given, int from, int steps, int ahead, awt_step_stats *sum)
{
    for (int n = from + 1; n <= steps; n++) {
        while (*given < n + ahead) {
            awt_motion m = lean_at((int64_t)++ * given * AWT_STEP_US);
            m.teleport = *given % 140 == 0;
            CHECK_INT(awt_forest_move(f, &m, NULL), AWT_OK);
        }
        awt_step_stats stats;
        CHECK_INT(awt_forest_advance(f, (int64_t)n * AWT_STEP_US, &stats, NULL), AWT_OK);
        sum->splits += stats.splits, sum->merges += stats.merges;
    }
}

/* A small forest in the middle of a lean, its queue in use. */
static awt_forest *forest_under_way(void)
{
    awt_forest *f = forest_with_ball(fixture_groom("long", FEW_STRANDS), "long");
    int given = 0;
    awt_step_stats sum = {0};
    play_to(f, &given, 0, 200, 5, &sum);
    CHECK(sum.splits > 0);
    return f;
}

TEST(a_restored_forest_goes_on_to_the_bit)
{
    static const char *const styles[] = {"long", "short-curly"};
    for (size_t s = 0; s < 2; s++) {
        for (int stop = 90; stop <= 250; stop += 160) {
            awt_forest *never_stopped = forest_with_ball(fixture_groom(styles[s], STRANDS), styles[s]);
            int given = 0;
            awt_step_stats before = {0}, after = {0}, again = {0};
            play_to(never_stopped, &given, 0, stop, 7, &before);
            CHECK_INT(never_stopped->trees[0].asleep, stop == 90);
            bytes b = snapshot_of(never_stopped);
            awt_groom *groom = NULL;
            awt_forest *restored = NULL;
            awt_error error = {0};
            CHECK_INT(awt_snapshot_restore(b.data, b.size, &groom, &restored, &error), AWT_OK);
            CHECK_TEXT(error.text, "");
            CHECK_U64(awt_forest_hash(restored), awt_forest_hash(never_stopped));
            int given_again = given;
            for (int n = stop; n < stop + 300; n++) {
                play_to(never_stopped, &given, n, n + 1, 7, &after);
                play_to(restored, &given_again, n, n + 1, 7, &again);
                if (awt_forest_hash(restored) != awt_forest_hash(never_stopped)) {
                    CHECK_INT(n + 1, -1); /* the first step that differs */
                    break;
                }
            }
            CHECK(after.splits > 0 && after.merges > 0);
            bytes end = snapshot_of(never_stopped), end_again = snapshot_of(restored);
            CHECK_INT(end_again.size, end.size);
            CHECK_BYTES(end_again.data, end.data, end.size);
            free(b.data), free(end.data), free(end_again.data);
            awt_forest_destroy(restored);
            awt_groom_destroy(groom);
            awt_forest_destroy(never_stopped);
        }
    }
}

TEST(a_snapshot_says_nothing_but_the_state)
{
    awt_forest *f = forest_under_way();
    bytes a = snapshot_of(f);
    unsigned char *b = malloc(a.size + 1);
    size_t size = 0;
    memset(b, 0xa5, a.size + 1);
    CHECK_INT(awt_forest_snapshot(f, b, a.size, &size, NULL), AWT_OK);
    CHECK_BYTES(b, a.data, a.size); /* whatever the room held before */
    CHECK_INT(b[a.size], 0xa5);

    memset(b, 0xa5, a.size + 1);
    awt_error error;
    CHECK_INT(awt_forest_snapshot(f, b, a.size - 1, &size, &error), AWT_LIMIT);
    CHECK_INT(size, a.size);
    CHECK_INT(b[a.size - 1], 0xa5);

    awt_groom *groom;
    awt_forest *restored;
    CHECK_INT(awt_snapshot_restore(a.data, a.size, &groom, &restored, NULL), AWT_OK);
    CHECK_INT(awt_forest_snapshot(restored, b, a.size, &size, NULL), AWT_OK);
    CHECK_INT(size, a.size);
    CHECK_BYTES(b, a.data, a.size);
    free(a.data), free(b);
    awt_forest_destroy(restored);
    awt_groom_destroy(groom);
    awt_forest_destroy(f);
}

TEST(the_groom_of_a_snapshot_is_the_groom)
{
    for (size_t s = 0; s < awt_style_count(); s++) {
        const char *style = awt_style_at(s)->name;
        const awt_groom *a = fixture_groom(style, STRANDS);
        awt_forest *f = fixture_forest(a, style, zero, zero);
        bytes snapshot = snapshot_of(f);
        awt_groom *b = NULL;
        awt_params params;
        CHECK_INT(awt_snapshot_read_groom(snapshot.data, snapshot.size, &b, &params, NULL), AWT_OK);
        const size_t gcs = a->gc_count, nodes = gcs * a->info.sections;
        const size_t points = (size_t)a->info.strand_count * a->info.points_per_strand;
        CHECK_BYTES(&b->info, &a->info, sizeof a->info);
        CHECK_BYTES(b->level_first, a->level_first, sizeof a->level_first);
        CHECK_BYTES(&b->mass_unit_kg, &a->mass_unit_kg, sizeof a->mass_unit_kg);
        CHECK_BYTES(b->gc_super, a->gc_super, gcs * 4);
        CHECK_BYTES(b->gc_sub_first, a->gc_sub_first, gcs * 4);
        CHECK_BYTES(b->gc_sub_count, a->gc_sub_count, gcs * 4);
        CHECK_BYTES(b->gc_tree, a->gc_tree, gcs * 4);
        CHECK_BYTES(b->gc_strand_count, a->gc_strand_count, gcs * 4);
        CHECK_BYTES(b->gc_strand_first, a->gc_strand_first, (gcs - groom_finest_first(a) + 1) * 4);
        CHECK_BYTES(b->rest_position, a->rest_position, nodes * sizeof(vec3));
        CHECK_BYTES(b->rest_radius, a->rest_radius, nodes * sizeof(float));
        CHECK_BYTES(b->rest_frame, a->rest_frame, a->info.finest_nodes * sizeof(quat));
        CHECK_BYTES(b->strand_offset, a->strand_offset, points * 3 * sizeof(float));
        awt_params expected = awt_style_at(s)->params;
        CHECK_BYTES(&params, &expected, sizeof params);
        awt_groom_destroy(b);
        free(snapshot.data);
        awt_forest_destroy(f);
    }
}

TEST(a_film_head_of_hair_goes_on_to_the_bit)
{
    const char *path = check_data("hair/sintel_16pt.v4.tfx");
    if (!path) {
        check_skip("no real hair here");
        return;
    }
    size_t size = 0;
    unsigned char *file = check_read_file(path, &size);
    awt_strands strands = {0};
    awt_placement placement = {0};
    awt_groom_def def = awt_groom_def_default();
    awt_groom *groom = NULL, *groom_again = NULL;
    awt_forest *f = NULL, *restored = NULL;
    CHECK_INT(awt_strands_read(file, size, &strands, NULL), AWT_OK);
    CHECK_INT(awt_strands_place(&strands, &placement, NULL), AWT_OK);
    CHECK_INT(awt_groom_build(&strands, &def, NULL, NULL, &groom, NULL), AWT_OK);
    awt_forest_def start = awt_forest_def_default(groom);
    CHECK_INT(awt_forest_create(groom, &start, &f, NULL), AWT_OK);
    for (int n = 1; n <= 150; n++) {
        fixture_advance(f, fixture_clip("lean"), (int64_t)n * AWT_STEP_US, zero, zero, NULL);
    }
    bytes b = snapshot_of(f);
    CHECK_INT(awt_snapshot_restore(b.data, b.size, &groom_again, &restored, NULL), AWT_OK);
    for (int n = 151; n <= 250; n++) {
        fixture_advance(f, fixture_clip("lean"), (int64_t)n * AWT_STEP_US, zero, zero, NULL);
        fixture_advance(restored, fixture_clip("lean"), (int64_t)n * AWT_STEP_US, zero, zero, NULL);
    }
    CHECK_U64(awt_forest_hash(restored), awt_forest_hash(f));
    awt_forest_destroy(restored);
    awt_groom_destroy(groom_again);
    awt_forest_destroy(f);
    awt_groom_destroy(groom);
    awt_strands_fini(&strands);
    free(b.data), free(file);
}

/* ---- versions ---------------------------------------------------------------------------------------------------- */

TEST(a_snapshot_of_other_physics_gives_its_groom_and_parameters_only)
{
    awt_forest *f = forest_under_way();
    bytes b = snapshot_of(f);
    store_u32(b.data + 8, AWT_PHYSICS_VERSION + 1);
    memcpy(section(&b, "PARA").data + 1, "xplit", 5); /* of split_threshold, the first: a name of the future */
    memcpy(section(&b, "SPLT").data, "    ", 4);      /* and a state that means nothing to us */
    repair(&b);
    awt_groom *groom;
    awt_forest *restored;
    awt_params params;
    awt_error error;
    CHECK_INT(awt_snapshot_restore(b.data, b.size, &groom, &restored, &error), AWT_OTHER_VERSION);
    CHECK(groom == NULL && restored == NULL);
    CHECK(strstr(error.text, "physics version") != NULL);
    CHECK_INT(awt_snapshot_read_groom(b.data, b.size, &groom, &params, &error), AWT_OK);
    CHECK_INT(groom->info.strand_count, FEW_STRANDS);
    CHECK_NEAR(params.style_omega, awt_forest_params(f).style_omega, 0);
    CHECK_NEAR(params.split_threshold, awt_params_default().split_threshold, 0);
    awt_groom_destroy(groom);

    store_u32(b.data + 8, AWT_PHYSICS_VERSION);
    repair(&b);
    CHECK_INT(awt_snapshot_restore(b.data, b.size, &groom, &restored, &error), AWT_NO_PARAM);
    const uint32_t format = load_u32(b.data + 4);
    for (uint32_t other = format - 1; other <= format + 1; other += 2) { /* the one before bound strands otherwise */
        store_u32(b.data + 4, other);
        repair(&b);
        CHECK_INT(awt_snapshot_read_groom(b.data, b.size, &groom, &params, &error), AWT_OTHER_VERSION);
    }
    free(b.data);
    awt_forest_destroy(f);
}

TEST(a_snapshot_from_before_hair_had_colours_gives_its_groom)
{
    awt_forest *f = forest_under_way();
    bytes b = snapshot_of(f);
    awt_groom *groom;
    awt_params params;
    for (uint32_t k = 0; k < section_count(&b); k++) {
        unsigned char *entry = entry_at(&b, k);
        if (memcmp(entry, "LOOK", 4) == 0) {
            memcpy(entry, "GONE", 4);
        }
    }
    repair(&b);
    CHECK_INT(awt_snapshot_read_groom(b.data, b.size, &groom, &params, NULL), AWT_BAD_VALUE);
    store_u32(b.data + 8, 4);
    repair(&b);
    CHECK_INT(awt_snapshot_read_groom(b.data, b.size, &groom, &params, NULL), AWT_OK);
    CHECK_INT(groom->info.strand_count, FEW_STRANDS);
    awt_groom_destroy(groom);
    free(b.data);
    awt_forest_destroy(f);
}

/* ---- strangers' bytes -------------------------------------------------------------------------------------------- */

/* Tries the bytes; if they make a forest, it must live. False: refused, with words. */
static bool survives(const unsigned char *data, size_t size)
{
    unsigned char *exact = malloc(size ? size : 1); /* so that a sanitiser sees a step beyond the end */
    memcpy(exact, data, size);
    awt_groom *groom;
    awt_forest *f;
    awt_error error = {0};
    awt_status status = awt_snapshot_restore(exact, size, &groom, &f, &error);
    free(exact);
    if (status != AWT_OK) {
        CHECK(groom == NULL && f == NULL);
        CHECK_INT(error.status, status);
        CHECK(error.text[0] != '\0');
        return false;
    }
    float *centres = malloc((size_t)groom->info.finest_nodes * 3 * sizeof(float));
    float *frames = malloc((size_t)groom->info.finest_nodes * 4 * sizeof(float));
    float *scratch = malloc(awt_groom_strand_scratch(groom) * sizeof(float));
    float *points = malloc((size_t)groom->info.strand_count * groom->info.points_per_strand * 3 * sizeof(float));
    for (int n = 1; n <= 3; n++) {
        awt_forest_advance(f, awt_forest_time(f) + AWT_STEP_US, NULL, NULL);
    }
    awt_forest_hash(f);
    awt_forest_guides(f, centres, frames);
    awt_groom_strands(groom, centres, frames, scratch, points);
    free(centres), free(frames), free(scratch), free(points);
    awt_forest_destroy(f);
    awt_groom_destroy(groom);
    return true;
}

TEST(a_snapshot_cut_anywhere_is_refused)
{
    awt_forest *f = forest_under_way();
    bytes b = snapshot_of(f);
    for (size_t size = 0; size < b.size; size += 97) {
        CHECK(!survives(b.data, size));
    }
    CHECK(!survives(b.data, b.size - 1));
    b.data = realloc(b.data, b.size + 1);
    b.data[b.size] = 0;
    CHECK(!survives(b.data, b.size + 1));
    CHECK(survives(b.data, b.size));
    free(b.data);
    awt_forest_destroy(f);
}

TEST(a_snapshot_with_one_bit_changed_is_refused)
{
    awt_forest *f = forest_under_way();
    bytes b = snapshot_of(f);
    rng r = rng_seed(1);
    for (int n = 0; n < 200; n++) {
        size_t at = n < 100 ? rng_u32(&r) % 600 : rng_u32(&r) % b.size;
        unsigned char bit = (unsigned char)(1u << rng_u32(&r) % 8);
        b.data[at] ^= bit;
        CHECK(!survives(b.data, b.size));
        b.data[at] ^= bit;
    }
    free(b.data);
    awt_forest_destroy(f);
}

/* Checksums keep no stranger out: behind fitting ones, whatever is in range may come, and nothing may break. */
TEST(changed_snapshots_with_fitting_checksums_break_nothing)
{
    awt_forest *f = forest_under_way();
    bytes b = snapshot_of(f), changed = {malloc(b.size), b.size};
    rng r = rng_seed(2);
    int refused = 0, alive = 0;
    for (int n = 0; n < 250; n++) {
        memcpy(changed.data, b.data, b.size);
        for (uint32_t flips = 1 + rng_u32(&r) % 4; flips > 0; flips--) {
            const unsigned char *entry = entry_at(&b, rng_u32(&r) % section_count(&b));
            size_t at = (size_t)load_u64(entry + 8) + rng_u32(&r) % (size_t)load_u64(entry + 16);
            changed.data[at] ^= (unsigned char)(1u << rng_u32(&r) % 8);
        }
        repair(&changed);
        survives(changed.data, changed.size) ? alive++ : refused++;
    }
    CHECK(refused > 50 && alive > 25);
    for (int n = 0; n < 150; n++) { /* the table itself */
        memcpy(changed.data, b.data, b.size);
        size_t at = TABLE_AT - 4 + rng_u32(&r) % (ENTRY_SIZE * (size_t)section_count(&b) + 4);
        changed.data[at] ^= (unsigned char)(1u << rng_u32(&r) % 8);
        size_t table_end = TABLE_AT + ENTRY_SIZE * (size_t)(section_count(&changed) & 63);
        store_u32(changed.data + table_end, crc32c(changed.data, table_end));
        CHECK(!survives(changed.data, changed.size));
    }
    free(b.data), free(changed.data);
    awt_forest_destroy(f);
}

static uint32_t bits_of(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

TEST(a_snapshot_that_lies_is_refused_by_the_section_that_lies)
{
    awt_forest *f = forest_under_way();
    const awt_groom *g = f->groom;
    const size_t finest = groom_finest_first(g);
    bytes b = snapshot_of(f), lie = {malloc(b.size), b.size};
    const size_t waiting = section(&b, "MOTN").size; /* from its end: the last pose that waits */
    size_t split = 0;                                /* a tree that is */
    while (f->trees[split].count == g->info.sections) {
        split++;
    }
    const struct {
        const char *section;
        size_t at;
        uint32_t value;
        const char *said;
    } lies[] = {
        {"SIZE", 0, 0, "SIZE"},                               /* strands */
        {"SIZE", 0, 200001, "SIZE"},                          /* more than there may be */
        {"SIZE", 0, 0xffffffffu, "SIZE"},                     /* */
        {"SIZE", 0, 200000, "wrong size"},                    /* more than there are bytes for */
        {"SIZE", 4, 257, "SIZE"},                             /* points */
        {"SIZE", 8, 5, "SIZE"},                               /* levels */
        {"SIZE", 8, 0, "SIZE"},                               /* */
        {"SIZE", 12, 65, "SIZE"},                             /* sections */
        {"SIZE", 12, 1, "SIZE"},                              /* */
        {"SIZE", 16, g->info.wisp_count[1] + 1, "SIZE"},      /* fewer wisps below than above */
        {"MEAS", 0, bits_of(0.3f), "MEAS"},                   /* a mass unit that is no power of two */
        {"MEAS", 0, bits_of(0.0f), "MEAS"},                   /* */
        {"COLL", 0, 17, "obstacles"},                         /* how many */
        {"COLL", 8, 3, "COLL"},                               /* tied to a fourth frame */
        {"COLL", 12, bits_of(NAN), "obstacle"},               /* nowhere */
        {"GSUB", 0, 0, "GSUB"},                               /* a top wisp without sub-wisps */
        {"GSUB", 0, g->gc_count, "GSUB"},                     /* with everybody's */
        {"GSUB", finest * 4, 1, "GSUB"},                      /* a finest one with some */
        {"GSTR", 0, g->gc_strand_count[0] + 1, "GSUB"},       /* strands that its sub-wisps have not */
        {"GSTR", finest * 4, 150, "GSUB"},                    /* */
        {"GPOS", 0, bits_of(INFINITY), "GPOS"},               /* */
        {"GRAD", 4, bits_of(-1.0f), "GRAD"},                  /* */
        {"GFRM", 0, bits_of(1.5f), "GFRM"},                   /* no unit quaternion */
        {"GOFF", 4, bits_of(NAN), "GOFF"},                    /* */
        {"SPLT", 0, 0, "SPLT"},                               /* the root cross-section split */
        {"SPLT", 0, g->info.sections + 1, "SPLT"},            /* */
        {"SPLT", finest * 4, g->info.sections - 1, "SPLT"},   /* a finest wisp split */
        {"SPLT", g->level_first[1] * 4, 1, "SPLT"},           /* a sub-wisp split where its super-wisp is not */
        {"EVNT", 4, 0x7fffffffu, "EVNT"},                     /* in the future */
        {"NPOS", 0, bits_of(NAN), "NPOS"},                    /* */
        {"NVEL", 0, bits_of(1e7f), "NVEL"},                   /* */
        {"NAGI", 0, bits_of(-1.0f), "NAGI"},                  /* */
        {"NRAD", 0, bits_of(-1.0f), "NRAD"},                  /* */
        {"NFRM", 12, bits_of(NAN), "NFRM"},                   /* */
        {"MOTN", 4, 0x7fffffffu, "MOTN"},                     /* now, far from now */
        {"MOTN", 92, 0x7ff80000u, "MOTN"},                    /* the head's pose: no number */
        {"TREE", 0, g->info.wisp_count[0], "TREE"},           /* the next splits of a tree that is not there */
        {"TREE", 4 + split * 10, 1, "TREE"},                  /* asleep while split */
        {"TREE", 6, bits_of(-1.0f), "TREE"},                  /* */
        {"TREE", 10, bits_of(NAN), "TREE"},                   /* */
        {"MOTN", waiting - 3 * 112 - 5, 0x7fffffffu, "MOTN"}, /* a pose that waits for a time beyond time */
    };
    for (size_t k = 0; k < sizeof lies / sizeof lies[0]; k++) {
        memcpy(lie.data, b.data, b.size);
        bytes there = section(&lie, lies[k].section);
        CHECK(lies[k].at + 4 <= there.size);
        store_u32(there.data + lies[k].at, lies[k].value);
        repair(&lie);
        awt_groom *groom;
        awt_forest *forest;
        awt_error error = {0};
        CHECK(awt_snapshot_restore(lie.data, lie.size, &groom, &forest, &error) != AWT_OK);
        CHECK(groom == NULL && forest == NULL);
        if (!strstr(error.text, lies[k].said)) {
            CHECK_TEXT(error.text, lies[k].said);
            CHECK_INT(k, -1);
        }
    }
    free(b.data), free(lie.data);
    awt_forest_destroy(f);
}

TEST(crc32c_is_castagnolis)
{
    unsigned char block[32];
    CHECK_INT(crc32c("123456789", 9), 0xe3069283u);
    CHECK_INT(crc32c("", 0), 0);
    memset(block, 0, sizeof block);
    CHECK_INT(crc32c(block, sizeof block), 0x8a9136aau);
    memset(block, 0xff, sizeof block);
    CHECK_INT(crc32c(block, sizeof block), 0x62a8ab43u);
    for (int k = 0; k < 32; k++) {
        block[k] = (unsigned char)k;
    }
    CHECK_INT(crc32c(block, sizeof block), 0x46dd794eu);
}
