/* test_server_vault.c: files of the state directory: whole or not at all, whoever may be in the way. */
#include "check.h"
#include "folder_fixture.h"
#include "keeper.h"
#include "log.h"
#include "saved.h"
#include "vault.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

static bool open_vault(vault *v, const char *state)
{
    char error[256] = "";
    bool opened = vault_open(v, state, error, sizeof error);
    CHECK_TEXT(error, "");
    return opened;
}

typedef struct counted {
    uint32_t count;
    uint64_t sum;
} counted;

static bool count_file(void *context, uint64_t handle)
{
    counted *c = context;
    c->count++;
    c->sum += handle;
    return true;
}

static counted count_files(const vault *v)
{
    counted c = {0};
    CHECK(vault_list(v, count_file, &c));
    return c;
}

TEST(vault_files_are_read_as_they_were_written_and_replaced)
{
    char state[FOLDER_PATH];
    vault v;
    size_t size = 0;
    folder_make(state);
    CHECK(open_vault(&v, state));
    CHECK(vault_write(&v, 0x100000001, "first", 5) && vault_write(&v, 7, "other", 5));
    CHECK(vault_write(&v, 0x100000001, "second one", 10));
    unsigned char *bytes = vault_read(&v, 0x100000001, &size);
    CHECK_U64(size, 10);
    CHECK_BYTES(bytes, "second one", 10);
    free(bytes);
    counted c = count_files(&v);
    CHECK_INT(c.count, 2);
    CHECK_U64(c.sum, 0x100000008);
    CHECK(vault_remove(&v, 7) && vault_remove(&v, 7));
    vault_set_aside(&v, 0x100000001);
    CHECK_INT(count_files(&v).count, 0);
    CHECK(!vault_read(&v, 7, &size));
    CHECK_INT(errno, ENOENT);
    folder_remove(state);
}

TEST(vault_removes_what_was_half_written_and_passes_over_strangers)
{
    char state[FOLDER_PATH], path[LIMIT_PATH + 64];
    vault v;
    folder_make(state);
    CHECK(open_vault(&v, state) && vault_write(&v, 5, "whole", 5));
    static const char *const others[] = {"0000000000000006.part", "notes.txt", "zz00000000000007.forest", "8.forest"};
    for (int i = 0; i < 4; i++) {
        snprintf(path, sizeof path, "%s/%s", v.folder, others[i]);
        close(open(path, O_WRONLY | O_CREAT, 0600));
    }
    CHECK(open_vault(&v, state));
    counted c = count_files(&v);
    CHECK_INT(c.count, 1);
    CHECK_U64(c.sum, 5);
    snprintf(path, sizeof path, "%s/%s", v.folder, others[0]);
    CHECK(access(path, F_OK) != 0);
    snprintf(path, sizeof path, "%s/%s", v.folder, others[1]);
    CHECK(access(path, F_OK) == 0); /* not ours to remove */
    folder_remove(state);
}

TEST(vault_that_cannot_be_made_says_so)
{
    char state[FOLDER_PATH], error[256] = "";
    vault v;
    folder_make(state);
    char path[96];
    snprintf(path, sizeof path, "%s/forests", state);
    close(open(path, O_WRONLY | O_CREAT, 0600)); /* a file stands where the folder should */
    CHECK(!vault_open(&v, state, error, sizeof error));
    CHECK(strstr(error, "/forests cannot be") != NULL);
    folder_remove(state);
}

TEST(vault_keeps_the_old_file_where_the_new_one_cannot_be_written)
{
    char state[FOLDER_PATH], beside[LIMIT_PATH + 64];
    vault v;
    size_t size = 0;
    folder_make(state);
    CHECK(open_vault(&v, state) && vault_write(&v, 5, "old", 3));
    snprintf(beside, sizeof beside, "%s/0000000000000005.part", v.folder);
    CHECK_INT(mkdir(beside, 0700), 0); /* nothing can be written there */
    CHECK(!vault_write(&v, 5, "new", 3));
    unsigned char *bytes = vault_read(&v, 5, &size);
    CHECK_BYTES(bytes, "old", 3);
    free(bytes);
    folder_remove(state);
}

/* ---- the keeper -------------------------------------------------------------------------------------------------- */

static int64_t no_time_us(void)
{
    return 1;
}

static unsigned char *heap_copy(const char *text)
{
    unsigned char *bytes = malloc(strlen(text));
    CHECK(bytes != NULL);
    memcpy(bytes, text, strlen(text));
    return bytes;
}

/* No file of this process can grow longer than that. Nothing is to be checked meanwhile: it could not be printed. */
typedef struct disk_room {
    struct rlimit limit;
    struct sigaction action;
} disk_room;

static disk_room disk_fill(rlim_t left)
{
    disk_room before;
    sigaction(SIGXFSZ, &(struct sigaction){.sa_handler = SIG_IGN}, &before.action);
    getrlimit(RLIMIT_FSIZE, &before.limit);
    setrlimit(RLIMIT_FSIZE, &(struct rlimit){.rlim_cur = left, .rlim_max = before.limit.rlim_max});
    return before;
}

static void disk_free(const disk_room *before)
{
    setrlimit(RLIMIT_FSIZE, &before->limit);
    sigaction(SIGXFSZ, &before->action, NULL);
}

static int count_entries(const char *path)
{
    DIR *folder = opendir(path);
    int count = 0;
    for (const struct dirent *entry; folder && (entry = readdir(folder)) != NULL;) {
        count += entry->d_name[0] != '.';
    }
    if (folder) {
        closedir(folder);
    }
    return count;
}

TEST(keeper_writes_the_newest_of_each_forest_and_removes)
{
    char state[FOLDER_PATH], text[32];
    vault v;
    size_t size = 0;
    folder_make(state);
    CHECK(open_vault(&v, state));
    keeper *k = keeper_create(&v, no_time_us);
    CHECK(k != NULL);
    for (int i = 0; i < 100; i++) {
        snprintf(text, sizeof text, "number %02d", i);
        CHECK(keeper_write(k, 1 + (uint64_t)i % 3, heap_copy(text), strlen(text)));
    }
    keeper_remove(k, 2);
    CHECK(keeper_drain(k));
    CHECK_INT(count_files(&v).count, 2);
    unsigned char *bytes = vault_read(&v, 1, &size);
    CHECK_BYTES(bytes, "number 99", 9);
    free(bytes);
    keeper_counts counts = keeper_count(k);
    CHECK(counts.written >= 2 && counts.failed == 0 && counts.refused == 0 && counts.waiting == 0);
    CHECK(keeper_write(k, 9, heap_copy("last"), 4));
    keeper_destroy(k); /* writes what waits first */
    bytes = vault_read(&v, 9, &size);
    CHECK_BYTES(bytes, "last", 4);
    free(bytes);
    folder_remove(state);
}

TEST(keeper_reports_what_could_not_be_written_and_goes_on)
{
    char state[FOLDER_PATH], beside[LIMIT_PATH + 64];
    vault v;
    folder_make(state);
    log_set_level(LOG_ERROR);
    CHECK(open_vault(&v, state));
    snprintf(beside, sizeof beside, "%s/0000000000000005.part", v.folder);
    CHECK_INT(mkdir(beside, 0700), 0);
    keeper *k = keeper_create(&v, no_time_us);
    CHECK(keeper_write(k, 5, heap_copy("five"), 4) && keeper_write(k, 6, heap_copy("six"), 3));
    CHECK(!keeper_drain(k));
    CHECK_U64(keeper_count(k).failed, 1);
    CHECK_U64(keeper_count(k).written, 1);
    CHECK_U64(keeper_take_lost(k), 5);
    CHECK_U64(keeper_take_lost(k), 0); /* said once */
    CHECK(keeper_drain(k));
    keeper_destroy(k);
    folder_remove(state);
}

TEST(keeper_on_a_full_disk_leaves_the_earlier_file_and_writes_again_once_there_is_room)
{
    enum { ROOM = 16384, LARGE = 65536 };
    char state[FOLDER_PATH];
    vault v;
    size_t size = 0;
    unsigned char *bytes = NULL;
    folder_make(state);
    CHECK(open_vault(&v, state));
    keeper *k = keeper_create(&v, no_time_us);
    CHECK(keeper_write(k, 5, heap_copy("earlier"), 7) && keeper_drain(k));
    const disk_room before = disk_fill(ROOM);
    CHECK(keeper_write(k, 5, calloc(1, LARGE), LARGE));
    const bool drained = keeper_drain(k);
    disk_free(&before);
    CHECK(!drained);
    bytes = vault_read(&v, 5, &size);
    CHECK_U64(size, 7);
    CHECK_BYTES(bytes, "earlier", 7);
    free(bytes);
    CHECK_INT(count_entries(v.folder), 1); /* nothing half written takes what room there is */
    CHECK_U64(keeper_take_lost(k), 5);
    CHECK(keeper_write(k, 5, calloc(1, LARGE), LARGE) && keeper_drain(k));
    bytes = vault_read(&v, 5, &size);
    CHECK_U64(size, LARGE);
    free(bytes);
    keeper_destroy(k);
    folder_remove(state);
}

TEST(keeper_makes_a_folder_again_that_was_removed)
{
    char state[FOLDER_PATH];
    vault v;
    folder_make(state);
    CHECK(open_vault(&v, state));
    keeper *k = keeper_create(&v, no_time_us);
    CHECK_INT(rmdir(v.folder), 0);
    keeper_remove(k, 7); /* which is not there anyway */
    CHECK(keeper_write(k, 5, heap_copy("five"), 4) && keeper_drain(k));
    CHECK_INT(count_files(&v).count, 1);
    keeper_destroy(k);
    folder_remove(state);
}

TEST(keeper_refuses_more_than_may_wait)
{
    char state[FOLDER_PATH];
    vault v;
    folder_make(state);
    CHECK(open_vault(&v, state));
    keeper *k = keeper_create(&v, no_time_us);
    CHECK(!keeper_write(k, 5, heap_copy("x"), (size_t)LIMIT_KEEPER_BYTES + 1)); /* judged by its size alone */
    CHECK_U64(keeper_count(k).refused, 1);
    CHECK(keeper_drain(k));
    keeper_destroy(k);
    CHECK_INT(count_files(&v).count, 0);
    folder_remove(state);
}

/* ---- saved forests ----------------------------------------------------------------------------------------------- */

static saved example(void)
{
    saved s = {.handle = 0x300000002, .name = "long", .sequence = 77};
    snprintf(s.account, sizeof s.account, "studio");
    s.mode = 1;
    s.rate = 0.25;
    s.importance = 8;
    s.hash = 0x1234567890abcdef;
    s.state = "state";
    s.state_size = 5;
    memset(s.drive_token, 0xd1, sizeof s.drive_token);
    memset(s.view_token, 0xe2, sizeof s.view_token);
    return s;
}

TEST(saved_forest_is_read_as_it_was_written)
{
    const saved s = example();
    const size_t size = saved_size(&s);
    unsigned char *bytes = malloc(size);
    saved again;
    CHECK(bytes != NULL);
    memcpy(saved_state(&s, bytes), s.state, s.state_size);
    saved_write(&s, bytes);
    CHECK_INT(saved_read(bytes, size, &again, NULL), AWT_OK);
    CHECK_U64(again.handle, s.handle);
    CHECK_TEXT(again.name, s.name);
    CHECK_U64(again.sequence, s.sequence);
    CHECK_U64(again.hash, s.hash);
    CHECK_TEXT(again.account, "studio");
    CHECK_INT(again.mode, 1);
    CHECK_NEAR(again.rate, 0.25, 0);
    CHECK_NEAR(again.importance, 8, 0);
    CHECK_BYTES(again.drive_token, s.drive_token, sizeof s.drive_token);
    CHECK_BYTES(again.view_token, s.view_token, sizeof s.view_token);
    CHECK_U64(again.state_size, 5);
    CHECK_BYTES(again.state, "state", 5);
    free(bytes);
}

TEST(saved_forest_with_a_field_that_cannot_be_is_refused)
{
    enum { COUNT = 7 };
    saved bad[COUNT];
    for (int i = 0; i < COUNT; i++) {
        bad[i] = example();
    }
    bad[0].handle = 0;
    bad[1].mode = 3;
    bad[2].rate = 0;
    bad[3].rate = (double)NAN;
    bad[4].importance = -1;
    bad[5].importance = NAN;
    memset(bad[6].account, 'x', sizeof bad[6].account);
    for (int i = 0; i < COUNT; i++) {
        unsigned char *bytes = malloc(saved_size(&bad[i]));
        saved again;
        CHECK(bytes != NULL);
        memcpy(saved_state(&bad[i], bytes), bad[i].state, bad[i].state_size);
        saved_write(&bad[i], bytes);
        CHECK_INT(saved_read(bytes, saved_size(&bad[i]), &again, NULL), AWT_BAD_VALUE);
        free(bytes);
    }
}

TEST(saved_forest_that_is_cut_or_damaged_is_refused)
{
    const saved s = example();
    const size_t size = saved_size(&s);
    unsigned char *bytes = malloc(size);
    saved again;
    CHECK(bytes != NULL);
    memcpy(saved_state(&s, bytes), s.state, s.state_size);
    saved_write(&s, bytes);
    for (size_t cut = 0; cut < size; cut++) {
        unsigned char *exact = malloc(cut ? cut : 1);
        memcpy(exact, bytes, cut);
        CHECK(saved_read(exact, cut, &again, NULL) != AWT_OK);
        free(exact);
    }
    for (size_t at = 0; at < size; at++) {
        bytes[at] ^= 0x40;
        CHECK(saved_read(bytes, size, &again, NULL) != AWT_OK);
        bytes[at] ^= 0x40;
    }
    free(bytes);
}
