/* quantile.c: see quantile.h. */
#include "quantile.h"

#include <math.h>
#include <stdlib.h>

static int quantile_order(const void *left, const void *right)
{
    double a = *(const double *)left, b = *(const double *)right;
    return (a > b) - (a < b);
}

void quantile_sort(double *values, size_t count)
{
    if (count > 0) {
        qsort(values, count, sizeof *values, quantile_order);
    }
}

double quantile_at(const double *sorted, size_t count, double share)
{
    if (count == 0) {
        return 0;
    }
    double rank = ceil(share * (double)count);
    size_t index = rank < 1 ? 0 : rank > (double)count ? count - 1 : (size_t)rank - 1;
    return sorted[index];
}
