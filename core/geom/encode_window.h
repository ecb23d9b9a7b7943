/* encode_window.h: a few patches in a row, encoded at once.
 *
 * Our own encoder goes through RANS_LANES patches at a time, so patches are taken by windows: as many in a row as hold
 * so many that are to be encoded; those that are kept cost nothing. Windows need nothing of each other, and what comes
 * out of a patch does not depend on the window it was in nor on who encoded it. */
#ifndef GEOM_ENCODE_WINDOW_H
#define GEOM_ENCODE_WINDOW_H

#include "geom/layout.h"

typedef struct encode_window {
    uint32_t first, after;        /* patches in a row */
    uint32_t patches[RANS_LANES]; /* those to be encoded, [count], in order */
    int count;
    draco_job jobs[RANS_LANES]; /* theirs */
    uint32_t clamped_points;
    awt_status status; /* of encode_window_run */
    awt_error error;
} encode_window;

/* The memory that one thread encodes windows with, and that holds what came out until the next one. */
typedef struct encode_hand encode_hand;
/* AWT_NO_MEMORY. */
awt_status encode_hand_create(const geom_layout *layout, encode_hand **out, awt_error *error);
/* Accepts NULL. */
void encode_hand_destroy(encode_hand *hand);
size_t encode_hand_bytes(const encode_hand *hand);

/* Whether a patch is taken from the frame before. */
bool encode_keeps(const geom_frame_def *def, uint32_t patch);
/* The window that begins with patch `first`. */
void encode_window_plan(const geom_layout *layout, const geom_frame_def *def, uint32_t first, encode_window *out);
/* Encodes it; encode_window_put then gives the bytes of its patches until the hand's next run. */
void encode_window_run(encode_hand *hand, const geom_layout *layout, const geom_frame_def *def, encode_window *w);
/* Copies job number `job` to `out` [w->jobs[job].size]. */
void encode_window_put(const encode_hand *hand, const geom_layout *layout, const encode_window *w, int job,
                       unsigned char *out);

/* The points of a patch are not finite: AWT_BAD_VALUE. */
awt_status encode_refuse_points(const geom_layout *layout, const geom_patch *patch, awt_error *error);
const float *encode_points_of(const geom_layout *layout, const geom_frame_def *def, const geom_patch *patch);

#endif
