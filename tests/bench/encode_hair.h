/* encode_hair.h: the hair whose frames awt-bench encode measures: made by the plan and moved through its clip. */
#ifndef BENCH_ENCODE_HAIR_H
#define BENCH_ENCODE_HAIR_H

#include "bench/encode.h"

/* Zeroed: nothing. */
typedef struct encode_hair {
    awt_groom *groom;
    awt_forest *forest;
    awt_groom_info info;
    float *centres, *frames, *scratch, *points;
} encode_hair;

/* Whatever it says, encode_hair_free is due. */
awt_status encode_hair_make(const encode_plan *plan, encode_hair *h, awt_error *error);
void encode_hair_free(encode_hair *h);
/* On to that time of the clip. */
awt_status encode_hair_move(const encode_plan *plan, encode_hair *h, int64_t time_us, awt_error *error);

#endif
