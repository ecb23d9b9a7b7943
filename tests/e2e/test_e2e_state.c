/* test_e2e_state.c: the daemon ends, by SIGTERM or killed at any moment, and starts again: its forests are there, each
 * as it was at some moment before, whole. */
#include "check.h"
#include "e2e/daemon.h"

#include "base/crc32c.h"
#include "base/rng.h"

#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { STRANDS = 200, STEP_US = 10000, FEW_KILLS = 6, PATIENCE = 3000 /* hundredths of a second */ };

static const char *const saving_often[] = {"--save-interval", "1", NULL};

static struct proto_create_reply create(awtclient *client, uint64_t seed)
{
    proto_message request = {.type = PROTO_CREATE}, answer = {0};
    awtclient_error error = {0};
    request.as.create.style = proto_str_of("long");
    request.as.create.seed = seed;
    request.as.create.strands = STRANDS;
    request.as.create.head.orientation[3] = request.as.create.body.orientation[3] = 1;
    CHECK(awtclient_call(client, &request, &answer, &error));
    CHECK_TEXT(error.text, "");
    return answer.as.create_reply;
}

static int64_t attach(awtclient *client, const struct proto_create_reply *forest)
{
    proto_message request = {.type = PROTO_ATTACH}, answer = {0};
    awtclient_error error = {0};
    request.as.attach.forest = forest->forest;
    memcpy(request.as.attach.token, forest->drive_token, sizeof request.as.attach.token);
    CHECK(awtclient_call(client, &request, &answer, &error));
    CHECK_TEXT(error.text, "");
    return answer.as.attach_reply.time_us;
}

/* Moves and steps from step `from` to step `to`; false: the connection ended on the way. A sum of the hair. */
static bool drive(awtclient *client, uint64_t forest, int from, int to, uint32_t *sum)
{
    *sum = 0;
    for (int n = from; n <= to; n++) {
        proto_message motion = {.type = PROTO_MOTION}, query = {.type = PROTO_QUERY}, answer = {0};
        awtclient_error error = {0};
        motion.as.motion.forest = query.as.query.forest = forest;
        motion.as.motion.sequence = (uint32_t)n;
        motion.as.motion.time_us = query.as.query.time_us = (int64_t)n * STEP_US;
        motion.as.motion.head.position[0] = motion.as.motion.body.position[0] = 0.02 * (n % 7);
        motion.as.motion.head.orientation[3] = motion.as.motion.body.orientation[3] = 1;
        if (!awtclient_send(client, &motion, &error) || !awtclient_call(client, &query, &answer, &error)) {
            return false;
        }
        *sum = crc32c_more(*sum, answer.as.frame.glb.bytes, answer.as.frame.glb.length);
    }
    return true;
}

static uint64_t state_hash(awtclient *client, uint64_t forest)
{
    proto_message request = {.type = PROTO_SNAPSHOT}, answer = {0};
    awtclient_error error = {0};
    request.as.snapshot.forest = forest;
    CHECK(awtclient_call(client, &request, &answer, &error));
    CHECK_TEXT(error.text, "");
    return answer.as.snapshot_reply.hash;
}

TEST(e2e_daemon_that_was_stopped_goes_on_to_the_bit_when_it_starts_again)
{
    daemon_process daemon;
    uint32_t before = 0, never_stopped = 0, after = 0;
    CHECK(daemon_start(&daemon, 2, NULL));
    awtclient *client = daemon_client(&daemon);
    const struct proto_create_reply stops = create(client, 3), goes_on = create(client, 3);
    CHECK(drive(client, stops.forest, 1, 12, &before) && drive(client, goes_on.forest, 1, 30, &never_stopped));
    CHECK(drive(client, goes_on.forest, 31, 50, &never_stopped));
    const uint64_t hash = state_hash(client, stops.forest);
    awtclient_close(client);
    CHECK_INT(daemon_end(&daemon), 0);
    for (int n = 0; n < 2; n++) { /* stopping and starting changes nothing either */
        CHECK(daemon_start_again(&daemon, 1, NULL));
        client = daemon_client(&daemon);
        CHECK_INT(attach(client, &stops), 12 * STEP_US);
        CHECK_U64(state_hash(client, stops.forest), hash);
        awtclient_close(client);
        CHECK_INT(daemon_end(&daemon), 0);
    }
    CHECK(daemon_start_again(&daemon, 2, NULL));
    client = daemon_client(&daemon);
    attach(client, &stops);
    CHECK(drive(client, stops.forest, 13, 30, &after) && drive(client, stops.forest, 31, 50, &after));
    CHECK_U64(after, never_stopped);
    awtclient_close(client);
    CHECK_INT(daemon_stop(&daemon), 0);
}

TEST(e2e_daemon_that_stops_tells_its_clients_and_then_refuses)
{
    daemon_process daemon;
    CHECK(daemon_start(&daemon, 1, NULL));
    awtclient *client = daemon_client(&daemon);
    proto_message message = {0}, stats = {.type = PROTO_STATS}, answer = {0};
    awtclient_error error = {0};
    kill(daemon.pid, SIGTERM);
    CHECK(awtclient_receive(client, &message, &error));
    CHECK_TEXT(proto_type_name(message.type), "GOAWAY");
    CHECK_INT(message.as.goaway.grace_ms, 1000);
    CHECK(awtclient_call(client, &stats, &answer, &error)); /* for so long it goes on as before */
    while (awtclient_call(client, &stats, &answer, &error)) {
        nanosleep(&(struct timespec){.tv_nsec = 10000000}, NULL);
    }
    CHECK(error.code == PROTO_ERROR_STOPPING || error.code == AWTCLIENT_CLOSED);
    awtclient_close(client);
    CHECK_INT(daemon_stop(&daemon), 0);
}

/* The file in which a forest is kept: a new one, with another number, each time it is saved. 0: there is none. */
static ino_t kept_file(const daemon_process *daemon, uint64_t forest)
{
    char path[160];
    struct stat about;
    snprintf(path, sizeof path, "%s/forests/%016llx.forest", daemon->state_directory, (unsigned long long)forest);
    return stat(path, &about) == 0 ? about.st_ino : 0;
}

/* Has it saved and waits until that is done. */
static void save(const daemon_process *daemon, uint64_t forest)
{
    const ino_t before = kept_file(daemon, forest);
    kill(daemon->pid, SIGUSR1);
    for (int n = 0; n < PATIENCE && kept_file(daemon, forest) == before; n++) {
        nanosleep(&(struct timespec){.tv_nsec = 10000000}, NULL);
    }
    CHECK(kept_file(daemon, forest) != before);
}

/* Kills the daemon at some moment of saving or stepping, starts it again, and looks at what is there. */
static void kill_and_look(daemon_process *daemon, const struct proto_create_reply *forest, rng *random, int *step)
{
    uint32_t sum = 0;
    awtclient *client = daemon_client(daemon);
    const int64_t at_us = attach(client, forest);
    CHECK(at_us % STEP_US == 0 && at_us <= (int64_t)*step * STEP_US);
    const int from = (int)(at_us / STEP_US);
    CHECK(drive(client, forest->forest, from + 1, from + 20 + (int)(rng_u32(random) % 40), &sum));
    *step = from + 60;
    if (rng_u32(random) % 2) {
        save(daemon, forest->forest);
    } else {
        kill(daemon->pid, SIGUSR1); /* saving begins */
        nanosleep(&(struct timespec){.tv_nsec = (long)(rng_u32(random) % 12000) * 1000}, NULL);
    }
    daemon_kill(daemon);
    awtclient_close(client);
    CHECK(daemon_start_again(daemon, 1, saving_often));
}

/* The hash that a forest has at that step, from one that nobody killed. */
static uint64_t true_hash(awtclient *client, uint64_t reference, int *reached, int step)
{
    uint32_t sum = 0;
    CHECK(step >= *reached && drive(client, reference, *reached + 1, step, &sum));
    *reached = step;
    return state_hash(client, reference);
}

TEST(e2e_daemon_killed_at_any_moment_keeps_a_whole_state)
{
    const char *asked = getenv("AWT_KILLS"); /* make soak: hundreds */
    const long kills = asked ? strtol(asked, NULL, 10) : FEW_KILLS;
    daemon_process daemon, other;
    rng random = rng_seed(20251125);
    int step = 0, reached = 0;
    CHECK(daemon_start(&daemon, 1, saving_often) && daemon_start(&other, 1, NULL));
    awtclient *client = daemon_client(&daemon), *reference = daemon_client(&other);
    const struct proto_create_reply forest = create(client, 3), truth = create(reference, 3);
    save(&daemon, forest.forest);
    awtclient_close(client);
    for (long n = 0; n < kills; n++) {
        kill_and_look(&daemon, &forest, &random, &step);
        client = daemon_client(&daemon);
        const int restored = (int)(attach(client, &forest) / STEP_US);
        if (restored >= reached) { /* the reference runs forwards only */
            CHECK_U64(state_hash(client, forest.forest), true_hash(reference, truth.forest, &reached, restored));
        }
        awtclient_close(client);
    }
    CHECK(reached > 0);
    awtclient_close(reference);
    CHECK_INT(daemon_stop(&daemon), 0);
    CHECK_INT(daemon_stop(&other), 0);
}

TEST(e2e_state_directory_that_cannot_be_written_stops_the_start)
{
    daemon_process daemon;
    char forests[96];
    CHECK(daemon_start(&daemon, 1, NULL));
    CHECK_INT(daemon_end(&daemon), 0);
    snprintf(forests, sizeof forests, "%s/forests", daemon.state_directory);
    CHECK_INT(rmdir(forests), 0);
    int fd = open(forests, O_WRONLY | O_CREAT, 0600); /* a file stands in the way */
    CHECK(fd >= 0);
    close(fd);
    CHECK(!daemon_start_again(&daemon, 1, NULL));
    CHECK_INT(daemon_end(&daemon), 1);
    unlink(forests);
    daemon_forget(&daemon);
}
