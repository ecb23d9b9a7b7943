/* sessionbook.h: which forests a session has open, learnt from the messages that pass, and how they are opened again.
 */
#ifndef CLIENTS_SESSIONBOOK_H
#define CLIENTS_SESSIONBOOK_H

#include "awtsession.h"

typedef enum book_state {
    BOOK_OPEN,
    BOOK_ASKED,  /* an ATTACH is under way */
    BOOK_CLOSED, /* the connection was lost */
    BOOK_GONE    /* the daemon does not have it any more */
} book_state;

typedef struct sessionbook {
    awtsession_forest forests[AWTSESSION_FORESTS];
    book_state states[AWTSESSION_FORESTS];
    uint64_t requests[AWTSESSION_FORESTS]; /* of the ATTACH under way */
    bool known[AWTSESSION_FORESTS];        /* it was open once */
    uint32_t count;
} sessionbook;

/* The caller's message has been queued; it has its request id. */
void sessionbook_sent(sessionbook *book, const proto_message *message);
/* A message has come. */
void sessionbook_came(sessionbook *book, const proto_message *message);

/* The connection is lost. `told`: the caller knows which forests were gone, and they can be forgotten. */
void sessionbook_lost(sessionbook *book, bool told);
/* The daemon says what is open. */
void sessionbook_resumed(sessionbook *book, const struct proto_resume_reply *reply);
/* The ATTACH of a forest that is to be opened again, which is asked for from now on. False: there is none. */
bool sessionbook_next_attach(sessionbook *book, proto_message *attach, uint32_t *number);
/* That ATTACH has been sent, with this request id. */
void sessionbook_asked(sessionbook *book, uint32_t number, uint64_t request);
/* Nothing is to be opened again, and no ATTACH is under way. */
bool sessionbook_settled(const sessionbook *book);

#endif
