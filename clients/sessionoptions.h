/* sessionoptions.h: options of a session with their own copy of every text, for they outlive the call that gave them.
 */
#ifndef CLIENTS_SESSIONOPTIONS_H
#define CLIENTS_SESSIONOPTIONS_H

#include "awtsession.h"
#include "codec.h"

enum { SESSIONOPTIONS_TEXTS = 4 /* address, token file, token, name */ };

/* Does not move: `given` points into it. */
typedef struct sessionoptions {
    awtsession_options given; /* timeout_ms > 0, and a routing key */
    char *texts[SESSIONOPTIONS_TEXTS];
    uint8_t routing_key[AWTCODEC_KEY_SIZE];
    bool transport_brought; /* the first connection's, by the caller */
} sessionoptions;

/* Into a zeroed one. False: `error` says why (no memory, no random numbers); sessionoptions_fini all the same. */
bool sessionoptions_copy(sessionoptions *self, const awtsession_options *options, awtclient_error *error);
void sessionoptions_fini(sessionoptions *self);

/* Begins the next connection. NULL: `error` says why. */
awtlink *sessionoptions_connect(sessionoptions *self, int64_t now_us, awtclient_error *error);

#endif
