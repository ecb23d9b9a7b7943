/* encode_subject.h: frames of one kind and level, encoded and decoded by us and by libdraco, one after the other, so
 * that whatever else the machine does meets both. */
#ifndef BENCH_ENCODE_SUBJECT_H
#define BENCH_ENCODE_SUBJECT_H

#include "bench/encode_hair.h"
#include "geom/draco_read.h"
#include "geom/layout.h"

/* Encoders, and what was measured of each frame. */
typedef struct encode_subject {
    geom_layout *layout, *stock_layout;
    geom_scratch *scratch, *stock_scratch;
    geom_buffer frame, previous, kept, stock_frame;
    draco_reader *reader;
    float *points; /* of the layout's level */
    float *vertices;
    bool *unchanged;
    const spread *helpers; /* NULL: not measured */
    double *encode_ms[ENCODE_MOVINGS], *shared_ms, *stock_ms, *vertices_ms, *evaluate_ms, *decode_ms,
        *stock_decode_ms;                             /* [frames] */
    double bytes, stock_bytes, entropy_bits, error_m; /* sums, and the greatest */
    uint32_t done;
} encode_subject;

/* Of a zeroed one; whatever it says, encode_subject_free is due. */
awt_status encode_subject_make(const encode_hair *h, geom_kind kind, geom_level level, uint32_t frames,
                               encode_subject *s, awt_error *error);
void encode_subject_free(encode_subject *s);
/* Measures it also by several hands; of a layout that they encode nothing of together, not. */
awt_status encode_subject_share(encode_subject *s, const spread *helpers, awt_error *error);
/* Of the hair as it is now. */
awt_status encode_subject_measure(const encode_hair *h, encode_subject *s, int64_t time_us, awt_error *error);
/* ENCODE_MOVINGS rows of all that was measured. */
void encode_subject_rows(encode_subject *s, encode_row *rows);

#endif
