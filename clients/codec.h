/* codec.h: the client's half of the protocol without a socket: a stream of incoming bytes to messages, the handshake,
 * request ids. Bytes in, messages out; no clock, no I/O, no POSIX header, so that it also serves where the transport is
 * not a socket of ours (TLS, a browser, Windows).
 *
 * The way of the bytes: awtcodec_room gives a place, the caller puts what came there and says so by awtcodec_filled,
 * then takes messages by awtcodec_next until there are no more. */
#ifndef AWTCLIENT_CODEC_H
#define AWTCLIENT_CODEC_H

#include "auth.h"
#include "awtlink.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { AWTCODEC_KEY_SIZE = 16, AWTCODEC_NAME_MAX = 64 };

typedef struct awtcodec {
    bool in;                   /* the handshake is over: longer messages may come */
    uint64_t last_request;     /* request ids count up from 1 and never come again */
    uint32_t greatest_payload; /* bytes that the daemon takes in one message; WELCOME said so */
    uint8_t server_nonce[AUTH_NONCE_SIZE], client_nonce[AUTH_NONCE_SIZE];
    uint8_t token[AUTH_TOKEN_SIZE];
    uint8_t session[AUTH_TOKEN_SIZE]; /* WELCOME's, for RESUME */
    char name[AWTCODEC_NAME_MAX + 1];
    unsigned char *buffer; /* heap; bytes start .. end-1 have come and are not yet taken */
    size_t capacity, start, end;
} awtcodec;

void awtcodec_init(awtcodec *codec);
/* Accepts a zeroed codec. */
void awtcodec_fini(awtcodec *codec);

/* ---- errors ------------------------------------------------------------------------------------------ */

#if defined(__GNUC__)
#define AWTCODEC_FORMAT __attribute__((format(printf, 3, 4)))
#else
#define AWTCODEC_FORMAT
#endif

/* Writes code and text into `error` unless it is NULL. Always false: what the failing function returns. */
bool awtcodec_fail(awtclient_error *error, int code, const char *format, ...) AWTCODEC_FORMAT;
/* Copies `from` into `error` unless that is NULL. Always false. */
bool awtcodec_pass(awtclient_error *error, const awtclient_error *from);
/* The same from an ERROR that came; `about` is the type of the message that the caller waits for an answer to. */
bool awtcodec_fail_by(awtclient_error *error, const struct proto_error *from, uint16_t about);

/* ---- incoming bytes ---------------------------------------------------------------------------------- */

/* A place for the next incoming bytes, of *size > 0 bytes; invalidates the texts and blobs of earlier messages. The
 * buffer at most doubles, so that a peer who announces much and sends little costs little. NULL: no memory. */
unsigned char *awtcodec_room(awtcodec *codec, size_t *size);
/* The first `size` bytes of that place have been filled. */
void awtcodec_filled(awtcodec *codec, size_t size);

typedef enum awtcodec_result {
    AWTCODEC_MESSAGE, /* *message is the next one; its texts and blobs are good until awtcodec_room */
    AWTCODEC_MORE,    /* more bytes are needed */
    AWTCODEC_BAD      /* this is not the protocol; the connection cannot go on */
} awtcodec_result;

/* Whether a whole message has come, AWTCODEC_MESSAGE, without taking it. */
awtcodec_result awtcodec_ready(const awtcodec *codec, awtclient_error *error);

/* The next whole message. Messages of a later version that need not be understood are skipped. */
awtcodec_result awtcodec_next(awtcodec *codec, proto_message *message, awtclient_error *error);

/* ---- the handshake: hello, welcome, and, if that returns with auth_required, auth, auth_reply -------- */

/* HELLO. The text in it is good as long as the codec. `name` NULL: the library's own. */
void awtcodec_hello(awtcodec *codec, const char *name, const uint8_t routing_key[AWTCODEC_KEY_SIZE],
                    proto_message *out);
/* Takes the answer to HELLO. */
bool awtcodec_welcome(awtcodec *codec, const proto_message *answer, bool *auth_required, awtclient_error *error);
/* AUTH. `nonce` is random, never used before. */
void awtcodec_auth(awtcodec *codec, const uint8_t token[AUTH_TOKEN_SIZE], const uint8_t nonce[AUTH_NONCE_SIZE],
                   proto_message *out);
/* Takes the answer to AUTH and checks that the daemon holds the token too. */
bool awtcodec_auth_reply(awtcodec *codec, const proto_message *answer, awtclient_error *error);

/* ---- requests ---------------------------------------------------------------------------------------- */

/* Type of the message that answers a request of `type`; 0: none does (though an ERROR may). */
uint16_t awtcodec_answer_type(uint16_t type);
/* Gives a request its id, if it has none, and says that the daemon must understand it. */
void awtcodec_number(awtcodec *codec, proto_message *request);

typedef enum awtcodec_match {
    AWTCODEC_ANSWER, /* it answers the request */
    AWTCODEC_OTHER,  /* it has nothing to do with it */
    AWTCODEC_FAILED  /* the request failed, or the connection did; `error` says why */
} awtcodec_match;

/* What a message that came is to the request that waits. An ERROR without request id counts as a failure: it is about
 * the connection or about a message to which nobody waits for an answer, and would be lost otherwise. */
awtcodec_match awtcodec_matches(const proto_message *request, const proto_message *message, awtclient_error *error);

#ifdef __cplusplus
}
#endif

#endif
