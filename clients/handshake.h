/* handshake.h: the client's way in, one message at a time: HELLO, WELCOME, and, where the daemon wants a token, AUTH
 * and its reply. Where the token comes from is decided here; what the messages hold is codec.c's. */
#ifndef CLIENTS_HANDSHAKE_H
#define CLIENTS_HANDSHAKE_H

#include "auth.h"
#include "awtlink.h"
#include "codec.h"

typedef struct handshake {
    bool welcomed;
    char *token_file; /* heap; NULL: where auth_token_path says */
    bool token_given;
    uint8_t token[AUTH_TOKEN_SIZE];
} handshake;

/* Random bytes of the system's. */
bool handshake_random(void *bytes, size_t size, awtclient_error *error);

/* Copies what it needs of the options and gives HELLO, to be sent first. False: `error` says why (a token given is
 * none, no random numbers, no memory). */
bool handshake_init(handshake *self, awtcodec *codec, const awtclient_options *options, proto_message *hello,
                    awtclient_error *error);
/* Accepts a zeroed one. */
void handshake_fini(handshake *self);

typedef enum handshake_result { HANDSHAKE_SEND, HANDSHAKE_DONE, HANDSHAKE_FAILED } handshake_result;

/* Takes what the daemon answered. HANDSHAKE_SEND: *reply is to be sent next; HANDSHAKE_DONE: the client is in;
 * HANDSHAKE_FAILED: `error` says why. Reads the token file (or, without one, the one that auth_token_path names) when
 * the daemon wants a token. */
handshake_result handshake_take(handshake *self, awtcodec *codec, const proto_message *answer, proto_message *reply,
                                awtclient_error *error);

#endif
