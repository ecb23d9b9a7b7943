/* reload.c: see reload.h. */
#include "reload.h"
#include "accounts_file.h"
#include "session.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The name of a setting that has changed and cannot while the daemon runs; NULL: there is none. */
static const char *find_fixed(const reload *r, const config *asked)
{
    const config *now = &r->running;
    const struct {
        const char *name;
        bool changed;
    } fixed[] = {
        {"listen", strcmp(now->host, asked->host) != 0 || strcmp(now->port, asked->port) != 0},
        {"admin", strcmp(now->admin_host, asked->admin_host) != 0 || strcmp(now->admin_port, asked->admin_port) != 0},
        {"admin-open", now->admin_open != asked->admin_open},
        {"workers", now->workers != asked->workers},
        {"io-threads", now->io_threads != asked->io_threads},
        {"state-dir", strcmp(now->state_directory, asked->state_directory) != 0},
        {"token-file", strcmp(now->token_file, asked->token_file) != 0},
        {"no-save", now->saves != asked->saves},
        {"save-interval", now->save_us != asked->save_us},
        {"drain-grace", now->drain_us != asked->drain_us},
        {"no-auth", now->no_auth != asked->no_auth},
        {"max-connections", now->max_connections != asked->max_connections},
        {"resume-grace", now->resume_grace_us != asked->resume_grace_us},
        {"forest-grace", now->forest_grace_us != asked->forest_grace_us},
        {"quiet-timeout", now->quiet_us != asked->quiet_us},
        {"max-forests (it may not rise above what it was at the start)", asked->max_forests > r->most_forests},
    };
    for (size_t i = 0; i < sizeof fixed / sizeof fixed[0]; i++) {
        if (fixed[i].changed) {
            return fixed[i].name;
        }
    }
    return NULL;
}

/* All of it, or nothing and false. */
static bool take_over(reload *r, const config *asked, const account_list *accounts)
{
    service_lock(r->shared);
    const bool taken = accounts_set(&r->shared->accounts, accounts);
    if (taken) {
        r->shared->forests.greatest = asked->max_forests;
        sessions_end_closed(r->shared);
    }
    service_unlock(r->shared);
    if (!taken) {
        return false;
    }
    log_set_level(asked->level);
    log_set_format(asked->format);
    r->running = *asked;
    return true;
}

void reload_settings(void *context)
{
    reload *r = context;
    config asked;
    char error[1536 + LIMIT_PATH], quoted[LOG_QUOTED];
    account_list accounts = {0};
    if (config_read(r->running.argument_count, r->running.arguments, &asked, error, sizeof error) != OPTIONS_RUN ||
        (asked.accounts_file[0] && !accounts_file_read(asked.accounts_file, &accounts, error, sizeof error))) {
        log_write(LOG_ERROR, "settings refused", "why=%s", log_quote(error, strlen(error), quoted));
        return;
    }
    const char *fixed = find_fixed(r, &asked);
    if (fixed) {
        log_write(LOG_ERROR, "settings refused", "changed=\"%s\" why=\"it takes a restart; nothing was changed\"",
                  fixed);
        return;
    }
    if (!take_over(r, &asked, &accounts)) {
        log_write(LOG_ERROR, "settings refused",
                  "why=\"more than %d accounts, with those that are struck off and still hold something\"",
                  LIMIT_ACCOUNTS);
        return;
    }
    log_write(LOG_INFO, "settings taken", "max_forests=%lu accounts=%lu", (unsigned long)asked.max_forests,
              (unsigned long)accounts.count);
}
