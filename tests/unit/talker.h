/* talker.h: a client over wire_fixture.h that keeps account of what it asked and what came of it: every request is to
 * be answered, by its kind of answer or by an ERROR with a number that says why. It takes no memory. */
#ifndef TALKER_H
#define TALKER_H

#include "unit/wire_fixture.h"

enum { TALKER_OPEN = 16, TALKER_STATE = 1 << 20 };

typedef struct talker {
    wire *on;
    int number; /* of the wire's clients */
    uint64_t last_request, open[TALKER_OPEN];
    const char *broken;      /* what did not hold; NULL: everything did */
    uint16_t code, about;    /* of the first ERROR; 0: none came */
    uint32_t errors, frames; /* that came */
    uint32_t sum;            /* of all GLBs, bindings and states */
    uint64_t forest;         /* the one made last, and its token */
    uint8_t drive_token[16];
    uint8_t server_nonce[AUTH_NONCE_SIZE], session[PARKING_TOKEN_SIZE];
    uint64_t subscription, subscribed; /* of the last SUBSCRIBE_REPLY: its handle, and its request */
    uint64_t sequence;                 /* of the newest FRAME by that subscription; 0: none came */
    uint32_t resumed;                  /* forests of the last RESUME_REPLY */
    size_t state_size;                 /* of the last SNAPSHOT_REPLY */
    unsigned char state[TALKER_STATE];
} talker;

/* Begins anew, not connected. */
void talker_init(talker *t, wire *on, int number);

/* Connects and shows that it has the token; nothing where it is there already. False: it was not let in. */
bool talker_come(talker *t);
/* Sends a request; everything settles. True: it has been answered, with no ERROR. */
bool talker_ask(talker *t, proto_message message);
/* Sends what has no answer; everything settles. */
void talker_say(talker *t, proto_message message);

/* A whole file, in pieces. */
bool talker_upload(talker *t, uint32_t number, const void *bytes, size_t size);

#endif
