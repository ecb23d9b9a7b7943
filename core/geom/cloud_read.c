/* cloud_read.c: clouds back to symbols (cloud.h): standard C alone. */
#include "geom/cloud.h"

#include "base/bytes.h"

#include <string.h>

void cloud_head(uint32_t points, uint32_t components, unsigned char head[CLOUD_HEAD_BYTES])
{
    static const unsigned char before[11] = {'D', 'R', 'A', 'C', 'O', 2, 3, 0, 0, 0, 0};
    const unsigned char after[10] = {1, 1, 4, 3, (unsigned char)components, 0, 0, 1, 0xfe, 1};
    memcpy(head, before, sizeof before);
    store_u32(head + sizeof before, points);
    memcpy(head + sizeof before + 4, after, sizeof after);
}

static bool open_cloud(const cloud_source *source, uint32_t components, int bits, symbols_tables *tables,
                       rans_source *out)
{
    const unsigned char *at = source->bytes, *end = at + source->size;
    unsigned char head[CLOUD_HEAD_BYTES];
    cloud_head(source->points, components, head);
    if (source->size < sizeof head || memcmp(at, head, sizeof head) != 0) {
        return false;
    }
    at += sizeof head;
    return symbols_open(&at, end, UINT32_C(1) << bits, tables, out) && at == end;
}

bool cloud_read(cloud_reader *reader, const cloud_source sources[RANS_LANES], uint32_t components, int bits)
{
    rans_target targets[RANS_LANES] = {{.count = 0}};
    for (int k = 0; k < RANS_LANES; k++) {
        if (sources[k].points > 0) {
            targets[k].symbols = reader->symbols[k];
            targets[k].count = (size_t)sources[k].points * components;
            if (!open_cloud(&sources[k], components, bits, &reader->tables[k], &targets[k].source)) {
                return false;
            }
        }
    }
    return rans_decode_lanes(targets);
}
