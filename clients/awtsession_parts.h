/* awtsession_parts.h: what is in a session, for its two files: awtsession.c is the whole, awtsession_return.c gets it
 * from a new connection to where it was. Private to them.
 *
 * A session is between connections (no link), connecting (the link shakes hands), returning (RESUME and the ATTACHes
 * are under way) or open; or it is lost for good. */
#ifndef CLIENTS_AWTSESSION_PARTS_H
#define CLIENTS_AWTSESSION_PARTS_H

#include "awtsession.h"
#include "backoff.h"
#include "codec.h"
#include "sessionbook.h"
#include "sessionoptions.h"

typedef enum session_state {
    SESSION_AWAY,
    SESSION_CONNECTING,
    SESSION_RETURNING,
    SESSION_OPEN,
    SESSION_LOST
} session_state;

struct awtsession {
    session_state state;
    awtlink *link;
    sessionoptions options;
    uint8_t token[AUTH_TOKEN_SIZE];
    bool resumable; /* token is of a session that was cut off */
    sessionbook book;
    int patience_ms;                    /* in force */
    int64_t now_us, since_us, again_us; /* since when, and when again, a connection is tried */
    backoff waits;
    uint64_t resume_request, ping_request; /* under way; 0: none */
    bool loss_to_tell;
    awtclient_error why; /* of the latest loss */
};

/* The connection, or the attempt at one, has ended by `why`. */
void session_lose(awtsession *s, const awtclient_error *why);

/* The link has just become ready. */
void session_arrive(awtsession *s);
/* Takes a message that is the session's own business. False: it is the caller's. */
bool session_take_own(awtsession *s, const proto_message *message);
/* Does what is left to do before the session is open; true: it has just become so. */
bool session_has_returned(awtsession *s);

#endif
