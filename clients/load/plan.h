/* plan.h: what awt-load is to do, from its command line. */
#ifndef LOAD_PLAN_H
#define LOAD_PLAN_H

#include <stdbool.h>
#include <stdint.h>

#define LOAD_ADDRESS "127.0.0.1:4680" /* awtd's own default */

typedef enum load_scenario {
    LOAD_QUERY,       /* connections ask for the latest frame of their forest */
    LOAD_STREAM,      /* drivers move their forests, the connections have subscribed */
    LOAD_MIXED,       /* as stream, while other forests come and go and others ask */
    LOAD_IDLE,        /* as query, without and then with many more connections that say nothing */
    LOAD_CHURN,       /* connections that come, ask once and go */
    LOAD_SLOW_VIEWER, /* as stream, with and without a tenth of the viewers reading nothing */
    LOAD_SCENARIOS
} load_scenario;

/* The scenario's name on the command line and in JSON. */
const char *load_scenario_name(load_scenario scenario);
/* True where drivers move forests and viewers watch. */
bool load_scenario_streams(load_scenario scenario);

enum { LOAD_MAX_CONNECTIONS = 16000, LOAD_MAX_FORESTS = 4096, LOAD_MAX_PAIRS = 40 };

typedef struct load_plan {
    const char *address, *token_file;
    load_scenario scenario;
    int64_t settle_ns;    /* that the load runs before */
    int64_t duration_ns;  /* that the daemon is measured */
    uint32_t connections; /* that ask, or that watch */
    uint32_t idle;        /* further ones that say nothing */
    uint32_t forests;
    double rate;      /* of each asking connection, or of each driver, a second */
    bool closed;      /* the next request goes out when the last is answered, not by the clock */
    uint32_t pairs;   /* slow-viewer: of slices with and without */
    uint32_t threads; /* of the generator */
    const char *style, *motion;
    uint32_t strands;    /* 0: the style's own number */
    uint8_t kind, level; /* as on the wire */
    bool deltas;
    bool free;       /* heads run by the daemon's clock; `rate` is that of poses and frames */
    double moving;   /* share of the heads that are moved */
    uint32_t credit; /* frames that may be under way to a viewer */
    bool no_floor;
    const char *floor;        /* the bare server's address at the far end; NULL: one is started here */
    const char *floor_server; /* not NULL: be the bare server, there */
    const char *json, *hdr;   /* files, "-" or NULL */
    bool quiet;
} load_plan;

typedef enum load_asked { LOAD_RUN, LOAD_DONE, LOAD_WRONG } load_asked;

/* Reads the command line (without the program's name). Help and version are printed (LOAD_DONE), what is wrong is said
 * (LOAD_WRONG). */
load_asked load_plan_read(int argc, char *const *argv, load_plan *plan);

#endif
