/* awtctl.h: what the subcommands of awtctl share. Private to awtctl*.c. */
#ifndef CLIENTS_AWTCTL_H
#define CLIENTS_AWTCTL_H

#include "awtclient.h"
#include "base/options.h"
#include "jsonout.h"

#include <stdbool.h>
#include <stddef.h>

#if defined(__GNUC__)
#define AWTCTL_FORMAT(place) __attribute__((format(printf, place, (place) + 1)))
#else
#define AWTCTL_FORMAT(place)
#endif

typedef enum awtctl_exit { AWTCTL_FINE, AWTCTL_FAILED, AWTCTL_WRONG_USAGE } awtctl_exit;

/* How to reach the daemon, with the options that say so. */
typedef struct awtctl_connection {
    const char *address, *token_file;
} awtctl_connection;

#define AWTCTL_ADDRESS "127.0.0.1:4680" /* awtd's own default */
#define AWTCTL_CONNECTION_OPTIONS(connection)                                                 \
    {"connect", OPTION_TEXT, "HOST:PORT", &(connection).address, 0, 0, "where awtd listens"}, \
    {                                                                                         \
        "token-file", OPTION_TEXT, "FILE", &(connection).token_file, 0, 0,                    \
            "awtd's token; without it the file that a local awtd leaves in its state folder"  \
    }

/* Reads a subcommand's arguments. False: the program ends here, with *code (help and version included). */
bool awtctl_options(const option_program *program, int argc, char *const *argv, const char **operands,
                    size_t operand_max, size_t *operand_count, awtctl_exit *code);

/* Say on stderr what is wrong; return what their name says. */
awtctl_exit awtctl_failed(const char *format, ...) AWTCTL_FORMAT(1);
awtctl_exit awtctl_wrong_usage(const option_program *program, const char *format, ...) AWTCTL_FORMAT(2);

/* NULL: why has been said. */
awtclient *awtctl_connect(const awtctl_connection *connection, int timeout_ms);

/* Writes what `fill` writes to standard output ("-") or to a file, whole or not at all. False: why has been said. */
bool awtctl_write_json(const char *path, void (*fill)(jsonout *json, const void *context), const void *context);

awtctl_exit awtctl_play(int argc, char *const *argv);
awtctl_exit awtctl_inspect(int argc, char *const *argv);
awtctl_exit awtctl_stats(int argc, char *const *argv);
awtctl_exit awtctl_ping(int argc, char *const *argv);
awtctl_exit awtctl_clock(int argc, char *const *argv);
awtctl_exit awtctl_styles(int argc, char *const *argv);

#endif
