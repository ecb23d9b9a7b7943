/* hdr.h: a histogram of times with three significant digits from 1 ns to 18 minutes (log-linear buckets, as
 * HdrHistogram's): the slowest of a million answers is in it as exactly as the fastest.
 *
 * Any thread may add at any time; whoever reads while others add sees some state between. */
#ifndef LOAD_HDR_H
#define LOAD_HDR_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

enum {
    HDR_BITS = 40,    /* greatest value: 2^40 - 1 ns; greater ones are counted there */
    HDR_EXACT = 2048, /* values below this have a bucket each */
    HDR_HALF = 1024,  /* buckets of each doubling beyond */
    HDR_BUCKETS = HDR_EXACT + (HDR_BITS - 11) * HDR_HALF
};

typedef struct hdr {
    atomic_uint_fast64_t counts[HDR_BUCKETS];
    atomic_uint_fast64_t total;
    atomic_int_fast64_t greatest_ns; /* to the nanosecond */
} hdr;

/* Heap; NULL: no memory. */
hdr *hdr_create(void);
/* Accepts NULL. */
void hdr_destroy(hdr *h);

/* Negative values count as 0. */
void hdr_add(hdr *h, int64_t ns);
/* Adds all that is in `from`. */
void hdr_merge(hdr *into, const hdr *from);

uint64_t hdr_count(const hdr *h);
/* The value that `share` of all (0 to 1) do not exceed: nearest rank, the upper end of its bucket but never more than
 * the greatest value. 0 where there are none. */
int64_t hdr_at(const hdr *h, double share);

/* The percentiles in HdrHistogram's text form, values in microseconds. False: the file takes no more. */
bool hdr_write(const hdr *h, FILE *file);

/* A bucket of a value, and the greatest value of a bucket; for hdr.c and its tests. */
unsigned hdr_bucket_of(int64_t ns);
int64_t hdr_bucket_end(unsigned bucket);

#endif
