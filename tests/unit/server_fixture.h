/* server_fixture.h: a daemon without sockets, threads or clock, and clients that talk to its sessions in memory.
 */
#ifndef SERVER_FIXTURE_H
#define SERVER_FIXTURE_H

#include "session.h"

enum { FAKE_RECEIVED = 512, FAKE_SESSIONS = 128 /* that the service takes */ };

/* One message that a session sent; its texts and blobs point into `bytes`. */
typedef struct fake_received {
    uint64_t turn; /* of all messages that any session sent: 1, 2, ... */
    proto_message message;
    unsigned char *bytes;
    size_t size;
} fake_received;

typedef struct fake_client {
    session talk;
    bool congested; /* the sink says that it is not drained */
    uint32_t next, count;
    fake_received received[FAKE_RECEIVED];
} fake_client;

extern int64_t fake_now_us; /* what the sessions' clock says */
extern const uint8_t fake_token[AUTH_TOKEN_SIZE];

/* A service with that many worker threads (0: fake_work runs the jobs). */
bool fake_service_init(service *shared, unsigned workers, uint32_t max_forests, bool auth_required);
/* One that wants a token, with those accounts beside the owner's, and no threads. */
bool fake_service_init_with(service *shared, uint32_t max_forests, const account_list *accounts);

/* A client whose session has just been accepted; heap, fake_client_destroy. */
fake_client *fake_client_create(service *shared);
/* The same, greeted (the service wants no auth). */
fake_client *fake_client_open(service *shared);
/* The same, which has answered a service that wants a token with the proof of this one; what comes of it is to be
 * received. */
fake_client *fake_client_with_token(service *shared, const uint8_t token[AUTH_TOKEN_SIZE]);
void fake_client_destroy(fake_client *client);

/* Has the session receive what a connection would give it. False: the header was refused or skipped. */
bool fake_send(fake_client *client, const proto_message *message);
/* Header and payload as they are. */
bool fake_send_bytes(fake_client *client, uint16_t type, uint16_t flags, const unsigned char *payload, uint32_t length);

/* The next message that the session sent; NULL: none. */
const proto_message *fake_receive(fake_client *client);
/* Makes room: what was received is forgotten. */
void fake_forget(fake_client *client);
/* The next message is of that type, or the check fails; never NULL. */
const proto_message *fake_expect(fake_client *client, uint16_t type);
/* The next message is an ERROR of that code. */
void fake_expect_error(fake_client *client, int code);

/* Runs jobs and takes their results until none is left (without threads), or until the client has a message. */
void fake_work(service *shared, fake_client *client);

/* Requests with sensible values everywhere. */
proto_message fake_hello(void);
proto_message fake_create(uint64_t seed);
proto_message fake_motion(uint64_t forest, uint32_t sequence, int64_t time_us);
proto_message fake_query(uint64_t forest, int64_t time_us);

/* Creates a small forest and waits for it. */
struct proto_create_reply fake_make_forest(service *shared, fake_client *client, uint64_t seed);

#endif
