/* engine_loop.c: a game's loop with hair from awtd, whole, to be copied from.
 *
 * Each tick of the loop does four things, none of which waits for the daemon: it tells the daemon where the head will
 * be (drive), takes what has come (listen), has it decoded (decode; a game gives that to its job system), and shows
 * hair of now, mixed from the frames that are there (show). What is sent is ahead of the game by as long as a frame
 * needed lately from its request until it could be shown (awtlead.h). Where the head will be by then is predicted from
 * its velocity (engine_head.h); the difference of what is shown from the true motion is what that costs, and is printed
 * (engine_measure.h).
 *
 * Hair is made before the game begins, and again where a restarted daemon has lost it (engine_hair.h); a lost
 * connection comes back by itself (awtsession.h), and the hair stands meanwhile.
 *
 * Simulated time is the game's own, one second a second. It stands at 0 while the game loads. */
#include "awtlead.h"
#include "engine_hair.h"
#include "engine_head.h"

#include "base/options.h"
#include "base/version.h"

#include <poll.h>
#include <time.h>

#define LOOP_EXTRAPOLATE_US 40000 /* that far, ever slower, hair moves on where a frame is late */
#define LOOP_PATIENCE_MS 60000
#define LOOP_LOADING_US 60000000

typedef struct loop_plan {
    const char *address, *token_file, *style, *json;
    long long rate, strands;
    double seconds;
} loop_plan;

typedef struct loop {
    const loop_plan *plan;
    engine_hair hair;
    awtlead lead;
    bool playing;     /* time goes */
    int64_t began_us; /* the machine's clock when simulated time was 0 */
    int64_t first_us; /* the first time that was asked for; 0: none yet */
    engine_measure measure;
} loop;

static int64_t now_us(const loop *l)
{
    return l->playing ? awtclient_now_us() - l->began_us : 0;
}

/* ---- a tick --------------------------------------------------------------------------------------------------- */

/* Where the head will be when the hair that is asked for now is shown. */
static bool drive(loop *l, int64_t time_us)
{
    l->hair.begin_us = time_us + awtlead_us(&l->lead);
    l->hair.begin_head = engine_predicted_head(time_us, l->hair.begin_us);
    int64_t at_us;
    if (!engine_hair_ready(&l->hair) || !awtlead_ask(&l->lead, time_us, &at_us)) {
        return true;
    }
    l->first_us = l->first_us != 0 ? l->first_us : at_us;
    const proto_pose head = engine_predicted_head(time_us, at_us);
    return engine_hair_ask(&l->hair, at_us, &head);
}

/* A game gives awtframes_decode to its job system, and calls awtframes_end in the tick after it is done. */
static bool decode(loop *l)
{
    awtframes *frames = l->hair.frames;
    awtclient_error error;
    bool any = false;
    while (awtframes_begin(frames)) {
        awtframes_decode(frames);
        if (!awtframes_end(frames, &error)) {
            l->measure.undecoded++; /* the daemon's next frame is against one that was acknowledged, or whole */
            continue;
        }
        awtlead_came(&l->lead, now_us(l), awtframes_newest_us(frames));
        any = true;
    }
    return !any || engine_hair_acknowledge(&l->hair);
}

/* Here a game hands shown.positions to its renderer (awtwrite.h), under the head's true pose. */
static void show(loop *l, int64_t time_us)
{
    awtframes_shown shown;
    const proto_pose truth = engine_true_head(time_us);
    if (awtframes_show(l->hair.frames, time_us, &shown)) {
        engine_measure_shown(&l->measure, &shown, time_us, &truth);
    }
}

/* ---- the loop ------------------------------------------------------------------------------------------------- */

/* Waits for the daemon, but not beyond `until_us` of the machine's clock, and takes what came. poll knows whole
 * milliseconds only: the last of them is slept without it. */
static bool wait_for(loop *l, int64_t until_us)
{
    awtclient_error error;
    awtsession *session = l->hair.session;
    const int64_t due_us = awtsession_deadline_us(session), end_us = until_us < due_us ? until_us : due_us;
    const int64_t left_us = awtsession_pending(session) ? 0 : end_us - awtclient_now_us();
    const unsigned wanted = awtsession_wanted(session);
    struct pollfd entry = {.fd = awtsession_descriptor(session)};
    entry.events = (short)((wanted & AWTLINK_READ ? POLLIN : 0) | (wanted & AWTLINK_WRITE ? POLLOUT : 0));
    if (poll(&entry, 1, left_us > 0 ? (int)(left_us / 1000) : 0) == 0 && left_us > 0 && left_us < 1000) {
        nanosleep(&(struct timespec){.tv_nsec = (long)left_us * 1000}, NULL);
    }
    return (awtsession_pump(session, awtclient_now_us(), &error) || engine_failed(error.text)) &&
           engine_hair_listen(&l->hair) && decode(l);
}

/* A tick, due at a time of the machine's clock: until then what is left belongs to the daemon. */
static bool tick(loop *l, int64_t due_us)
{
    do {
        if (!wait_for(l, due_us)) {
            return false;
        }
    } while (awtclient_now_us() < due_us);
    return drive(l, now_us(l));
}

static int64_t due_us(const loop *l, uint64_t number)
{
    return l->began_us + (int64_t)(number * 1000000 / (uint64_t)l->plan->rate);
}

/* The loading screen: until there is hair, and until its frames have come up with the game's time. The number of the
 * tick that is the first to be shown; 0: it failed. */
static uint64_t load(loop *l)
{
    const int64_t until_us = awtclient_now_us() + LOOP_LOADING_US;
    l->hair.begin_head = engine_true_head(0);
    while ((!engine_hair_ready(&l->hair) || l->hair.clock.count == 0) && awtclient_now_us() < until_us) {
        if (!wait_for(l, until_us)) {
            return 0;
        }
    }
    l->began_us = awtclient_now_us();
    l->playing = true;
    awtlead_begin(&l->lead, ENGINE_STEP_US, ENGINE_OLDEST_US, awtclock_round_us(&l->hair.clock));
    for (uint64_t number = 1; awtclient_now_us() < until_us; number++) {
        if (!tick(l, due_us(l, number))) {
            return 0;
        }
        const int64_t newest_us = awtframes_newest_us(l->hair.frames);
        if (l->first_us != 0 && now_us(l) >= l->first_us && newest_us >= now_us(l)) {
            return number + 1;
        }
    }
    engine_failed("no hair within a minute");
    return 0;
}

static bool play(loop *l)
{
    const uint64_t first = load(l);
    const uint64_t last = first + (uint64_t)(l->plan->seconds * (double)l->plan->rate);
    l->measure.tick_us = 1000000 / l->plan->rate;
    for (uint64_t number = first; first != 0 && number < last; number++) {
        if (!tick(l, due_us(l, number))) {
            return false;
        }
        engine_measure_tick(&l->measure, due_us(l, number), awtclient_now_us());
        show(l, now_us(l));
    }
    l->measure.lead_us = awtlead_us(&l->lead);
    return first != 0;
}

int main(int argc, char **argv)
{
    loop_plan plan = {.address = "127.0.0.1:4680", .style = "long-curly", .rate = 60, .strands = 1000, .seconds = 10};
    const option options[] = {
        {"connect", OPTION_TEXT, "HOST:PORT", &plan.address, 0, 0, "where awtd is"},
        {"token-file", OPTION_TEXT, "FILE", &plan.token_file, 0, 0, "its token, where it is not found by itself"},
        {"style", OPTION_TEXT, "NAME", &plan.style, 0, 0, "of hair"},
        {"strands", OPTION_INTEGER, "N", &plan.strands, 1, 200000, "of the hair"},
        {"rate", OPTION_INTEGER, "HZ", &plan.rate, 1, 1000, "ticks of the loop a second"},
        {"seconds", OPTION_REAL, "S", &plan.seconds, 0.1, 86400, "how long"},
        {"json", OPTION_OPTIONAL_TEXT, "FILE", &plan.json, 0, 0, "what was measured, as JSON"},
    };
    const option_program program = {"engine_loop", "a game's loop with hair from awtd, measured", NULL, options,
                                    sizeof options / sizeof options[0]};
    size_t operands;
    int code;
    if (!options_begin(&program, argc - 1, argv + 1, NULL, 0, &operands, &code)) {
        return code;
    }
    static loop l;
    const awtsession_options where = {
        .link = {.address = plan.address, .token_file = plan.token_file, .name = "engine_loop " AWTD_VERSION},
        .patience_ms = LOOP_PATIENCE_MS};
    awtclient_error error = {.text = "not enough memory"};
    l.plan = &plan;
    l.hair = (engine_hair){.style = plan.style, .strands = (uint32_t)plan.strands, .measure = &l.measure};
    l.hair.frames = awtframes_create(LOOP_EXTRAPOLATE_US);
    l.hair.session = l.hair.frames ? awtsession_open(&where, awtclient_now_us(), &error) : NULL;
    const bool good = (l.hair.session || engine_failed(error.text)) && play(&l) &&
                      engine_measure_tell(&l.measure, l.hair.frames, &l.hair.clock, plan.json);
    awtsession_close(l.hair.session);
    awtframes_destroy(l.hair.frames);
    return good ? 0 : 1;
}
