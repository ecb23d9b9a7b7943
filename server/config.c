/* config.c: see config.h. */
#include "config.h"
#include "auth.h"
#include "base/version.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* The options as they were given, before they are checked against each other. */
typedef struct given {
    const char *listen, *state_directory, *token_file, *level;
    long long workers, max_forests, max_connections;
    long long resume_grace_s, forest_grace_s, quiet_s;
    bool no_auth;
} given;

static long long processors(void)
{
#ifdef _SC_NPROCESSORS_ONLN
    long online = sysconf(_SC_NPROCESSORS_ONLN);
    return online < 1 ? 1 : online > LIMIT_WORKERS_GREATEST ? LIMIT_WORKERS_GREATEST : online;
#else
    return 1;
#endif
}

static option_result read_options(int count, char *const *arguments, given *g, char *error, size_t error_size)
{
    const option options[] = {
        {"listen", OPTION_TEXT, "HOST:PORT", &g->listen, 0, 0, "where to listen; port 0: any"},
        {"workers", OPTION_INTEGER, "N", &g->workers, 1, LIMIT_WORKERS_GREATEST, "threads that simulate"},
        {"state-dir", OPTION_TEXT, "DIR", &g->state_directory, 0, 0,
         "what the daemon keeps; else $AWTD_STATE_DIR, $XDG_STATE_HOME/awtd, ~/.local/state/awtd"},
        {"token-file", OPTION_TEXT, "FILE", &g->token_file, 0, 0, "the token; else DIR/token, made on first start"},
        {"no-auth", OPTION_FLAG, NULL, &g->no_auth, 0, 0, "no token is wanted; loopback addresses only"},
        {"max-forests", OPTION_INTEGER, "N", &g->max_forests, 1, LIMIT_FORESTS_GREATEST, "forests that may live"},
        {"max-connections", OPTION_INTEGER, "N", &g->max_connections, 1, LIMIT_CONNECTIONS_GREATEST,
         "connections that may be open"},
        {"resume-grace", OPTION_INTEGER, "S", &g->resume_grace_s, 0, LIMIT_GRACE_S_GREATEST,
         "seconds that a session which was cut off can be resumed"},
        {"forest-grace", OPTION_INTEGER, "S", &g->forest_grace_s, 0, LIMIT_GRACE_S_GREATEST,
         "seconds that a forest lives on when nobody has it open; 0: for ever"},
        {"quiet-timeout", OPTION_INTEGER, "S", &g->quiet_s, 0, LIMIT_GRACE_S_GREATEST,
         "seconds after which a silent client is let go; 0: never"},
        {"log-level", OPTION_TEXT, "LEVEL", &g->level, 0, 0, "error, warn, info or debug"},
    };
    const option_program program = {.name = "awtd",
                                    .summary = "Simulates heads of hair and streams them over TCP.",
                                    .options = options,
                                    .option_count = sizeof options / sizeof options[0]};
    size_t operands = 0;
    option_result result = options_parse(&program, count, arguments, NULL, 0, &operands, error, error_size);
    if (result == OPTIONS_HELP) {
        options_help(&program, stdout);
    } else if (result == OPTIONS_VERSION) {
        puts("awtd " AWTD_VERSION);
    }
    return result;
}

/* Directory and file of the token, where the daemon wants one. */
static bool take_paths(const given *g, config *out, char *error, size_t error_size)
{
    if (out->no_auth) {
        return true;
    }
    if (g->token_file) {
        out->own_token_file = true;
        if (strlen(g->token_file) >= sizeof out->token_file) {
            snprintf(error, error_size, "--token-file: the path is longer than %d bytes", LIMIT_PATH - 1);
            return false;
        }
        memcpy(out->token_file, g->token_file, strlen(g->token_file) + 1);
        return true;
    }
    if (g->state_directory && strlen(g->state_directory) < sizeof out->state_directory) {
        memcpy(out->state_directory, g->state_directory, strlen(g->state_directory) + 1);
    } else if (g->state_directory || !auth_state_directory(out->state_directory, sizeof out->state_directory)) {
        snprintf(error, error_size, "no place for the token: give --state-dir DIR, shorter than %d bytes", LIMIT_PATH);
        return false;
    }
    if (!auth_token_path(out->state_directory, out->token_file, sizeof out->token_file)) {
        snprintf(error, error_size, "the state directory's path is too long");
        return false;
    }
    return true;
}

option_result config_read(int count, char *const *arguments, config *out, char *error, size_t error_size)
{
    given g = {.listen = "127.0.0.1:4680",
               .level = "info",
               .workers = processors(),
               .max_forests = LIMIT_FORESTS,
               .max_connections = LIMIT_CONNECTIONS,
               .resume_grace_s = LIMIT_RESUME_GRACE_S,
               .forest_grace_s = LIMIT_FOREST_GRACE_S,
               .quiet_s = LIMIT_QUIET_S};
    *out = (config){0};
    option_result result = read_options(count, arguments, &g, error, error_size);
    if (result != OPTIONS_RUN) {
        return result;
    }
    out->workers = (unsigned)g.workers;
    out->max_forests = (uint32_t)g.max_forests;
    out->max_connections = (uint32_t)g.max_connections;
    out->no_auth = g.no_auth;
    out->resume_grace_us = g.resume_grace_s * 1000000;
    out->forest_grace_us = g.forest_grace_s * 1000000;
    out->quiet_us = g.quiet_s * 1000000;
    if (!options_split_address(g.listen, out->host, sizeof out->host, out->port, sizeof out->port)) {
        snprintf(error, error_size, "--listen takes HOST:PORT, with an IPv6 address as [ADDRESS]:PORT, not \"%s\"",
                 g.listen);
        return OPTIONS_WRONG;
    }
    if (!log_level_parse(g.level, &out->level)) {
        snprintf(error, error_size, "--log-level takes error, warn, info or debug, not \"%s\"", g.level);
        return OPTIONS_WRONG;
    }
    return take_paths(&g, out, error, error_size) ? OPTIONS_RUN : OPTIONS_WRONG;
}
