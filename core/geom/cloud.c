/* cloud.c: symbols to clouds (cloud.h). */
#include "geom/cloud.h"

#include "base/error.h"

#include <stdlib.h>
#include <string.h>

typedef struct cloud_lane {
    uint16_t *symbols;    /* [room] */
    uint32_t *counts;     /* [4][2^bits] */
    uint16_t *used;       /* [2^bits] */
    rans_entry *entries;  /* [2^bits] */
    unsigned char *bytes; /* [symbols_bound] */
    size_t size;          /* of the last run */
} cloud_lane;

struct cloud_writer {
    uint32_t alphabet;
    size_t held;
    cloud_lane lanes[RANS_LANES];
};

static void *hold(cloud_writer *writer, size_t size)
{
    writer->held += size;
    return malloc(size);
}

awt_status cloud_writer_create(size_t room, int bits, cloud_writer **out, awt_error *error)
{
    cloud_writer *writer = calloc(1, sizeof *writer);
    bool made = writer != NULL;
    if (writer) {
        writer->held = sizeof *writer;
        writer->alphabet = UINT32_C(1) << bits;
    }
    for (int k = 0; made && k < RANS_LANES; k++) {
        cloud_lane *lane = &writer->lanes[k];
        lane->symbols = hold(writer, room * sizeof *lane->symbols);
        lane->counts = hold(writer, 4 * writer->alphabet * sizeof *lane->counts);
        lane->used = hold(writer, writer->alphabet * sizeof *lane->used);
        lane->entries = hold(writer, writer->alphabet * sizeof *lane->entries);
        lane->bytes = hold(writer, symbols_bound(writer->alphabet, room));
        made = lane->symbols && lane->counts && lane->used && lane->entries && lane->bytes;
    }
    if (!made) {
        cloud_writer_destroy(writer);
        writer = NULL;
    }
    *out = writer;
    return made ? AWT_OK : error_set(error, AWT_NO_MEMORY, NULL);
}

void cloud_writer_destroy(cloud_writer *writer)
{
    for (int k = 0; writer && k < RANS_LANES; k++) {
        cloud_lane *lane = &writer->lanes[k];
        free(lane->symbols);
        free(lane->counts);
        free(lane->used);
        free(lane->entries);
        free(lane->bytes);
    }
    free(writer);
}

size_t cloud_writer_bytes(const cloud_writer *writer)
{
    return writer->held;
}

uint16_t *cloud_writer_symbols(cloud_writer *writer, int lane)
{
    return writer->lanes[lane].symbols;
}

void cloud_writer_run(cloud_writer *writer, cloud_job jobs[RANS_LANES], bool measure)
{
    symbols_run runs[RANS_LANES] = {{0}};
    for (int k = 0; k < RANS_LANES; k++) {
        const cloud_lane *lane = &writer->lanes[k];
        if (jobs[k].points > 0) {
            runs[k] = (symbols_run){.scheme = SYMBOLS_RAW,
                                    .symbols = lane->symbols,
                                    .count = (size_t)jobs[k].points * jobs[k].components,
                                    .alphabet = jobs[k].alphabet,
                                    .counts = lane->counts,
                                    .used = lane->used,
                                    .entries = lane->entries,
                                    .bytes = lane->bytes,
                                    .measure = measure};
        }
    }
    symbols_write(runs);
    for (int k = 0; k < RANS_LANES; k++) {
        writer->lanes[k].size = runs[k].size;
        jobs[k].size = CLOUD_HEAD_BYTES + runs[k].size;
        jobs[k].entropy_bits = runs[k].entropy_bits;
    }
}

void cloud_writer_put(const cloud_writer *writer, const cloud_job *job, int lane, unsigned char *out)
{
    cloud_head(job->points, job->components, out);
    memcpy(out + CLOUD_HEAD_BYTES, writer->lanes[lane].bytes, writer->lanes[lane].size);
}
