/* bare.h: a client that is a socket and no more, of a daemon that wants no token: what it does not read stays unread,
 * and nothing is sent for it behind a test's back. */
#ifndef E2E_BARE_H
#define E2E_BARE_H

#include "proto.h"

#include <stdbool.h>
#include <stddef.h>

enum { BARE_MESSAGE = 512 /* bytes of those that are sent, at most */, BARE_SESSION = 16 };

/* A socket that blocks, 30 s at most, greeted; -1: it was not. `session` (may be NULL): what RESUME takes. */
int bare_open(const char *address, unsigned char session[BARE_SESSION]);
/* Sends it whole. False: nobody takes it. */
bool bare_send(int fd, const proto_message *message);
/* Sends it and waits for what carries its request id and is no PROGRESS. Texts and blobs of the answer are good until
 * the next call. False: the connection ended. */
bool bare_ask(int fd, const proto_message *message, proto_message *answer);

/* A small forest of long hair, alike for all of one seed. Its handle; 0: there is none. */
uint64_t bare_create(int fd, uint64_t seed);
/* Connections and forests of the daemon, as it counts them. */
struct proto_stats_reply bare_stats(int fd);

/* The memory that a process has in use, KiB; 0: nobody knows. */
long bare_resident_kib(long pid);

#endif
