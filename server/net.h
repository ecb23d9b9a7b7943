/* net.h: the thin layer over sockets: every call to the socket interface is here. Errors are texts that the caller has
 * room for; nothing logs, nothing blocks, every descriptor is non-blocking and closed on exec. */
#ifndef NET_H
#define NET_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>
#include <sys/uio.h>

enum { NET_ADDRESS = 80 }; /* bytes of "[IPV6%scope]:PORT" */

/* A non-blocking pipe: [0] to read, [1] to write. */
bool net_pipe(int ends[2]);

/* Raises the number of descriptors that the process may have as far as it can, and returns it; 0: nobody knows. */
uint64_t net_raise_descriptors(void);

/* Where to listen. */
typedef struct net_place {
    const char *option;       /* that named it, without the dashes: for errors */
    const char *host, *port;  /* an empty host: any address; port 0: any port */
    const char *loopback_why; /* an address that other machines reach is refused, with this advice; NULL: it is not */
} net_place;

/* Whether one could listen there, as far as that is known without doing it. False: `error` says why not. */
bool net_check(const net_place *place, char *error, size_t error_size);

/* Listens. `bound` receives the address in numbers. -1: `error` says why. */
int net_listen(const net_place *place, char bound[NET_ADDRESS], char *error, size_t error_size);

typedef enum net_result { NET_DONE, NET_LATER, NET_ENDED, NET_FAILED, NET_EXHAUSTED } net_result;

/* NET_DONE: *fd is a connection without Nagle's delay and `peer` its far end. NET_LATER: none waits.
 * NET_EXHAUSTED: no descriptor or memory is left for it. NET_FAILED: this one went away; try the next. */
net_result net_accept(int listener, int *fd, char peer[NET_ADDRESS]);

/* NET_DONE: *got bytes (> 0) came. NET_LATER, NET_ENDED (the peer sends no more), NET_FAILED. */
net_result net_receive(int fd, void *bytes, size_t size, size_t *got);

/* Sends from `count` pieces. NET_DONE: *sent bytes (> 0) went out. NET_LATER, NET_FAILED. Never raises SIGPIPE. */
net_result net_send(int fd, const struct iovec *pieces, size_t count, size_t *sent);

/* Says that nothing more will be sent. */
void net_end_sending(int fd);

#endif
