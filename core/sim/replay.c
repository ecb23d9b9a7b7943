/* replay.c: a recording (record_ops.h) run again, each step compared with what the forest was then. */
#include "base/crc32c.h"
#include "base/error.h"
#include "sim/record_ops.h"

#include <stdlib.h>

struct awt_replay {
    codec from; /* the records */
    awt_groom *groom;
    awt_forest *forest;
    uint64_t steps;
};

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
        awt_status status = record_walk_##op(payload, &value, error);                                          \
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
    if (size < sizeof RECORDING_MAGIC || memcmp(bytes, RECORDING_MAGIC, sizeof RECORDING_MAGIC) != 0) {
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
