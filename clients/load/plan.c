/* plan.c: see plan.h. */
#include "load/plan.h"

#include "awt.h"
#include "base/options.h"
#include "base/version.h"

#include <stdio.h>
#include <string.h>

enum { PLAN_LINKS_A_THREAD = 128, PLAN_MAX_THREADS = 64, KIND_GUIDES = 2 };

static const char *const SCENARIOS[] = {"query", "stream", "mixed", "idle", "churn", "slow-viewer"};
static const char *const KINDS[] = {"ribbon", "strands", "guides", "nodes"};
static const char *const LEVELS[] = {"full", "fifth", "guides"};

/* What is usual for each scenario. */
static const struct {
    long long connections, forests, idle;
    double rate, duration_s;
} USUAL[LOAD_SCENARIOS] = {
    [LOAD_QUERY] = {64, 4, 0, 60, 10},    [LOAD_STREAM] = {64, 4, 0, 60, 10}, [LOAD_MIXED] = {32, 4, 0, 30, 10},
    [LOAD_IDLE] = {64, 4, 10000, 20, 10}, [LOAD_CHURN] = {8, 1, 0, 5, 10},    [LOAD_SLOW_VIEWER] = {40, 2, 0, 30, 20},
};

const char *load_scenario_name(load_scenario scenario)
{
    return SCENARIOS[scenario];
}

bool load_scenario_streams(load_scenario scenario)
{
    return scenario == LOAD_STREAM || scenario == LOAD_MIXED || scenario == LOAD_SLOW_VIEWER;
}

static load_asked wrong(const char *text, const char *what)
{
    fprintf(stderr, "awt-load: %s%s\nawt-load --help says how it is used\n", text, what);
    return LOAD_WRONG;
}

/* The place of `name` in `names`, or `count`. */
static unsigned choice(const char *name, const char *const *names, unsigned count)
{
    unsigned k = 0;
    while (k < count && strcmp(names[k], name) != 0) {
        k++;
    }
    return k;
}

/* As they were given; numbers that are 0 are the scenario's own. */
typedef struct given {
    const char *scenario, *kind, *level;
    long long connections, idle, forests, pairs, threads, strands, credit;
    double rate, settle_s, duration_s;
} given;

static option_result read_options(int argc, char *const *argv, load_plan *p, given *g, char *error, size_t error_size)
{
    const option options[] = {
        {"connect", OPTION_TEXT, "HOST:PORT", &p->address, 0, 0, "where awtd listens"},
        {"token-file", OPTION_TEXT, "FILE", &p->token_file, 0, 0,
         "awtd's token; without it the file that a local awtd leaves in its state folder"},
        {"scenario", OPTION_TEXT, "NAME", &g->scenario, 0, 0, "query, stream, mixed, idle, churn or slow-viewer"},
        {"duration", OPTION_REAL, "S", &g->duration_s, 0, 86400,
         "seconds that awtd is measured, and as long again the bare server; 0: the scenario's own"},
        {"settle", OPTION_REAL, "S", &g->settle_s, 0, 60,
         "seconds that the load runs before anything is measured, as heads of hair take to fall asleep"},
        {"connections", OPTION_INTEGER, "N", &g->connections, 0, LOAD_MAX_CONNECTIONS,
         "that ask or watch (slow-viewer: a tenth of them stalls); 0: the scenario's own number"},
        {"idle", OPTION_INTEGER, "N", &g->idle, 0, LOAD_MAX_CONNECTIONS,
         "idle: further connections that say nothing, as many as the system lets us have; 0: 10000"},
        {"forests", OPTION_INTEGER, "N", &g->forests, 0, LOAD_MAX_FORESTS,
         "heads of hair; 0: the scenario's own number"},
        {"rate", OPTION_REAL, "R", &g->rate, 0, 1e6,
         "requests a second of each connection (churn: visits; where viewers watch: steps of each head); 0: the "
         "scenario's"},
        {"closed", OPTION_FLAG, NULL, &p->closed, 0, 0,
         "ask as soon as the last answer is there, instead of by the clock: throughput"},
        {"style", OPTION_TEXT, "NAME", &p->style, 0, 0, "a built-in style"},
        {"strands", OPTION_INTEGER, "N", &g->strands, 0, AWT_MAX_STRANDS,
         "strands of each head (2000: frames of about 20 KB); 0: the style's number"},
        {"kind", OPTION_TEXT, "KIND", &g->kind, 0, 0, "ribbon, strands, guides or nodes"},
        {"level", OPTION_TEXT, "LEVEL", &g->level, 0, 0, "full, fifth or guides, of ribbon and strands"},
        {"deltas", OPTION_FLAG, NULL, &p->deltas, 0, 0, "viewers take deltas"},
        {"credit", OPTION_INTEGER, "N", &g->credit, 1, 64, "frames that may be under way to a viewer"},
        {"motion", OPTION_TEXT, "CLIP", &p->motion, 0, 0,
         "of the heads that are driven: still, lean, lean-forever, jump, run or shake"},
        {"free", OPTION_FLAG, NULL, &p->free, 0, 0,
         "stream: the heads run by awtd's own clock, and frames come at --rate; awtd alone is measured"},
        {"moving", OPTION_REAL, "SHARE", &p->moving, 0, 1, "of the heads that are moved, the others hold still"},
        {"pairs", OPTION_INTEGER, "N", &g->pairs, 1, LOAD_MAX_PAIRS, "slow-viewer: of slices with and without"},
        {"threads", OPTION_INTEGER, "N", &g->threads, 0, PLAN_MAX_THREADS,
         "that make the load; 0: one for each 128 connections"},
        {"no-floor", OPTION_FLAG, NULL, &p->no_floor, 0, 0, "measure awtd alone"},
        {"floor", OPTION_TEXT, "HOST:PORT", &p->floor, 0, 0,
         "a bare server that runs there; without it one is started here"},
        {"floor-server", OPTION_TEXT, "HOST:PORT", &p->floor_server, 0, 0,
         "be that bare server (port 0: any) until killed; whoever reaches it can use it"},
        {"json", OPTION_OPTIONAL_TEXT, "FILE", &p->json, 0, 0, "all figures as JSON, to FILE or stdout"},
        {"hdr", OPTION_TEXT, "FILE", &p->hdr, 0, 0, "awtd's latencies as HdrHistogram percentiles, microseconds"},
        {"quiet", OPTION_FLAG, NULL, &p->quiet, 0, 0, "no progress"},
    };
    const option_program program = {.name = "awt-load",
                                    .summary =
                                        "Loads awtd, and beside it, in turns, a bare poll() server with the same "
                                        "messages, so that every time is also a ratio.",
                                    .options = options,
                                    .option_count = sizeof options / sizeof options[0]};
    size_t operands = 0;
    option_result result = options_parse(&program, argc, argv, NULL, 0, &operands, error, error_size);
    if (result == OPTIONS_HELP) {
        options_help(&program, stdout);
    } else if (result == OPTIONS_VERSION) {
        puts("awt-load " AWTD_VERSION);
    }
    return result;
}

static load_asked take_names(load_plan *p, const given *g)
{
    p->scenario = (load_scenario)choice(g->scenario, SCENARIOS, LOAD_SCENARIOS);
    p->kind = (uint8_t)choice(g->kind, KINDS, 4);
    p->level = (uint8_t)choice(g->level, LEVELS, 3);
    if (p->scenario == LOAD_SCENARIOS) {
        return wrong("there is no scenario ", g->scenario);
    }
    if (p->kind == 4 || p->level == 3) {
        return wrong("there is no kind or level ", p->kind == 4 ? g->kind : g->level);
    }
    if (p->kind >= KIND_GUIDES) {
        p->level = 0; /* the only one there is of them */
    }
    if (strlen(p->style) > 32) {
        return wrong("no style has so long a name: ", p->style);
    }
    if (p->closed && p->scenario == LOAD_CHURN) {
        return wrong("--closed is not for ", "churn");
    }
    if (p->free && (p->closed || p->scenario != LOAD_STREAM)) {
        return wrong("--free is for ", "stream, by the clock");
    }
    p->no_floor = p->no_floor || p->free;
    return LOAD_RUN;
}

static uint32_t number(long long asked, long long usual)
{
    return (uint32_t)(asked > 0 ? asked : usual);
}

static void take_numbers(load_plan *p, const given *g)
{
    p->connections = number(g->connections, USUAL[p->scenario].connections);
    p->forests = number(g->forests, USUAL[p->scenario].forests);
    p->idle = p->scenario == LOAD_IDLE ? number(g->idle, USUAL[p->scenario].idle) : 0;
    p->rate = g->rate > 0 ? g->rate : USUAL[p->scenario].rate;
    p->duration_ns = (int64_t)((g->duration_s > 0 ? g->duration_s : USUAL[p->scenario].duration_s) * 1e9);
    p->settle_ns = (int64_t)(g->settle_s * 1e9);
    p->pairs = p->scenario == LOAD_SLOW_VIEWER ? (uint32_t)g->pairs : 0;
    p->strands = (uint32_t)g->strands;
    p->credit = (uint32_t)g->credit;
    const uint32_t usual = (p->connections + PLAN_LINKS_A_THREAD - 1) / PLAN_LINKS_A_THREAD;
    p->threads = g->threads > 0 ? (uint32_t)g->threads : usual < PLAN_MAX_THREADS ? usual : PLAN_MAX_THREADS;
}

load_asked load_plan_read(int argc, char *const *argv, load_plan *plan)
{
    char error[256];
    given g = {.scenario = "query", .kind = "strands", .level = "fifth", .strands = 2000, .pairs = 10, .credit = 2};
    *plan = (load_plan){.address = LOAD_ADDRESS, .style = "long", .motion = "lean-forever", .moving = 1};
    switch (read_options(argc, argv, plan, &g, error, sizeof error)) {
    case OPTIONS_HELP:
    case OPTIONS_VERSION:
        return LOAD_DONE;
    case OPTIONS_WRONG:
        return wrong(error, "");
    case OPTIONS_RUN:
        break;
    }
    load_asked asked = take_names(plan, &g);
    if (asked == LOAD_RUN) {
        take_numbers(plan, &g);
    }
    return asked;
}
