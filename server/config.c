/* config.c: see config.h. */
#include "config.h"
#include "auth.h"
#include "base/options_layers.h"
#include "base/version.h"
#include "text_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The options as they were given, before they are checked against each other. */
typedef struct given {
    const char *listen, *admin, *state_directory, *token_file, *accounts, *level, *format, *file;
    long long workers, io_threads, max_forests, max_connections;
    long long resume_grace_s, forest_grace_s, quiet_s, save_interval_s, drain_s;
    bool no_auth, no_save, admin_open, check, print;
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

/* Half as many as processors: small poll sets beat large ones, but a thread that has to wake, and to wait for a
 * processor, costs more than either. On two processors one thread answers 300 at 60 Hz as well as seven, gives 64 that
 * ask in turn an eighth more, and lets nobody wait for it behind others like it. */
static long long io_threads(void)
{
    long long count = (processors() + 1) / 2;
    return count < LIMIT_IO_THREADS_GREATEST ? count : LIMIT_IO_THREADS_GREATEST;
}

/* How many of the options, at the end of the table, only the command line takes. */
enum { COMMAND_LINE_ALONE = 3 };

static bool copy_path(const char *name, const char *path, char out[LIMIT_PATH], char *error, size_t error_size)
{
    if (strlen(path) >= LIMIT_PATH) {
        snprintf(error, error_size, "--%s: the path is longer than %d bytes", name, LIMIT_PATH - 1);
        return false;
    }
    memcpy(out, path, strlen(path) + 1);
    return true;
}

/* The state directory, where one was named or the token needs one. */
static bool take_state_directory(const given *g, config *out, char *error, size_t error_size)
{
    if (g->state_directory) {
        return copy_path("state-dir", g->state_directory, out->state_directory, error, error_size);
    }
    if (out->no_auth || g->token_file || auth_state_directory(out->state_directory, sizeof out->state_directory)) {
        return true;
    }
    snprintf(error, error_size, "no place for the token: give --state-dir DIR, shorter than %d bytes", LIMIT_PATH);
    return false;
}

/* State directory and token file, where the daemon wants them. */
static bool take_paths(const given *g, config *out, char *error, size_t error_size)
{
    if (!take_state_directory(g, out, error, error_size)) {
        return false;
    }
    out->saves = !g->no_save && out->state_directory[0] != '\0';
    if (out->no_auth && g->accounts) {
        snprintf(error, error_size, "--accounts says who is let in, and --no-auth that everyone is: leave one out");
        return false;
    }
    if (g->accounts && !copy_path("accounts", g->accounts, out->accounts_file, error, error_size)) {
        return false;
    }
    if (out->no_auth) {
        return true;
    }
    if (g->token_file) {
        out->own_token_file = true;
        return copy_path("token-file", g->token_file, out->token_file, error, error_size);
    }
    if (!auth_token_path(out->state_directory, out->token_file, sizeof out->token_file)) {
        snprintf(error, error_size, "the state directory's path is too long");
        return false;
    }
    return true;
}

static bool take_address(const char *name, const char *text, char host[CONFIG_HOST], char port[CONFIG_PORT],
                         char *error, size_t error_size)
{
    if (options_split_address(text, host, CONFIG_HOST, port, CONFIG_PORT)) {
        return true;
    }
    snprintf(error, error_size, "--%s takes HOST:PORT, with an IPv6 address as [ADDRESS]:PORT, not \"%s\"", name, text);
    return false;
}

static bool take_addresses(const given *g, config *out, char *error, size_t error_size)
{
    return take_address("listen", g->listen, out->host, out->port, error, error_size) &&
           (!g->admin || take_address("admin", g->admin, out->admin_host, out->admin_port, error, error_size));
}

static bool take_log(const given *g, config *out, char *error, size_t error_size)
{
    if (!log_level_parse(g->level, &out->level)) {
        snprintf(error, error_size, "--log-level takes error, warn, info or debug, not \"%s\"", g->level);
        return false;
    }
    if (!log_format_parse(g->format, &out->format)) {
        snprintf(error, error_size, "--log-format takes text or json, not \"%s\"", g->format);
        return false;
    }
    return true;
}

/* From texts and numbers to what the daemon wants, while the texts are there. */
static option_result take(given *g, const option_program *program, config *out, char *error, size_t error_size)
{
    out->workers = (unsigned)g->workers;
    out->io_threads = (unsigned)g->io_threads;
    out->max_forests = (uint32_t)g->max_forests;
    out->max_connections = (uint32_t)g->max_connections;
    out->no_auth = g->no_auth;
    out->resume_grace_us = g->resume_grace_s * 1000000;
    out->forest_grace_us = g->forest_grace_s * 1000000;
    out->quiet_us = g->quiet_s * 1000000;
    out->save_us = g->save_interval_s * 1000000;
    out->drain_us = g->drain_s * 1000000;
    out->admin_open = g->admin_open;
    out->check = g->check;
    if (!take_addresses(g, out, error, error_size) || !take_log(g, out, error, error_size) ||
        !take_paths(g, out, error, error_size)) {
        return OPTIONS_WRONG;
    }
    if (g->print) {
        option_program settings = *program;
        settings.option_count -= COMMAND_LINE_ALONE;
        options_print(&settings, stdout);
    }
    return OPTIONS_RUN;
}

static const text_file settings_file = {.what = "settings file", .greatest = LIMIT_CONFIG_FILE};

/* Sets what the settings' file says, then what the environment says, then what the command line says, each over what
 * was said before. The file's text, which settings point into, is the caller's to free. */
static option_result read_layers(const option_program *program, int count, char *const *arguments, given *g,
                                 char **file, char *error, size_t error_size)
{
    const given defaults = *g;
    option_program settings = *program;
    size_t operands = 0;
    settings.option_count -= COMMAND_LINE_ALONE;
    /* first for the file's name, and for mistakes, which are told before those in the file */
    option_result result = options_parse(program, count, arguments, NULL, 0, &operands, error, error_size);
    if (result != OPTIONS_RUN) {
        return result;
    }
    const char *named = g->file ? g->file : getenv("AWTD_CONFIG");
    const bool named_one = named && *named;
    *g = defaults;
    if ((named_one && !(*file = text_file_read(&settings_file, named, error, error_size))) ||
        (named_one && !options_take_text(&settings, *file, named, error, error_size)) ||
        !options_take_environment(&settings, "AWTD", getenv, error, error_size)) {
        return OPTIONS_WRONG;
    }
    return options_parse(program, count, arguments, NULL, 0, &operands, error, error_size);
}

static option_result read_options(int count, char *const *arguments, given *g, config *out, char *error,
                                  size_t error_size)
{
    const option options[] = {
        {"listen", OPTION_TEXT, "HOST:PORT", &g->listen, 0, 0, "where to listen; port 0: any"},
        {"workers", OPTION_INTEGER, "N", &g->workers, 1, LIMIT_WORKERS_GREATEST, "threads that simulate"},
        {"io-threads", OPTION_INTEGER, "N", &g->io_threads, 1, LIMIT_IO_THREADS_GREATEST,
         "threads that serve busy connections; one more has those that are idle"},
        {"state-dir", OPTION_TEXT, "DIR", &g->state_directory, 0, 0,
         "what the daemon keeps; else $AWTD_STATE_DIR, $XDG_STATE_HOME/awtd, ~/.local/state/awtd"},
        {"token-file", OPTION_TEXT, "FILE", &g->token_file, 0, 0, "the token; else DIR/token, made on first start"},
        {"accounts", OPTION_TEXT, "FILE", &g->accounts, 0, 0,
         "further tokens, each with a name and bounds: lines NAME TOKEN [forests=N ...]; see awtd(8)"},
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
        {"save-interval", OPTION_INTEGER, "S", &g->save_interval_s, 0, LIMIT_GRACE_S_GREATEST,
         "seconds from one round of bringing changed forests to DIR to the next; 0: only when the daemon stops"},
        {"no-save", OPTION_FLAG, NULL, &g->no_save, 0, 0, "no forest is kept in DIR, and none is made again from it"},
        {"drain-grace", OPTION_INTEGER, "S", &g->drain_s, 0, LIMIT_DRAIN_S_GREATEST,
         "seconds that clients have to leave when the daemon stops"},
        {"admin", OPTION_TEXT, "HOST:PORT", &g->admin, 0, 0,
         "answers /livez, /readyz and /metrics over HTTP there; none unless it is given"},
        {"admin-open", OPTION_FLAG, NULL, &g->admin_open, 0, 0, "--admin may be an address that other machines reach"},
        {"log-level", OPTION_TEXT, "LEVEL", &g->level, 0, 0, "error, warn, info or debug"},
        {"log-format", OPTION_TEXT, "FORMAT", &g->format, 0, 0, "text or json; the log is standard error"},
        {"config", OPTION_TEXT, "FILE", &g->file, 0, 0,
         "lines NAME = VALUE of the above; else $AWTD_CONFIG, else none"},
        {"check", OPTION_FLAG, NULL, &g->check, 0, 0, "says whether it could start so, and does not: exit code 0 or 2"},
        {"print-config", OPTION_FLAG, NULL, &g->print, 0, 0, "prints all settings as a file takes them, and ends"},
    };
    const option_program program = {.name = "awtd",
                                    .summary = "Simulates heads of hair and streams them over TCP.\n"
                                               "Each setting is the command line's, else $AWTD_NAME's (as "
                                               "AWTD_MAX_FORESTS), else the file's, else as below.",
                                    .options = options,
                                    .option_count = sizeof options / sizeof options[0]};
    char *file = NULL;
    option_result result = read_layers(&program, count, arguments, g, &file, error, error_size);
    if (result == OPTIONS_RUN) {
        result = take(g, &program, out, error, error_size);
    }
    free(file);
    if (result == OPTIONS_HELP) {
        options_help(&program, stdout);
    } else if (result == OPTIONS_VERSION) {
        puts("awtd " AWTD_VERSION);
    } else if (result == OPTIONS_RUN && g->print) {
        result = OPTIONS_HELP;
    }
    return result;
}

option_result config_read(int count, char *const *arguments, config *out, char *error, size_t error_size)
{
    given g = {.listen = "127.0.0.1:4680",
               .level = "info",
               .format = "text",
               .workers = processors(),
               .io_threads = io_threads(),
               .max_forests = LIMIT_FORESTS,
               .max_connections = LIMIT_CONNECTIONS,
               .resume_grace_s = LIMIT_RESUME_GRACE_S,
               .forest_grace_s = LIMIT_FOREST_GRACE_S,
               .quiet_s = LIMIT_QUIET_S,
               .drain_s = LIMIT_DRAIN_S};
    *out = (config){.argument_count = count, .arguments = arguments};
    return read_options(count, arguments, &g, out, error, error_size);
}
