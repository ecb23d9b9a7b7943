/* talker.c: see talker.h. */
#include "unit/talker.h"

#include "base/crc32c.h"
#include "unit/server_fixture.h"

#include <string.h>

enum { PIECE = 40000 };

void talker_init(talker *t, wire *on, int number)
{
    memset(t, 0, offsetof(talker, state));
    t->on = on;
    t->number = number;
}

/* ---- what comes -------------------------------------------------------------------------------------------------- */

static uint64_t *find_open(talker *t, uint64_t request)
{
    for (int i = 0; i < TALKER_OPEN; i++) {
        if (t->open[i] == request) {
            return &t->open[i];
        }
    }
    return NULL;
}

static void add_blob(talker *t, proto_blob blob)
{
    t->sum = crc32c_more(t->sum, blob.bytes, blob.length);
}

static void keep_state(talker *t, proto_blob state)
{
    add_blob(t, state);
    t->state_size = state.length <= TALKER_STATE ? state.length : 0;
    memcpy(t->state, state.bytes, t->state_size);
}

static void take_error(talker *t, const struct proto_error *error)
{
    t->broken = error->text.length == 0 ? "an ERROR does not say why" : t->broken;
    t->code = t->errors == 0 ? error->code : t->code;
    t->about = t->errors == 0 ? error->about : t->about;
    t->errors++;
}

static void keep(talker *t, const proto_message *message)
{
    switch (message->type) {
    case PROTO_ERROR:
        take_error(t, &message->as.error);
        break;
    case PROTO_WELCOME:
        memcpy(t->server_nonce, message->as.welcome.nonce, sizeof t->server_nonce);
        memcpy(t->session, message->as.welcome.session, sizeof t->session);
        break;
    case PROTO_CREATE_REPLY:
        t->forest = message->as.create_reply.forest;
        memcpy(t->drive_token, message->as.create_reply.drive_token, sizeof t->drive_token);
        break;
    case PROTO_RESUME_REPLY:
        t->resumed = message->as.resume_reply.forests.count;
        break;
    case PROTO_SUBSCRIBE_REPLY:
        t->subscription = message->as.subscribe_reply.subscription;
        t->subscribed = message->request;
        t->sequence = 0;
        break;
    case PROTO_FRAME:
        t->frames++;
        t->sequence = message->request == t->subscribed ? message->as.frame.sequence : t->sequence;
        add_blob(t, message->as.frame.glb);
        break;
    case PROTO_BINDING_REPLY:
        add_blob(t, message->as.binding_reply.binding);
        break;
    case PROTO_SNAPSHOT_REPLY:
        keep_state(t, message->as.snapshot_reply.state);
        break;
    }
}

static void hear(void *context, const proto_message *message)
{
    talker *t = context;
    uint64_t *asked = message->request && message->type != PROTO_PROGRESS ? find_open(t, message->request) : NULL;
    if (asked) {
        *asked = 0;
    }
    keep(t, message);
}

/* ---- what is said ------------------------------------------------------------------------------------------------ */

static void send_it(talker *t, proto_message *message)
{
    message->request = ++t->last_request;
    message->flags = PROTO_FLAG_REQUIRED;
    wire_send(t->on, t->number, message);
    wire_settle(t->on);
}

void talker_say(talker *t, proto_message message)
{
    send_it(t, &message);
}

bool talker_ask(talker *t, proto_message message)
{
    const uint32_t errors = t->errors;
    uint64_t *place = find_open(t, 0);
    if (!wire_is_there(t->on, t->number)) {
        return false;
    }
    *place = t->last_request + 1;
    send_it(t, &message);
    const bool answered = *place == 0;
    *place = 0;
    if (!answered && wire_is_there(t->on, t->number)) {
        t->broken = "a request was never answered, and the connection stands";
    }
    return answered && t->errors == errors;
}

bool talker_come(talker *t)
{
    if (wire_is_there(t->on, t->number)) {
        return true;
    }
    wire_settle(t->on); /* the daemon may not have seen its end yet */
    proto_message auth = {.type = PROTO_AUTH};
    if (!wire_connect(t->on, t->number, hear, t) || !talker_ask(t, fake_hello())) {
        return false;
    }
    auth_client_proof(fake_token, t->server_nonce, auth.as.auth.nonce, auth.as.auth.proof);
    return talker_ask(t, auth);
}

bool talker_upload(talker *t, uint32_t number, const void *bytes, size_t size)
{
    proto_message message = {.type = PROTO_UPLOAD};
    struct proto_upload *up = &message.as.upload;
    auth_sha256 hash;
    auth_sha256_init(&hash);
    auth_sha256_add(&hash, bytes, size);
    *up = (struct proto_upload){.upload = number, .total = size};
    auth_sha256_done(&hash, up->sha256);
    bool taken = size > 0;
    for (; taken && up->offset < up->total; up->offset += up->piece.length) {
        const uint64_t left = up->total - up->offset;
        up->piece = (proto_blob){(const unsigned char *)bytes + up->offset, (uint32_t)(left < PIECE ? left : PIECE)};
        taken = talker_ask(t, message);
    }
    return taken;
}
