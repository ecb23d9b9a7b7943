/* test_server_start.c: options, token file and address: what a start depends on. */
#include "check.h"
#include "config.h"
#include "net.h"
#include "token.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static option_result read_config(config *out, char *error, size_t error_size, const char *a, const char *b,
                                 const char *c)
{
    char texts[3][64], *arguments[3];
    const char *given[3] = {a, b, c};
    int count = 0;
    for (; count < 3 && given[count]; count++) {
        snprintf(texts[count], sizeof texts[count], "%s", given[count]);
        arguments[count] = texts[count];
    }
    return config_read(count, arguments, out, error, error_size);
}

TEST(server_options_have_their_defaults)
{
    config c;
    char error[512];
    CHECK_INT(read_config(&c, error, sizeof error, "--state-dir=/tmp/somewhere", NULL, NULL), OPTIONS_RUN);
    CHECK_TEXT(c.host, "127.0.0.1");
    CHECK_TEXT(c.port, "4680");
    CHECK(c.workers >= 1);
    CHECK(c.io_threads >= 1 && c.io_threads <= c.workers);
    CHECK_INT(c.max_forests, LIMIT_FORESTS);
    CHECK_INT(c.max_connections, LIMIT_CONNECTIONS);
    CHECK_INT(c.level, LOG_INFO);
    CHECK(!c.no_auth);
    CHECK_TEXT(c.token_file, "/tmp/somewhere/token");
}

TEST(server_options_are_checked)
{
    config c;
    char error[512];
    CHECK_INT(read_config(&c, error, sizeof error, "--listen=[::1]:0", "--no-auth", "--workers=3"), OPTIONS_RUN);
    CHECK_TEXT(c.host, "::1");
    CHECK(c.no_auth);
    CHECK_INT(c.workers, 3);
    static const char *const wrong[] = {"--listen=nowhere",     "--listen=::1:80",  "--workers=0",
                                        "--workers=257",        "--max-forests=0",  "--max-connections=65537",
                                        "--log-level=shouting", "--max-forests=1x", "--state-dir",
                                        "--io-threads=0",       "--io-threads=257"};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        error[0] = '\0';
        CHECK_INT(read_config(&c, error, sizeof error, wrong[i], NULL, NULL), OPTIONS_WRONG);
        CHECK(error[0] != '\0');
    }
    CHECK_INT(read_config(&c, error, sizeof error, "--token-file=/x/y", "--state-dir=/z", NULL), OPTIONS_RUN);
    CHECK_TEXT(c.token_file, "/x/y");
    CHECK(c.own_token_file);
}

static int listen_at(const char *host, const char *port, char bound[NET_ADDRESS], char *error, size_t error_size)
{
    const net_place place = {.option = "listen", .host = host, .port = port, .loopback_why = "say --no-auth not"};
    const int fd = net_listen(&place, bound, error, error_size);
    const bool reachable = fd >= 0 || strstr(error, "cannot listen");
    CHECK(net_check(&place, error, error_size) == reachable);
    return fd;
}

/* A file of settings; the path is static. */
static const char *settings(const char *text, size_t size)
{
    static char path[64];
    snprintf(path, sizeof path, "/tmp/awtd-test-XXXXXX");
    int fd = mkstemp(path);
    CHECK(fd >= 0 && write(fd, text, size) == (ssize_t)size);
    close(fd);
    return path;
}

TEST(server_settings_come_from_the_flag_else_the_environment_else_the_file)
{
    config c;
    char error[512] = "", flag[80];
    static const char text[] =
        "max-forests = 11\nworkers = 12\nmax-connections = 13\nlisten = [::1]:14\nno-auth = yes\n";
    const char *path = settings(text, sizeof text - 1);
    snprintf(flag, sizeof flag, "--config=%s", path);
    setenv("AWTD_WORKERS", "22", 1);
    setenv("AWTD_MAX_FORESTS", "21", 1);
    CHECK_INT(read_config(&c, error, sizeof error, flag, "--max-forests=31", NULL), OPTIONS_RUN);
    CHECK_TEXT(error, "");
    CHECK_INT(c.max_forests, 31);
    CHECK_INT(c.workers, 22);
    CHECK_INT(c.max_connections, 13);
    CHECK_TEXT(c.host, "::1");
    CHECK_TEXT(c.port, "14");
    CHECK(c.no_auth);
    CHECK_INT(read_config(&c, error, sizeof error, flag, "--no-auth=no", "--token-file=/x"), OPTIONS_RUN);
    CHECK(!c.no_auth);
    unsetenv("AWTD_WORKERS");
    unsetenv("AWTD_MAX_FORESTS");
    setenv("AWTD_CONFIG", path, 1);
    CHECK_INT(read_config(&c, error, sizeof error, "--listen=:99", NULL, NULL), OPTIONS_RUN);
    CHECK_INT(c.workers, 12);
    CHECK_TEXT(c.port, "99");
    unsetenv("AWTD_CONFIG");
    unlink(path);
}

TEST(server_settings_file_that_cannot_be_one_is_refused)
{
    config c;
    char error[2048] = "", flag[80];
    static char large[LIMIT_CONFIG_FILE + 1];
    memset(large, '#', sizeof large);
    const struct {
        const char *text;
        size_t size;
        const char *why;
    } wrong[] = {{"workers = 0\n", 12, ":1: "},
                 {"#\nconfig = x\n", 13, ":2: there is no setting"},
                 {"check = yes\n", 12, ":1: there is no setting"},
                 {"a\0b", 3, "NUL"},
                 {large, sizeof large, "longer than"}};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        const char *path = settings(wrong[i].text, wrong[i].size);
        snprintf(flag, sizeof flag, "--config=%s", path);
        CHECK_INT(read_config(&c, error, sizeof error, flag, NULL, NULL), OPTIONS_WRONG);
        CHECK(strstr(error, path) != NULL && strstr(error, wrong[i].why) != NULL);
        unlink(path);
    }
    const char *path = settings(large, sizeof large - 1); /* just small enough */
    snprintf(flag, sizeof flag, "--config=%s", path);
    CHECK_INT(read_config(&c, error, sizeof error, flag, "--no-auth", NULL), OPTIONS_RUN);
    unlink(path);
    CHECK_INT(read_config(&c, error, sizeof error, flag, NULL, NULL), OPTIONS_WRONG);
    CHECK(strstr(error, "cannot be opened") != NULL);
    CHECK_INT(read_config(&c, error, sizeof error, "--config=/tmp", NULL, NULL), OPTIONS_WRONG);
    CHECK(strstr(error, "plain file") != NULL);
}

TEST(server_without_auth_listens_on_loopback_alone)
{
    char bound[NET_ADDRESS], error[512] = "";
    CHECK_INT(listen_at("0.0.0.0", "0", bound, error, sizeof error), -1);
    CHECK(strstr(error, "--no-auth") != NULL);
    CHECK_INT(listen_at("", "0", bound, error, sizeof error), -1);
    int fd = listen_at("127.0.0.1", "0", bound, error, sizeof error);
    CHECK(fd >= 0);
    CHECK(strncmp(bound, "127.0.0.1:", 10) == 0 && strcmp(bound, "127.0.0.1:0") != 0);
    CHECK_INT(listen_at("127.0.0.1", bound + 10, bound, error, sizeof error), -1);
    CHECK(strstr(error, "cannot listen") != NULL);
    close(fd);
}

/* A folder of our own, and the paths in it. */
typedef struct place {
    char root[64], directory[96], path[128];
} place;

static bool place_init(place *p)
{
    snprintf(p->root, sizeof p->root, "/tmp/awtd-test-XXXXXX");
    if (!mkdtemp(p->root)) {
        return false;
    }
    snprintf(p->directory, sizeof p->directory, "%s/a/b", p->root);
    snprintf(p->path, sizeof p->path, "%s/token", p->directory);
    return true;
}

static void place_fini(const place *p)
{
    char middle[80];
    snprintf(middle, sizeof middle, "%s/a", p->root);
    unlink(p->path);
    rmdir(p->directory);
    rmdir(middle);
    rmdir(p->root);
}

static mode_t mode_of(const char *path)
{
    struct stat about = {0};
    CHECK(stat(path, &about) == 0);
    return about.st_mode & 0777;
}

static void write_file(const char *path, const char *text)
{
    FILE *file = fopen(path, "w");
    CHECK(file != NULL);
    if (file) {
        fputs(text, file);
        fclose(file);
    }
}

TEST(server_token_is_made_once_for_its_owner_alone)
{
    place p;
    char error[512] = "";
    uint8_t first[AUTH_TOKEN_SIZE] = {0}, again[AUTH_TOKEN_SIZE] = {0}, none[AUTH_TOKEN_SIZE] = {0};
    CHECK(place_init(&p));
    mode_t before = umask(0777);                                    /* whatever the umask is */
    CHECK(token_open(p.path, first, error, sizeof error) == false); /* no such folder */
    umask(0);
    CHECK(token_make_directory(p.directory, error, sizeof error));
    CHECK(token_make_directory(p.directory, error, sizeof error));
    CHECK_INT(mode_of(p.directory), 0700);
    umask(0777);
    CHECK(token_open(p.path, first, error, sizeof error));
    umask(before);
    CHECK_INT(mode_of(p.path), 0600);
    CHECK(memcmp(first, none, sizeof first) != 0);
    CHECK(token_open(p.path, again, error, sizeof error));
    CHECK_BYTES(again, first, sizeof first);
    place_fini(&p); /* the folder is empty but for the token: no temporary file was left */
    CHECK(access(p.root, F_OK) != 0);
}

TEST(server_token_is_checked_without_being_made)
{
    place p;
    char error[512] = "";
    uint8_t token[AUTH_TOKEN_SIZE];
    CHECK(place_init(&p));
    CHECK(token_check(p.path, true, error, sizeof error));
    CHECK(!token_check(p.path, false, error, sizeof error));
    CHECK(strstr(error, "cannot be made") != NULL);
    CHECK(access(p.directory, F_OK) != 0);
    CHECK(!token_check("/dev/null/x/token", true, error, sizeof error));
    CHECK(token_make_directory(p.directory, error, sizeof error));
    CHECK(token_check(p.path, false, error, sizeof error));
    CHECK(access(p.path, F_OK) != 0);
    CHECK(token_open(p.path, token, error, sizeof error));
    CHECK(token_check(p.path, false, error, sizeof error));
    CHECK(chmod(p.path, 0644) == 0);
    CHECK(!token_check(p.path, false, error, sizeof error));
    CHECK(strstr(error, "chmod 600") != NULL);
    place_fini(&p);
}

TEST(server_token_that_others_may_touch_is_refused)
{
    place p;
    char error[512] = "";
    uint8_t token[AUTH_TOKEN_SIZE];
    CHECK(place_init(&p));
    CHECK(token_make_directory(p.directory, error, sizeof error));
    CHECK(token_open(p.path, token, error, sizeof error));
    static const mode_t modes[] = {0640, 0604, 0620, 0602, 0644, 0666};
    for (size_t i = 0; i < sizeof modes / sizeof modes[0]; i++) {
        CHECK(chmod(p.path, modes[i]) == 0);
        CHECK(!token_open(p.path, token, error, sizeof error));
        CHECK(strstr(error, "chmod 600") != NULL);
    }
    CHECK(chmod(p.path, 0400) == 0);
    CHECK(token_open(p.path, token, error, sizeof error));
    place_fini(&p);
}

TEST(server_token_file_must_hold_a_token)
{
    place p;
    char error[512] = "";
    uint8_t token[AUTH_TOKEN_SIZE];
    CHECK(place_init(&p));
    CHECK(token_make_directory(p.directory, error, sizeof error));
    static const char *const texts[] = {"", "0123", "0123456789abcdef0123456789abcdeg\n",
                                        "0123456789abcdef0123456789abcdef0\n"};
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        write_file(p.path, texts[i]);
        CHECK(chmod(p.path, 0600) == 0);
        CHECK(!token_open(p.path, token, error, sizeof error));
        CHECK(strstr(error, "32 hexadecimal digits") != NULL);
    }
    unlink(p.path);
    CHECK(mkdir(p.path, 0700) == 0);
    CHECK(!token_open(p.path, token, error, sizeof error));
    CHECK(strstr(error, "plain file") != NULL);
    rmdir(p.path);
    place_fini(&p);
}
