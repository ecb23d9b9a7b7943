/* book.h: what a run has measured, written by all threads of the generator at once. */
#ifndef LOAD_BOOK_H
#define LOAD_BOOK_H

#include "load/hdr.h"
#include "load/timeline.h"

enum { BOOK_TEXT = 256, BOOK_LATE_NS = 1000000 };

typedef struct book {
    hdr *latency[LOAD_MODES]; /* from when a request was due to when its answer, or its frame, was whole */
    hdr *age[LOAD_MODES];     /* of frames on arrival; none of the floor */
    hdr **pairs;              /* [pair_slices] latency of each slice, where pairs are compared; else NULL */
    uint32_t pair_slices;
    atomic_uint_fast64_t due[LOAD_MODES];     /* requests, or frames, that were to come */
    atomic_uint_fast64_t came[LOAD_MODES];    /* that came */
    atomic_uint_fast64_t late[LOAD_MODES];    /* requests sent more than BOOK_LATE_NS after they were due */
    atomic_uint_fast64_t bytes[LOAD_MODES];   /* of what came */
    atomic_uint_fast64_t skipped[LOAD_MODES]; /* frames that the daemon left out for want of credit */
    atomic_uint_fast64_t stale[LOAD_MODES];   /* frames that it flagged as older than they should be */
    atomic_uint_fast64_t errors;
    atomic_flag told;           /* error_text is being, or has been, written */
    atomic_bool readable;       /* and may be read */
    char error_text[BOOK_TEXT]; /* the first error */
} book;

/* False: no memory; book_fini in any case. `pair_slices` 0: slices are not kept apart. */
bool book_init(book *b, uint32_t pair_slices);
/* Accepts a zeroed book. */
void book_fini(book *b);

/* An answer of `bytes` that was due in `slice`; `age_ns` < 0: not known. */
void book_answer(book *b, load_mode mode, uint32_t slice, int64_t latency_ns, int64_t age_ns, uint64_t bytes);
/* A request that went out so long after it was due, to which `answers` are to come. */
void book_sent(book *b, load_mode mode, int64_t after_ns, uint64_t answers);
/* Something failed; the first text is kept. */
void book_error(book *b, const char *format, ...)
#if defined(__GNUC__)
    __attribute__((format(printf, 2, 3)))
#endif
    ;
/* The first error's text, "" where there was none. */
const char *book_error_text(const book *b);

/* Mean size of what came in a mode; 0: nothing did. */
uint64_t book_mean_bytes(const book *b, load_mode mode);

/* Median over the pairs of slices of laden p99 / plain p99; 0 where there is no whole pair. */
double book_pair_ratio(const book *b, const timeline *t);

#endif
