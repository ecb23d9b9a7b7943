/* test_e2e_full_disk.c: the state directory takes nothing more, or is gone, while the daemon runs: it serves on, says
 * why nothing is saved and what helps, leaves what it saved before, and saves again as soon as it can. */
#define _GNU_SOURCE /* prlimit */
#include "check.h"
#include "e2e/kept.h"

#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

enum { ROOM = 16384 /* bytes: for the log, and for no forest */ };

/* A daemon whose log can be read, with a forest that has gone a few steps and is saved. */
typedef struct logged_daemon {
    daemon_process process;
    char logs[FOLDER_PATH], log[FOLDER_PATH + 8], folder[FOLDER_PATH + 16];
    awtclient *client;
    struct proto_create_reply forest;
} logged_daemon;

/* Starts it, or starts it again. */
static void start_logged(logged_daemon *d, bool (*start)(daemon_process *, int, const char *const *))
{
    char before[512];
    const char *wanted = getenv("AWT_TEST_LOG");
    snprintf(before, sizeof before, "%s", wanted ? wanted : "");
    setenv("AWT_TEST_LOG", d->log, 1);
    CHECK(start(&d->process, 1, NULL));
    CHECK_INT(wanted ? setenv("AWT_TEST_LOG", before, 1) : unsetenv("AWT_TEST_LOG"), 0);
    d->client = daemon_client(&d->process);
}

static void logged_begin(logged_daemon *d)
{
    uint32_t sum = 0;
    *d = (logged_daemon){0};
    folder_make(d->logs);
    snprintf(d->log, sizeof d->log, "%s/log", d->logs);
    start_logged(d, daemon_start);
    snprintf(d->folder, sizeof d->folder, "%s/forests", d->process.state_directory);
    d->forest = kept_create(d->client, 3);
    CHECK(kept_drive(d->client, d->forest.forest, 1, 5, &sum));
    kept_save(&d->process, d->forest.forest);
}

static void logged_end(logged_daemon *d)
{
    awtclient_close(d->client);
    CHECK_INT(daemon_stop(&d->process), 0); /* all is saved */
    folder_remove(d->logs);
}

/* How often the log says it. */
static int log_count(const logged_daemon *d, const char *what)
{
    char line[1024];
    int count = 0;
    FILE *log = fopen(d->log, "r");
    while (log && fgets(line, sizeof line, log)) {
        count += strstr(line, what) != NULL;
    }
    if (log) {
        fclose(log);
    }
    return count;
}

/* Has it saved, which fails; waits until the log says so. */
static void save_in_vain(const logged_daemon *d, const char *why, const char *what_to_do)
{
    const int before = log_count(d, "forest not saved");
    kill(d->process.pid, SIGUSR1);
    for (int n = 0; n < KEPT_PATIENCE && log_count(d, "forest not saved") == before; n++) {
        nanosleep(&(struct timespec){.tv_nsec = 10000000}, NULL);
    }
    CHECK_INT(log_count(d, why), before + 1);
    CHECK_INT(log_count(d, what_to_do), before + 1);
}

/* No file of the daemon's can grow longer than that. */
static void set_room(const logged_daemon *d, rlim_t left)
{
    struct rlimit limit;
    CHECK_INT(prlimit(d->process.pid, RLIMIT_FSIZE, NULL, &limit), 0);
    limit.rlim_cur = left < limit.rlim_max ? left : limit.rlim_max;
    CHECK_INT(prlimit(d->process.pid, RLIMIT_FSIZE, &limit, NULL), 0);
}

TEST(e2e_daemon_on_a_full_disk_serves_on_and_saves_once_there_is_room)
{
    logged_daemon d;
    uint32_t sum = 0;
    logged_begin(&d);
    const ino_t earlier = kept_file(&d.process, d.forest.forest);
    set_room(&d, ROOM);
    CHECK(kept_drive(d.client, d.forest.forest, 6, 10, &sum));
    save_in_vain(&d, "why=\"File too large\"", "make room there");
    CHECK_U64(kept_file(&d.process, d.forest.forest), earlier);
    CHECK(kept_drive(d.client, d.forest.forest, 11, 15, &sum));
    const uint64_t hash = kept_hash(d.client, d.forest.forest);
    save_in_vain(&d, "why=\"File too large\"", "make room there");
    set_room(&d, RLIM_INFINITY);
    kept_save(&d.process, d.forest.forest); /* though nothing has changed since it was tried last */
    daemon_kill(&d.process);
    awtclient_close(d.client);
    start_logged(&d, daemon_start_again);
    CHECK_INT(kept_attach(d.client, &d.forest), 15 * KEPT_STEP_US);
    CHECK_U64(kept_hash(d.client, d.forest.forest), hash);
    logged_end(&d);
}

TEST(e2e_daemon_that_stops_on_a_full_disk_says_so_and_leaves_the_earlier_state)
{
    logged_daemon d;
    uint32_t sum = 0;
    logged_begin(&d);
    set_room(&d, ROOM);
    CHECK(kept_drive(d.client, d.forest.forest, 6, 10, &sum));
    awtclient_close(d.client);
    CHECK_INT(daemon_end(&d.process), 1);
    CHECK_INT(log_count(&d, "not all forests could be saved in"), 1);
    start_logged(&d, daemon_start_again);
    CHECK_INT(kept_attach(d.client, &d.forest), 5 * KEPT_STEP_US);
    logged_end(&d);
}

TEST(e2e_daemon_whose_folder_goes_away_serves_on_and_saves_when_it_is_back)
{
    logged_daemon d;
    uint32_t sum = 0;
    char away[FOLDER_PATH + 16];
    logged_begin(&d);
    const ino_t earlier = kept_file(&d.process, d.forest.forest);
    snprintf(away, sizeof away, "%s/away", d.process.state_directory);
    CHECK_INT(rename(d.folder, away), 0);
    int fd = open(d.folder, O_WRONLY | O_CREAT, 0600); /* a file stands in the way */
    CHECK(fd >= 0);
    close(fd);
    CHECK(kept_drive(d.client, d.forest.forest, 6, 10, &sum));
    save_in_vain(&d, "why=\"Not a directory\"", "put the folder back");
    CHECK(kept_drive(d.client, d.forest.forest, 11, 15, &sum));
    CHECK_INT(unlink(d.folder), 0);
    CHECK_INT(rename(away, d.folder), 0);
    CHECK_U64(kept_file(&d.process, d.forest.forest), earlier);
    kept_save(&d.process, d.forest.forest);
    folder_remove(d.folder); /* and all that is in it */
    CHECK(kept_drive(d.client, d.forest.forest, 16, 20, &sum));
    kept_save(&d.process, d.forest.forest);
    CHECK(kept_file(&d.process, d.forest.forest) != 0);
    logged_end(&d);
}
