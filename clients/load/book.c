/* book.c: see book.h. */
#include "load/book.h"

#include "quantile.h"

#include <stdarg.h>
#include <stdlib.h>

bool book_init(book *b, uint32_t pair_slices)
{
    *b = (book){.pair_slices = pair_slices, .told = ATOMIC_FLAG_INIT};
    bool made = true;
    for (int mode = 0; mode < LOAD_MODES; mode++) {
        b->latency[mode] = hdr_create();
        b->age[mode] = hdr_create();
        made = made && b->latency[mode] && b->age[mode];
    }
    if (pair_slices > 0) {
        b->pairs = calloc(pair_slices, sizeof *b->pairs);
        made = made && b->pairs;
    }
    for (uint32_t s = 0; made && s < pair_slices; s++) {
        made = (b->pairs[s] = hdr_create()) != NULL;
    }
    return made;
}

void book_fini(book *b)
{
    for (int mode = 0; mode < LOAD_MODES; mode++) {
        hdr_destroy(b->latency[mode]);
        hdr_destroy(b->age[mode]);
    }
    for (uint32_t s = 0; b->pairs && s < b->pair_slices; s++) {
        hdr_destroy(b->pairs[s]);
    }
    free(b->pairs);
}

void book_answer(book *b, load_mode mode, uint32_t slice, int64_t latency_ns, int64_t age_ns, uint64_t bytes)
{
    hdr_add(b->latency[mode], latency_ns);
    if (slice < b->pair_slices) {
        hdr_add(b->pairs[slice], latency_ns);
    }
    if (age_ns >= 0) {
        hdr_add(b->age[mode], age_ns);
    }
    atomic_fetch_add_explicit(&b->came[mode], 1, memory_order_relaxed);
    atomic_fetch_add_explicit(&b->bytes[mode], bytes, memory_order_relaxed);
}

void book_sent(book *b, load_mode mode, int64_t after_ns, uint64_t answers)
{
    atomic_fetch_add_explicit(&b->due[mode], answers, memory_order_relaxed);
    if (after_ns > BOOK_LATE_NS) {
        atomic_fetch_add_explicit(&b->late[mode], 1, memory_order_relaxed);
    }
}

void book_error(book *b, const char *format, ...)
{
    atomic_fetch_add_explicit(&b->errors, 1, memory_order_relaxed);
    if (!atomic_flag_test_and_set(&b->told)) {
        va_list arguments;
        va_start(arguments, format);
        vsnprintf(b->error_text, sizeof b->error_text, format, arguments);
        va_end(arguments);
        atomic_store(&b->readable, true);
    }
}

const char *book_error_text(const book *b)
{
    return atomic_load(&b->readable) ? b->error_text : "";
}

uint64_t book_mean_bytes(const book *b, load_mode mode)
{
    const uint64_t count = atomic_load_explicit(&b->came[mode], memory_order_relaxed);
    return count > 0 ? atomic_load_explicit(&b->bytes[mode], memory_order_relaxed) / count : 0;
}

double book_pair_ratio(const book *b, const timeline *t)
{
    double ratios[TIMELINE_MAX_SLICES / 2];
    const hdr *half[LOAD_MODES] = {NULL};
    size_t count = 0;
    for (uint32_t s = 0; s < t->slices && s < b->pair_slices; s++) {
        half[t->modes[s]] = b->pairs[s];
        if (half[LOAD_PLAIN] && half[LOAD_LADEN]) {
            const int64_t plain = hdr_at(half[LOAD_PLAIN], 0.99);
            if (plain > 0 && hdr_count(half[LOAD_LADEN]) > 0) {
                ratios[count++] = (double)hdr_at(half[LOAD_LADEN], 0.99) / (double)plain;
            }
            half[LOAD_PLAIN] = half[LOAD_LADEN] = NULL;
        }
    }
    quantile_sort(ratios, count);
    return quantile_at(ratios, count, 0.5);
}
