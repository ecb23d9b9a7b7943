/* formats.c: what holds for every strand file. */
#include "groom/formats.h"

#include "base/error.h"

#include <inttypes.h>

awt_status read_check_counts(const char *format, uint32_t strands, uint64_t points, awt_error *error)
{
    if (strands == 0 || points == 0) {
        return error_set(error, AWT_NO_STRANDS, "the %s file announces %" PRIu32 " strands and %" PRIu64 " points",
                         format, strands, points);
    }
    if (strands > AWT_MAX_STRANDS) {
        return error_set(error, AWT_LIMIT, "the %s file announces %" PRIu32 " strands; the limit is %d", format,
                         strands, AWT_MAX_STRANDS);
    }
    if (points > AWT_MAX_POINTS) {
        return error_set(error, AWT_LIMIT, "the %s file announces %" PRIu64 " points; the limit is %d", format, points,
                         AWT_MAX_POINTS);
    }
    return AWT_OK;
}
