/* strandcheck.c: see strandcheck.h. */
#include "strandcheck.h"

#include "base/error.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static double point_distance(const float *a, const float *b)
{
    double x = (double)b[0] - (double)a[0], y = (double)b[1] - (double)a[1], z = (double)b[2] - (double)a[2];
    return sqrt(x * x + y * y + z * z);
}

static double strand_length(const geom_strands *strands, uint32_t strand)
{
    const float *p = strands->positions + (size_t)strand * strands->points_per_strand * 3;
    double length = 0;
    for (uint32_t i = 0; i + 1 < strands->points_per_strand; i++) {
        length += point_distance(p + 3 * (size_t)i, p + 3 * (size_t)i + 3);
    }
    return length;
}

static const float *strand_root(const geom_strands *strands, uint32_t strand)
{
    return strands->positions + (size_t)strand * strands->points_per_strand * 3;
}

static awt_status check_finite(const geom_strands *strands, awt_error *error)
{
    size_t count = (size_t)strands->strand_count * strands->points_per_strand * 3;
    for (size_t i = 0; i < count; i++) {
        if (!isfinite(strands->positions[i])) {
            return error_set(error, AWT_BAD_VALUE, "point %zu of the frame is not finite", i / 3);
        }
    }
    return AWT_OK;
}

static awt_status keep_first(strandcheck *check, strandcheck_first *first, const geom_strands *strands,
                             awt_error *error)
{
    first->strand_count = strands->strand_count;
    first->points_per_strand = strands->points_per_strand;
    first->roots = malloc((size_t)strands->strand_count * 3 * sizeof(float));
    first->lengths = malloc((size_t)strands->strand_count * sizeof(float));
    check->bins = check->bins ? check->bins : calloc(STRANDCHECK_BINS, sizeof *check->bins);
    if (!first->roots || !first->lengths || !check->bins) {
        strandcheck_fini(check);
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    for (uint32_t s = 0; s < strands->strand_count; s++) {
        memcpy(first->roots + 3 * (size_t)s, strand_root(strands, s), 3 * sizeof(float));
        first->lengths[s] = (float)strand_length(strands, s);
    }
    return AWT_OK;
}

static void check_strand(strandcheck *check, const strandcheck_first *first, const geom_strands *strands, uint32_t s)
{
    double length = (double)first->lengths[s];
    double percent = length > 0 ? fabs(strand_length(strands, s) / length - 1) * 100 : 0;
    double root = point_distance(first->roots + 3 * (size_t)s, strand_root(strands, s));
    size_t bin = percent < 100 ? (size_t)(percent * 100) : STRANDCHECK_BINS - 1;
    check->bins[bin]++;
    check->measured++;
    check->greatest_percent = fmax(check->greatest_percent, percent);
    check->greatest_root_m = fmax(check->greatest_root_m, root);
}

awt_status strandcheck_add(strandcheck *check, const geom_strands *strands, awt_error *error)
{
    awt_status status = check_finite(strands, error);
    if (status != AWT_OK) {
        return status;
    }
    strandcheck_first *first = &check->first[strands->level];
    if (!first->roots) {
        return keep_first(check, first, strands, error);
    }
    if (strands->strand_count != first->strand_count || strands->points_per_strand != first->points_per_strand) {
        return error_set(error, AWT_BAD_VALUE, "the frame has %u strands of %u points, the first one had %u of %u",
                         strands->strand_count, strands->points_per_strand, first->strand_count,
                         first->points_per_strand);
    }
    for (uint32_t s = 0; s < strands->strand_count; s++) {
        check_strand(check, first, strands, s);
    }
    check->frames++;
    return AWT_OK;
}

double strandcheck_percent(const strandcheck *check, double share)
{
    uint64_t below = 0;
    for (size_t bin = 0; bin < STRANDCHECK_BINS && check->measured > 0; bin++) {
        below += check->bins[bin];
        if ((double)below >= share * (double)check->measured) {
            return fmin((double)(bin + 1) / 100, check->greatest_percent);
        }
    }
    return check->greatest_percent;
}

void strandcheck_fini(strandcheck *check)
{
    for (int level = 0; level < STRANDCHECK_LEVELS; level++) {
        free(check->first[level].roots);
        free(check->first[level].lengths);
    }
    free(check->bins);
    *check = (strandcheck){0};
}
