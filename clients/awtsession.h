/* awtsession.h: a link that comes back. Like a link (awtlink.h) it never blocks and owns no thread, no clock and no
 * loop; unlike one it outlives its connection: when that is lost it connects anew, later and later (0.1 s at first,
 * doubled up to 5 s, half of each by chance, so that many clients do not come at once), takes up its session with the
 * daemon (RESUME), and opens with their tokens those forests that the session does not hold any more (ATTACH), as after
 * a restart of the daemon. What can only be done by the caller it is told: which requests are not answered any more
 * (all), that subscriptions have ended (all), and which forests are gone and are to be created anew.
 *
 *     awtsession *session = awtsession_open(&options, awtclient_now_us(), &error);
 *     while (awtsession_pump(session, awtclient_now_us(), &error)) {
 *         switch (awtsession_next(session, &message, &error)) {
 *         case AWTSESSION_OPENED: subscribe to the forests that awtsession_forests says are open, create the others;
 *         case AWTSESSION_MESSAGE: as of a link;
 *         case AWTSESSION_LOST: nothing that was asked is answered any more; `error` says why;
 *         case AWTSESSION_NOTHING: poll awtsession_descriptor for awtsession_wanted until awtsession_deadline_us,
 *             but not at all while awtsession_pending;
 *         }
 *     }
 *
 * One thread at a time may use a session. */
#ifndef AWTSESSION_H
#define AWTSESSION_H

#include "awtlink.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
    AWTSESSION_FORESTS = 256, /* remembered; a daemon lets a connection have no more open */
    AWTSESSION_STAY_LOST = -1 /* as patience: the first failure is for good */
};

typedef struct awtsession_options {
    awtclient_options link; /* everything is copied. A `transport` given here is for the first connection only */
    int patience_ms;        /* for how long to try to connect before that is given up; 0: for ever; or the above */
    /* Makes the transport of each connection (TLS, for example), which may not block. NULL: TCP to the address. */
    bool (*make_transport)(void *context, awtlink_transport *out, awtclient_error *error);
    void *context;
} awtsession_options;

typedef struct awtsession awtsession;

/* Begins to connect. NULL: `error` says why: the options are wrong, or no memory, or the first failure is for good. The
 * caller owns the result: awtsession_close. */
awtsession *awtsession_open(const awtsession_options *options, int64_t now_us, awtclient_error *error);
/* Says BYE if that goes out at once, so that the daemon keeps nothing for it; closes, frees. Accepts NULL. */
void awtsession_close(awtsession *session);

/* Connects, sends and receives as far as that goes now. `now_us` is the caller's monotonic clock. False: it is given up
 * for good, `error` says why: the token or the version is wrong, the other end does not speak the protocol, no memory,
 * or the patience is over. Invalidates what awtsession_next gave. */
bool awtsession_pump(awtsession *session, int64_t now_us, awtclient_error *error);

typedef enum awtsession_news {
    AWTSESSION_NOTHING, /* now */
    AWTSESSION_MESSAGE, /* *message came, as awtlink_next gives it, with the errors of requests that take too long */
    AWTSESSION_OPENED,  /* messages may be queued; the forests from before are in awtsession_forests */
    AWTSESSION_LOST     /* the connection, which was open, has ended; `error` says why. Nothing is answered any more */
} awtsession_news;

awtsession_news awtsession_next(awtsession *session, proto_message *message, awtclient_error *error);

/* As awtlink_queue. AWTCLIENT_FULL, too, while there is no open connection. */
bool awtsession_queue(awtsession *session, proto_message *message, awtclient_error *error);

/* A forest that was created or attached by this session and neither detached nor destroyed. */
typedef struct awtsession_forest {
    uint64_t forest;
    uint8_t token[16]; /* to drive it, or that which it was attached with */
    bool may_drive;
    bool open; /* false after AWTSESSION_OPENED: it has ended, create it anew; it leaves with the next loss */
} awtsession_forest;

/* Good until the next call with this session. */
const awtsession_forest *awtsession_forests(const awtsession *session, uint32_t *count);

/* Drops the connection, if there is one, and connects anew, with this patience until the session is open; then that of
 * the options is in force again. For sessions that have been given up, and connections that are of no more use. */
void awtsession_return(awtsession *session, int patience_ms, int64_t now_us);

/* The connection's link, to look at (its descriptor, its times); NULL while there is none. Its messages are taken by
 * awtsession_next. */
awtlink *awtsession_link(const awtsession *session);

/* As those of awtlink.h; the descriptor is -1 while there is no connection. */
int awtsession_descriptor(const awtsession *session);
unsigned awtsession_wanted(const awtsession *session);
bool awtsession_pending(const awtsession *session);
int64_t awtsession_deadline_us(const awtsession *session);

#ifdef __cplusplus
}
#endif

#endif
