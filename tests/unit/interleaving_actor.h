/* interleaving_actor.h: one client of an interleaving, and the stage that all of them stand on. */
#ifndef INTERLEAVING_ACTOR_H
#define INTERLEAVING_ACTOR_H

#include "input.h"
#include "interleaving.h"
#include "server_fixture.h"

#include "base/rng.h"

enum {
    ACTOR_REQUESTS = 64,      /* that may be open; beyond, it says nothing new */
    ACTOR_WIRE = 256 * 1024,  /* bytes said that have not arrived */
    ACTOR_SUBSCRIPTIONS = 64, /* begun on one connection, ended ones too */
    STAGE_FORESTS = 8,        /* the last ones made, which all actors have heard of */
    STAGE_STATE = 64 * 1024   /* bytes of a forest's state */
};

typedef struct stage {
    uint32_t (*decide)(void *context, uint32_t below); /* below >= 1 */
    void *context;
    service *shared;
    struct proto_create_reply forests[STAGE_FORESTS];
    uint32_t forests_made;
    uint32_t motions;
    uint8_t token[PARKING_TOKEN_SIZE]; /* of the session that was cut off last */
    int64_t time_us;                   /* that was asked for last */
    size_t state_size;                 /* of the state that was seen last, if it is not too large */
    unsigned char state[STAGE_STATE];
    interleaving seen;
} stage;

/* A request that waits for its answer; request 0: none. */
typedef struct open_request {
    uint64_t request;
    uint16_t type;
    uint32_t answers; /* that are to come */
} open_request;

typedef struct begun_subscription {
    uint64_t request, handle; /* handle 0: not answered yet */
    uint64_t credit, frames;  /* given, and come */
    uint64_t sequence;        /* of the last frame */
} begun_subscription;

/* Zeroed: not connected. */
typedef struct actor {
    stage *on;
    bool there, congested;
    bool garbled; /* it sent what is no message: what is answered to that is not foreseen */
    session talk;
    input in;
    unsigned char *wire; /* [ACTOR_WIRE], heap */
    size_t wire_size;
    uint64_t last_request;
    struct proto_create_reply mine, attaching; /* the forest that it opened last, and the one it asked to open last */
    uint8_t server_nonce[AUTH_NONCE_SIZE], token[PARKING_TOKEN_SIZE];
    open_request open[ACTOR_REQUESTS];
    begun_subscription subscriptions[ACTOR_SUBSCRIPTIONS];
    uint32_t subscription_count;
} actor;

/* Runs one job that waits, with what follows from it. False: there was none. */
bool stage_work(stage *s);
/* Notes the first thing that did not hold. */
void stage_expect(stage *s, bool holds, const char *otherwise);

bool actor_is_there(const actor *who);
/* The daemon listens to it no more. */
bool actor_is_refused(const actor *who);
/* Connects; nothing where the daemon takes no more sessions. */
void actor_connect(actor *who, stage *on);
/* The connection ends, wherever it is. Accepts one that is not there. */
void actor_cut(actor *who);

/* Puts a message that a client might send into the wire, or bytes that are none. */
void actor_say(actor *who);
void actor_say_garbage(actor *who);
/* At most so many bytes of the wire arrive, and what is whole is done. */
void actor_hear(actor *who, size_t most);
/* Whether its output is full. */
void actor_congest(actor *who, bool congested);

/* Whoever is in and did not talk garbage has all its answers. */
void actor_expect_nothing(const actor *who);

#endif
