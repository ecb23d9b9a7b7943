/* engine_measure.c: see engine_measure.h. */
#include "engine_measure.h"
#include "jsonout.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define LATE_US 8000   /* half a frame, and more than a machine that is not busy takes */
#define FELT_US 250000 /* for so long after it was late a stall is the loop's or the daemon's */

void engine_measure_tick(engine_measure *m, int64_t due_us, int64_t came_us)
{
    const int64_t late_us = came_us - due_us;
    m->ticks++;
    m->late_ticks += late_us > m->tick_us;
    m->latest_us = late_us > m->latest_us ? late_us : m->latest_us;
    m->woken_late_us = late_us > LATE_US ? m->last_time_us + late_us : m->woken_late_us;
}

void engine_measure_lost(engine_measure *m)
{
    m->losses++;
    m->lost_us = m->last_time_us;
}

void engine_measure_frame(engine_measure *m, const struct proto_frame *frame, const awtclock *clock)
{
    const double age_us = (double)awtclock_age_us(clock, frame->age_us);
    m->received++;
    m->left_late_us = frame->age_us > LATE_US ? m->last_time_us : m->left_late_us;
    m->bytes += (double)frame->glb.length;
    m->age_sum_us += age_us;
    m->age_greatest_us = fmax(m->age_greatest_us, age_us);
}

static double distance(const double a[3], const double b[3])
{
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

static bool felt(int64_t late_us, int64_t time_us)
{
    return late_us != 0 && time_us - late_us < FELT_US;
}

/* A stall is told apart when it is over: then what it waited for has come. */
static void end_stall(engine_measure *m, int64_t time_us)
{
    const bool lost = m->lost_us != 0 && time_us - m->lost_us <= m->stall_us + FELT_US;
    const engine_cause cause = lost                              ? ENGINE_BY_LOSS
                               : felt(m->woken_late_us, time_us) ? ENGINE_BY_LOOP
                               : felt(m->left_late_us, time_us)  ? ENGINE_BY_DAEMON
                                                                 : ENGINE_BY_WAY;
    m->longest_stall_us[cause] = m->stall_us > m->longest_stall_us[cause] ? m->stall_us : m->longest_stall_us[cause];
    m->stall_us = 0;
}

void engine_measure_shown(engine_measure *m, const awtframes_shown *shown, int64_t time_us, const proto_pose *truth)
{
    const double off_m = distance(shown->head.position, truth->position);
    if (m->shown > 0) {
        const int64_t passed_us = time_us - m->last_time_us, went_us = shown->time_us - m->last_shown_us;
        m->backwards += went_us < 0;
        if (2 * went_us < passed_us) {
            m->stall_us += passed_us;
        } else if (m->stall_us > 0) {
            end_stall(m, time_us);
        }
    }
    m->last_time_us = time_us;
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
    jsonout_integer(&j, "longest_stall_by_loss_us", m->longest_stall_us[ENGINE_BY_LOSS]);
    jsonout_integer(&j, "longest_stall_by_loop_us", m->longest_stall_us[ENGINE_BY_LOOP]);
    jsonout_integer(&j, "longest_stall_by_daemon_us", m->longest_stall_us[ENGINE_BY_DAEMON]);
    jsonout_integer(&j, "longest_stall_by_way_us", m->longest_stall_us[ENGINE_BY_WAY]);
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
    printf("%" PRIu64 " shown between frames, %" PRIu64 " beyond, %" PRIu64 " held\n", ways[AWTFRAMES_BETWEEN],
           ways[AWTFRAMES_BEYOND], ways[AWTFRAMES_HELD]);
    printf("longest stall: %.1f ms by the way, %.1f by a late daemon, %.1f by this loop, woken late, %.1f by a loss\n",
           (double)m->longest_stall_us[ENGINE_BY_WAY] / 1000, (double)m->longest_stall_us[ENGINE_BY_DAEMON] / 1000,
           (double)m->longest_stall_us[ENGINE_BY_LOOP] / 1000, (double)m->longest_stall_us[ENGINE_BY_LOSS] / 1000);
    printf("%" PRIu64 " frames, %.1f KB each; age %.1f ms, at most %.1f; round %.1f ms; asked for %.1f ms ahead\n",
           m->received, mean(m->bytes, m->received) / 1000, mean(m->age_sum_us, m->received) / 1000,
           m->age_greatest_us / 1000, (double)awtclock_round_us(clock) / 1000, (double)m->lead_us / 1000);
    printf("the head shown was off the true one by %.2f mm, at most %.2f: the prediction's error\n",
           mean(m->off_sum_m, m->shown) * 1000, m->off_greatest_m * 1000);
}

bool engine_measure_tell(engine_measure *m, const awtframes *frames, const awtclock *clock, const char *json)
{
    end_stall(m, m->last_time_us);
    const bool alone = json && strcmp(json, "-") == 0;
    if (!alone) {
        write_text(m, frames, clock);
    }
    if (!json) {
        return fflush(stdout) == 0;
    }
    FILE *file = alone ? stdout : fopen(json, "w");
    if (!file) {
        fprintf(stderr, "engine_loop: %s cannot be written\n", json);
        return false;
    }
    write_json(m, frames, clock, file);
    return (file == stdout ? fflush(file) : fclose(file)) == 0;
}
