/* record.c: the inputs of a forest written down as they come (record_ops.h says how); replay.c runs them again. */
#include "awt.h"

#include "base/assert.h"
#include "base/crc32c.h"
#include "base/error.h"
#include "sim/record_ops.h"

#include <stdlib.h>

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
        record_walk_##op(&c, &copy, NULL);                                    \
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
    memcpy(bytes, RECORDING_MAGIC, sizeof RECORDING_MAGIC);
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
