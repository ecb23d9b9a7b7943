/* awtlink.h: one connection to awtd that never blocks, for callers with a loop of their own: it owns no thread, no
 * clock and no loop. Connecting, the handshake, what is sent and what comes are all driven by one call:
 *
 *     awtlink *link = awtlink_open(&options, awtclient_now_us(), &error);
 *     for (;;) {
 *         poll the descriptor (awtlink_descriptor) for what the link waits for (awtlink_wanted), but not longer than
 *         until awtlink_deadline_us, and not at all while awtlink_pending;
 *         if (!awtlink_pump(link, awtclient_now_us(), &error)) ...;
 *         while (awtlink_next(link, &message, &error)) ...;
 *     }
 *
 * A link costs little before it is used: its buffers grow with what goes through them, so that one process can have
 * hundreds. One thread at a time may use a link; different links do not know each other. Links include no POSIX header:
 * the bytes go through a transport, which is TCP (socket.h) unless the caller brings one, TLS for example. */
#ifndef AWTLINK_H
#define AWTLINK_H

#include "proto.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- errors, and what is wanted ---------------------------------------------------------------------- */

/* Written where something fails; wherever one is taken it may be NULL. */
typedef struct awtclient_error {
    int code;   /* a PROTO_ERROR_ code that the daemon sent, or one of awtclient_failure (negative) */
    bool retry; /* trying again may help */
    uint32_t retry_after_ms;
    char text[256]; /* what went wrong and what to do about it, for people */
} awtclient_error;

enum awtclient_failure {
    AWTCLIENT_ADDRESS = -1, /* the address does not resolve or nobody listens there */
    AWTCLIENT_TOKEN = -2,   /* a token is wanted and none was found, or the daemon does not hold it */
    AWTCLIENT_CLOSED = -3,  /* the connection ended */
    AWTCLIENT_TIMEOUT = -4, /* no answer in time */
    AWTCLIENT_PEER = -5,    /* the other end does not speak the protocol */
    AWTCLIENT_MEMORY = -6,
    AWTCLIENT_FULL = -7 /* not now: the link is not ready yet, or too much waits to be sent; pump and try again */
};

/* What a transport's send and receive answer instead of a number of bytes. */
enum awtlink_answer {
    AWTLINK_ENDED = 0,       /* receive: the peer sends no more */
    AWTLINK_WANT_READ = -1,  /* nothing now; again when the descriptor can be read */
    AWTLINK_WANT_WRITE = -2, /* nothing now; again when it can be written (connecting, too) */
    AWTLINK_FAILED = -3      /* for good; *error says why, where it was written */
};

/* How bytes travel. No function may block. All run in the thread that calls the link. `context` is theirs. */
typedef struct awtlink_transport {
    void *context;
    /* Sends up to `size` > 0 bytes: how many, > 0, or an awtlink_answer. */
    long (*send)(void *context, const void *bytes, size_t size, awtclient_error *error);
    /* Receives up to `size` > 0 bytes: how many, > 0, or an awtlink_answer. */
    long (*receive)(void *context, void *bytes, size_t size, awtclient_error *error);
    /* What to poll; asked each time anew, for it may change while connecting. -1: nothing. */
    int (*descriptor)(void *context);
    /* Ends it and frees the context. NULL: the caller does. */
    void (*close)(void *context);
} awtlink_transport;

/* Zero it first: what is left 0 or NULL is as the line says, and later versions append fields. */
typedef struct awtclient_options {
    const char *address;                /* "HOST:PORT"; host empty: localhost */
    const char *token_file;             /* NULL: where auth_token_path says; read only if the daemon wants a token */
    const char *token;                  /* the token itself, 32 hexadecimal digits, instead of a file; NULL: the file */
    const char *name;                   /* for the daemon's log */
    int timeout_ms;                     /* of connecting and of each answer; 0: 30,000 */
    uint32_t queue_bytes;               /* that may wait to be sent, beyond one message; 0: 4 MiB */
    const awtlink_transport *transport; /* instead of TCP to `address`; the link takes it over. NULL: TCP */
    const uint8_t *routing_key; /* [16]; links with the same reach the same daemon (PROTOCOL.md). NULL: random */
} awtclient_options;

/* ---- the link ---------------------------------------------------------------------------------------- */

typedef struct awtlink awtlink;

/* Begins to connect; the handshake goes on by awtlink_pump and must be over timeout_ms after `now_us`. Everything in
 * `options` is copied. Resolving a name is the system's and may take its time; an address in numbers takes none. NULL:
 * `error` says why (a transport given is closed then). The caller owns the result: awtlink_close. */
awtlink *awtlink_open(const awtclient_options *options, int64_t now_us, awtclient_error *error);
/* Says BYE if that goes out at once, closes, frees. Accepts NULL. */
void awtlink_close(awtlink *link);
/* The same without a BYE: the daemon keeps the session for a while, to be resumed. Accepts NULL. */
void awtlink_drop(awtlink *link);

/* Sends and receives what the transport takes and gives now, within bounds, so that one link does not keep the loop
 * from the others; drives the handshake. It receives no further while a whole message waits to be taken. `now_us` is
 * the caller's monotonic clock. Invalidates the message that awtlink_next gave. False: the link has failed for good;
 * `error` says why, as does every later call. Messages that came before the failure are given first. */
bool awtlink_pump(awtlink *link, int64_t now_us, awtclient_error *error);

/* The next message that is the caller's business, if one has come: PING is answered here, BYE ends the link. Its texts
 * and blobs are good until the next call of this or of awtlink_pump. False with error->code 0: none now. False else:
 * the link has failed.
 *
 * A request that nobody has answered timeout_ms after it was queued (of a CREATE: after its last PROGRESS) is answered
 * here: by an ERROR with its id, its type as `about`, and the code PROTO_ERROR_TIMED_OUT. The link goes on; the answer,
 * should it come after all, is given like any message. Of requests with several answers (STEP_MANY, SUBSCRIBE) the
 * first counts. */
bool awtlink_next(awtlink *link, proto_message *message, awtclient_error *error);

/* Copies a message into the queue of what goes out. One that expects an answer gets a request id, if it has none,
 * returned in it; answers are matched by awtcodec_matches or by the id. AWTCLIENT_FULL: nothing was queued, and it may
 * be tried again (4096 requests without an answer are as many as may be); PROTO_ERROR_LIMIT, PROTO_ERROR_TOO_LONG: the
 * message cannot be sent; else the link has failed. */
bool awtlink_queue(awtlink *link, proto_message *message, awtclient_error *error);

/* The handshake is over: messages may be queued. */
bool awtlink_ready(const awtlink *link);
/* Bytes that wait to be sent. */
size_t awtlink_queued(const awtlink *link);

/* What to poll: -1, or the transport's descriptor. */
int awtlink_descriptor(const awtlink *link);
enum { AWTLINK_READ = 1, AWTLINK_WRITE = 2 };
/* Whether to poll it for reading (POLLIN), for writing (POLLOUT) or for both: bits of the above. */
unsigned awtlink_wanted(const awtlink *link);
/* There is more to do at once, whatever the descriptor says (a transport may hold bytes of its own). */
bool awtlink_pending(const awtlink *link);
/* When awtlink_pump, then awtlink_next, want to be called even if nothing comes: the handshake's or the next request's
 * time is over then. INT64_MAX: it does not matter. */
int64_t awtlink_deadline_us(const awtlink *link);
/* The pump's time when the latest bytes came: that of the message given last, for clocks and ages. */
int64_t awtlink_received_us(const awtlink *link);

/* [16]: WELCOME's secret for RESUME, once the link is ready (awtsession.h does that). Good as long as the link. */
const uint8_t *awtlink_session_token(const awtlink *link);

/* Microseconds of this machine's monotonic clock (POSIX only). */
int64_t awtclient_now_us(void);

#ifdef __cplusplus
}
#endif

#endif
