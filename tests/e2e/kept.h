/* kept.h: a forest of a real daemon that is driven, and kept in its state directory. */
#ifndef E2E_KEPT_H
#define E2E_KEPT_H

#include "e2e/daemon.h"

enum { KEPT_STEP_US = 10000, KEPT_PATIENCE = 3000 /* hundredths of a second that a test waits for something */ };

/* A small forest with long hair. */
struct proto_create_reply kept_create(awtclient *client, uint64_t seed);
/* Opens it to drive it; its time. */
int64_t kept_attach(awtclient *client, const struct proto_create_reply *forest);
/* Moves and steps from step `from` to step `to`; false: the connection ended on the way. A sum of the hair. */
bool kept_drive(awtclient *client, uint64_t forest, int from, int to, uint32_t *sum);
/* The hash of its state. */
uint64_t kept_hash(awtclient *client, uint64_t forest);

/* The file in which it is kept: a new one, with another number, each time it is saved. 0: there is none. */
ino_t kept_file(const daemon_process *daemon, uint64_t forest);
/* Has it saved and waits until that is done. */
void kept_save(const daemon_process *daemon, uint64_t forest);

#endif
