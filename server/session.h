/* session.h: one client's conversation with the daemon, apart from sockets and clocks.
 *
 * What comes in is a header and a payload (protocol.h); what goes out goes to a sink. A connection puts a socket behind
 * the sink; the tests put a list there. The files session_*.c hold what each message does, by topic; protocol.c holds
 * the table of who may say what when. */
#ifndef SESSION_H
#define SESSION_H

#include "limits.h"
#include "promises.h"
#include "service.h"
#include "subscription.h"

/* Where a session's messages go. */
typedef struct session_sink {
    void *context;
    /* Encodes and sends. The message's texts are good only during the call. */
    void (*message)(void *context, const proto_message *message);
    /* Sends a FRAME, or BINDING_REPLY, of one of the picture's views; takes the reference. */
    void (*picture)(void *context, picture *shown, const view *v, const delivery *to);
    /* True if all that was given before is gone. */
    bool (*drained)(void *context);
    /* What comes next answers a request from a thread that may send it itself. NULL: that changes nothing. */
    void (*prompt)(void *context);
    /* What session_due_us says may have changed, or the session is closing. NULL: nobody wants to know. */
    void (*touched)(void *context);
} session_sink;

typedef enum session_state {
    SESSION_GREETING, /* HELLO must come */
    SESSION_AUTH,     /* AUTH must come */
    SESSION_OPEN,
    SESSION_CLOSING /* nothing more is listened to; what was said is still sent */
} session_state;

typedef struct session {
    service *shared;
    session_sink sink;
    uint64_t handle; /* in shared->sessions */
    session_state state;
    account *who;  /* NULL until it is in */
    char peer[80]; /* for the log */
    uint8_t nonce[AUTH_NONCE_SIZE];
    uint8_t token[PARKING_TOKEN_SIZE]; /* what RESUME names it by */
    int64_t heard_us;                  /* when the last message came */
    int64_t pinged_us;                 /* when it was asked since whether it is there; 0: it was not */
    bool vanished;                     /* it is closing because its client said nothing any more */
    uint32_t pending;                  /* requests that wait for a worker */
    promise *promised;                 /* answers with a deadline */
    uint32_t last_write_us;            /* written by whoever is behind the sink: see FRAME */

    holdings holds;
    uint64_t subscription_serial;
    uint32_t subscription_next;  /* whose turn it is */
    uint32_t subscription_top;   /* places from this on were never taken */
    subscription *subscriptions; /* [LIMIT_SESSION_SUBSCRIPTIONS], heap; NULL: there was none yet */
} session;

/* False: as many sessions as the service takes. `peer` is for the log. */
bool session_init(session *s, service *shared, const session_sink *sink, const char *peer);
/* Ends its subscriptions; its forests live on. What it holds is parked if it was cut off. Accepts a zeroed one. */
void session_fini(session *s);

/* What it holds is for who comes back with its token. */
bool session_is_resumable(const session *s);

/* The session that asked; NULL: it is gone. */
session *session_find(const service *shared, origin from);

/* ---- what handlers say ------------------------------------------------------------------------------------------ */

#if defined(__GNUC__)
#define SESSION_FORMAT __attribute__((format(printf, 5, 6)))
#else
#define SESSION_FORMAT
#endif

/* Sends a message, unless the session is closing. */
void session_send(session *s, const proto_message *message);

/* An ERROR about a message of type `about`; `format` NULL: the code's own text. Where the code closes the connection,
 * the session is closing from then on. */
void session_error(session *s, uint16_t about, uint64_t request, int code, const char *format, ...) SESSION_FORMAT;
/* The same for what the library said. */
void session_error_awt(session *s, uint16_t about, uint64_t request, const awt_error *error);

/* Lets it in for that account. False: an ERROR about `about` was sent, and the session is closing. */
bool session_enter(session *s, uint16_t about, uint64_t request, account *who);
/* Ends those whose accounts are open no more. */
void sessions_end_closed(service *shared);

/* Whether its account makes and moves things; false: an ERROR was sent. */
bool session_may_drive(session *s, const proto_message *message);

/* Sends BYE and closes. */
void session_bye(session *s, const char *reason);

/* The answer comes now, from a worker that may send it itself: before what it says. */
void session_prompt(session *s);

/* Sends a view of a picture as the answer of `request`; holds its own reference. */
void session_picture(session *s, picture *shown, const view *v, uint64_t request);

/* The same where the picture is older than was asked for. */
void session_stale_picture(session *s, picture *shown, const view *v, uint64_t request);

/* ---- forests of a session --------------------------------------------------------------------------------------- */

/* Opens a forest, or widens what it may do there. False: an ERROR about that message was sent. */
bool session_attach(session *s, uint16_t about, uint64_t request, resident *r, bool may_drive);
/* Ends the session's subscriptions on it too. */
void session_detach(session *s, uint64_t forest);

/* The forest that the message names, if the session may use it so; NULL: an ERROR was sent. */
resident *session_resident(session *s, const proto_message *message, uint64_t forest, bool to_drive);

/* Has the forest of a recipe (taken) made; CREATE_REPLY, or ERROR, follows when it is. False: an ERROR was sent. */
bool session_make(session *s, const proto_message *message, recipe *making);

/* The complete upload of that number; NULL: there is none. */
upload *session_complete_upload(session *s, uint32_t number);

/* An input of this message for a forest's queue; the caller fills in `as`. NULL: no memory (session_push says so). */
forest_input *session_input(const session *s, const proto_message *message, forest_input_kind kind);
/* Queues it (taken; may be NULL). False: an ERROR was sent. */
bool session_push(session *s, const proto_message *message, resident *r, forest_input *input);

/* ---- subscriptions ---------------------------------------------------------------------------------------------- */

/* A free place for one. NULL: LIMIT_SESSION_SUBSCRIPTIONS are taken; or no memory, and s->subscriptions is NULL too. */
subscription *session_subscription_place(session *s);
void session_end_subscriptions(session *s);
/* Those on one forest. */
void session_end_subscriptions_on(session *s, uint64_t forest);
/* NULL: none of that handle. */
subscription *session_subscription(session *s, uint64_t handle);

/* Sends waiting frames, one at a time as the sink drains. */
void session_stream(session *s);

/* ---- the clock --------------------------------------------------------------------------------------------------- */

/* Sends what only the clock allows: frames whose time has come, PING to who has been silent. Who stays silent is let
 * go.
 */
void session_tick(session *s);

/* A message has come. */
void session_heard(session *s);
/* Monotonic time at which its next message may be taken; earlier than now: at once. */
int64_t session_free_us(const session *s);

/* Monotonic time at which session_tick has something to do; INT64_MAX: never. */
int64_t session_due_us(const session *s);

#endif
