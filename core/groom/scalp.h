/* scalp.h: where on the head hair grows, for the built-in styles. Places are directions from the head's centre. */
#ifndef GROOM_SCALP_H
#define GROOM_SCALP_H

#include <stdbool.h>
#include <stdint.h>
#include "base/vec.h"

/* Inside the hairline? `slack` moves the line down (positive) or up, in sines of elevation. */
bool scalp_holds(dvec3 direction, double slack);

/* `count` places spread evenly over the scalp, without rows, the hairline frayed by `fray`; the first n of them are
 * spread evenly too. */
void scalp_spread(uint64_t seed, uint32_t count, double fray, dvec3 *places);

#endif
