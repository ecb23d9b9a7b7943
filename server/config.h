/* config.h: what is asked of the daemon: by the command line, else by the environment, else by a file, else as is
 * usual. */
#ifndef CONFIG_H
#define CONFIG_H

#include "base/options.h"
#include "limits.h"
#include "log.h"

enum { CONFIG_HOST = 256, CONFIG_PORT = 8 };

typedef struct config {
    char host[CONFIG_HOST], port[CONFIG_PORT];
    char admin_host[CONFIG_HOST], admin_port[CONFIG_PORT]; /* where HTTP is answered; no port: nowhere */
    bool admin_open;                                       /* other machines may reach that */
    unsigned workers, io_threads;
    uint32_t max_forests, max_connections;
    char state_directory[LIMIT_PATH]; /* empty: none; made only if the token file is in it, or forests are kept */
    char token_file[LIMIT_PATH];
    char accounts_file[LIMIT_PATH]; /* empty: none */
    bool saves;                     /* forests are kept in the state directory */
    int64_t save_us;                /* from one round of it to the next; 0: only at the end */
    int64_t drain_us;               /* that clients have to leave when the daemon stops */
    bool own_token_file;            /* the token file was named: its directory is not the daemon's to make */
    bool no_auth;
    int64_t resume_grace_us, forest_grace_us, quiet_us; /* see service.h */
    log_level level;
    log_format format;
    bool check;             /* only say whether it could start */
    int argument_count;     /* what it was read from, to be read again */
    char *const *arguments; /* not copied */
} config;

/* Reads arguments[0 .. count-1] (without the program's name), and what they and $AWTD_... name. OPTIONS_HELP and
 * OPTIONS_VERSION have printed what was asked (help, settings, version) to standard output; OPTIONS_WRONG: `error` says
 * what and why. */
option_result config_read(int count, char *const *arguments, config *out, char *error, size_t error_size);

#endif
