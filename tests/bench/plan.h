/* plan.h: what awt-bench paper is to measure, from its command line. */
#ifndef BENCH_PLAN_H
#define BENCH_PLAN_H

#include "base/options.h"
#include "bench/bench.h"

enum { PAPER_MAX_STYLES = 16, PAPER_MAX_PARAMS = OPTION_LIST_MAX };

typedef struct paper_param {
    char name[33];
    float value;
} paper_param;

typedef struct paper_plan {
    const awt_style *styles[PAPER_MAX_STYLES];
    size_t style_count;
    const char *motion_name;
    motion clip; /* heap */
    int64_t length_us;
    uint32_t strands, points, workers;
    double theta; /* split threshold of all styles; < 0: each style's own */
    int links;    /* 0 rigid, 1 springs; < 0: each style's own */
    size_t param_count;
    paper_param params[PAPER_MAX_PARAMS]; /* over the styles' own, the last word theirs */
    const char *json;                     /* file, "-" or NULL */
} paper_plan;

/* False: the program ends here, with *code (help and version included). On success paper_plan_fini. */
bool paper_plan_read(int argc, char *const *argv, paper_plan *plan, int *code);
void paper_plan_fini(paper_plan *plan);

/* A style's parameters, with what the plan sets. */
awt_params paper_plan_params(const paper_plan *plan, const awt_style *style);

#endif
