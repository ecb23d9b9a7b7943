/* report.h: what awt-load says in the end. */
#ifndef LOAD_REPORT_H
#define LOAD_REPORT_H

#include "load/member.h"

/* The table, for people: every figure of awtd, of the bare server, and their ratio. */
void report_table(const load_run *run, FILE *file);

/* The JSON and the percentile file, where the plan wants them. False: why has been said. */
bool report_files(const load_run *run);

/* The JSON alone; what it says of awtd is of the laden slices where there are any. */
bool report_json(const load_run *run, FILE *file);

#endif
