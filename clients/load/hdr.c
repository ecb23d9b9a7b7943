/* hdr.c: see hdr.h. */
#include "load/hdr.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

enum { HDR_TICKS = 5 }; /* lines of the text form for each halving of what is left to 100 % */

hdr *hdr_create(void)
{
    return calloc(1, sizeof(hdr));
}

void hdr_destroy(hdr *h)
{
    free(h);
}

unsigned hdr_bucket_of(int64_t ns)
{
    const int64_t greatest = (INT64_C(1) << HDR_BITS) - 1;
    uint64_t value = (uint64_t)(ns < 0 ? 0 : ns > greatest ? greatest : ns);
    unsigned shift = 0;
    while (value >> shift >= HDR_EXACT) {
        shift++;
    }
    return (unsigned)(value >> shift) + shift * HDR_HALF;
}

int64_t hdr_bucket_end(unsigned bucket)
{
    if (bucket < HDR_EXACT) {
        return bucket;
    }
    const unsigned shift = (bucket - HDR_HALF) / HDR_HALF;
    const int64_t top = (int64_t)(bucket - shift * HDR_HALF);
    return ((top + 1) << shift) - 1;
}

static void hdr_raise(hdr *h, int64_t ns)
{
    int_fast64_t seen = atomic_load_explicit(&h->greatest_ns, memory_order_relaxed);
    while (ns > seen && !atomic_compare_exchange_weak_explicit(&h->greatest_ns, &seen, ns, memory_order_relaxed,
                                                               memory_order_relaxed)) {
    }
}

void hdr_add(hdr *h, int64_t ns)
{
    atomic_fetch_add_explicit(&h->counts[hdr_bucket_of(ns)], 1, memory_order_relaxed);
    atomic_fetch_add_explicit(&h->total, 1, memory_order_relaxed);
    hdr_raise(h, ns);
}

void hdr_merge(hdr *into, const hdr *from)
{
    for (unsigned b = 0; b < HDR_BUCKETS; b++) {
        uint64_t count = atomic_load_explicit(&from->counts[b], memory_order_relaxed);
        if (count > 0) {
            atomic_fetch_add_explicit(&into->counts[b], count, memory_order_relaxed);
            atomic_fetch_add_explicit(&into->total, count, memory_order_relaxed);
        }
    }
    hdr_raise(into, atomic_load_explicit(&from->greatest_ns, memory_order_relaxed));
}

uint64_t hdr_count(const hdr *h)
{
    return atomic_load_explicit(&h->total, memory_order_relaxed);
}

/* The upper end of a bucket, as far as anything was seen there. */
static int64_t hdr_value(const hdr *h, unsigned bucket)
{
    const int64_t end = hdr_bucket_end(bucket), greatest = atomic_load_explicit(&h->greatest_ns, memory_order_relaxed);
    return end < greatest ? end : greatest;
}

/* The bucket of the value of rank `rank` (from 1), and in *through how many values lie up to its end. */
static unsigned hdr_find(const hdr *h, uint64_t rank, uint64_t *through)
{
    uint64_t sum = 0;
    for (unsigned b = 0; b < HDR_BUCKETS; b++) {
        sum += atomic_load_explicit(&h->counts[b], memory_order_relaxed);
        if (sum >= rank) {
            *through = sum;
            return b;
        }
    }
    *through = sum;
    return HDR_BUCKETS - 1;
}

static uint64_t hdr_rank(double share, uint64_t total)
{
    const double rank = ceil(share * (double)total);
    return rank < 1 ? 1 : rank > (double)total ? total : (uint64_t)rank;
}

int64_t hdr_at(const hdr *h, double share)
{
    const uint64_t total = hdr_count(h);
    uint64_t through;
    if (total == 0) {
        return 0;
    }
    return share >= 1 ? (int64_t)atomic_load_explicit(&h->greatest_ns, memory_order_relaxed)
                      : hdr_value(h, hdr_find(h, hdr_rank(share, total), &through));
}

static void hdr_write_foot(const hdr *h, FILE *file)
{
    const double total = (double)hdr_count(h);
    double sum = 0, squares = 0;
    for (unsigned b = 0; b < HDR_BUCKETS; b++) {
        const double count = (double)atomic_load_explicit(&h->counts[b], memory_order_relaxed);
        const double us = (double)hdr_bucket_end(b) * 1e-3;
        sum += count * us;
        squares += count * us * us;
    }
    const double mean = total > 0 ? sum / total : 0, spread = total > 0 ? squares / total - mean * mean : 0;
    fprintf(file, "#[Mean    = %12.3f, StdDeviation   = %12.3f]\n", mean, spread > 0 ? sqrt(spread) : 0);
    fprintf(file, "#[Max     = %12.3f, Total count    = %12" PRIu64 "]\n", (double)hdr_at(h, 1) * 1e-3, hdr_count(h));
    fprintf(file, "#[Buckets = %12d, SubBuckets     = %12d]\n", HDR_BITS - 10, HDR_EXACT);
}

bool hdr_write(const hdr *h, FILE *file)
{
    const uint64_t total = hdr_count(h);
    fprintf(file, "%12s %14s %10s %14s\n\n", "Value", "Percentile", "TotalCount", "1/(1-Percentile)");
    double left = 1; /* share that is beyond */
    for (uint64_t through = 0, written = 0; through < total; left *= pow(0.5, 1.0 / HDR_TICKS)) {
        const unsigned bucket = hdr_find(h, hdr_rank(1 - left, total), &through);
        const double share = (double)through / (double)total;
        if (through == written) {
            continue; /* the same value as before */
        }
        written = through;
        fprintf(file, "%12.3f %14.12f %10" PRIu64, (double)hdr_value(h, bucket) * 1e-3, share, through);
        if (through < total) {
            fprintf(file, " %14.2f\n", 1 / (1 - share));
        } else {
            fputc('\n', file);
        }
    }
    hdr_write_foot(h, file);
    return !ferror(file);
}
