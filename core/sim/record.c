/* record.c: the inputs of a forest written down as they come, and run again.
 *
 * magic "AWTR", u32 format version, u64 size of the snapshot of the start, the snapshot; then records: u8 operation,
 * u32 size, payload, CRC32C of all three. RECORD_OPS is the one list of operations: from it come their numbers, the
 * writer and the reader; each has one walk over its payload that serves both. */
#include "awt.h"

#include "base/assert.h"
#include "base/codec.h"
#include "base/crc32c.h"
#include "base/error.h"
#include "sim/snapshot.h"

#include <stdlib.h>

enum { RECORD_FORMAT = 1, RECORDING_HEADER = 16, RECORD_HEADER = 5, RECORD_CRC = 4, RECORD_SIZE_MOST = 8192 };

static const unsigned char recording_magic[4] = {'A', 'W', 'T', 'R'};

typedef struct record_advance {
    int64_t time_us;
    uint64_t hash; /* of the state then */
} record_advance;

typedef struct record_skip {
    int64_t time_us;
} record_skip;

/* Operation, its number in the file, its payload. */
#define RECORD_OPS(X)             \
    X(move, 1, awt_motion)        \
    X(params, 2, awt_params)      \
    X(advance, 3, record_advance) \
    X(skip, 4, record_skip)

struct awt_replay {
    codec from; /* the records */
    awt_groom *groom;
    awt_forest *forest;
    uint64_t steps;
};

/* ---- payloads: one walk each, for writing and reading ------------------------------------------------------------ */

static void walk_pose(codec *c, awt_pose *pose)
{
    for (int k = 0; k < 3; k++) {
        codec_f64(c, &pose->position[k]);
    }
    for (int k = 0; k < 4; k++) {
        codec_f64(c, &pose->orientation[k]);
    }
}

static awt_status walk_move(codec *c, awt_motion *motion, awt_error *error)
{
    codec_i64(c, &motion->time_us);
    codec_bool(c, &motion->teleport);
    walk_pose(c, &motion->head);
    walk_pose(c, &motion->body);
    codec_u32(c, &motion->collider_count);
    if (motion->collider_count > AWT_MAX_COLLIDERS) {
        return error_set(error, AWT_LIMIT, "a record has %lu obstacle poses; %d are the most",
                         (unsigned long)motion->collider_count, AWT_MAX_COLLIDERS);
    }
    for (uint32_t k = 0; k < motion->collider_count; k++) {
        codec_u32(c, &motion->colliders[k].id);
        walk_pose(c, &motion->colliders[k].pose);
    }
    return AWT_OK;
}

static awt_status walk_params(codec *c, awt_params *params, awt_error *error)
{
    if (c->in) {
        return snapshot_read_params(c, false, params, error);
    }
    snapshot_write_params(c, params);
    return AWT_OK;
}

static awt_status walk_advance(codec *c, record_advance *advance, awt_error *error)
{
    (void)error;
    codec_i64(c, &advance->time_us);
    codec_u64(c, &advance->hash);
    return AWT_OK;
}

static awt_status walk_skip(codec *c, record_skip *skip, awt_error *error)
{
    (void)error;
    codec_i64(c, &skip->time_us);
    return AWT_OK;
}

/* ---- recording -------------------------------------------------------------------------------------------------- */

/* Puts head and checksum about the payload that `c` has written behind RECORD_HEADER bytes, and sends it. */
static void record_send(const awt_recorder *recorder, codec *c, unsigned char op)
{
    ASSERT(!c->spent);
    c->out[0] = op;
    store_u32(c->out + 1, (uint32_t)(c->at - RECORD_HEADER));
    store_u32(c->out + c->at, crc32c(c->out, c->at));
    recorder->write(recorder->context, c->out, c->at + RECORD_CRC);
}

#define RECORD_WRITER(op, number, type)                                       \
    static void write_##op(const awt_recorder *recorder, const type *payload) \
    {                                                                         \
        unsigned char bytes[RECORD_SIZE_MOST + RECORD_CRC];                   \
        codec c = codec_writing(bytes, RECORD_SIZE_MOST);                     \
        type copy = *payload;                                                 \
        c.at = RECORD_HEADER;                                                 \
        walk_##op(&c, &copy, NULL);                                           \
        record_send(recorder, &c, number);                                    \
    }
RECORD_OPS(RECORD_WRITER)
#undef RECORD_WRITER

awt_status awt_recorder_begin(awt_recorder *recorder, awt_error *error)
{
    size_t size = 0;
    awt_status status = awt_forest_snapshot(recorder->forest, NULL, 0, &size, error);
    if (status != AWT_OK) {
        return status;
    }
    unsigned char *bytes = malloc(RECORDING_HEADER + size);
    if (!bytes) {
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    memcpy(bytes, recording_magic, sizeof recording_magic);
    store_u32(bytes + 4, RECORD_FORMAT);
    store_u64(bytes + 8, size);
    status = awt_forest_snapshot(recorder->forest, bytes + RECORDING_HEADER, size, &size, error);
    if (status == AWT_OK) {
        recorder->write(recorder->context, bytes, RECORDING_HEADER + size);
    }
    free(bytes);
    return status;
}

awt_status awt_recorder_move(awt_recorder *recorder, const awt_motion *motion, awt_error *error)
{
    awt_status status = awt_forest_move(recorder->forest, motion, error);
    if (status == AWT_OK) {
        write_move(recorder, motion);
    }
    return status;
}

awt_status awt_recorder_set_params(awt_recorder *recorder, const awt_params *params, awt_error *error)
{
    awt_status status = awt_forest_set_params(recorder->forest, params, error);
    if (status == AWT_OK) {
        write_params(recorder, params);
    }
    return status;
}

awt_status awt_recorder_advance(awt_recorder *recorder, int64_t time_us, awt_step_stats *stats, awt_error *error)
{
    awt_status status = awt_forest_advance(recorder->forest, time_us, stats, error);
    if (status == AWT_OK) {
        record_advance advance = {time_us, awt_forest_hash(recorder->forest)};
        write_advance(recorder, &advance);
    }
    return status;
}

awt_status awt_recorder_skip(awt_recorder *recorder, int64_t time_us, awt_error *error)
{
    awt_status status = awt_forest_skip(recorder->forest, time_us, error);
    if (status == AWT_OK) {
        write_skip(recorder, &(record_skip){time_us});
    }
    return status;
}

/* ---- replaying -------------------------------------------------------------------------------------------------- */

static awt_status replay_move(awt_replay *replay, const awt_motion *motion, awt_error *error)
{
    return awt_forest_move(replay->forest, motion, error);
}

static awt_status replay_params(awt_replay *replay, const awt_params *params, awt_error *error)
{
    return awt_forest_set_params(replay->forest, params, error);
}

static awt_status replay_advance(awt_replay *replay, const record_advance *advance, awt_error *error)
{
    awt_status status = awt_forest_advance(replay->forest, advance->time_us, NULL, error);
    if (status != AWT_OK) {
        return status;
    }
    if (awt_forest_hash(replay->forest) != advance->hash) {
        return error_set(error, AWT_BAD_VALUE,
                         "step %llu, to %.6f s, gives another state than the recording (hash %016llx, not %016llx)",
                         (unsigned long long)replay->steps + 1, (double)advance->time_us * 1e-6,
                         (unsigned long long)awt_forest_hash(replay->forest), (unsigned long long)advance->hash);
    }
    replay->steps++;
    return AWT_OK;
}

static awt_status replay_skip(awt_replay *replay, const record_skip *skip, awt_error *error)
{
    return awt_forest_skip(replay->forest, skip->time_us, error);
}

static awt_status replay_damaged(const awt_replay *replay, awt_error *error)
{
    return error_set(error, AWT_BAD_VALUE, "a record after step %llu of the recording is damaged",
                     (unsigned long long)replay->steps);
}

#define REPLAY_READER(op, number, type)                                                                        \
    static awt_status run_##op(awt_replay *replay, codec *payload, awt_error *error)                           \
    {                                                                                                          \
        type value = {0};                                                                                      \
        awt_status status = walk_##op(payload, &value, error);                                                 \
        if (status == AWT_OK) {                                                                                \
            status = codec_ends(payload) ? replay_##op(replay, &value, error) : replay_damaged(replay, error); \
        }                                                                                                      \
        return status;                                                                                         \
    }
RECORD_OPS(REPLAY_READER)
#undef REPLAY_READER

/* Finds the next record whole and undamaged. */
static awt_status replay_take(awt_replay *replay, unsigned char *op, codec *payload, awt_error *error)
{
    codec *from = &replay->from;
    const unsigned char *record = from->in + from->at;
    size_t left = from->size - from->at, size = RECORD_HEADER;
    if (left >= RECORD_HEADER) {
        if (load_u32(record + 1) > RECORD_SIZE_MOST) {
            return replay_damaged(replay, error);
        }
        size += load_u32(record + 1);
    }
    if (left < size + RECORD_CRC) {
        return error_set(error, AWT_TRUNCATED, "the recording ends within a record, after step %llu",
                         (unsigned long long)replay->steps);
    }
    if (load_u32(record + size) != crc32c(record, size)) {
        return replay_damaged(replay, error);
    }
    *op = record[0];
    *payload = codec_reading(record + RECORD_HEADER, size - RECORD_HEADER);
    from->at += size + RECORD_CRC;
    return AWT_OK;
}

static awt_status replay_run(awt_replay *replay, unsigned char op, codec *payload, awt_error *error)
{
    switch (op) {
#define REPLAY_CASE(name, number, type) \
    case number:                        \
        return run_##name(replay, payload, error);
        RECORD_OPS(REPLAY_CASE)
#undef REPLAY_CASE
    default:
        return error_set(error, AWT_OTHER_VERSION, "the recording has an operation %d that this program has not", op);
    }
}

awt_status awt_replay_next(awt_replay *replay, bool *more, awt_error *error)
{
    const uint64_t before = replay->steps;
    while (replay->steps == before) {
        unsigned char op = 0;
        codec payload;
        *more = replay->from.at < replay->from.size;
        if (!*more) {
            return AWT_OK;
        }
        awt_status status = replay_take(replay, &op, &payload, error);
        if (status == AWT_OK) {
            status = replay_run(replay, op, &payload, error);
        }
        if (status != AWT_OK) {
            return status;
        }
    }
    return AWT_OK;
}

static awt_status check_header(const unsigned char *bytes, size_t size, awt_error *error)
{
    if (size < sizeof recording_magic || memcmp(bytes, recording_magic, sizeof recording_magic) != 0) {
        return error_set(error, AWT_BAD_FORMAT, "this is not a recording");
    }
    if (size < RECORDING_HEADER || load_u64(bytes + 8) > size - RECORDING_HEADER) {
        return error_set(error, AWT_TRUNCATED, "the recording ends before its first step");
    }
    if (load_u32(bytes + 4) != RECORD_FORMAT) {
        return error_set(error, AWT_OTHER_VERSION, "a recording of format %lu; this program reads format %d",
                         (unsigned long)load_u32(bytes + 4), RECORD_FORMAT);
    }
    return AWT_OK;
}

awt_status awt_replay_create(const void *bytes, size_t size, awt_replay **out, awt_error *error)
{
    *out = NULL;
    awt_status status = check_header(bytes, size, error);
    if (status != AWT_OK) {
        return status;
    }
    awt_replay *replay = calloc(1, sizeof *replay);
    if (!replay) {
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    replay->from = codec_reading(bytes, size);
    const size_t snapshot = (size_t)load_u64(replay->from.in + 8);
    replay->from.at = RECORDING_HEADER + snapshot;
    status = awt_snapshot_restore(replay->from.in + RECORDING_HEADER, snapshot, &replay->groom, &replay->forest, error);
    if (status != AWT_OK) {
        awt_replay_destroy(replay);
        return status;
    }
    *out = replay;
    return AWT_OK;
}

const awt_forest *awt_replay_forest(const awt_replay *replay)
{
    return replay->forest;
}

uint64_t awt_replay_steps(const awt_replay *replay)
{
    return replay->steps;
}

void awt_replay_destroy(awt_replay *replay)
{
    if (replay) {
        awt_forest_destroy(replay->forest);
        awt_groom_destroy(replay->groom);
        free(replay);
    }
}
