/* drawing.h: what a worker needs to draw a forest: for every form in use its layout and scratch, the frame before for
 * patches that did not move, and the last frames in whole numbers for deltas.
 *
 * Everything is made where it is first wanted and used again from then on: in the steady state drawing takes no memory
 * but what a picture's buffers grow by. One thread at a time. */
#ifndef DRAWING_H
#define DRAWING_H

#include "awt.h"
#include "wishes.h"

typedef struct drawing drawing;

/* The groom must outlive it, and `helpers`, which may be NULL, do their part of its frames. AWT_LIMIT (too many
 * points), AWT_NO_MEMORY. */
awt_status drawing_create(const awt_groom *groom, const spread *helpers, drawing **out, awt_error *error);
/* Accepts NULL. */
void drawing_destroy(drawing *d);

/* Bytes that it holds, without layouts; of one form alone, 0 as long as it is not in use. */
uint64_t drawing_bytes(const drawing *d);
uint64_t drawing_form_bytes(const drawing *d, int form);

/* Between two steps: the forest as it stands is what it is shown coming from, until after its next sub-step. Without
 * memory for that it is shown as it stands. */
void drawing_hold(drawing *d, const awt_forest *forest);
/* From now on the forest is shown as at `time_us`: between what was held and what it is now, where it has made just one
 * sub-step since, else as it stands. Returns the time that is shown. */
int64_t drawing_show(drawing *d, const awt_forest *forest, int64_t time_us);

/* Adds to `out` the views that are wanted of the forest as it is shown, which is that of `sequence`: that must be the
 * same whenever the sequence is. Nodes are shown as the forest stands. A delta whose base is not among the last
 * LIMIT_DELTA_BASES frames kept of its form is drawn whole. What cannot be drawn is left out; then the first error
 * comes back, and the other views are there. */
awt_status drawing_draw(drawing *d, const awt_forest *forest, uint64_t sequence, const wishes *wanted, picture *out,
                        awt_error *error);

#endif
