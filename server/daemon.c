/* daemon.c: see daemon.h. */
#include "daemon.h"
#include "accounts_file.h"
#include "admin.h"
#include "clock.h"
#include "completions.h"
#include "door.h"
#include "drain.h"
#include "health.h"
#include "net.h"
#include "random.h"
#include "reload.h"
#include "restore.h"
#include "token.h"
#include "base/version.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static net_place listen_place(const config *asked)
{
    return (net_place){.option = "listen",
                       .host = asked->host,
                       .port = asked->port,
                       .loopback_why = asked->no_auth
                                           ? "--no-auth lets everyone in who reaches it: listen on 127.0.0.1 "
                                             "or ::1, or leave --no-auth out"
                                           : NULL};
}

static net_place admin_place(const config *asked)
{
    return (net_place){.option = "admin",
                       .host = asked->admin_host,
                       .port = asked->admin_port,
                       .loopback_why = asked->admin_open
                                           ? NULL
                                           : "it asks nobody for a token: choose 127.0.0.1 or ::1, or say "
                                             "--admin-open if others may see what it tells"};
}

/* None where there is no file of them. */
static bool read_accounts(const config *asked, account_list *out, char *error, size_t error_size)
{
    *out = (account_list){0};
    return asked->accounts_file[0] == '\0' || accounts_file_read(asked->accounts_file, out, error, error_size);
}

bool daemon_check(const config *asked, char *error, size_t error_size)
{
    const net_place place = listen_place(asked), admins = admin_place(asked);
    account_list accounts;
    return net_check(&place, error, error_size) && (!asked->admin_port[0] || net_check(&admins, error, error_size)) &&
           (asked->no_auth || token_check(asked->token_file, !asked->own_token_file, error, error_size)) &&
           read_accounts(asked, &accounts, error, error_size);
}

static bool open_token(const config *asked, service_options *options, char *error, size_t error_size)
{
    options->auth_required = !asked->no_auth;
    if (asked->no_auth) {
        return true;
    }
    return (asked->own_token_file || token_make_directory(asked->state_directory, error, error_size)) &&
           token_open(asked->token_file, options->token, error, error_size);
}

/* Scripts wait for this line: it says that connections are taken, and on which port. */
static void announce(const config *asked, const char *bound, uint64_t descriptors)
{
    health_set_serving();
    printf("listening on %s\n", bound);
    fflush(stdout);
    char token[LOG_QUOTED];
    log_write(LOG_INFO, "started", "version=%s listen=%s workers=%u io_threads=%u descriptors=%llu token=%s",
              AWTD_VERSION, bound, asked->workers, asked->io_threads, (unsigned long long)descriptors,
              asked->no_auth ? "none" : log_quote(asked->token_file, strlen(asked->token_file), token));
}

/* Each connection has a descriptor, and each loop two. */
static void check_descriptors(const config *asked, uint64_t descriptors)
{
    uint64_t wanted = asked->max_connections + LIMIT_CONNECTIONS_REFUSED + 2 * (uint64_t)asked->io_threads + 32;
    if (descriptors < wanted) {
        log_write(LOG_WARN, "few descriptors", "connections=%lu descriptors=%llu wanted=%llu",
                  (unsigned long)asked->max_connections, (unsigned long long)descriptors, (unsigned long long)wanted);
    }
}

/* What the operator is answered with, and settings that are read again. */
typedef struct operation {
    reload settings;
    admin *operators;
} operation;

/* Answers the operator from now on, for there may be much to do before clients are served. */
static bool start_admin(operation *o, service *shared, const config *asked, char *error, size_t error_size)
{
    const net_place place = admin_place(asked);
    char bound[NET_ADDRESS];
    int listener = asked->admin_port[0] ? net_listen(&place, bound, error, error_size) : -1;
    if (asked->admin_port[0] && listener < 0) {
        return false;
    }
    o->settings = (reload){.running = *asked, .most_forests = asked->max_forests, .shared = shared};
    o->operators = admin_create(&(admin_def){.listener = listener, .reload = reload_settings, .context = &o->settings});
    if (!o->operators) {
        snprintf(error, error_size, "no memory, thread or descriptor is left for --admin");
        return false;
    }
    if (listener >= 0) {
        printf("admin on %s\n", bound);
    }
    return true;
}

/* What a worker does with the job that it has just done: brings the results to those who asked. */
static void on_job_done(void *context)
{
    service *shared = context;
    service_lock(shared);
    completions_take(shared);
    connections_send_replies(shared);
    service_unlock(shared);
}

/* What the state directory holds, before anyone comes in. */
static void restore_forests(service *shared, const vault *place)
{
    if (shared->options.keeper && !restore_all(shared, place)) {
        char folder[LOG_QUOTED];
        log_write(LOG_ERROR, "forests not restored", "folder=%s why=\"%s\"",
                  log_quote(place->folder, strlen(place->folder), folder), strerror(errno));
    }
}

static bool serve(const config *asked, service_options *options, const vault *place, const wake *bell, int listener,
                  const char *bound, char *error, size_t error_size)
{
    service shared = {0};
    loops inside = {0};
    operation operated = {0};
    door entrance = {.shared = &shared,
                     .inside = &inside,
                     .own = {.bell = *bell},
                     .listener = listener,
                     .greatest = asked->max_connections};
    const uint64_t descriptors = net_raise_descriptors();
    options->wake = on_job_done;
    options->wake_context = &shared;
    if (!service_init(&shared, options) || !loops_start(&inside, &shared, asked->io_threads)) {
        snprintf(error, error_size,
                 "not enough memory, threads or descriptors for %u workers and %u I/O threads; give --workers N and "
                 "--io-threads N",
                 asked->workers, asked->io_threads);
        service_fini(&shared);
        close(listener);
        return false;
    }
    if (!start_admin(&operated, &shared, asked, error, error_size)) {
        close(listener);
        loops_stop(&inside);
        service_fini(&shared);
        loops_fini(&inside);
        return false;
    }
    check_descriptors(asked, descriptors);
    restore_forests(&shared, place);
    announce(asked, bound, descriptors);
    door_run(&entrance);
    drain_clients(&shared, asked->drain_us, wake_hurry_asked);
    const bool all_saved = drain_forests(&shared);
    loops_stop(&inside);
    admin_destroy(operated.operators);
    service_fini(&shared); /* may wait for a groom that is being built */
    loops_fini(&inside);
    log_write(LOG_INFO, "stopped", "listen=%s", bound);
    if (!all_saved) {
        snprintf(error, error_size, "not all forests could be saved in %s: see the log", place->folder);
    }
    return all_saved;
}

/* The place where forests are kept, and the keeper; neither where none are. */
static bool open_vault(const config *asked, vault *place, service_options *options, char *error, size_t error_size)
{
    if (!asked->saves) {
        return true;
    }
    if (!token_make_directory(asked->state_directory, error, error_size) ||
        !vault_open(place, asked->state_directory, error, error_size)) {
        return false;
    }
    options->keep_us = asked->save_us;
    options->keeper = keeper_create(place, clock_monotonic_us);
    if (!options->keeper) {
        snprintf(error, error_size, "not enough memory or threads");
    }
    return options->keeper != NULL;
}

bool daemon_run(const config *asked, char *error, size_t error_size)
{
    static wake bell; /* outlives the call: a signal may come at any time */
    service_options options = {.workers = asked->workers,
                               .io_threads = asked->io_threads,
                               .max_forests = asked->max_forests,
                               .max_sessions = asked->max_connections + LIMIT_CONNECTIONS_REFUSED,
                               .resume_grace_us = asked->resume_grace_us,
                               .forest_grace_us = asked->forest_grace_us,
                               .quiet_us = asked->quiet_us,
                               .clock_us = clock_monotonic_us};
    char bound[NET_ADDRESS];
    vault where = {0};
    account_list accounts;
    bool served = false;
    log_set_level(asked->level);
    log_set_format(asked->format);
    if (!random_open()) {
        snprintf(error, error_size, "/dev/urandom cannot be opened: %s; tokens are made of it", strerror(errno));
        return false;
    }
    if (!open_token(asked, &options, error, error_size) || !read_accounts(asked, &accounts, error, error_size)) {
        return false;
    }
    options.accounts = &accounts;
    if (!wake_init(&bell)) {
        snprintf(error, error_size, "no descriptors are left for this process");
        return false;
    }
    const net_place place = listen_place(asked);
    int listener = net_listen(&place, bound, error, error_size);
    if (listener < 0) {
        return false;
    }
    wake_on_signals(&bell);
    if (open_vault(asked, &where, &options, error, error_size)) {
        served = serve(asked, &options, &where, &bell, listener, bound, error, error_size);
    } else {
        close(listener);
    }
    keeper_destroy(options.keeper);
    return served;
}
