/* framemix.h: hair between frames: the newest decoded ones, and what is shown of them at any time. */
#ifndef CLIENTS_FRAMEMIX_H
#define CLIENTS_FRAMEMIX_H

#include "awtframes.h"
#include "geom/receive.h"

typedef struct mix_frame {
    int64_t time_us;
    proto_pose head;
    float *positions; /* heap, [mix's strands * points][3]; NULL: never needed yet */
} mix_frame;

/* Embedded: framemix_init. One thread. */
typedef struct framemix {
    int64_t extrapolate_us;
    uint32_t strand_count, points_per_strand;
    mix_frame frames[AWTFRAMES_KEPT]; /* a ring, in order of time, all of one shape */
    uint32_t first, count;
    float *widths;   /* heap, [points_per_strand] */
    float *shown[2]; /* heap, as positions: what is shown, and what was */
    proto_pose heads[2];
    int64_t shown_us; /* INT64_MIN: nothing */
    uint64_t counts[3];
} framemix;

void framemix_init(framemix *mix, int64_t extrapolate_us);
void framemix_fini(framemix *mix);

/* Copies a frame. One that is not newer than the newest is left out; one of another shape begins anew. False: no
 * memory: it is left out. */
bool framemix_add(framemix *mix, const geom_strands *strands);
/* INT64_MIN: none. */
int64_t framemix_newest_us(const framemix *mix);
/* As awtframes_show. */
bool framemix_show(framemix *mix, int64_t time_us, awtframes_shown *shown);

#endif
