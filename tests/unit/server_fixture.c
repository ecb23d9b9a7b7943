/* server_fixture.c: see server_fixture.h. */
#include "server_fixture.h"
#include "check.h"
#include "completions.h"
#include "log.h"
#include "protocol.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

int64_t fake_now_us = 1000000;
const uint8_t fake_token[AUTH_TOKEN_SIZE] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16};

static int64_t fake_clock_us(void)
{
    return fake_now_us;
}

static void fake_wake(void *context)
{
    (void)context;
}

static bool init(service *shared, unsigned workers, uint32_t max_forests, bool auth_required,
                 const account_list *accounts)
{
    service_options options = {.workers = workers,
                               .max_forests = max_forests,
                               .max_sessions = FAKE_SESSIONS,
                               .auth_required = auth_required,
                               .accounts = accounts,
                               .clock_us = fake_clock_us,
                               .wake = fake_wake};
    memcpy(options.token, fake_token, sizeof fake_token);
    log_set_level(LOG_ERROR);
    return service_init(shared, &options);
}

bool fake_service_init(service *shared, unsigned workers, uint32_t max_forests, bool auth_required)
{
    return init(shared, workers, max_forests, auth_required, NULL);
}

bool fake_service_init_with(service *shared, uint32_t max_forests, const account_list *accounts)
{
    return init(shared, 0, max_forests, true, accounts);
}

/* ---- the sink ---------------------------------------------------------------------------------------------------- */

/* Keeps what was sent by encoding it and decoding it again, as a client would. */
static void keep(fake_client *client, const proto_message *message)
{
    CHECK(client->count < FAKE_RECEIVED);
    if (client->count == FAKE_RECEIVED) {
        return;
    }
    static uint64_t turns;
    fake_received *kept = &client->received[client->count++];
    kept->turn = ++turns;
    kept->size = proto_encoded_size(message);
    kept->bytes = malloc(kept->size);
    CHECK(kept->size > 0 && kept->bytes);
    CHECK_U64(proto_encode(message, kept->bytes, kept->size), kept->size);
    proto_header header = proto_header_read(kept->bytes);
    CHECK_INT(proto_decode(&header, kept->bytes + PROTO_HEADER_SIZE, &kept->message, NULL), 0);
}

static void sink_message(void *context, const proto_message *message)
{
    keep(context, message);
}

static void sink_picture(void *context, picture *shown, const view *v, const delivery *to)
{
    proto_message message;
    picture_message(shown, v, to, &message);
    keep(context, &message);
    picture_release(shown);
}

static bool sink_drained(void *context)
{
    return !((fake_client *)context)->congested;
}

/* ---- clients ----------------------------------------------------------------------------------------------------- */

fake_client *fake_client_create(service *shared)
{
    fake_client *client = calloc(1, sizeof *client);
    session_sink sink = {.context = client, .message = sink_message, .picture = sink_picture, .drained = sink_drained};
    CHECK(client && session_init(&client->talk, shared, &sink, "test"));
    return client;
}

fake_client *fake_client_open(service *shared)
{
    fake_client *client = fake_client_create(shared);
    proto_message hello = fake_hello();
    CHECK(fake_send(client, &hello));
    fake_expect(client, PROTO_WELCOME);
    CHECK_INT(client->talk.state, SESSION_OPEN);
    return client;
}

fake_client *fake_client_with_token(service *shared, const uint8_t token[AUTH_TOKEN_SIZE])
{
    fake_client *client = fake_client_create(shared);
    proto_message hello = fake_hello(), auth = {.type = PROTO_AUTH, .request = 9};
    fake_send(client, &hello);
    struct proto_welcome welcome = fake_expect(client, PROTO_WELCOME)->as.welcome;
    CHECK_INT(welcome.auth_required, 1);
    memset(auth.as.auth.nonce, 0x5a, sizeof auth.as.auth.nonce);
    auth_client_proof(token, welcome.nonce, auth.as.auth.nonce, auth.as.auth.proof);
    fake_send(client, &auth);
    return client;
}

void fake_client_destroy(fake_client *client)
{
    session_fini(&client->talk);
    fake_forget(client);
    free(client);
}

bool fake_send_bytes(fake_client *client, uint16_t type, uint16_t flags, const unsigned char *payload, uint32_t length)
{
    proto_header header = {.length = length, .type = type, .flags = flags, .request = 7};
    if (protocol_judge(&client->talk, &header) != PROTOCOL_TAKE) {
        return false;
    }
    unsigned char *exact = malloc(length ? length : 1); /* exactly as long as it says, for the sanitizer */
    CHECK(exact != NULL);
    if (length > 0) {
        memcpy(exact, payload, length);
    }
    protocol_receive(&client->talk, &header, exact);
    free(exact);
    return true;
}

bool fake_send(fake_client *client, const proto_message *message)
{
    size_t size = proto_encoded_size(message);
    unsigned char *bytes = malloc(size ? size : 1);
    CHECK(size > 0 && bytes);
    proto_encode(message, bytes, size);
    proto_header header = proto_header_read(bytes);
    bool taken = protocol_judge(&client->talk, &header) == PROTOCOL_TAKE;
    if (taken) {
        protocol_receive(&client->talk, &header, bytes + PROTO_HEADER_SIZE);
    }
    free(bytes);
    return taken;
}

const proto_message *fake_receive(fake_client *client)
{
    return client->next < client->count ? &client->received[client->next++].message : NULL;
}

void fake_forget(fake_client *client)
{
    for (uint32_t i = 0; i < client->count; i++) {
        free(client->received[i].bytes);
    }
    client->next = client->count = 0;
}

const proto_message *fake_expect(fake_client *client, uint16_t type)
{
    static const proto_message nothing;
    const proto_message *message = fake_receive(client);
    CHECK_TEXT(message ? proto_type_name(message->type) : "(none)", proto_type_name(type));
    return message && message->type == type ? message : &nothing;
}

void fake_expect_error(fake_client *client, int code)
{
    CHECK_INT(fake_expect(client, PROTO_ERROR)->as.error.code, code);
}

void fake_work(service *shared, fake_client *client)
{
    if (worker_pool_count(shared->pool) == 0) {
        while (worker_pool_run_one(shared->pool)) {
            completions_take(shared);
        }
        return;
    }
    do {
        nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL);
        completions_take(shared);
    } while (client->next == client->count);
}

/* ---- requests ---------------------------------------------------------------------------------------------------- */

static const proto_pose at_rest = {.orientation = {0, 0, 0, 1}};

proto_message fake_hello(void)
{
    proto_message message = {.type = PROTO_HELLO, .request = 1};
    struct proto_hello *hello = &message.as.hello;
    memcpy(hello->magic, PROTO_MAGIC, sizeof hello->magic);
    hello->lowest_version = hello->highest_version = PROTO_VERSION;
    hello->client = proto_str_of("test");
    hello->length = (uint16_t)(proto_encoded_size(&message) - PROTO_HEADER_SIZE);
    return message;
}

proto_message fake_create(uint64_t seed)
{
    proto_message message = {.type = PROTO_CREATE, .request = 2};
    struct proto_create *create = &message.as.create;
    create->style = proto_str_of("short");
    create->seed = seed;
    create->strands = 200;
    create->points_per_strand = 8;
    create->finest_wisps = 40;
    create->top_wisps = 8;
    create->head = create->body = at_rest;
    return message;
}

proto_message fake_motion(uint64_t forest, uint32_t sequence, int64_t time_us)
{
    proto_message message = {.type = PROTO_MOTION, .request = 3};
    struct proto_motion *motion = &message.as.motion;
    motion->forest = forest;
    motion->sequence = sequence;
    motion->time_us = time_us;
    motion->head = motion->body = at_rest;
    motion->head.position[0] = (double)time_us * 1e-6;
    return message;
}

proto_message fake_query(uint64_t forest, int64_t time_us)
{
    proto_message message = {.type = PROTO_QUERY, .request = 4};
    message.as.query.forest = forest;
    message.as.query.time_us = time_us;
    return message;
}

struct proto_create_reply fake_make_forest(service *shared, fake_client *client, uint64_t seed)
{
    proto_message create = fake_create(seed);
    CHECK(fake_send(client, &create));
    fake_work(shared, client);
    return fake_expect(client, PROTO_CREATE_REPLY)->as.create_reply;
}
