/* histogram.c: see histogram.h. */
#include "histogram.h"

/* Bucket 2k counts up to 3 * 2^(k-1), bucket 2k + 1 up to 2^(k+1); bucket 0 up to 1. */
uint64_t histogram_bound_us(size_t i)
{
    if (i == 0) {
        return 1;
    }
    return i % 2 ? UINT64_C(2) << (i / 2) : UINT64_C(3) << (i / 2 - 1);
}

size_t histogram_bucket(uint64_t us)
{
    if (us <= 1) {
        return 0;
    }
    size_t doublings = 0;
    for (uint64_t rest = us - 1; rest > 1; rest >>= 1) {
        doublings++;
    }
    size_t i = 2 * doublings;
    i += i == 0 || us > histogram_bound_us(i);
    return i < HISTOGRAM_BOUNDS ? i : HISTOGRAM_BOUNDS;
}
