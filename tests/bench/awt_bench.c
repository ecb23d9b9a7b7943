/* awt_bench.c: awt-bench: measures, and asserts nothing but in soak. */
#include "bench/bench.h"

#include "base/version.h"

#include <stdio.h>
#include <string.h>

static const struct {
    const char *name;
    int (*run)(int argc, char *const *argv);
    const char *help;
} SUBCOMMANDS[] = {
    {"paper", bench_paper, "the table of the paper's §5.2: single level against AWT, for the four styles"},
    {"encode", bench_encode, "frames: encoding, decoding and size, beside stock libdraco"},
    {"capacity", bench_capacity, "what a head of hair costs a core, part by part, and how many heads a core holds"},
    {"soak", bench_soak, "minutes of the most violent motion, checked: no NaN, no growth, rest at the end"},
};

int main(int argc, char **argv)
{
    const char *name = argc > 1 ? argv[1] : "paper";
    if (strcmp(name, "--version") == 0) {
        puts("awt-bench " AWTD_VERSION);
        return 0;
    }
    for (size_t i = 0; i < sizeof SUBCOMMANDS / sizeof SUBCOMMANDS[0]; i++) {
        if (strcmp(SUBCOMMANDS[i].name, name) == 0) {
            return SUBCOMMANDS[i].run(argc > 2 ? argc - 2 : 0, argv + 2);
        }
    }
    FILE *out = strcmp(name, "--help") == 0 ? stdout : stderr;
    fputs("usage: awt-bench SUBCOMMAND [options]\n\n", out);
    for (size_t i = 0; i < sizeof SUBCOMMANDS / sizeof SUBCOMMANDS[0]; i++) {
        fprintf(out, "  %-10s %s\n", SUBCOMMANDS[i].name, SUBCOMMANDS[i].help);
    }
    fputs("\nawt-bench SUBCOMMAND --help says more.\n", out);
    return out == stdout ? 0 : 2;
}
