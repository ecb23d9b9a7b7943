/* awtlink_parts.h: what is in a link, for its three files: awtlink.c is the whole, awtlink_send.c sends,
 * awtlink_receive.c takes what comes. Private to them. */
#ifndef CLIENTS_AWTLINK_PARTS_H
#define CLIENTS_AWTLINK_PARTS_H

#include "awtlink.h"
#include "codec.h"
#include "handshake.h"
#include "openrequests.h"
#include "outqueue.h"

enum { LINK_PUMP_BYTES = 1 << 20 /* in and out each, by one call */ };

struct awtlink {
    awtlink_transport transport;
    awtcodec codec;
    handshake greeting;
    outqueue out;
    openrequests open;
    uint32_t queue_bytes;
    int timeout_ms;
    int64_t deadline_us, now_us, received_us;
    unsigned wanted;    /* AWTLINK_READ, AWTLINK_WRITE: what the transport said last */
    bool send_waits;    /* the transport takes no more until then */
    bool pending;       /* receiving stopped by our bound, not by the transport */
    bool sending_ended; /* the transport sends no more; `failure` says why, once nothing more comes */
    bool failed;        /* for good */
    awtclient_error failure;
};

/* For good; link->failure says why. Always false. */
bool link_fail(awtlink *link);
/* The reason that stands where nobody gave another. */
void link_closed(awtlink *link);
/* What the transport answered where it took or gave no bytes. */
void link_note_wait(awtlink *link, long answer);

/* Queues a copy, ready or not. As awtlink_queue, but nobody waits for an answer. */
bool link_enqueue(awtlink *link, const proto_message *message, awtclient_error *error);
/* Sends of the queue what the transport takes now, within the bound. */
void link_flush(awtlink *link);

/* Receives until a message is whole, the transport has no more, or it is enough for one call. */
void link_receive(awtlink *link);
/* The next message that is not the link's own business. False with the link unfailed: none has come. */
bool link_take(awtlink *link, proto_message *message);
/* The request that has waited too long, as an ERROR of ours. False: none has. */
bool link_take_overdue(awtlink *link, proto_message *message);

#endif
