/* modelled.c: see modelled.h. A wisp is known by the first of its strands; sorted by these, level by level, strands
 * come in the groom's order. No two keys are alike, so every sort gives the same. */
#include "groom/modelled.h"

#include "base/error.h"

#include <stdlib.h>

/* One strand's row of one level. */
typedef struct wisp_row {
    uint32_t wisp, strand;
} wisp_row;

static uint32_t file_strand(const awt_strands *strands, uint32_t strand)
{
    return strands->file_strand ? strands->file_strand[strand] : strand;
}

static uint32_t wisp_of(const awt_strands *strands, const awt_hierarchy *hierarchy, uint32_t strand, uint32_t level)
{
    return hierarchy->wisps[(size_t)file_strand(strands, strand) * hierarchy->levels + level];
}

/* Is there a row for every strand? */
static awt_status check_rows(const awt_strands *strands, const awt_hierarchy *hierarchy, awt_error *error)
{
    uint64_t in_file = (uint64_t)strands->strand_count + strands->skipped_count;
    if (in_file != hierarchy->strand_count) {
        return error_set(error, AWT_BAD_VALUE, "the hierarchy is of %lu strands, but there are %lu%s",
                         (unsigned long)hierarchy->strand_count, (unsigned long)in_file,
                         strands->skipped_count ? ", counting those that are left out" : "");
    }
    for (uint32_t s = 0; s < strands->strand_count; s++) {
        if (file_strand(strands, s) >= hierarchy->strand_count) {
            return error_set(error, AWT_BAD_VALUE, "strand %lu has no row in the hierarchy",
                             (unsigned long)file_strand(strands, s));
        }
    }
    return AWT_OK;
}

static int compare_rows(const void *a, const void *b)
{
    const wisp_row *x = a, *y = b;
    int by_wisp = (x->wisp > y->wisp) - (x->wisp < y->wisp);
    return by_wisp ? by_wisp : (x->strand > y->strand) - (x->strand < y->strand);
}

/* Finds every strand's wisp of the level by the wisp's first strand. The number of wisps. */
static uint32_t name_wisps(const awt_strands *strands, const awt_hierarchy *hierarchy, uint32_t level, wisp_row *rows,
                           modelled_strand *named)
{
    uint32_t count = 0, first = 0;
    for (uint32_t s = 0; s < strands->strand_count; s++) {
        rows[s] = (wisp_row){wisp_of(strands, hierarchy, s, level), s};
    }
    qsort(rows, strands->strand_count, sizeof *rows, compare_rows);
    for (uint32_t k = 0; k < strands->strand_count; k++) {
        if (k == 0 || rows[k].wisp != rows[k - 1].wisp) {
            first = rows[k].strand;
            count++;
        }
        named[rows[k].strand].first[level] = first;
    }
    return count;
}

/* Do strands that share a wisp share one at the level above too? */
static awt_status check_nesting(const awt_strands *strands, const awt_hierarchy *hierarchy,
                                const modelled_strand *named, awt_error *error)
{
    for (uint32_t s = 0; s < strands->strand_count; s++) {
        for (uint32_t level = 1; level < hierarchy->levels; level++) {
            uint32_t first = named[s].first[level];
            if (named[s].first[level - 1] != named[first].first[level - 1]) {
                return error_set(error, AWT_BAD_VALUE,
                                 "strand %lu is in wisp %lu of level %lu, as strand %lu is, but in another wisp of "
                                 "level %lu than that (strands counted from 0, levels from 1, the coarsest)",
                                 (unsigned long)file_strand(strands, s),
                                 (unsigned long)wisp_of(strands, hierarchy, s, level), (unsigned long)level + 1,
                                 (unsigned long)file_strand(strands, first), (unsigned long)level);
            }
        }
    }
    return AWT_OK;
}

static int compare_strands(const void *a, const void *b)
{
    const modelled_strand *x = a, *y = b;
    for (uint32_t level = 0; level < AWT_MAX_LEVELS; level++) { /* levels that there are not are all alike */
        if (x->first[level] != y->first[level]) {
            return x->first[level] < y->first[level] ? -1 : 1;
        }
    }
    return (x->strand > y->strand) - (x->strand < y->strand);
}

awt_status modelled_sort(const awt_strands *strands, const awt_hierarchy *hierarchy, groom_plan *plan,
                         modelled_strand **out, awt_error *error)
{
    const uint32_t count = strands->strand_count;
    *out = NULL;
    awt_status status = check_rows(strands, hierarchy, error);
    if (status != AWT_OK) {
        return status;
    }
    wisp_row *rows = calloc(count, sizeof *rows);
    modelled_strand *named = calloc(count, sizeof *named);
    if (!rows || !named) {
        status = error_set(error, AWT_NO_MEMORY, NULL);
        goto fail;
    }
    for (uint32_t s = 0; s < count; s++) {
        named[s].strand = s;
    }
    for (uint32_t level = 0; level < hierarchy->levels; level++) {
        plan->wisp_count[level] = name_wisps(strands, hierarchy, level, rows, named);
    }
    status = check_nesting(strands, hierarchy, named, error);
    if (status != AWT_OK) {
        goto fail;
    }
    qsort(named, count, sizeof *named, compare_strands);
    plan->levels = hierarchy->levels;
    free(rows);
    *out = named;
    return AWT_OK;

fail:
    free(rows);
    free(named);
    return status;
}
