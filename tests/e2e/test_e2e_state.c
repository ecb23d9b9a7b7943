/* test_e2e_state.c: the daemon ends, by SIGTERM or killed at any moment, and starts again: its forests are there, each
 * as it was at some moment before, whole. */
#include "check.h"
#include "e2e/kept.h"

#include "base/rng.h"

#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

enum { FEW_KILLS = 6 };

static const char *const saving_often[] = {"--save-interval", "1", NULL};

TEST(e2e_daemon_that_was_stopped_goes_on_to_the_bit_when_it_starts_again)
{
    daemon_process daemon;
    uint32_t before = 0, never_stopped = 0, after = 0;
    CHECK(daemon_start(&daemon, 2, NULL));
    awtclient *client = daemon_client(&daemon);
    const struct proto_create_reply stops = kept_create(client, 3), goes_on = kept_create(client, 3);
    CHECK(kept_drive(client, stops.forest, 1, 12, &before) &&
          kept_drive(client, goes_on.forest, 1, 30, &never_stopped));
    CHECK(kept_drive(client, goes_on.forest, 31, 50, &never_stopped));
    const uint64_t hash = kept_hash(client, stops.forest);
    awtclient_close(client);
    CHECK_INT(daemon_end(&daemon), 0);
    for (int n = 0; n < 2; n++) { /* stopping and starting changes nothing either */
        CHECK(daemon_start_again(&daemon, 1, NULL));
        client = daemon_client(&daemon);
        CHECK_INT(kept_attach(client, &stops), 12 * KEPT_STEP_US);
        CHECK_U64(kept_hash(client, stops.forest), hash);
        awtclient_close(client);
        CHECK_INT(daemon_end(&daemon), 0);
    }
    CHECK(daemon_start_again(&daemon, 2, NULL));
    client = daemon_client(&daemon);
    kept_attach(client, &stops);
    CHECK(kept_drive(client, stops.forest, 13, 30, &after) && kept_drive(client, stops.forest, 31, 50, &after));
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

/* Kills the daemon at some moment of saving or stepping, starts it again, and looks at what is there. */
static void kill_and_look(daemon_process *daemon, const struct proto_create_reply *forest, rng *random, int *step)
{
    uint32_t sum = 0;
    awtclient *client = daemon_client(daemon);
    const int64_t at_us = kept_attach(client, forest);
    CHECK(at_us % KEPT_STEP_US == 0 && at_us <= (int64_t)*step * KEPT_STEP_US);
    const int from = (int)(at_us / KEPT_STEP_US);
    CHECK(kept_drive(client, forest->forest, from + 1, from + 20 + (int)(rng_u32(random) % 40), &sum));
    *step = from + 60;
    if (rng_u32(random) % 2) {
        kept_save(daemon, forest->forest);
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
    CHECK(step >= *reached && kept_drive(client, reference, *reached + 1, step, &sum));
    *reached = step;
    return kept_hash(client, reference);
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
    const struct proto_create_reply forest = kept_create(client, 3), truth = kept_create(reference, 3);
    kept_save(&daemon, forest.forest);
    awtclient_close(client);
    for (long n = 0; n < kills; n++) {
        kill_and_look(&daemon, &forest, &random, &step);
        client = daemon_client(&daemon);
        const int restored = (int)(kept_attach(client, &forest) / KEPT_STEP_US);
        if (restored >= reached) { /* the reference runs forwards only */
            CHECK_U64(kept_hash(client, forest.forest), true_hash(reference, truth.forest, &reached, restored));
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
