/* wake.h: the pipe that ends poll's sleep: rung by whoever has something for the sleeper to do, and by signals that ask
 * the daemon to stop. */
#ifndef WAKE_H
#define WAKE_H

#include <stdbool.h>

typedef struct wake {
    int ends[2]; /* [0] is polled */
} wake;

/* False: no descriptors left. */
bool wake_init(wake *w);
/* Not for one that signals ring: they may come until the process ends. */
void wake_fini(wake *w);

/* Ends the present or the next sleep. Any thread, and signal handlers. `context` is a wake. */
void wake_ring(void *context);
/* Before looking at what was rung for. */
void wake_clear(wake *w);

/* From now on SIGTERM, SIGINT and SIGUSR1 ring `w`; SIGPIPE is ignored. Once in a process; `w` must live until its end.
 */
void wake_on_signals(wake *w);
/* SIGTERM or SIGINT has come; more than once. */
bool wake_stop_asked(void);
bool wake_hurry_asked(void);
/* SIGUSR1 has come since the last call: forests are to be brought to the disk. */
bool wake_save_asked(void);

/* From now on SIGHUP rings `w`, which must live until the process ends. */
void wake_on_hangup(wake *w);
/* Whether SIGHUP came since the last call. After wake_clear. */
bool wake_take_hangup(void);

#endif
