/* config.h: what the command line asks of the daemon. */
#ifndef CONFIG_H
#define CONFIG_H

#include "base/options.h"
#include "limits.h"
#include "log.h"

typedef struct config {
    char host[256], port[8];
    unsigned workers;
    uint32_t max_forests, max_connections;
    char state_directory[LIMIT_PATH]; /* made only if the token file is in it */
    char token_file[LIMIT_PATH];
    bool own_token_file; /* the token file was named: its directory is not the daemon's to make */
    bool no_auth;
    int64_t resume_grace_us, forest_grace_us, quiet_us; /* see service.h */
    log_level level;
} config;

/* Reads arguments[0 .. count-1] (without the program's name). OPTIONS_HELP and OPTIONS_VERSION have printed what was
 * asked to standard output; OPTIONS_WRONG: `error` says what and why. */
option_result config_read(int count, char *const *arguments, config *out, char *error, size_t error_size);

#endif
