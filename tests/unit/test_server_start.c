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
                                        "--workers=257",        "--max-forests=0",  "--max-connections=5000",
                                        "--log-level=shouting", "--max-forests=1x", "--state-dir"};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        error[0] = '\0';
        CHECK_INT(read_config(&c, error, sizeof error, wrong[i], NULL, NULL), OPTIONS_WRONG);
        CHECK(error[0] != '\0');
    }
    CHECK_INT(read_config(&c, error, sizeof error, "--token-file=/x/y", "--state-dir=/z", NULL), OPTIONS_RUN);
    CHECK_TEXT(c.token_file, "/x/y");
    CHECK(c.own_token_file);
}

TEST(server_without_auth_listens_on_loopback_alone)
{
    char bound[NET_ADDRESS], error[512] = "";
    CHECK_INT(net_listen("0.0.0.0", "0", true, bound, error, sizeof error), -1);
    CHECK(strstr(error, "--no-auth") != NULL);
    CHECK_INT(net_listen("", "0", true, bound, error, sizeof error), -1);
    int fd = net_listen("127.0.0.1", "0", true, bound, error, sizeof error);
    CHECK(fd >= 0);
    CHECK(strncmp(bound, "127.0.0.1:", 10) == 0 && strcmp(bound, "127.0.0.1:0") != 0);
    CHECK_INT(net_listen("127.0.0.1", bound + 10, true, bound, error, sizeof error), -1);
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
