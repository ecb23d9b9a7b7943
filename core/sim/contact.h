/* contact.h: wisps that touch each other (AWT §4.1, §4.2). */
#ifndef SIM_CONTACT_H
#define SIM_CONTACT_H

#include "sim/state.h"

/* Room for the contacts of a forest of so many slots, from a real arena or a counting one. */
void contact_lay_out(awt_forest *f, arena *a, size_t slots);

/* Finds the pairs of active segments that touch and move against each other, and writes into f->active_push what their
 * friction and repulsion change of every active node's velocity in this sub-step. Returns how many pairs. */
uint32_t contact_resolve(awt_forest *f, float dt_s);

/* Takes all pushes away, those of slots that may be used again included: when contact may have been turned off. */
void contact_clear(awt_forest *f);

#endif
