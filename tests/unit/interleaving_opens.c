/* interleaving_opens.c: see interleaving_says.h: how a client of an interleaving comes in, and by what forests it has.
 */
#include "interleaving_says.h"

#include "base/assert.h"
#include "hair_file.h"

#include <string.h>

enum { STRANDS = 12, WISPS = 3, TOP_WISPS = 1 };

uint32_t actor_decide(const actor *who, uint32_t below)
{
    return who->on->decide(who->on->context, below);
}

static open_request *free_open(actor *who)
{
    for (int i = 0; i < ACTOR_REQUESTS; i++) {
        if (who->open[i].request == 0) {
            return &who->open[i];
        }
    }
    return NULL;
}

void actor_put(actor *who, proto_message *message, uint32_t answers)
{
    const size_t size = proto_encoded_size(message);
    open_request *place = answers > 0 ? free_open(who) : NULL;
    ASSERT(size > 0);
    if (size > ACTOR_WIRE - who->wire_size || (answers > 0 && !place)) {
        return;
    }
    message->request = ++who->last_request;
    message->flags = PROTO_FLAG_REQUIRED;
    who->wire_size += proto_encode(message, who->wire + who->wire_size, ACTOR_WIRE - who->wire_size);
    who->on->seen.sent++;
    if (place) {
        *place = (open_request){message->request, message->type, answers};
    }
}

void actor_say_garbage(actor *who)
{
    const uint32_t size = actor_decide(who, 64);
    if (size > ACTOR_WIRE - who->wire_size) {
        return;
    }
    who->garbled = true;
    for (uint32_t i = 0; i < size; i++) {
        who->wire[who->wire_size++] = (unsigned char)actor_decide(who, 256);
    }
}

const struct proto_create_reply *actor_some_forest(const actor *who)
{
    static const struct proto_create_reply never = {.forest = UINT64_C(0x7700000001)};
    const uint32_t known = who->on->forests_made < STAGE_FORESTS ? who->on->forests_made : STAGE_FORESTS;
    if (who->mine.forest != 0 && actor_decide(who, 8) != 0) {
        return &who->mine;
    }
    return known > 0 && actor_decide(who, 8) != 0 ? &who->on->forests[actor_decide(who, known)] : &never;
}

void say_hello(actor *who)
{
    proto_message message = fake_hello();
    actor_put(who, &message, 1);
}

void say_auth(actor *who)
{
    proto_message message = {.type = PROTO_AUTH};
    struct proto_auth *auth = &message.as.auth;
    memset(auth->nonce, (int)actor_decide(who, 256), sizeof auth->nonce);
    auth_client_proof(fake_token, who->server_nonce, auth->nonce, auth->proof);
    auth->proof[0] ^= (uint8_t)(actor_decide(who, 16) == 0);
    actor_put(who, &message, 1);
}

/* The session that was cut off last. */
void say_resume(actor *who)
{
    proto_message message = {.type = PROTO_RESUME};
    memcpy(message.as.resume.session, who->on->token, sizeof who->on->token);
    actor_put(who, &message, 1);
}

void say_create(actor *who)
{
    proto_message message = fake_create(actor_decide(who, 3));
    message.as.create.strands = STRANDS;
    message.as.create.finest_wisps = WISPS;
    message.as.create.top_wisps = TOP_WISPS;
    message.as.create.progress = (uint8_t)actor_decide(who, 2);
    switch (actor_decide(who, 8)) {
    case 0:
        message.as.create.source = 1;
        message.as.create.upload = actor_decide(who, 3);
        break;
    case 1:
        message = hair_file_create(0, 1);
        break;
    }
    actor_put(who, &message, 1);
}

void say_upload(actor *who)
{
    static const unsigned char piece[256] = {'H', 'A', 'I', 'R'};
    proto_message message = {.type = PROTO_UPLOAD};
    struct proto_upload *said = &message.as.upload;
    said->upload = actor_decide(who, 3);
    said->total = 256 * (uint64_t)actor_decide(who, 4);
    said->offset = 256 * (uint64_t)actor_decide(who, 4);
    said->piece = (proto_blob){piece, actor_decide(who, 2) ? 256 : actor_decide(who, 257)};
    actor_put(who, &message, 1);
}

/* A whole file, with its hash, in two pieces. */
static void put_file(actor *who, uint32_t number, const void *bytes, size_t size)
{
    proto_message message = {.type = PROTO_UPLOAD};
    struct proto_upload *said = &message.as.upload;
    auth_sha256 hash;
    auth_sha256_init(&hash);
    auth_sha256_add(&hash, bytes, size);
    *said = (struct proto_upload){.upload = number, .total = size, .piece = {bytes, (uint32_t)size / 2}};
    auth_sha256_done(&hash, said->sha256);
    actor_put(who, &message, 1);
    said->offset = said->piece.length;
    said->piece = (proto_blob){(const unsigned char *)bytes + said->offset, (uint32_t)(size - said->offset)};
    actor_put(who, &message, 1);
}

void say_hair(actor *who)
{
    unsigned char hair[HAIR_FILE_SIZE];
    hair_file_write(hair);
    put_file(who, 0, hair, sizeof hair);
    if (actor_decide(who, 4) != 0) {
        put_file(who, 1, hair_file_hierarchy, strlen(hair_file_hierarchy));
    }
}

void say_attach(actor *who)
{
    const struct proto_create_reply *forest = actor_some_forest(who);
    proto_message message = {.type = PROTO_ATTACH};
    message.as.attach.forest = forest->forest;
    memcpy(message.as.attach.token, actor_decide(who, 2) ? forest->drive_token : forest->view_token,
           sizeof message.as.attach.token);
    message.as.attach.token[3] ^= (uint8_t)(actor_decide(who, 32) == 0);
    who->attaching = *forest;
    actor_put(who, &message, 1);
}

/* Of the state that was seen last, mostly. */
void say_restore(actor *who)
{
    proto_message message = {.type = PROTO_RESTORE};
    message.as.restore.upload = actor_decide(who, 4);
    if (message.as.restore.upload > 1) {
        put_file(who, message.as.restore.upload, who->on->state, who->on->state_size);
    }
    actor_put(who, &message, 1);
}
