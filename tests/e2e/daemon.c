/* daemon.c: see daemon.h. */
#include "e2e/daemon.h"

#include "base/options.h"
#include "check.h"

#include <fcntl.h>
#include <netdb.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static void run_daemon(const char *program, int out, char *const *arguments)
{
    int log = open("/dev/null", O_WRONLY);
    const char *wanted = getenv("AWT_TEST_LOG"); /* where the daemons' logs go, for who looks for a fault */
    if (wanted) {
        close(log);
        log = open(wanted, O_WRONLY | O_CREAT | O_APPEND, 0600);
    }
    dup2(out, STDOUT_FILENO);
    dup2(log, STDERR_FILENO);
    execv(program, arguments);
    _exit(127);
}

/* A line of the daemon's standard output, without its end. */
static bool read_line(int from, char *line, size_t size)
{
    size_t used = 0;
    while (used + 1 < size) {
        ssize_t got = read(from, line + used, 1);
        if (got <= 0) {
            return false;
        }
        if (line[used] == '\n') {
            break;
        }
        used++;
    }
    line[used] = '\0';
    return true;
}

/* Copies what follows `prefix`. False: it is not there. */
static bool take_after(const char *line, const char *prefix, char *out, size_t size)
{
    const bool there = strncmp(line, prefix, strlen(prefix)) == 0;
    if (there) {
        snprintf(out, size, "%s", line + strlen(prefix));
    }
    return there;
}

/* Reads "listening on HOST:PORT" and, with `admin`, before it, if it comes, "admin on HOST:PORT". */
static bool read_addresses(int from, char *address, char *admin, size_t size)
{
    char line[128];
    while (read_line(from, line, sizeof line)) {
        if (take_after(line, "listening on ", address, size)) {
            return true;
        }
        if (!admin || !take_after(line, "admin on ", admin, size)) {
            return false;
        }
    }
    return false;
}

static bool spawn(const char *const *all, pid_t *pid, char *address, char *admin, size_t size)
{
    int out[2];
    if (pipe(out) != 0) {
        return false;
    }
    *pid = fork();
    if (*pid == 0) {
        close(out[0]);
        run_daemon(all[0], out[1], (char *const *)(uintptr_t)all);
    }
    close(out[1]);
    bool up = *pid > 0 && read_addresses(out[0], address, admin, size);
    close(out[0]);
    return up;
}

bool daemon_spawn(const char *const *all, pid_t *pid, char *address, size_t size)
{
    return spawn(all, pid, address, NULL, size);
}

bool daemon_start(daemon_process *daemon, int workers, const char *const *arguments)
{
    memset(daemon, 0, sizeof *daemon);
    folder_make(daemon->state_directory);
    snprintf(daemon->token_file, sizeof daemon->token_file, "%s/token", daemon->state_directory);
    return daemon_start_again(daemon, workers, arguments);
}

bool daemon_start_again(daemon_process *daemon, int workers, const char *const *arguments)
{
    char program[1024], count[16];
    snprintf(program, sizeof program, "%s/awtd", check_build_directory());
    snprintf(count, sizeof count, "%d", workers);
    const char *all[24] = {program, "--listen",    "127.0.0.1:0",          "--workers",
                           count,   "--state-dir", daemon->state_directory};
    size_t used = 7;
    for (; arguments && *arguments && used + 1 < sizeof all / sizeof all[0]; arguments++) {
        all[used++] = *arguments;
    }
    return spawn(all, &daemon->pid, daemon->address, daemon->admin, sizeof daemon->address);
}

bool line_start(line_process *line, const char *target, const char *delay_ms, const char *jitter_ms, const char *rate)
{
    char program[1024];
    snprintf(program, sizeof program, "%s/awt-relay", check_build_directory());
    const char *const all[] = {program,    "--connect", target,   "--delay", delay_ms,
                               "--jitter", jitter_ms,   "--rate", rate,      NULL};
    return spawn(all, &line->pid, line->address, NULL, sizeof line->address);
}

void line_stop(line_process *line)
{
    if (line->pid > 0) {
        kill(line->pid, SIGTERM);
        waitpid(line->pid, NULL, 0);
    }
}

void daemon_kill(daemon_process *daemon)
{
    kill(daemon->pid, SIGKILL);
    waitpid(daemon->pid, NULL, 0);
}

int daemon_end(daemon_process *daemon)
{
    int status = 0, result = -1;
    kill(daemon->pid, SIGTERM);
    for (int n = 0; n < 2000; n++) {
        if (waitpid(daemon->pid, &status, WNOHANG) == daemon->pid) {
            result = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
            break;
        }
        nanosleep(&(struct timespec){0, 10000000}, NULL);
    }
    if (result < 0) {
        kill(daemon->pid, SIGKILL);
        waitpid(daemon->pid, &status, 0);
    }
    return result;
}

void daemon_forget(daemon_process *daemon)
{
    folder_remove(daemon->state_directory);
}

int daemon_stop(daemon_process *daemon)
{
    int result = daemon_end(daemon);
    daemon_forget(daemon);
    return result;
}

awtclient *daemon_client(const daemon_process *daemon)
{
    awtclient_error error = {0};
    awtclient *client = awtclient_open(
        &(awtclient_options){.address = daemon->address, .token_file = daemon->token_file, .name = "tests"}, &error);
    CHECK_TEXT(client ? "" : error.text, "");
    return client;
}

int daemon_socket(const daemon_process *daemon)
{
    return daemon_socket_to(daemon->address);
}

int daemon_socket_to(const char *address)
{
    char host[48], port[8];
    struct addrinfo hints = {.ai_family = AF_UNSPEC, .ai_socktype = SOCK_STREAM}, *list = NULL;
    if (!options_split_address(address, host, sizeof host, port, sizeof port) ||
        getaddrinfo(host, port, &hints, &list) != 0) {
        return -1;
    }
    int fd = socket(list->ai_family, list->ai_socktype, 0);
    if (fd >= 0 && connect(fd, list->ai_addr, list->ai_addrlen) != 0) {
        close(fd);
        fd = -1;
    }
    freeaddrinfo(list);
    return fd;
}
