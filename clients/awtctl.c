/* awtctl.c: the command line client: a table of subcommands. Exit codes: 0 fine, 1 failed, 2 wrong usage. */
#include "awtctl.h"

#include "base/version.h"

#include <stdio.h>
#include <string.h>

static const struct {
    const char *name;
    awtctl_exit (*run)(int argc, char *const *argv);
    const char *help;
} SUBCOMMANDS[] = {
    {"play", awtctl_play, "moves a head of hair through a clip, frame by frame, and writes GLB files"},
    {"inspect", awtctl_inspect, "says what is in a GLB file that awtd made"},
    {"clock", awtctl_clock, "lets a forest run by the daemon's clock, pauses it, or gives it to its driver"},
    {"styles", awtctl_styles, "lists the daemon's built-in styles and all parameters"},
    {"stats", awtctl_stats, "shows the daemon's counts and times"},
    {"ping", awtctl_ping, "measures the way to the daemon and back"},
};

static void print_help(FILE *file)
{
    fputs("usage: awtctl SUBCOMMAND [options]\nTalks to awtd, the hair simulation daemon.\n\n", file);
    for (size_t i = 0; i < sizeof SUBCOMMANDS / sizeof SUBCOMMANDS[0]; i++) {
        fprintf(file, "  %-10s %s\n", SUBCOMMANDS[i].name, SUBCOMMANDS[i].help);
    }
    fputs("\nawtctl SUBCOMMAND --help says more. Exit codes: 0 fine, 1 failed, 2 wrong usage.\n", file);
}

int main(int argc, char **argv)
{
    const char *name = argc > 1 ? argv[1] : "";
    if (strcmp(name, "--help") == 0 || strcmp(name, "help") == 0) {
        print_help(stdout);
        return AWTCTL_FINE;
    }
    if (strcmp(name, "--version") == 0) {
        puts("awtctl " AWTD_VERSION);
        return AWTCTL_FINE;
    }
    for (size_t i = 0; i < sizeof SUBCOMMANDS / sizeof SUBCOMMANDS[0]; i++) {
        if (strcmp(SUBCOMMANDS[i].name, name) == 0) {
            return (int)SUBCOMMANDS[i].run(argc - 2, argv + 2);
        }
    }
    if (argc > 1) {
        fprintf(stderr, "awtctl: there is no subcommand \"%s\"\n", name);
    }
    print_help(stderr);
    return AWTCTL_WRONG_USAGE;
}
