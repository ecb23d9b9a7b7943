/* fake_daemon.h: a daemon that follows a script, for tests of the client: it serves one connection at a time on the
 * loopback, in a thread of its own, as well or as badly as the script wants. */
#ifndef FAKE_DAEMON_H
#define FAKE_DAEMON_H

#include "auth.h"
#include "awtclient.h"

#include <pthread.h>

enum { FAKE_PATIENCE_MS = 20000 };

/* The token of an honest script. */
extern const uint8_t script_token[AUTH_TOKEN_SIZE];

/* What a script saw; read by the test after fake_stop. */
typedef struct fake {
    void (*script)(struct fake *self);
    int listener, peer;
    pthread_t thread;
    bool running;
    char address[32];
    unsigned char *in; /* the last message's bytes */
    proto_message got;
    bool proof_good, said_bye;
    uint8_t sessions; /* begun; the token of each is 16 times its number, from 1 */
    uint32_t pings_answered, motions, pieces;
    auth_sha256 uploaded;
} fake;

/* Listens at a port of its own (`address` says which) and runs the script on the first connection. */
bool fake_start(fake *self, void (*script)(fake *self));
/* Waits until the script has ended. */
void fake_stop(fake *self);

/* A client of it; as awtclient_open. */
awtclient *fake_open(const fake *self, const char *token_file, int timeout_ms, awtclient_error *error);

/* For scripts. False: the connection has ended, or what came does not decode. */
/* Ends the connection and takes the next one. */
bool fake_hang_up(fake *self);
bool fake_write(fake *self, const void *bytes, size_t size);
bool script_send(fake *self, const proto_message *message);
/* The next message, into `got`. */
bool fake_read(fake *self);
/* Takes HELLO and answers it. */
bool fake_welcome(fake *self, bool auth_required);
/* Takes AUTH and answers it, with a proof under `own_token`. */
bool fake_admit(fake *self, const uint8_t own_token[AUTH_TOKEN_SIZE]);
/* An ERROR about a message of type `about`, to be tried again after 250 ms. */
void fake_error(fake *self, uint64_t request, uint16_t about, uint16_t code, const char *text);

#endif
