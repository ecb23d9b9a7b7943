/* read_tfx.c: the header of a TressFX file (.tfx), versions 3.0 and 4.0.
 *
 * There is no magic number: the file begins with its version as a float, and only those two values are taken. Of
 * the arrays only the positions are read, so only their offset must make sense. Of 3.0 the guides are read; its
 * follow hairs are not in the file. Source: DATA.md. */
#include "groom/formats.h"

#include "base/bytes.h"
#include "base/error.h"

#include <inttypes.h>

/* What differs between the versions. */
typedef struct tfx_version {
    const char *format;
    float version;
    uint32_t header;          /* bytes */
    uint32_t offset_at;       /* where the header says where the positions are */
    uint32_t bytes_per_point; /* 4.0: x y z and w, 0 for a pinned point */
} tfx_version;

static const tfx_version tfx_versions[] = {
    {"TressFX 3.0", 3.0f, 296, 144, 12},
    {"TressFX 4.0", 4.0f, 160, 12, 16},
};

static const tfx_version *tfx_version_find(const unsigned char *bytes, size_t size)
{
    for (size_t i = 0; size >= 4 && i < sizeof tfx_versions / sizeof tfx_versions[0]; i++) {
        if (load_f32(bytes) == tfx_versions[i].version) {
            return &tfx_versions[i];
        }
    }
    return NULL;
}

bool read_is_tfx(const unsigned char *bytes, size_t size)
{
    return tfx_version_find(bytes, size) != NULL;
}

static awt_status tfx_check_counts(const tfx_version *version, uint32_t strands, uint32_t points_per_strand,
                                   awt_error *error)
{
    if (points_per_strand > AWT_MAX_POINTS_PER_STRAND) {
        return error_set(error, AWT_LIMIT, "the %s file announces strands of %" PRIu32 " points; the limit is %d",
                         version->format, points_per_strand, AWT_MAX_POINTS_PER_STRAND);
    }
    return read_check_counts(version->format, strands, (uint64_t)strands * points_per_strand, error);
}

/* Do the positions lie behind the header, aligned, and inside the file? */
static awt_status tfx_check_positions(const tfx_version *version, uint32_t strands, uint32_t points_per_strand,
                                      uint32_t offset, size_t size, awt_error *error)
{
    uint64_t length = (uint64_t)strands * points_per_strand * version->bytes_per_point;
    if (offset < version->header || offset % 4 != 0) {
        return error_set(error, AWT_BAD_VALUE,
                         "the header puts the positions at offset %" PRIu32 ", which is %s (%s, header of %" PRIu32
                         " bytes)",
                         offset, offset < version->header ? "inside the header" : "not a multiple of 4",
                         version->format, version->header);
    }
    if (offset > size || length > size - offset) {
        return error_set(error, AWT_TRUNCATED,
                         "the header announces %" PRIu32 " strands of %" PRIu32 " points, %" PRIu64
                         " bytes at offset %" PRIu32 ", but the file has %zu",
                         strands, points_per_strand, length, offset, size);
    }
    return AWT_OK;
}

awt_status read_tfx(const unsigned char *bytes, size_t size, read_layout *out, awt_error *error)
{
    const tfx_version *version = tfx_version_find(bytes, size);
    if (!version) {
        return error_set(error, AWT_BAD_FORMAT, NULL);
    }
    if (size < version->header) {
        return error_set(error, AWT_TRUNCATED, "a %s header has %" PRIu32 " bytes, but the file has %zu",
                         version->format, version->header, size);
    }
    uint32_t strands = load_u32(bytes + 4), points_per_strand = load_u32(bytes + 8);
    uint32_t offset = load_u32(bytes + version->offset_at);
    awt_status status = tfx_check_counts(version, strands, points_per_strand, error);
    if (!status) {
        status = tfx_check_positions(version, strands, points_per_strand, offset, size, error);
    }
    if (status) {
        return status;
    }
    *out = (read_layout){.format = version->format,
                         .strand_count = strands,
                         .points_per_strand = points_per_strand,
                         .points = bytes + offset,
                         .point_stride = version->bytes_per_point};
    return AWT_OK;
}
