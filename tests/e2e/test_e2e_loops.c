/* test_e2e_loops.c: many connections on several I/O threads: the same bytes, idle ones that cost the others nothing,
 * and replies that meet a client which does not read or has gone. */
#include "check.h"
#include "e2e/daemon.h"

#include "base/hash.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

enum { STRANDS = 300, PATIENCE = 6000 /* hundredths of a second */ };

static uint64_t create(awtclient *client, uint32_t strands, uint64_t seed)
{
    proto_message request = {.type = PROTO_CREATE}, answer;
    request.as.create.style = proto_str_of("short");
    request.as.create.seed = seed;
    request.as.create.strands = strands;
    request.as.create.head.orientation[3] = request.as.create.body.orientation[3] = 1;
    awtclient_error error = {0};
    bool made = awtclient_call(client, &request, &answer, &error);
    CHECK_TEXT(error.text, "");
    return made ? answer.as.create_reply.forest : 0;
}

static proto_message step_query(uint64_t forest, int n)
{
    proto_message query = {.type = PROTO_QUERY};
    query.as.query.forest = forest;
    query.as.query.time_us = (int64_t)n * 16667;
    return query;
}

static proto_message latest_query(uint64_t forest)
{
    proto_message query = {.type = PROTO_QUERY};
    query.as.query.forest = forest;
    query.as.query.latest = 1;
    return query;
}

/* The answer to a request that must not fail. */
static bool ask(awtclient *client, proto_message request, proto_message *answer)
{
    awtclient_error error = {0};
    bool answered = awtclient_call(client, &request, answer, &error);
    CHECK_TEXT(error.text, "");
    return answered;
}

static struct proto_stats_reply stats(awtclient *client)
{
    proto_message answer = {0};
    ask(client, (proto_message){.type = PROTO_STATS}, &answer);
    return answer.as.stats_reply;
}

/* Waits until so many are idle, and says how many are. */
static uint32_t wait_for_idle(awtclient *asker, uint32_t least, uint32_t most)
{
    uint32_t idle = stats(asker).idle_connections;
    for (int n = 0; n < PATIENCE && (idle < least || idle > most); n++) {
        nanosleep(&(struct timespec){.tv_nsec = 10000000}, NULL);
        idle = stats(asker).idle_connections;
    }
    return idle;
}

/* ---- the same bytes ---------------------------------------------------------------------------------------------- */

enum { PLAYERS = 12, FRAMES = 30 };

typedef struct player {
    const daemon_process *daemon;
    uint64_t seed, hash;
} player;

/* Half of what it asks for is answered by a worker, half by its I/O thread. */
static void *play(void *context)
{
    player *p = context;
    awtclient *client = daemon_client(p->daemon);
    uint64_t forest = client ? create(client, STRANDS, p->seed) : 0;
    proto_message frame;
    p->hash = HASH_SEED;
    for (int n = 1; forest && n <= 2 * FRAMES; n++) {
        if (!ask(client, n % 2 ? step_query(forest, n) : latest_query(forest), &frame)) {
            break;
        }
        const proto_blob *glb = &frame.as.frame.glb;
        p->hash = hash_words(hash_u64(p->hash, glb->length), glb->bytes, glb->length / 4);
    }
    awtclient_close(client);
    return NULL;
}

static void play_all(const char *io_threads, uint64_t hashes[PLAYERS])
{
    daemon_process daemon;
    const char *const arguments[] = {"--io-threads", io_threads, NULL};
    CHECK(daemon_start(&daemon, 2, arguments));
    player players[PLAYERS];
    pthread_t threads[PLAYERS];
    for (int k = 0; k < PLAYERS; k++) {
        players[k] = (player){.daemon = &daemon, .seed = (uint64_t)k + 1};
        CHECK_INT(pthread_create(&threads[k], NULL, play, &players[k]), 0);
    }
    for (int k = 0; k < PLAYERS; k++) {
        pthread_join(threads[k], NULL);
        hashes[k] = players[k].hash;
    }
    CHECK_INT(daemon_stop(&daemon), 0);
}

TEST(e2e_many_io_threads_serve_the_same_bytes_as_one)
{
    uint64_t one[PLAYERS], many[PLAYERS];
    play_all("1", one);
    play_all("9", many);
    for (int k = 0; k < PLAYERS; k++) {
        CHECK_U64(many[k], one[k]);
        CHECK(k == 0 || one[k] != one[k - 1]);
    }
}

/* ---- idle connections -------------------------------------------------------------------------------------------- */

TEST(e2e_a_connection_that_falls_idle_is_set_apart_and_answered_when_it_wakes)
{
    daemon_process daemon;
    const char *const arguments[] = {"--io-threads", "2", NULL};
    CHECK(daemon_start(&daemon, 1, arguments));
    awtclient *sleeper = daemon_client(&daemon), *busy = daemon_client(&daemon), *viewer = daemon_client(&daemon);
    proto_message answer, attach = {.type = PROTO_ATTACH}, subscribe = {.type = PROTO_SUBSCRIBE};
    proto_message make = {.type = PROTO_CREATE};
    make.as.create.style = proto_str_of("short");
    make.as.create.strands = STRANDS;
    make.as.create.head.orientation[3] = make.as.create.body.orientation[3] = 1;
    CHECK(ask(sleeper, make, &answer));
    uint64_t forest = answer.as.create_reply.forest;
    attach.as.attach.forest = subscribe.as.subscribe.forest = forest;
    memcpy(attach.as.attach.token, answer.as.create_reply.view_token, sizeof attach.as.attach.token);
    CHECK(ask(viewer, attach, &answer));
    subscribe.as.subscribe.credit = 1000;
    CHECK(ask(viewer, subscribe, &answer));
    CHECK_INT(stats(busy).io_threads, 2);
    CHECK_INT(wait_for_idle(busy, 2, 2), 2);
    CHECK(ask(sleeper, (proto_message){.type = PROTO_PING}, &answer)); /* only keeps it open */
    CHECK_INT(stats(busy).idle_connections, 2);

    CHECK(ask(sleeper, step_query(forest, 1), &answer)); /* wakes it, and with the frame the viewer */
    CHECK_INT(answer.type, PROTO_FRAME);
    awtclient_error error = {0};
    CHECK(awtclient_receive(viewer, &answer, &error));
    CHECK_INT(answer.type, PROTO_FRAME);
    CHECK_INT(wait_for_idle(busy, 0, 0), 0);
    CHECK_INT(wait_for_idle(busy, 2, 2), 2); /* and they fall asleep again */
    awtclient_close(sleeper);
    awtclient_close(busy);
    awtclient_close(viewer);
    CHECK_INT(daemon_stop(&daemon), 0);
}

enum { IDLE = 1100 };

/* False: this process may not have so many descriptors. */
static bool room_for_descriptors(rlim_t count)
{
    struct rlimit limit;
    if (getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_max < count) {
        return false;
    }
    limit.rlim_cur = limit.rlim_cur < count ? count : limit.rlim_cur;
    return setrlimit(RLIMIT_NOFILE, &limit) == 0;
}

TEST(e2e_a_thousand_idle_connections_stay_open_while_others_are_served)
{
    if (!room_for_descriptors(IDLE + 64)) {
        check_skip("too few descriptors");
        return;
    }
    daemon_process daemon;
    const char *const arguments[] = {"--io-threads", "2", "--max-connections", "1200", NULL};
    CHECK(daemon_start(&daemon, 1, arguments));
    awtclient **idle = calloc(IDLE, sizeof *idle), *busy = daemon_client(&daemon);
    uint64_t forest = create(busy, STRANDS, 1);
    proto_message answer;
    int opened = 0, answered = 0;
    for (; opened < IDLE && (idle[opened] = daemon_client(&daemon)); opened++) {
    }
    CHECK_INT(opened, IDLE);
    CHECK_INT(wait_for_idle(busy, IDLE, IDLE), IDLE);
    for (int n = 1; n <= 200; n++) {
        answered += ask(busy, n % 2 ? step_query(forest, n) : latest_query(forest), &answer);
    }
    CHECK_INT(answered, 200);
    CHECK_INT(stats(busy).connections, IDLE + 1);
    CHECK_INT(stats(busy).idle_connections, IDLE);
    for (int k = 0; k < opened; k += 11) {
        CHECK(ask(idle[k], (proto_message){.type = PROTO_LIST}, &answer));
        CHECK_INT(answer.as.list_reply.total, 1);
    }
    for (int k = 0; k < opened; k++) {
        awtclient_close(idle[k]);
    }
    for (int n = 0; n < PATIENCE && stats(busy).connections > 1; n++) {
        nanosleep(&(struct timespec){.tv_nsec = 10000000}, NULL);
    }
    CHECK_INT(stats(busy).connections, 1);
    CHECK_INT(stats(busy).idle_connections, 0);
    awtclient_close(busy);
    free(idle);
    CHECK_INT(daemon_stop(&daemon), 0);
}

/* ---- replies of workers ------------------------------------------------------------------------------------------ */

TEST(e2e_replies_to_a_client_that_does_not_read_block_nobody_and_are_all_there_when_it_does)
{
    enum { UNREAD = 60, LARGE = 12000 };
    daemon_process daemon;
    CHECK(daemon_start(&daemon, 1, NULL));
    awtclient *deaf = daemon_client(&daemon), *other = daemon_client(&daemon);
    int small = 256 * 1024; /* less than a few frames */
    setsockopt(awtclient_descriptor(deaf), SOL_SOCKET, SO_RCVBUF, &small, sizeof small);
    uint64_t large = create(deaf, LARGE, 1), forest = create(other, STRANDS, 2), first = 0;
    awtclient_error error = {0};
    proto_message answer;
    for (int n = 1; n <= UNREAD; n++) { /* each is answered by the one worker */
        proto_message query = step_query(large, n);
        CHECK(awtclient_send(deaf, &query, &error));
        first = n == 1 ? query.request : first;
    }
    int answered = 0;
    for (int n = 1; n <= 50; n++) {
        answered += ask(other, step_query(forest, n), &answer);
    }
    CHECK_INT(answered, 50);
    CHECK(stats(other).frames_sent < UNREAD + 50); /* it is deaf indeed: some of its frames still wait */
    for (int n = 1; n <= UNREAD; n++) {
        CHECK(awtclient_receive(deaf, &answer, &error));
        CHECK_TEXT(error.text, "");
        CHECK_U64(answer.request, first + (uint64_t)n - 1);
        CHECK_INT(answer.as.frame.time_us, n * 16667);
    }
    awtclient_close(deaf);
    awtclient_close(other);
    CHECK_INT(daemon_stop(&daemon), 0);
}

TEST(e2e_clients_that_go_while_workers_write_to_them_leave_everyone_else_alone)
{
    enum { ROUNDS = 60, ASKED = 8 };
    daemon_process daemon;
    const char *const arguments[] = {"--io-threads", "3", NULL};
    CHECK(daemon_start(&daemon, 2, arguments));
    awtclient *owner = daemon_client(&daemon);
    proto_message answer, attach = {.type = PROTO_ATTACH}, make = {.type = PROTO_CREATE};
    make.as.create.style = proto_str_of("short");
    make.as.create.strands = STRANDS;
    make.as.create.head.orientation[3] = make.as.create.body.orientation[3] = 1;
    CHECK(ask(owner, make, &answer));
    uint64_t forest = attach.as.attach.forest = answer.as.create_reply.forest;
    memcpy(attach.as.attach.token, answer.as.create_reply.drive_token, sizeof attach.as.attach.token);
    int time = 0;
    for (int round = 0; round < ROUNDS; round++) {
        awtclient *leaver = daemon_client(&daemon);
        awtclient_error error = {0};
        CHECK(ask(leaver, attach, &answer));
        for (int n = 0; n < ASKED; n++) {
            proto_message query = step_query(forest, ++time);
            CHECK(awtclient_send(leaver, &query, &error));
        }
        if (round % 2) { /* by the half: a reset, while answers are on their way */
            struct linger at_once = {.l_onoff = 1};
            setsockopt(awtclient_descriptor(leaver), SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
        }
        nanosleep(&(struct timespec){.tv_nsec = 100000 * (round % 20)}, NULL);
        awtclient_close(leaver);
        if (round % 4 == 3) { /* what they asked is done in its turn; no more of it waits than the forest takes */
            CHECK(ask(owner, step_query(forest, ++time), &answer));
        }
    }
    CHECK(ask(owner, step_query(forest, ++time), &answer));
    CHECK_INT(answer.as.frame.time_us, time * 16667);
    for (int n = 0; n < PATIENCE && stats(owner).connections > 1; n++) {
        nanosleep(&(struct timespec){.tv_nsec = 10000000}, NULL);
    }
    CHECK_INT(stats(owner).connections, 1);
    awtclient_close(owner);
    CHECK_INT(daemon_stop(&daemon), 0);
}
