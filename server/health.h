/* health.h: what /readyz says: whether new clients are well advised to come here. Any thread. */
#ifndef SERVER_HEALTH_H
#define SERVER_HEALTH_H

#include <stdbool.h>

/* From now on clients are served; until then the daemon starts. */
void health_set_serving(void);
/* Whether new forests are refused for want of time. */
void health_set_overloaded(bool overloaded);

/* NULL: ready. Else why not: "starting", "draining" (a signal has asked to stop) or "overloaded". */
const char *health_unready(void);

#endif
