/* awtclient.h: talking to awtd from C. The codec (bytes in, messages out) is in codec.h and knows no socket;
 * the one file with a socket is socket.c; here both meet in a connection that sends requests and waits for answers. */
#ifndef AWTCLIENT_H
#define AWTCLIENT_H

#include "proto.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct awtclient awtclient;

typedef struct awtclient_error {
    int code;   /* a PROTO_ERROR_ code that the daemon sent, or one of awtclient_failure (negative) */
    bool retry; /* the daemon said that trying again may help */
    uint32_t retry_after_ms;
    char text[256]; /* what went wrong and what to do about it, for people */
} awtclient_error;

enum awtclient_failure {
    AWTCLIENT_ADDRESS = -1, /* the address does not resolve or nobody listens there */
    AWTCLIENT_TOKEN = -2,   /* a token is wanted and none was found, or the daemon does not hold it */
    AWTCLIENT_CLOSED = -3,  /* the connection ended */
    AWTCLIENT_TIMEOUT = -4, /* no answer in time */
    AWTCLIENT_PEER = -5,    /* the other end does not speak the protocol */
    AWTCLIENT_MEMORY = -6
};

typedef struct awtclient_options {
    const char *address;    /* "HOST:PORT" */
    const char *token_file; /* NULL: where auth_token_path says; read only if the daemon wants a token */
    const char *name;       /* for the daemon's log */
    int timeout_ms;         /* of connecting and of each answer; 0: 30,000 */
} awtclient_options;

/* Connects, greets and authenticates. NULL: `error` says why. The caller owns the result: awtclient_close. */
awtclient *awtclient_open(const awtclient_options *options, awtclient_error *error);
/* Says BYE where it can, closes, frees. Accepts NULL. */
void awtclient_close(awtclient *client);

/* Sends a message; request id 0 in *message is replaced by a new one (returned in it) if it expects an answer. */
bool awtclient_send(awtclient *client, proto_message *message, awtclient_error *error);
/* Waits for the next message, whatever it is. Its texts and blobs are good until the next call on this client. */
bool awtclient_receive(awtclient *client, proto_message *message, awtclient_error *error);
/* Sends and waits for the answer of that request (FRAMEs of subscriptions that arrive meanwhile are dropped).
 * An ERROR from the daemon becomes false with its code and text. */
bool awtclient_call(awtclient *client, proto_message *request, proto_message *answer, awtclient_error *error);

/* awtclient_call of a CREATE, whose `progress` it sets: `heard` is told each PROGRESS, and with each the time for the
 * answer begins anew. */
bool awtclient_create(awtclient *client, proto_message *request, proto_message *answer,
                      void (*heard)(void *context, const struct proto_progress *progress), void *context,
                      awtclient_error *error);

/* Sends a whole file in pieces as upload number `upload`; `progress` (may be NULL) hears shares from 0 to 1. */
bool awtclient_upload(awtclient *client, uint32_t upload, const void *bytes, size_t size,
                      void (*progress)(void *context, double share), void *context, awtclient_error *error);

/* The descriptor, for tests and for callers that poll. */
int awtclient_descriptor(const awtclient *client);

#ifdef __cplusplus
}
#endif

#endif
