/* histogram.h: the bounds in which durations are counted: two to each doubling, 1 us to 33.6 s, so that no quantile
 * read from them is off by more than half. */
#ifndef SERVER_HISTOGRAM_H
#define SERVER_HISTOGRAM_H

#include <stddef.h>
#include <stdint.h>

enum {
    HISTOGRAM_BOUNDS = 50,                   /* 1, 2, 3, 4, 6, 8, 12, ... 2^25 us */
    HISTOGRAM_BUCKETS = HISTOGRAM_BOUNDS + 1 /* what is above the last bound has a bucket, too */
};

/* The greatest value that bucket `i` (< HISTOGRAM_BOUNDS) counts, in microseconds. */
uint64_t histogram_bound_us(size_t i);

/* The bucket that counts `us`: the first whose bound is not below it. */
size_t histogram_bucket(uint64_t us);

#endif
