/* test_e2e_refusals.c: bad input at the daemon's door: a numbered error or the end of that connection, and everyone
 * else goes on. */
#include "check.h"
#include "e2e/daemon.h"

#include "base/rng.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

/* Sends bytes on a connection of their own and reads until the daemon closes; the code of the first ERROR, 0 if none
 * came, -1 if it neither closed nor answered within 10 s. */
static int answer_to(const daemon_process *daemon, const void *bytes, size_t size)
{
    int fd = daemon_socket(daemon);
    if (fd < 0) {
        return -2;
    }
    struct timeval patience = {.tv_sec = 10};
    setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    send(fd, bytes, size, MSG_NOSIGNAL);
    shutdown(fd, SHUT_WR);
    static unsigned char in[65536];
    size_t used = 0;
    ssize_t got = 0;
    while (used < sizeof in && (got = recv(fd, in + used, sizeof in - used, 0)) > 0) {
        used += (size_t)got;
    }
    int code = got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK) ? -1 : 0;
    close(fd);
    for (size_t at = 0; at + PROTO_HEADER_SIZE <= used;) {
        proto_header header = proto_header_read(in + at);
        if (header.length > used - at - PROTO_HEADER_SIZE) {
            break;
        }
        proto_message message;
        CHECK_INT(proto_decode(&header, in + at + PROTO_HEADER_SIZE, &message, NULL), 0);
        if (message.type == PROTO_ERROR) {
            CHECK(message.as.error.text.length > 0);
            return message.as.error.code;
        }
        at += PROTO_HEADER_SIZE + header.length;
    }
    return code;
}

static size_t hello(unsigned char *bytes, size_t size)
{
    proto_message m = {.type = PROTO_HELLO, .flags = PROTO_FLAG_REQUIRED, .request = 1};
    memcpy(m.as.hello.magic, PROTO_MAGIC, 4);
    m.as.hello.lowest_version = m.as.hello.highest_version = PROTO_VERSION;
    m.as.hello.client = proto_str_of("refusals");
    m.as.hello.length = (uint16_t)(proto_encoded_size(&m) - PROTO_HEADER_SIZE);
    return proto_encode(&m, bytes, size);
}

/* Another client's forest, which has to go on through everything. */
static uint64_t bystander_forest(awtclient *client)
{
    proto_message request = {.type = PROTO_CREATE}, answer;
    request.as.create.style = proto_str_of("short");
    request.as.create.strands = 500;
    request.as.create.head.orientation[3] = request.as.create.body.orientation[3] = 1;
    awtclient_error error = {0};
    bool made = awtclient_call(client, &request, &answer, &error);
    CHECK_TEXT(error.text, "");
    return made ? answer.as.create_reply.forest : 0;
}

static void bystander_goes_on(awtclient *client, uint64_t forest, int64_t *time_us)
{
    proto_message query = {.type = PROTO_QUERY}, frame;
    query.as.query.forest = forest;
    query.as.query.time_us = *time_us += 16667;
    awtclient_error error = {0};
    CHECK(awtclient_call(client, &query, &frame, &error));
    CHECK_TEXT(error.text, "");
}

TEST(e2e_hostile_bytes_end_their_own_connection_and_nobody_elses)
{
    daemon_process daemon;
    CHECK(daemon_start(&daemon, 1, NULL));
    awtclient *bystander = daemon_client(&daemon);
    uint64_t forest = bystander_forest(bystander);
    int64_t time_us = 0;

    unsigned char bytes[4096];
    size_t size = hello(bytes, sizeof bytes);
    for (size_t cut = 0; cut < size; cut++) { /* truncated: closed without more ado, or an error */
        CHECK(answer_to(&daemon, bytes, cut) >= 0);
    }
    bystander_goes_on(bystander, forest, &time_us);

    unsigned char wrong[4096];
    memcpy(wrong, bytes, size);
    wrong[PROTO_HEADER_SIZE] ^= 0x20;
    CHECK_INT(answer_to(&daemon, wrong, size), PROTO_ERROR_BAD_MAGIC);
    memcpy(wrong, bytes, size);
    wrong[PROTO_HEADER_SIZE + 4] = wrong[PROTO_HEADER_SIZE + 5] = 200;
    CHECK_INT(answer_to(&daemon, wrong, size), PROTO_ERROR_BAD_VERSION);
    memcpy(wrong, bytes, size);
    memset(wrong, 0xff, 4); /* four gigabytes announced */
    CHECK_INT(answer_to(&daemon, wrong, size), PROTO_ERROR_TOO_LONG);
    bystander_goes_on(bystander, forest, &time_us);

    rng r = rng_seed(7);
    for (int n = 0; n < 200; n++) {
        size_t length = 1 + rng_u32(&r) % sizeof wrong;
        for (size_t i = 0; i < length; i++) {
            wrong[i] = (unsigned char)rng_u32(&r);
        }
        CHECK(answer_to(&daemon, wrong, length) >= 0);
    }
    for (int n = 0; n < 200; n++) { /* a good greeting, then noise with a plausible header */
        memcpy(wrong, bytes, size);
        size_t length = 16 + rng_u32(&r) % 400;
        for (size_t i = 0; i < length; i++) {
            wrong[size + i] = (unsigned char)rng_u32(&r);
        }
        wrong[size + 1] = wrong[size + 2] = wrong[size + 3] = 0;
        wrong[size + 5] = 0;
        CHECK(answer_to(&daemon, wrong, size + length) >= 0);
    }
    bystander_goes_on(bystander, forest, &time_us);
    awtclient_close(bystander);
    CHECK_INT(daemon_stop(&daemon), 0);
}

TEST(e2e_without_the_right_token_nobody_gets_in)
{
    daemon_process daemon;
    CHECK(daemon_start(&daemon, 1, NULL));
    unsigned char bytes[1024];
    size_t size = hello(bytes, sizeof bytes);
    proto_message list = {.type = PROTO_LIST, .request = 2};
    size_t both = size + proto_encode(&list, bytes + size, sizeof bytes - size);
    CHECK_INT(answer_to(&daemon, bytes, both), PROTO_ERROR_NO_TOKEN);

    proto_message auth = {.type = PROTO_AUTH, .request = 2};
    both = size + proto_encode(&auth, bytes + size, sizeof bytes - size);
    CHECK_INT(answer_to(&daemon, bytes, both), PROTO_ERROR_WRONG_TOKEN);

    char other[] = "/tmp/awtd-test-token-XXXXXX";
    int fd = mkstemp(other);
    CHECK(fd >= 0 && write(fd, "00112233445566778899aabbccddeeff\n", 33) == 33);
    close(fd);
    awtclient_error error = {0};
    awtclient *client = awtclient_open(&(awtclient_options){.address = daemon.address, .token_file = other}, &error);
    CHECK(client == NULL);
    CHECK_INT(error.code, PROTO_ERROR_WRONG_TOKEN);
    client =
        awtclient_open(&(awtclient_options){.address = daemon.address, .token_file = "/nonexistent/token"}, &error);
    CHECK(client == NULL);
    CHECK_INT(error.code, AWTCLIENT_TOKEN);
    unlink(other);
    CHECK_INT(daemon_stop(&daemon), 0);
}

/* The code with which a CREATE fails; 0 if it does not. */
static int create_error(awtclient *client, proto_message *request)
{
    proto_message answer;
    awtclient_error error = {0};
    request->type = PROTO_CREATE;
    request->request = 0;
    request->as.create.head.orientation[3] = request->as.create.body.orientation[3] = 1;
    if (awtclient_call(client, request, &answer, &error)) {
        return 0;
    }
    CHECK(error.text[0] != '\0');
    return error.code;
}

static int upload_error(awtclient *client, const void *bytes, size_t size)
{
    awtclient_error error = {0};
    if (!awtclient_upload(client, 1, bytes, size, NULL, NULL, &error)) {
        return error.code;
    }
    proto_message request = {0};
    request.as.create.source = 1;
    request.as.create.upload = 1;
    return create_error(client, &request);
}

static void put_u32(unsigned char *at, uint32_t value)
{
    for (int k = 0; k < 4; k++) {
        at[k] = (unsigned char)(value >> (8 * k));
    }
}

/* A TressFX 4.0 file of `strands` strands of two points each, whose header may lie. */
static size_t tfx_file(unsigned char *bytes, uint32_t strands, uint32_t announced, float x)
{
    memset(bytes, 0, 160 + strands * 32);
    float version = 4.0f;
    memcpy(bytes, &version, 4);
    put_u32(bytes + 4, announced);
    put_u32(bytes + 8, 2);
    put_u32(bytes + 12, 160);
    for (uint32_t s = 0; s < strands; s++) {
        float points[8] = {x, (float)s, 0, 1, x, (float)s + 1, 0, 1};
        memcpy(bytes + 160 + s * 32, points, sizeof points);
    }
    return 160 + strands * 32;
}

TEST(e2e_bad_requests_get_numbered_errors_and_the_connection_goes_on)
{
    daemon_process daemon;
    CHECK(daemon_start(&daemon, 2, NULL));
    awtclient *client = daemon_client(&daemon), *bystander = daemon_client(&daemon);
    uint64_t forest = bystander_forest(bystander);
    int64_t time_us = 0;

    proto_message request = {0};
    request.as.create.style = proto_str_of("mullet");
    CHECK_INT(create_error(client, &request), PROTO_ERROR_NO_STYLE);
    request.as.create.style = proto_str_of("long");
    request.as.create.strands = 100000000;
    CHECK_INT(create_error(client, &request), PROTO_ERROR_LIMIT);
    request.as.create.strands = 100;
    request.as.create.params.count = 1;
    request.as.create.params.items[0] = (struct proto_param){.name = proto_str_of("bounce"), .value = 1};
    CHECK_INT(create_error(client, &request), PROTO_ERROR_NO_PARAM);
    request.as.create.params.items[0] = (struct proto_param){.name = proto_str_of("drag"), .value = -1};
    CHECK_INT(create_error(client, &request), PROTO_ERROR_BAD_VALUE);
    request = (proto_message){0};
    request.as.create.source = 1;
    request.as.create.upload = 9;
    CHECK_INT(create_error(client, &request), PROTO_ERROR_NO_UPLOAD);

    static unsigned char file[160 + 100 * 32];
    size_t size = tfx_file(file, 100, 101, 1); /* one strand more than there are */
    CHECK_INT(upload_error(client, file, size), PROTO_ERROR_BAD_STRANDS);
    size = tfx_file(file, 100, 4000000000u, 1);
    CHECK_INT(upload_error(client, file, size), PROTO_ERROR_LIMIT);
    size = tfx_file(file, 100, 0, 1);
    CHECK_INT(upload_error(client, file, size), PROTO_ERROR_BAD_STRANDS);
    float nan_value;
    uint32_t nan_bits = 0x7fc00000;
    memcpy(&nan_value, &nan_bits, 4);
    size = tfx_file(file, 100, 100, nan_value);
    CHECK_INT(upload_error(client, file, size), PROTO_ERROR_BAD_VALUE);
    CHECK_INT(upload_error(client, "not hair at all", 15), PROTO_ERROR_BAD_STRANDS);
    size = tfx_file(file, 100, 100, 1); /* a straight row of roots is no head */
    CHECK_INT(upload_error(client, file, size), PROTO_ERROR_NO_HEAD);

    proto_message query = {.type = PROTO_QUERY}, answer;
    awtclient_error error = {0};
    query.as.query.forest = forest; /* not attached here */
    CHECK(!awtclient_call(client, &query, &answer, &error));
    CHECK_INT(error.code, PROTO_ERROR_NOT_ALLOWED);
    query = (proto_message){.type = PROTO_QUERY};
    query.as.query.forest = 12345678;
    CHECK(!awtclient_call(client, &query, &answer, &error));
    CHECK_INT(error.code, PROTO_ERROR_NO_FOREST);

    bystander_goes_on(bystander, forest, &time_us);
    query = (proto_message){.type = PROTO_QUERY};
    query.as.query.forest = forest;
    query.as.query.time_us = 5; /* the forest is past that */
    CHECK(!awtclient_call(bystander, &query, &answer, &error));
    CHECK_INT(error.code, PROTO_ERROR_BAD_TIME);
    query.request = 0;
    query.as.query.time_us = time_us + 1000;
    query.as.query.kind = 3;
    query.as.query.level = 1;
    CHECK(!awtclient_call(bystander, &query, &answer, &error));
    CHECK_INT(error.code, PROTO_ERROR_NOT_SUPPORTED);
    bystander_goes_on(bystander, forest, &time_us);
    awtclient_close(client);
    awtclient_close(bystander);
    CHECK_INT(daemon_stop(&daemon), 0);
}
