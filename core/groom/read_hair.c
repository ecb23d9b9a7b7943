/* read_hair.c: the header of a cyHair file (.hair): 128 bytes, then the arrays its bits announce, in their order.
 *
 * The points array is required; without a segments array every strand has the default number of segments. A strand
 * has one point more than segments, and they must add up to the points announced. Source: DATA.md. */
#include "groom/formats.h"

#include "base/bytes.h"
#include "base/error.h"

#include <inttypes.h>
#include <string.h>

enum {
    HAIR_HEADER = 128,
    HAIR_COLOUR = 28, /* offset of the header's colour, f32[3] */
    HAIR_SEGMENTS = 1u << 0,
    HAIR_POINTS = 1u << 1,
    HAIR_THICKNESS = 1u << 2,
    HAIR_TRANSPARENCY = 1u << 3,
    HAIR_COLOURS = 1u << 4
};

static const char hair_format[] = "cyHair";

typedef struct hair_header {
    uint32_t strands, points, arrays, segments;
} hair_header;

bool read_is_hair(const unsigned char *bytes, size_t size)
{
    return size >= 4 && memcmp(bytes, "HAIR", 4) == 0;
}

/* Bytes of the whole file as its header announces it. Counts are within the limits: this cannot overflow. */
static uint64_t hair_announced_size(const hair_header *header)
{
    uint64_t bytes_per_point = (header->arrays & HAIR_POINTS ? 12u : 0) + (header->arrays & HAIR_THICKNESS ? 4u : 0) +
                               (header->arrays & HAIR_TRANSPARENCY ? 4u : 0) +
                               (header->arrays & HAIR_COLOURS ? 12u : 0);
    uint64_t bytes_per_strand = header->arrays & HAIR_SEGMENTS ? 2 : 0;
    return HAIR_HEADER + bytes_per_strand * header->strands + bytes_per_point * header->points;
}

static awt_status hair_check_header(const hair_header *header, size_t size, awt_error *error)
{
    if (!(header->arrays & HAIR_POINTS)) {
        return error_set(error, AWT_BAD_FORMAT, "the cyHair file has no points array");
    }
    awt_status status = read_check_counts(hair_format, header->strands, header->points, error);
    if (status) {
        return status;
    }
    uint64_t announced = hair_announced_size(header);
    if (announced > size) {
        return error_set(error, AWT_TRUNCATED,
                         "the header announces %" PRIu32 " strands and %" PRIu32 " points, %" PRIu64
                         " bytes in all, but the file has %zu",
                         header->strands, header->points, announced, size);
    }
    return AWT_OK;
}

/* What a screen shows for that share of its light. (The usual polynomial, for pow gives other bits elsewhere.) */
static float colour_to_linear(double shown)
{
    return (float)(shown * (shown * (shown * 0.305306011 + 0.682171111) + 0.012522878));
}

/* The colours of all points together, or the header's; nothing where one is not a colour. */
static void hair_take_colour(const hair_header *header, const unsigned char *bytes, float *out)
{
    const unsigned char *colours = bytes + HAIR_COLOUR;
    uint32_t count = 1;
    if (header->arrays & HAIR_COLOURS) {
        colours = bytes + hair_announced_size(header) - 12 * (size_t)header->points;
        count = header->points;
    }
    double sum[3] = {0};
    for (uint32_t i = 0; i < count; i++) {
        for (size_t k = 0; k < 3; k++) {
            const float part = load_f32(colours + 12 * (size_t)i + 4 * k);
            if (!(part >= 0 && part <= 1)) {
                return;
            }
            sum[k] += (double)part;
        }
    }
    for (int k = 0; k < 3; k++) {
        out[k] = colour_to_linear(sum[k] / count);
    }
}

/* Every strand within the limit, and all of them together as many points as the header says. */
static awt_status hair_check_segments(const hair_header *header, const unsigned char *segments, awt_error *error)
{
    uint64_t sum = 0;
    for (uint32_t strand = 0; strand < header->strands; strand++) {
        uint64_t points = (segments ? load_u16(segments + 2 * (size_t)strand) : header->segments) + UINT64_C(1);
        if (points > AWT_MAX_POINTS_PER_STRAND) {
            return error_set(error, AWT_LIMIT,
                             "strand %" PRIu32 " (counted from 0) has %" PRIu64 " points; the limit is %d", strand,
                             points, AWT_MAX_POINTS_PER_STRAND);
        }
        sum += points;
    }
    if (sum != header->points) {
        return error_set(error, AWT_BAD_VALUE,
                         "the segments of the %" PRIu32 " strands make %" PRIu64
                         " points, but the header announces %" PRIu32,
                         header->strands, sum, header->points);
    }
    return AWT_OK;
}

awt_status read_hair(const unsigned char *bytes, size_t size, read_layout *out, awt_error *error)
{
    if (size < HAIR_HEADER) {
        return error_set(error, AWT_TRUNCATED, "a cyHair header has %d bytes, but the file has %zu", HAIR_HEADER, size);
    }
    hair_header header = {load_u32(bytes + 4), load_u32(bytes + 8), load_u32(bytes + 12), load_u32(bytes + 16)};
    awt_status status = hair_check_header(&header, size, error);
    if (status) {
        return status;
    }
    bool has_segments = header.arrays & HAIR_SEGMENTS;
    const unsigned char *segments = has_segments ? bytes + HAIR_HEADER : NULL;
    status = hair_check_segments(&header, segments, error);
    if (status) {
        return status;
    }
    *out = (read_layout){.format = hair_format,
                         .strand_count = header.strands,
                         .points_per_strand = has_segments ? 0 : header.segments + 1,
                         .segments = segments,
                         .points = bytes + HAIR_HEADER + (has_segments ? 2 * (size_t)header.strands : 0),
                         .point_stride = 12};
    hair_take_colour(&header, bytes, out->colour);
    return AWT_OK;
}
