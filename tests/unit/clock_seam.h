/* clock_seam.h: the wall clock in the hands of the tests. The build has the linker lead every reading of a clock that
 * our code makes through here (Makefile: WRAP). */
#ifndef CLOCK_SEAM_H
#define CLOCK_SEAM_H

#include <stdint.h>

/* From now on the wall clock says so much more than it would; other clocks go as they go. Any thread. */
void clock_shift_wall(int64_t seconds);
/* How often our code has asked what time of day it is, since the program began. */
uint64_t clock_wall_readings(void);

#endif
