/* daemon.h: the process from its start to its end. */
#ifndef DAEMON_H
#define DAEMON_H

#include "config.h"

/* Opens the token, listens, starts the workers, says where it listens on standard output, serves until SIGTERM or
 * SIGINT, and frees everything. False: it could not start, and `error` says why and what to do. */
bool daemon_run(const config *asked, char *error, size_t error_size);

/* Whether daemon_run could begin, as far as that is known without making, binding or starting anything. False: `error`
 * says why not. */
bool daemon_check(const config *asked, char *error, size_t error_size);

#endif
