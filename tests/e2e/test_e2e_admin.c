/* test_e2e_admin.c: what an operator sees of a daemon: its pages, its checks, its settings read again. */
#include "check.h"
#include "e2e/daemon.h"
#include "limits.h"
#include "unit/prometheus.h"

#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static const char *const with_admin[] = {"--admin", "127.0.0.1:0", NULL};

/* All that comes until the daemon closes; the next call overwrites it. */
static const char *read_rest(int fd)
{
    static char text[128 * 1024];
    size_t used = 0;
    struct pollfd slot = {.fd = fd, .events = POLLIN};
    while (used + 1 < sizeof text && poll(&slot, 1, 20000) > 0) {
        ssize_t got = recv(fd, text + used, sizeof text - 1 - used, 0);
        if (got <= 0) {
            break;
        }
        used += (size_t)got;
    }
    text[used] = '\0';
    return text;
}

static const char *get(const daemon_process *daemon, const char *path)
{
    char request[128];
    int fd = daemon_socket_to(daemon->admin);
    int size = snprintf(request, sizeof request, "GET %s HTTP/1.1\r\nHost: x\r\n\r\n", path);
    CHECK(fd >= 0 && send(fd, request, (size_t)size, MSG_NOSIGNAL) == size);
    const char *text = read_rest(fd);
    close(fd);
    return text;
}

static const char *body_of(const char *answer)
{
    const char *end = strstr(answer, "\r\n\r\n");
    return end ? end + 4 : "";
}

TEST(e2e_operator_sees_a_daemon_that_lives_is_ready_and_counts)
{
    daemon_process daemon;
    char error[256] = "";
    CHECK(daemon_start(&daemon, 1, with_admin));
    CHECK_TEXT(body_of(get(&daemon, "/livez")), "alive\n");
    CHECK_TEXT(body_of(get(&daemon, "/readyz")), "ready\n");
    awtclient *client = daemon_client(&daemon);
    const char *metrics = body_of(get(&daemon, "/metrics"));
    prometheus_check(metrics, error, sizeof error);
    CHECK_TEXT(error, "");
    CHECK(prometheus_value(metrics, "awtd_connections") == 1);
    CHECK(prometheus_value(metrics, "awtd_workers") == 1);
    CHECK(prometheus_value(metrics, "awtd_received_bytes_total") > 0);
    CHECK(strncmp(get(&daemon, "/"), "HTTP/1.1 404 ", 13) == 0);
    awtclient_close(client);
    CHECK_INT(daemon_stop(&daemon), 0);
}

TEST(e2e_operators_address_holds_out_against_many_that_say_nothing)
{
    daemon_process daemon;
    int silent[3 * LIMIT_ADMIN_CONNECTIONS];
    CHECK(daemon_start(&daemon, 1, with_admin));
    for (size_t i = 0; i < sizeof silent / sizeof silent[0]; i++) {
        silent[i] = daemon_socket_to(daemon.admin);
        CHECK(silent[i] >= 0 && send(silent[i], "GET /", 5, MSG_NOSIGNAL) == 5);
    }
    CHECK_TEXT(body_of(get(&daemon, "/livez")), "alive\n");
    CHECK_TEXT(read_rest(silent[0]), ""); /* the oldest made room */
    for (size_t i = 0; i < sizeof silent / sizeof silent[0]; i++) {
        close(silent[i]);
    }
    int fd = daemon_socket_to(daemon.admin);
    static char large[LIMIT_ADMIN_REQUEST];
    memset(large, 'a', sizeof large);
    CHECK(send(fd, large, sizeof large, MSG_NOSIGNAL) == (ssize_t)sizeof large);
    CHECK(strncmp(read_rest(fd), "HTTP/1.1 431 ", 13) == 0);
    close(fd);
    CHECK_INT(daemon_stop(&daemon), 0);
}

TEST(e2e_operators_address_is_loopback_unless_that_is_spelled_out)
{
    daemon_process daemon;
    CHECK(!daemon_start(&daemon, 1, (const char *const[]){"--admin", "0.0.0.0:0", NULL}));
    daemon_stop(&daemon);
    CHECK(daemon_start(&daemon, 1, (const char *const[]){"--admin", "0.0.0.0:0", "--admin-open", NULL}));
    CHECK_INT(daemon_stop(&daemon), 0);
}

/* ---- settings ---------------------------------------------------------------------------------------------------- */

static void write_settings(const char *path, const char *text)
{
    FILE *file = fopen(path, "w");
    CHECK(file && fputs(text, file) >= 0 && fclose(file) == 0);
}

/* Waits until the log has that text; 20 s at most. */
static bool log_comes_to(const char *path, const char *text)
{
    for (int n = 0; n < 2000; n++) {
        size_t size = 0;
        unsigned char *log = check_read_file(path, &size);
        bool there = false;
        for (size_t i = 0; log && i + strlen(text) <= size && !there; i++) {
            there = memcmp(log + i, text, strlen(text)) == 0;
        }
        free(log);
        if (there) {
            return true;
        }
        nanosleep(&(struct timespec){0, 10000000}, NULL);
    }
    return false;
}

TEST(e2e_settings_are_read_again_whole_or_not_at_all)
{
    daemon_process daemon;
    char folder[FOLDER_PATH], path[FOLDER_PATH + 16], log[FOLDER_PATH + 16];
    folder_make(folder);
    snprintf(path, sizeof path, "%s/awtd.conf", folder);
    snprintf(log, sizeof log, "%s/log", folder);
    write_settings(path, "max-forests = 8\nlog-level = info\n");
    setenv("AWT_TEST_LOG", log, 1);
    CHECK(daemon_start(&daemon, 1, (const char *const[]){"--config", path, NULL}));
    unsetenv("AWT_TEST_LOG");
    write_settings(path, "max-forests = 4\nlog-level = debug\nlog-format = json\n");
    kill(daemon.pid, SIGHUP);
    CHECK(log_comes_to(log, "\"msg\":\"settings taken\",\"max_forests\":4,\"accounts\":0}"));
    awtclient_close(daemon_client(&daemon));
    CHECK(log_comes_to(log, "\"level\":\"debug\""));
    write_settings(path, "max-forests = 2\nlog-format = text\nmax-connections = 7\n");
    kill(daemon.pid, SIGHUP);
    CHECK(log_comes_to(log, "\"msg\":\"settings refused\",\"changed\":\"max-connections\""));
    write_settings(path, "max-forests = 9\nlog-format = text\n");
    kill(daemon.pid, SIGHUP);
    CHECK(log_comes_to(log, "\"changed\":\"max-forests ("));
    write_settings(path, "log-format = text\nmax-forests = 0\n");
    kill(daemon.pid, SIGHUP);
    CHECK(log_comes_to(log, "awtd.conf:2: "));
    CHECK_INT(daemon_stop(&daemon), 0);
    CHECK(log_comes_to(log, "\"msg\":\"stopped\"")); /* still JSON: nothing of what was refused holds */
    folder_remove(folder);
}

static bool is_answered(awtclient *client)
{
    proto_message request = {.type = PROTO_STATS}, answer;
    return client && awtclient_call(client, &request, &answer, NULL);
}

/* Whether a client with the token in that file is let in, and answered. */
static bool is_let_in(const daemon_process *daemon, const char *token_file)
{
    const awtclient_options where = {.address = daemon->address, .token_file = token_file};
    awtclient *client = awtclient_open(&where, NULL);
    const bool answered = is_answered(client);
    awtclient_close(client);
    return answered;
}

TEST(e2e_accounts_come_and_go_while_awtd_runs)
{
    daemon_process daemon;
    char folder[FOLDER_PATH], path[FOLDER_PATH + 16], log[FOLDER_PATH + 16], one[FOLDER_PATH + 16],
        two[FOLDER_PATH + 16];
    folder_make(folder);
    snprintf(path, sizeof path, "%s/accounts", folder);
    snprintf(log, sizeof log, "%s/log", folder);
    snprintf(one, sizeof one, "%s/one", folder);
    snprintf(two, sizeof two, "%s/two", folder);
    write_settings(one, "11111111111111111111111111111111\n");
    write_settings(two, "22222222222222222222222222222222\n");
    write_settings(path, "one 11111111111111111111111111111111 connections=1\n");
    CHECK(chmod(path, 0600) == 0);
    setenv("AWT_TEST_LOG", log, 1);
    CHECK(daemon_start(&daemon, 1, (const char *const[]){"--accounts", path, NULL}));
    unsetenv("AWT_TEST_LOG");
    CHECK(is_let_in(&daemon, one) && is_let_in(&daemon, daemon.token_file) && !is_let_in(&daemon, two));
    const awtclient_options where = {.address = daemon.address, .token_file = one};
    awtclient *stays = awtclient_open(&where, NULL);
    CHECK(stays && !is_let_in(&daemon, one)); /* it has one already */

    write_settings(path, "two 22222222222222222222222222222222\nthree 333\n");
    kill(daemon.pid, SIGHUP);
    CHECK(log_comes_to(log, "accounts:2: "));
    CHECK(is_answered(stays) && !is_let_in(&daemon, two));

    write_settings(path, "two 22222222222222222222222222222222\n");
    kill(daemon.pid, SIGHUP);
    CHECK(log_comes_to(log, "accounts=1"));
    CHECK(is_let_in(&daemon, two) && !is_let_in(&daemon, one) && is_let_in(&daemon, daemon.token_file));
    CHECK(!is_answered(stays)); /* sent away */
    awtclient_close(stays);
    CHECK_INT(daemon_stop(&daemon), 0);
    folder_remove(folder);
}

/* The exit code of awtd with that argument and --check. */
static int check_with(const char *argument)
{
    char command[1200];
    snprintf(command, sizeof command, "'%s/awtd' --check '%s' >/dev/null 2>&1", check_build_directory(), argument);
    int status = system(command);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(e2e_check_says_whether_awtd_could_start_and_starts_nothing)
{
    CHECK_INT(check_with("--no-auth"), 0);
    CHECK_INT(check_with("--workers=0"), 2);
    CHECK_INT(check_with("--config=/nowhere/awtd.conf"), 2);
    CHECK_INT(check_with("--listen=no.such.host.invalid:1"), 2);
    CHECK_INT(check_with("--token-file=/dev/null"), 2);
    CHECK_INT(check_with("--state-dir=/tmp/awtd-test-never-made"), 0);
    CHECK(access("/tmp/awtd-test-never-made", F_OK) != 0);
}
