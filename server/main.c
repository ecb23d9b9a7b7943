/* main.c: awtd: options, the daemon, the exit code (0 fine, 1 could not start, 2 wrong usage or settings). */
#include "daemon.h"

#include <stdio.h>

int main(int argc, char **argv)
{
    config asked;
    char error[1536 + LIMIT_PATH];
    switch (config_read(argc > 0 ? argc - 1 : 0, argv + (argc > 0), &asked, error, sizeof error)) {
    case OPTIONS_HELP:
    case OPTIONS_VERSION:
        return 0;
    case OPTIONS_WRONG:
        fprintf(stderr, "awtd: %s\n", error);
        return 2;
    case OPTIONS_RUN:
        break;
    }
    if (asked.check) {
        const bool good = daemon_check(&asked, error, sizeof error);
        fprintf(good ? stdout : stderr, "awtd: %s\n", good ? "all settings are good" : error);
        return good ? 0 : 2;
    }
    if (!daemon_run(&asked, error, sizeof error)) {
        fprintf(stderr, "awtd: %s\n", error);
        return 1;
    }
    return 0;
}
