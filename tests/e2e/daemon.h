/* daemon.h: a real awtd beside the tests: the one of the same build, on a free loopback port, with a state directory of
 * its own. */
#ifndef E2E_DAEMON_H
#define E2E_DAEMON_H

#include "awtclient.h"
#include "unit/folder_fixture.h"

#include <sys/types.h>

typedef struct daemon_process {
    pid_t pid;
    char address[128];
    char admin[128]; /* where it answers HTTP; empty: nowhere */
    char state_directory[FOLDER_PATH];
    char token_file[96];
} daemon_process;

/* Starts it with so many workers and further arguments (NULL-terminated; may be NULL). False: it did not come up. */
bool daemon_start(daemon_process *daemon, int workers, const char *const *arguments);
/* The same again, with the state directory that it had: after daemon_end or daemon_kill. */
bool daemon_start_again(daemon_process *daemon, int workers, const char *const *arguments);
/* SIGKILL, at whatever it is. */
void daemon_kill(daemon_process *daemon);
/* Sends SIGTERM and waits. The exit status; -1 if it did not exit by itself within 20 s (then it is killed). The state
 * directory stays. */
int daemon_end(daemon_process *daemon);
/* Removes the state directory of one that has ended. */
void daemon_forget(daemon_process *daemon);
/* daemon_end, then daemon_forget; the exit status. */
int daemon_stop(daemon_process *daemon);

/* A bad line to a daemon: awt-relay of the same build. Who connects to `address` gets there with that delay (both ways
 * each), jitter and bytes a second ("0": no limit). */
typedef struct line_process {
    pid_t pid;
    char address[128];
} line_process;

/* Starts any program that first says "listening on HOST:PORT": all[0], with what follows up to NULL as its arguments.
 */
bool daemon_spawn(const char *const *all, pid_t *pid, char *address, size_t size);

bool line_start(line_process *line, const char *target, const char *delay_ms, const char *jitter_ms, const char *rate);
/* Accepts a line that did not start. */
void line_stop(line_process *line);

/* A client of it, or NULL after a failed check. */
awtclient *daemon_client(const daemon_process *daemon);
/* A bare connected socket, or -1. */
int daemon_socket(const daemon_process *daemon);
/* The same to "HOST:PORT". */
int daemon_socket_to(const char *address);

#endif
