/* bench.h: what awt-bench's subcommands are. */
#ifndef BENCH_H
#define BENCH_H

/* Arguments without the subcommand's name; the exit code. */
int bench_paper(int argc, char *const *argv);

#endif
