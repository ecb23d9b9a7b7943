/* test_e2e_engine.c: the game's loop that engines copy from, against a daemon, near and at the end of a bad line. What
 * it counts is checked, never how fast this machine is: that the motion is even is checked in simulated time
 * (test_frames.c). */
#include "check.h"
#include "e2e/daemon.h"

#include <stdio.h>
#include <string.h>

/* The number after "key": in the text; -1: it is not there. */
static double figure(const char *text, const char *key)
{
    char pattern[64];
    double value = -1;
    snprintf(pattern, sizeof pattern, "\"%s\":", key);
    const char *place = strstr(text, pattern);
    return place && sscanf(place + strlen(pattern), "%lf", &value) == 1 ? value : -1;
}

static void run_loop(const daemon_process *daemon, const char *address, int rate)
{
    char command[1024], text[4096] = "";
    snprintf(command, sizeof command,
             "%s/engine_loop --connect %s --token-file %s --style short --strands 200 --rate %d --seconds 2 --json",
             check_build_directory(), address, daemon->token_file, rate);
    FILE *report = popen(command, "r");
    CHECK(report != NULL);
    if (report) {
        text[fread(text, 1, sizeof text - 1, report)] = 0;
        CHECK_INT(pclose(report), 0);
    }
    CHECK_INT(figure(text, "ticks"), 2 * rate);
    CHECK_INT(figure(text, "backwards"), 0);
    CHECK_INT(figure(text, "undecoded"), 0);
    CHECK(figure(text, "frames") > 0 && figure(text, "shown") > 0);
    CHECK_INT(figure(text, "between") + figure(text, "beyond") + figure(text, "held"), figure(text, "shown"));
    CHECK(figure(text, "off_greatest_m") < 0.5);
}

TEST(e2e_engine_loop_shows_hair_in_order_near_and_far)
{
    daemon_process daemon;
    line_process line = {0};
    CHECK(daemon_start(&daemon, 1, NULL));
    run_loop(&daemon, daemon.address, 60);
    CHECK(line_start(&line, daemon.address, "50", "20", "0"));
    run_loop(&daemon, line.address, 144);
    line_stop(&line);
    CHECK_INT(daemon_stop(&daemon), 0);
}
