/* door.h: the main thread while the daemon serves: accepts connections and hands them to the loops, does what only the
 * clock brings about (upkeep.h), and hears the signals. */
#ifndef DOOR_H
#define DOOR_H

#include "loops.h"

typedef struct door {
    service *shared;
    loops *inside;
    home own; /* no connection lives here; the bell is the one that signals ring */
    int listener;
    uint32_t greatest;      /* connections that may be open */
    int64_t accept_from_us; /* no accept before */
} door;

/* Serves until a signal asks to stop, and closes the listener. `d` lives until no worker and no loop runs any more:
 * they may ring its bell. */
void door_run(door *d);

#endif
