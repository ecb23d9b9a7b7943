/* wire_fixture.h: the daemon's connections on one thread: real sockets with real sessions behind them, whose turns the
 * test gives, without loops and without a clock, so that everything happens in the same order each time. Clients take
 * no memory: what the heap is asked for is the daemon's (heap_seam.h). */
#ifndef WIRE_FIXTURE_H
#define WIRE_FIXTURE_H

#include "connection.h"

enum { WIRE_CLIENTS = 4, WIRE_BYTES = 4 << 20 /* of one message at most */ };

typedef struct wire_client {
    connection *served; /* the daemon's end; NULL: it is gone */
    bool idle;          /* it lives in the cold home */
    int fd;             /* the client's; -1: it is gone */
    bool deaf;          /* reads nothing */
    void (*hear)(void *context, const proto_message *message);
    void *context;
    size_t size;
    unsigned char bytes[WIRE_BYTES]; /* received, and not a whole message yet */
} wire_client;

typedef struct wire {
    service shared;
    homes homes;
    wire_client clients[WIRE_CLIENTS];
} wire;

/* A service without workers or loops that wants AUTH with fake_token, by the fake clock (server_fixture.h). False: no
 * memory; nothing is left behind then. */
bool wire_begin(wire *w, uint32_t max_forests);
/* Cuts whoever is there, has what they held ended, and frees. */
void wire_end(wire *w);

/* A connection for client number `i`, who is not there. False: the daemon has no memory for it. */
bool wire_connect(wire *w, int i, void (*hear)(void *context, const proto_message *message), void *context);
/* Closes the client's end. */
void wire_cut(wire *w, int i);
bool wire_is_there(const wire *w, int i);

/* Writes the message whole; turns are given meanwhile if the socket is full. Nothing where the client is gone. */
void wire_send(wire *w, int i, const proto_message *message);
/* The same with bytes that may be anything. */
void wire_send_bytes(wire *w, int i, const unsigned char *bytes, size_t size);

/* Gives turns until nothing moves any more; no job runs, and nobody hears. */
void wire_turns(wire *w);
/* Gives turns and runs jobs, and clients hear, until nothing moves any more. */
void wire_settle(wire *w);
/* The clock goes on by so much at once; then wire_settle. */
void wire_pass(wire *w, int64_t us);

#endif
