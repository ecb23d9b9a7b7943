/* scenario.h: which members make which load. */
#ifndef LOAD_SCENARIO_H
#define LOAD_SCENARIO_H

#include "load/crew.h"

/* Adds the members of the plan's scenario, with their counterparts where the bare server is measured. False: the book
 * says why. */
bool scenario_fill(load_run *run, crew *c);

/* Connections that the scenario has beside those that say nothing, of both sides, and the descriptors it needs. */
uint32_t scenario_descriptors(const load_run *run);

#endif
