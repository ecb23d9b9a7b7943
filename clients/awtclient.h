/* awtclient.h: the one header of libawtclient, for C and C++. It brings the others: links that never wait (awtlink.h),
 * and come back by themselves (awtsession.h), frames to hair of any time (awtframes.h), behind the stream for who looks
 * on (awtpace.h) and ahead of it for who drives (awtlead.h), into an engine's memory (awtwrite.h) and axes
 * (awtspace.h), clocks and credit (awtclock.h), the short way to hair (awthair.h), and the messages (proto.h).
 *
 * Here is talking to awtd by calls that wait: a session, and a poll until what is wanted has come. Options and errors
 * are in awtlink.h; `error` may be NULL in every call. No call waits longer than the options' timeout_ms, whatever the
 * other end does: then its error is AWTCLIENT_TIMEOUT. After a call has failed by AWTCLIENT_CLOSED or
 * AWTCLIENT_TIMEOUT, awtclient_reopen gets the connection and its forests back. An ERROR from the daemon is false with
 * its PROTO_ERROR_ code, and the client goes on.
 *
 * One thread at a time may use a client; different clients do not know each other. No call starts a thread or touches
 * a signal. */
#ifndef AWTCLIENT_H
#define AWTCLIENT_H

#include "awtclock.h"
#include "awtframes.h"
#include "awthair.h"
#include "awtlead.h"
#include "awtlink.h"
#include "awtpace.h"
#include "awtsession.h"
#include "awtspace.h"
#include "awtwrite.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct awtclient awtclient;

/* Connects, greets and authenticates. Everything in `options` is copied. NULL: `error` says why (AWTCLIENT_ADDRESS,
 * AWTCLIENT_TOKEN, AWTCLIENT_PEER, AWTCLIENT_CLOSED, AWTCLIENT_TIMEOUT, AWTCLIENT_MEMORY, or the daemon's code). The
 * caller owns the result: awtclient_close. */
awtclient *awtclient_open(const awtclient_options *options, awtclient_error *error);
/* Says BYE where it can, closes, frees. Accepts NULL. */
void awtclient_close(awtclient *client);

/* Connects anew, with several tries within `patience_ms` (0: one), and opens again what was open: forests by their
 * session or their tokens. awtsession_forests(awtclient_session(client), ...) says which those are, and which are gone
 * and have to be created anew. Requests from before are not answered any more, and subscriptions have ended. False:
 * `error` says why; it may be tried again. A `transport` in the options was for one connection: then this fails. */
bool awtclient_reopen(awtclient *client, int patience_ms, awtclient_error *error);

/* Sends a message; request id 0 in *message is replaced by a new one (returned in it) if it expects an answer. Its
 * texts and blobs are the caller's, and not needed afterwards. False: AWTCLIENT_CLOSED, AWTCLIENT_TIMEOUT (the daemon
 * takes nothing; no other message can follow), PROTO_ERROR_LIMIT, PROTO_ERROR_TOO_LONG (it cannot be sent). */
bool awtclient_send(awtclient *client, proto_message *message, awtclient_error *error);
/* Waits for the next message, whatever it is. Its texts and blobs are good until the next call on this client. */
bool awtclient_receive(awtclient *client, proto_message *message, awtclient_error *error);
/* Sends and waits for the answer of that request (FRAMEs of subscriptions that arrive meanwhile are dropped). The
 * answer's texts and blobs are good until the next call on this client. An ERROR from the daemon becomes false with its
 * code and text; AWTCLIENT_PEER: the answer was of another type. `request` and `answer` may not be the same. */
bool awtclient_call(awtclient *client, proto_message *request, proto_message *answer, awtclient_error *error);

/* awtclient_call of a CREATE, whose `progress` it sets: `heard` is told each PROGRESS, and with each the time for the
 * answer begins anew. */
bool awtclient_create(awtclient *client, proto_message *request, proto_message *answer,
                      void (*heard)(void *context, const struct proto_progress *progress), void *context,
                      awtclient_error *error);

/* Sends a whole file of `size` > 0 bytes in pieces as upload number `upload` (any; CREATE names it); `progress` (may be
 * NULL) hears shares from 0 to 1. Each piece may take timeout_ms. */
bool awtclient_upload(awtclient *client, uint32_t upload, const void *bytes, size_t size,
                      void (*progress)(void *context, double share), void *context, awtclient_error *error);

/* The descriptor, for tests and for callers that poll; -1: there is no connection now. */
int awtclient_descriptor(const awtclient *client);
/* The session below. Who uses it too takes from the same stream of messages; it stays the client's. */
awtsession *awtclient_session(awtclient *client);

#ifdef __cplusplus
}
#endif

#endif
