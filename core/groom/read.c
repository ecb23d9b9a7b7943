/* read.c: a strand file in any format awtd reads, to polylines.
 *
 * A format's reader checks the header and says where the points lie (formats.h). From there on all formats are one:
 * every coordinate is checked, strands without length are left out and counted, and only then is memory taken, for
 * exactly what is kept. Sources: DATA.md. */
#include "groom/formats.h"

#include "base/bytes.h"
#include "base/error.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static uint32_t strand_points(const read_layout *layout, uint32_t strand)
{
    return layout->segments ? load_u16(layout->segments + 2 * (size_t)strand) + 1u : layout->points_per_strand;
}

static void point_load(const read_layout *layout, size_t point, float out[3])
{
    const unsigned char *bytes = layout->points + point * layout->point_stride;
    for (size_t axis = 0; axis < 3; axis++) {
        out[axis] = load_f32(bytes + 4 * axis);
    }
}

/* Is every coordinate a number, and has the strand two points that differ? */
static awt_status strand_check(const read_layout *layout, uint32_t strand, size_t first, bool *usable, awt_error *error)
{
    float root[3], point[3];
    point_load(layout, first, root);
    *usable = false;
    for (uint32_t i = 0; i < strand_points(layout, strand); i++) {
        point_load(layout, first + i, point);
        if (!isfinite(point[0]) || !isfinite(point[1]) || !isfinite(point[2])) {
            return error_set(error, AWT_BAD_VALUE,
                             "strand %" PRIu32 ", point %" PRIu32
                             " (counted from 0): a coordinate is not a finite number",
                             strand, i);
        }
        *usable = *usable || point[0] != root[0] || point[1] != root[1] || point[2] != root[2];
    }
    return AWT_OK;
}

/* Checks every point and counts what is kept. */
static awt_status strands_count(const read_layout *layout, awt_strands *counts, awt_error *error)
{
    size_t first = 0;
    for (uint32_t strand = 0; strand < layout->strand_count; strand++) {
        bool usable;
        awt_status status = strand_check(layout, strand, first, &usable, error);
        if (status) {
            return status;
        }
        uint32_t points = strand_points(layout, strand);
        counts->strand_count += usable ? 1 : 0;
        counts->point_count += usable ? points : 0;
        counts->skipped_count += usable ? 0 : 1;
        first += points;
    }
    if (counts->strand_count == 0) {
        return error_set(error, AWT_NO_STRANDS, "none of the %" PRIu32 " strands of the %s file has any length",
                         layout->strand_count, layout->format);
    }
    return AWT_OK;
}

/* Copies what strands_count counted. */
static void strands_copy(const read_layout *layout, awt_strands *out)
{
    uint32_t kept = 0, used = 0;
    size_t first = 0;
    for (uint32_t strand = 0; strand < layout->strand_count; strand++) {
        bool usable;
        uint32_t points = strand_points(layout, strand);
        strand_check(layout, strand, first, &usable, NULL);
        if (usable) {
            out->file_strand[kept] = strand;
            out->first_point[kept++] = used;
            for (uint32_t i = 0; i < points; i++) {
                point_load(layout, first + i, out->positions + 3 * (size_t)used++);
            }
        }
        first += points;
    }
    out->first_point[kept] = used;
}

static awt_status layout_find(const unsigned char *bytes, size_t size, read_layout *out, awt_error *error)
{
    if (read_is_hair(bytes, size)) {
        return read_hair(bytes, size, out, error);
    }
    if (read_is_tfx(bytes, size)) {
        return read_tfx(bytes, size, out, error);
    }
    return error_set(error, AWT_BAD_FORMAT, NULL);
}

awt_status awt_strands_read(const void *bytes, size_t size, awt_strands *out, awt_error *error)
{
    read_layout layout;
    awt_strands strands = {0};
    awt_status status = layout_find(bytes, size, &layout, error);
    if (status) {
        return status;
    }
    status = strands_count(&layout, &strands, error);
    if (status) {
        return status;
    }
    strands.first_point = malloc(((size_t)strands.strand_count + 1) * sizeof *strands.first_point);
    strands.positions = malloc((size_t)strands.point_count * 3 * sizeof *strands.positions);
    strands.file_strand = malloc(strands.strand_count * sizeof *strands.file_strand);
    if (!strands.first_point || !strands.positions || !strands.file_strand) {
        awt_strands_fini(&strands);
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    strands_copy(&layout, &strands);
    memcpy(strands.colour, layout.colour, sizeof strands.colour);
    *out = strands;
    return AWT_OK;
}

void awt_strands_fini(awt_strands *strands)
{
    free(strands->first_point);
    free(strands->positions);
    free(strands->file_strand);
    *strands = (awt_strands){0};
}
