/* encode_delta.h: the rows of awt-bench encode that are deltas. */
#ifndef BENCH_ENCODE_DELTA_H
#define BENCH_ENCODE_DELTA_H

#include "bench/encode.h"

/* Deltas of one hair's frames of kind strands: the last few as whole numbers, and what was measured. */
typedef struct delta_subject delta_subject;
awt_status delta_subject_create(const awt_groom *groom, uint32_t frames, delta_subject **out, awt_error *error);
void delta_subject_destroy(delta_subject *s);

/* Takes the next frame of ENCODE_FRAME_RATE a second; `measure` it too, where there are frames before it. */
awt_status delta_subject_frame(delta_subject *s, const float *points, const awt_pose *head, int64_t time_us,
                               bool measure, awt_error *error);

/* Fills the rows of every base and every moving. */
void delta_subject_rows(delta_subject *s, encode_row rows[ENCODE_DELTA_ROWS]);

#endif
