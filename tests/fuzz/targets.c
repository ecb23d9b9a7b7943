/* targets.c: see fuzz.h. */
#include "fuzz/fuzz.h"

#include "awt.h"
#include "base/assert.h"
#include "base/bytes.h"
#include "base/crc32c.h"
#include "geom/json.h"
#include "geom/read.h"
#include "motion/motion.h"
#include "proto.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Work, not memory, bounds what is worth doing with an input that was accepted. */
enum { MOST_POINTS = 4096, STEPS = 3, MOST_MESSAGE = 1 << 16 };

static void strands_run(const uint8_t *bytes, size_t size)
{
    awt_strands strands;
    if (awt_strands_read(bytes, size, &strands, NULL) != AWT_OK) {
        return;
    }
    awt_placement placement = {.scale = 0};
    awt_groom *groom = NULL;
    if (strands.point_count <= MOST_POINTS && awt_strands_place(&strands, &placement, NULL) == AWT_OK) {
        awt_groom_def def = awt_groom_def_default();
        def.head_radius_m = placement.head_radius_m;
        awt_groom_build(&strands, &def, NULL, NULL, &groom, NULL);
    }
    if (groom) {
        awt_forest_def def = awt_forest_def_default(groom);
        awt_forest *forest = NULL;
        awt_step_stats stats = {0};
        if (awt_forest_create(groom, &def, &forest, NULL) == AWT_OK) {
            ASSERT(awt_forest_advance(forest, STEPS * AWT_STEP_US, &stats, NULL) == AWT_OK);
            ASSERT(isfinite(stats.kinetic_energy_j));
        }
        awt_forest_destroy(forest);
    }
    awt_groom_destroy(groom);
    awt_strands_fini(&strands);
}

static void hierarchy_run(const uint8_t *bytes, size_t size)
{
    awt_hierarchy hierarchy;
    if (awt_hierarchy_read(bytes, size, &hierarchy, NULL) == AWT_OK) {
        ASSERT(hierarchy.levels >= 1 && hierarchy.levels <= AWT_MAX_LEVELS);
        awt_hierarchy_fini(&hierarchy);
    }
}

static void motion_run(const uint8_t *bytes, size_t size)
{
    const motion_options as_guessed = {.up = AWT_UP_GUESS};
    motion m = {0};
    if (motion_read(bytes, size, &as_guessed, &m, NULL) != AWT_OK) {
        return;
    }
    const int64_t end_us = m.samples[m.sample_count - 1].time_us;
    for (int64_t k = -1; k <= 5; k++) {
        motion_sample at = motion_at(&m, end_us / 4 * k);
        for (int i = 0; i < 4; i++) {
            ASSERT(isfinite(at.head.orientation[i]) && isfinite(at.body.orientation[i]));
            ASSERT(i == 3 || (isfinite(at.head.position[i]) && isfinite(at.body.position[i])));
        }
    }
    motion_fini(&m);
}

/* One whole message, header included; what is understood is written again, to the same bytes. */
static void message_run(const uint8_t *bytes, size_t size)
{
    if (size < PROTO_HEADER_SIZE || size > MOST_MESSAGE) {
        return;
    }
    proto_header header = proto_header_read(bytes);
    header.length = (uint32_t)(size - PROTO_HEADER_SIZE);
    static proto_message message;
    static unsigned char again[2 * MOST_MESSAGE];
    if (proto_decode(&header, bytes + PROTO_HEADER_SIZE, &message, NULL) != 0) {
        return;
    }
    if (header.type == PROTO_HELLO) {
        ASSERT(proto_encoded_size(&message) <= size); /* a later version's HELLO goes on behind what is known */
    } else {
        ASSERT(proto_encode(&message, again, sizeof again) == size);
        ASSERT(memcmp(again + PROTO_HEADER_SIZE, bytes + PROTO_HEADER_SIZE, size - PROTO_HEADER_SIZE) == 0);
    }
}

/* A snapshot's checksums set right, as a liar would (sections.h), so that what is behind them is reached. */
static void mend_sums(unsigned char *bytes, size_t size)
{
    enum { HEADER = 16, ENTRY = 24 };
    uint32_t count = size >= HEADER ? load_u32(bytes + 12) : UINT32_MAX;
    size_t table = HEADER + ENTRY * (size_t)(count <= 64 ? count : 0);
    if (count > 64 || size < table + 4) {
        return;
    }
    for (unsigned char *entry = bytes + HEADER; entry < bytes + table; entry += ENTRY) {
        uint64_t offset = load_u64(entry + 8), length = load_u64(entry + 16);
        if (offset <= size && length <= size - offset) {
            store_u32(entry + 4, crc32c(bytes + offset, (size_t)length));
        }
    }
    store_u32(bytes + table, crc32c(bytes, table));
}

static void snapshot_run(const uint8_t *bytes, size_t size)
{
    unsigned char *mended = malloc(size + 1);
    awt_groom *groom = NULL;
    awt_forest *forest = NULL;
    ASSERT(mended);
    memcpy(mended, bytes, size);
    mend_sums(mended, size);
    if (awt_snapshot_restore(mended, size, &groom, &forest, NULL) == AWT_OK) {
        int64_t time_us = awt_forest_time(forest);
        if (time_us <= AWT_MAX_TIME_US - STEPS * AWT_STEP_US) {
            awt_forest_advance(forest, time_us + STEPS * AWT_STEP_US, NULL, NULL);
        }
        awt_forest_hash(forest);
        awt_forest_destroy(forest);
        awt_groom_destroy(groom);
    }
    free(mended);
}

static void frame_run(const uint8_t *bytes, size_t size)
{
    geom_strands strands;
    if (geom_read_frame(bytes, size, &strands, NULL) == AWT_OK) {
        for (size_t i = 0; i < 3 * (size_t)strands.strand_count * strands.points_per_strand; i++) {
            ASSERT(isfinite(strands.positions[i]));
        }
        geom_strands_fini(&strands);
    }
}

static void json_run(const uint8_t *bytes, size_t size)
{
    json_document json;
    if (json_read((const char *)bytes, size, &json, NULL) == AWT_OK) {
        double value;
        for (uint32_t i = 0; i < json.count; i++) {
            ASSERT(json.tokens[i].after > i && json.tokens[i].after <= json.count);
            ASSERT(!json_real(&json, i, &value) || isfinite(value));
        }
        json_fini(&json);
    }
}

const fuzz_target fuzz_targets[FUZZ_TARGETS] = {
    {"strands", strands_run, fuzz_seed_strands},
    {"hierarchy", hierarchy_run, fuzz_seed_hierarchy},
    {"motion", motion_run, fuzz_seed_motion},
    {"message", message_run, fuzz_seed_message},
    {"snapshot", snapshot_run, fuzz_seed_snapshot},
    {"frame", frame_run, fuzz_seed_frame},
    {"json", json_run, fuzz_seed_json},
    {"delta", fuzz_run_delta, fuzz_seed_delta},
    {"session", fuzz_run_session, fuzz_seed_session},
};
