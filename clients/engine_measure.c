/* engine_measure.c: see engine_measure.h. */
#include "engine_measure.h"
#include "jsonout.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

void engine_measure_tick(engine_measure *m, int64_t due_us, int64_t came_us)
{
    const int64_t late_us = came_us - due_us;
    m->ticks++;
    m->late_ticks += late_us > m->tick_us;
    m->latest_us = late_us > m->latest_us ? late_us : m->latest_us;
}

void engine_measure_frame(engine_measure *m, const struct proto_frame *frame, const awtclock *clock)
{
    const double age_us = (double)awtclock_age_us(clock, frame->age_us);
    m->received++;
    m->bytes += (double)frame->glb.length;
    m->age_sum_us += age_us;
    m->age_greatest_us = fmax(m->age_greatest_us, age_us);
}

static double distance(const double a[3], const double b[3])
{
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

void engine_measure_shown(engine_measure *m, const awtframes_shown *shown, int64_t time_us, const proto_pose *truth)
{
    const bool stands = m->shown > 0 && shown->way == AWTFRAMES_HELD && shown->time_us == m->last_shown_us;
    const double off_m = distance(shown->head.position, truth->position);
    m->backwards += m->shown > 0 && shown->time_us < m->last_shown_us;
    m->stall = stands && time_us > shown->time_us ? m->stall + 1 : 0;
    m->longest_stall = m->stall > m->longest_stall ? m->stall : m->longest_stall;
    m->last_shown_us = shown->time_us;
    m->shown++;
    m->off_sum_m += off_m;
    m->off_greatest_m = fmax(m->off_greatest_m, off_m);
}

static double mean(double sum, uint64_t count)
{
    return count > 0 ? sum / (double)count : NAN;
}

static void write_json(const engine_measure *m, const awtframes *frames, const awtclock *clock, FILE *file)
{
    uint64_t ways[3];
    jsonout j = jsonout_begin(file);
    awtframes_counts(frames, ways);
    jsonout_object(&j, NULL);
    jsonout_unsigned(&j, "ticks", m->ticks);
    jsonout_unsigned(&j, "late_ticks", m->late_ticks);
    jsonout_integer(&j, "latest_us", m->latest_us);
    jsonout_unsigned(&j, "shown", m->shown);
    jsonout_unsigned(&j, "between", ways[AWTFRAMES_BETWEEN]);
    jsonout_unsigned(&j, "beyond", ways[AWTFRAMES_BEYOND]);
    jsonout_unsigned(&j, "held", ways[AWTFRAMES_HELD]);
    jsonout_unsigned(&j, "longest_stall_ticks", m->longest_stall);
    jsonout_unsigned(&j, "backwards", m->backwards);
    jsonout_unsigned(&j, "frames", m->received);
    jsonout_unsigned(&j, "undecoded", m->undecoded);
    jsonout_unsigned(&j, "busy", m->busy);
    jsonout_unsigned(&j, "losses", m->losses);
    jsonout_real(&j, "bytes", m->bytes);
    jsonout_real(&j, "off_mean_m", mean(m->off_sum_m, m->shown));
    jsonout_real(&j, "off_greatest_m", m->off_greatest_m);
    jsonout_real(&j, "age_mean_us", mean(m->age_sum_us, m->received));
    jsonout_real(&j, "age_greatest_us", m->age_greatest_us);
    jsonout_integer(&j, "round_us", awtclock_round_us(clock));
    jsonout_integer(&j, "lead_us", m->lead_us);
    jsonout_close(&j);
    jsonout_done(&j);
}

static void write_text(const engine_measure *m, const awtframes *frames, const awtclock *clock)
{
    uint64_t ways[3];
    awtframes_counts(frames, ways);
    printf("%" PRIu64 " ticks of %.1f ms, %" PRIu64 " of them late by more than one, at most by %.1f ms\n", m->ticks,
           (double)m->tick_us / 1000, m->late_ticks, (double)m->latest_us / 1000);
    printf("%" PRIu64 " shown between frames, %" PRIu64 " beyond, %" PRIu64 " held; longest stall %" PRIu64 " ticks\n",
           ways[AWTFRAMES_BETWEEN], ways[AWTFRAMES_BEYOND], ways[AWTFRAMES_HELD], m->longest_stall);
    printf("%" PRIu64 " frames, %.1f KB each; age %.1f ms, at most %.1f; round %.1f ms; asked for %.1f ms ahead\n",
           m->received, mean(m->bytes, m->received) / 1000, mean(m->age_sum_us, m->received) / 1000,
           m->age_greatest_us / 1000, (double)awtclock_round_us(clock) / 1000, (double)m->lead_us / 1000);
    printf("the head shown was off the true one by %.2f mm, at most %.2f: the prediction's error\n",
           mean(m->off_sum_m, m->shown) * 1000, m->off_greatest_m * 1000);
}

bool engine_measure_tell(const engine_measure *m, const awtframes *frames, const awtclock *clock, const char *json)
{
    if (!json) {
        write_text(m, frames, clock);
        return fflush(stdout) == 0;
    }
    FILE *file = strcmp(json, "-") == 0 ? stdout : fopen(json, "w");
    if (!file) {
        fprintf(stderr, "engine_loop: %s cannot be written\n", json);
        return false;
    }
    write_json(m, frames, clock, file);
    return (file == stdout ? fflush(file) : fclose(file)) == 0;
}
