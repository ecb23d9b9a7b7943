/* timeline.c: see timeline.h. */
#include "load/timeline.h"

enum { SLICE_NS = 1000000000, TIMELINE_LEAST_PAIRS = 2, QUIET_SHARE = 10 };

load_side timeline_side(load_mode mode)
{
    return mode == LOAD_FLOOR ? LOAD_BARE : LOAD_DAEMON;
}

static void timeline_push(timeline *t, load_mode mode)
{
    const load_side side = timeline_side(mode);
    t->of_side[side][t->side_slices[side]++] = (uint16_t)t->slices;
    t->modes[t->slices++] = (uint8_t)mode;
}

void timeline_make(timeline *t, int64_t settle_ns, int64_t daemon_ns, bool floor, bool laden, uint32_t pairs)
{
    const uint32_t most = TIMELINE_MAX_SLICES / 4; /* rounds: a pair and two slices of the bare server at most */
    int64_t rounds = pairs > 0 ? pairs : daemon_ns / SLICE_NS;
    rounds = rounds < TIMELINE_LEAST_PAIRS ? TIMELINE_LEAST_PAIRS : rounds > most ? most : rounds;
    *t = (timeline){.slice_ns = daemon_ns / rounds / (pairs > 0 ? 2 : 1)};
    t->busy_ns = t->slice_ns - t->slice_ns / QUIET_SHARE;
    for (int64_t left_ns = settle_ns; left_ns > 0 && t->slices < most; left_ns -= t->slice_ns) {
        timeline_push(t, LOAD_SETTLE);
    }
    for (int64_t round = 0; round < rounds * (pairs > 0 ? 2 : 1); round++) {
        /* of pairs: plain, laden; laden, plain; and so on */
        const bool second = pairs > 0 && (round % 4 == 1 || round % 4 == 2);
        timeline_push(t, laden || second ? LOAD_LADEN : LOAD_PLAIN);
        if (floor) {
            timeline_push(t, LOAD_FLOOR);
        }
    }
}

uint32_t timeline_slice_at(const timeline *t, int64_t ns)
{
    const int64_t slice = ns < 0 ? 0 : ns / t->slice_ns;
    return slice < t->slices ? (uint32_t)slice : t->slices;
}

bool timeline_due(const timeline *t, load_side side, int64_t phase_ns, int64_t period_ns, uint64_t tick,
                  int64_t *due_ns, uint32_t *slice)
{
    const int64_t total_ns = t->busy_ns * t->side_slices[side];
    if (phase_ns >= total_ns || tick > (uint64_t)((total_ns - phase_ns) / period_ns)) {
        return false;
    }
    const int64_t at_ns = phase_ns + (int64_t)tick * period_ns;
    if (at_ns >= total_ns) {
        return false;
    }
    *slice = t->of_side[side][at_ns / t->busy_ns];
    *due_ns = *slice * t->slice_ns + at_ns % t->busy_ns;
    return true;
}

double timeline_busy_s(const timeline *t, load_mode mode)
{
    uint32_t count = 0;
    for (uint32_t s = 0; s < t->slices; s++) {
        count += t->modes[s] == (uint8_t)mode;
    }
    return (double)count * (double)t->busy_ns * 1e-9;
}
