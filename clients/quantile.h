/* quantile.h: order statistics of a list of numbers. */
#ifndef CLIENTS_QUANTILE_H
#define CLIENTS_QUANTILE_H

#include <stddef.h>

/* Brings the values into rising order; they must be finite. */
void quantile_sort(double *values, size_t count);

/* The least value that `share` of the sorted values (0 to 1) do not exceed: nearest rank. 0 where there are none. */
double quantile_at(const double *sorted, size_t count, double share);

#endif
