/* health.h: what /readyz says: whether new clients are well advised to come here. Any thread. */
#ifndef SERVER_HEALTH_H
#define SERVER_HEALTH_H

#include <stdbool.h>
#include <stdint.h>

/* From now on clients are served; until then the daemon starts. */
void health_set_serving(void);
/* Whether new forests are refused for want of time; `now_us` is monotonic. That they are holds for LIMIT_OVERLOADED_US:
 * where nothing is simulated any more, nobody is left to take it back. */
void health_set_overloaded(bool overloaded, int64_t now_us);

/* NULL: ready. Else why not: "starting", "draining" (a signal has asked to stop) or "overloaded". */
const char *health_unready(int64_t now_us);

#endif
