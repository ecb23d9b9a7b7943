/* test_e2e_load.c: awt-load against a daemon, a dead address, a wrong token and programs that are no daemon. No time
 * that it measures is looked at. */
#include "check.h"
#include "e2e/daemon.h"
#include "unit/fake_daemon.h"

#include "geom/json.h"

#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

typedef struct outcome {
    int code;         /* its exit code; -1: it did not exit by itself */
    char said[65536]; /* on both outputs */
} outcome;

/* Runs awt-load with those arguments. */
static outcome *run_load(const char *arguments)
{
    outcome *o = calloc(1, sizeof *o);
    char command[1024];
    snprintf(command, sizeof command, "'%s/awt-load' --quiet %s 2>&1", check_build_directory(), arguments);
    FILE *pipe = popen(command, "r");
    CHECK(pipe != NULL);
    const size_t got = pipe ? fread(o->said, 1, sizeof o->said - 1, pipe) : 0;
    o->said[got] = '\0';
    const int status = pipe ? pclose(pipe) : -1;
    o->code = status != -1 && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return o;
}

static outcome *run_load_at(const daemon_process *daemon, const char *arguments)
{
    char all[900];
    snprintf(all, sizeof all, "--connect %s --token-file %s %s", daemon->address, daemon->token_file, arguments);
    return run_load(all);
}

static double number_at(const json_document *json, uint32_t object, const char *name)
{
    double value = -1;
    json_real(json, json_member(json, object, name), &value);
    return value;
}

/* What the JSON file says of a load that went well. */
static void check_figures(const char *path, const char *scenario, bool has_age)
{
    size_t size = 0;
    char *text = (char *)check_read_file(path, &size);
    json_document json = {0};
    CHECK(text && json_read(text, size, &json, NULL) == AWT_OK);
    if (json.count > 0) {
        const double offered = number_at(&json, 0, "offered_per_s");
        CHECK(json_is_text(&json, json_member(&json, 0, "scenario"), scenario));
        CHECK_NEAR(number_at(&json, 0, "errors"), 0, 0);
        CHECK(offered > 0 && number_at(&json, 0, "achieved_per_s") > 0);
        CHECK(number_at(&json, 0, "late_sends") >= 0);
        CHECK(number_at(&json, json_member(&json, 0, "latency_us"), "p50") > 0);
        CHECK(number_at(&json, json_member(&json, 0, "floor_us"), "p50") > 0);
        CHECK(!has_age || number_at(&json, json_member(&json, 0, "frame_age_us"), "max") > 0);
    }
    json_fini(&json);
    free(text);
    remove(path);
}

static void check_scenario(const char *scenario, const char *more)
{
    daemon_process daemon;
    char path[300], arguments[600];
    CHECK(daemon_start(&daemon, 1, NULL));
    snprintf(path, sizeof path, "%s/load-%s.json", check_build_directory(), scenario);
    snprintf(
        arguments, sizeof arguments,
        "--scenario %s --duration 0.5 --connections 6 --forests 2 --strands 200 --style short --rate 20 --json '%s' %s",
        scenario, path, more);
    outcome *o = run_load_at(&daemon, arguments);
    const bool good = o->code == 0 && strstr(o->said, "awtd / bare") && strstr(o->said, "errors: 0\n");
    CHECK_TEXT(good ? "" : o->said, "");
    check_figures(path, scenario, true);
    free(o);
    awtclient *client = daemon_client(&daemon);
    proto_message request = {.type = PROTO_STATS}, answer;
    CHECK(awtclient_call(client, &request, &answer, NULL));
    CHECK_INT(answer.as.stats_reply.forests, 0); /* it has ended the heads that it made */
    awtclient_close(client);
    CHECK_INT(daemon_stop(&daemon), 0);
}

static void check_failure(outcome *o, int code, const char *said)
{
    CHECK_INT(o->code, code);
    CHECK(strstr(o->said, said) != NULL);
    if (!strstr(o->said, said)) {
        CHECK_TEXT(o->said, said);
    }
    free(o);
}

TEST(e2e_load_query_asks_by_the_clock_and_as_fast_as_it_can)
{
    check_scenario("query", "");
    check_scenario("query", "--closed --kind ribbon --level guides");
}

TEST(e2e_load_stream_reaches_every_viewer)
{
    check_scenario("stream", "");
    check_scenario("stream", "--closed --motion still --threads 3");
    check_scenario("stream", "--deltas --motion jump --credit 3");
}

TEST(e2e_load_stream_watches_heads_that_run_by_the_daemons_clock)
{
    daemon_process daemon;
    unsigned long long answers = 0;
    CHECK(daemon_start(&daemon, 1, NULL));
    outcome *o = run_load_at(&daemon, "--scenario stream --free --moving 0.5 --duration 1 --connections 4 --forests 2 "
                                      "--strands 200 --style short --rate 20 --hdr -");
    const char *total = strstr(o->said, "Total count    =");
    CHECK_TEXT(o->code == 0 && total && strstr(o->said, "errors: 0\n") ? "" : o->said, "");
    CHECK(total && sscanf(total, "Total count    = %llu", &answers) == 1 && answers > 0);
    free(o);
    CHECK_INT(daemon_stop(&daemon), 0);
    check_failure(run_load("--free"), 2, "--free is for stream");
}

TEST(e2e_load_mixed_moves_watches_and_makes_heads)
{
    check_scenario("mixed", "--kind guides");
}

TEST(e2e_load_idle_holds_connections_beside_those_that_ask)
{
    check_scenario("idle", "--idle 20");
}

TEST(e2e_load_idle_holds_as_many_as_the_daemon_takes)
{
    static const char *const few[] = {"--max-connections", "12", NULL};
    daemon_process daemon;
    CHECK(daemon_start(&daemon, 1, few));
    outcome *o =
        run_load_at(&daemon, "--scenario idle --duration 0.3 --connections 4 --forests 1 --strands 200 --rate 20 "
                             "--idle 50");
    CHECK_INT(o->code, 0);
    CHECK(strstr(o->said, "idle ones of 50") != NULL);
    free(o);
    CHECK_INT(daemon_stop(&daemon), 0);
}

TEST(e2e_load_churn_comes_and_goes)
{
    check_scenario("churn", "");
}

TEST(e2e_load_slow_viewer_compares_pairs)
{
    check_scenario("slow-viewer", "--pairs 1 --connections 11");
}

TEST(e2e_load_writes_percentiles_and_measures_without_a_floor)
{
    daemon_process daemon;
    char path[300], arguments[600];
    size_t size = 0;
    CHECK(daemon_start(&daemon, 1, NULL));
    snprintf(path, sizeof path, "%s/load.hdr", check_build_directory());
    snprintf(arguments, sizeof arguments,
             "--duration 0.2 --connections 2 --forests 1 --strands 200 --no-floor --hdr '%s'", path);
    outcome *o = run_load_at(&daemon, arguments);
    CHECK_INT(o->code, 0);
    CHECK(strstr(o->said, "bare poll()") == NULL);
    char *text = (char *)check_read_file(path, &size);
    CHECK(text && size > 200 && strstr(text, "1/(1-Percentile)") && strstr(text, "#[Max     ="));
    free(text);
    remove(path);
    free(o);
    CHECK_INT(daemon_stop(&daemon), 0);
}

TEST(e2e_load_says_plainly_why_it_cannot_begin)
{
    daemon_process daemon;
    char arguments[300], wrong_token[128];
    check_failure(run_load("--connect 127.0.0.1:1"), 1, "nobody answers at 127.0.0.1:1");
    check_failure(run_load("--scenario dance"), 2, "there is no scenario dance");
    check_failure(run_load("--kind wool"), 2, "there is no kind or level wool");
    check_failure(run_load("--rate fast"), 2, "--rate takes a number");
    check_failure(run_load("--floor-server nowhere:x"), 1, "HOST:PORT is wanted");
    CHECK(daemon_start(&daemon, 1, NULL));
    snprintf(wrong_token, sizeof wrong_token, "%s/load-wrong-token", check_build_directory());
    FILE *file = fopen(wrong_token, "w");
    fputs("00112233445566778899aabbccddeeff\n", file);
    fclose(file);
    snprintf(arguments, sizeof arguments, "--connect %s --token-file '%s'", daemon.address, wrong_token);
    check_failure(run_load(arguments), 1, "is not that of this daemon");
    remove(wrong_token);
    check_failure(run_load_at(&daemon, "--style bald"), 1, "no built-in style");
    check_failure(run_load_at(&daemon, "--motion moonwalk"), 1, "there is no clip \"moonwalk\"");
    check_failure(run_load_at(&daemon, "--duration 0.2 --strands 200 --floor 127.0.0.1:1"), 1, "the bare server");
    CHECK_INT(daemon_stop(&daemon), 0);
}

/* ---- programs that are no daemon --------------------------------------------------------------------------------- */

static const char noise[] = "HTTP/1.1 400 Bad Request\r\nContent-Length: 0\r\n\r\nand so on, and so on, and so on\r\n";

static void script_noise(fake *self)
{
    fake_read(self);
    fake_write(self, noise, sizeof noise);
}

/* Serves who comes first as a daemon would, so that the load begins; then the load's own connections come, and the
 * first of them is told nonsense. */
static void script_two_faces(fake *self)
{
    struct pollfd next = {.fd = self->listener, .events = POLLIN};
    bool going = fake_welcome(self, false);
    while (going && poll(&next, 1, 0) == 0 && fake_read(self)) {
        proto_message answer = {.request = self->got.request};
        if (self->got.type == PROTO_CREATE) {
            answer.type = PROTO_CREATE_REPLY;
            answer.as.create_reply.forest = 1;
        } else if (self->got.type == PROTO_QUERY) {
            answer.type = PROTO_FRAME;
        } else {
            answer.type = PROTO_PONG;
        }
        self->pings_answered += answer.type == PROTO_PONG;
        going = script_send(self, &answer);
        going = going && (self->pings_answered < 5 || poll(&next, 1, FAKE_PATIENCE_MS) == 1);
    }
    const int owner = self->peer;
    self->peer = going ? accept(self->listener, NULL, NULL) : -1;
    script_noise(self);
    close(owner);
}

TEST(e2e_load_survives_programs_that_are_no_daemon)
{
    static void (*const scripts[])(fake * self) = {script_noise, script_two_faces};
    for (size_t i = 0; i < sizeof scripts / sizeof scripts[0]; i++) {
        fake server;
        char arguments[300];
        CHECK(fake_start(&server, scripts[i]));
        snprintf(arguments, sizeof arguments, "--connect %s --connections 1 --forests 1 --duration 0.2",
                 server.address);
        outcome *o = run_load(arguments);
        CHECK_INT(o->code, 1);
        CHECK(strstr(o->said, "protocol") != NULL);
        if (!strstr(o->said, "protocol")) {
            CHECK_TEXT(o->said, "");
        }
        free(o);
        fake_stop(&server);
    }
}
