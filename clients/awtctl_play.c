/* awtctl_play.c: moves a head of hair through a clip. Lock-step: each frame is the head's pose at its time (MOTION),
 * the question for the hair at that time (QUERY), and its answer; nothing runs ahead, so every run of the same clip
 * shows the same hair.
 *
 * How long a frame took to go out is only known afterwards: the next one says it, and STATS says it of the last. A
 * frame's line in the table waits for that. */
#include "awtctl_play.h"

#include "files.h"
#include "motion/load.h"
#include "progress.h"
#include "socket.h"

#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>

enum {
    PLAY_TIMEOUT_MS = 120000, /* building a large groom takes a while */
    PLAY_MAX_FRAMES = 1000000,
    PLAY_FILES = 20
};

typedef struct play {
    play_plan plan;
    play_record record;
    motion motion;
    awtclient *client;
    play_stream stream;
    FILE *text; /* the human side of the output: not where JSON goes */
    size_t frame_count, every;
    bool created; /* the forest is there */
    progress progress;
} play;

/* Set by Ctrl-C and SIGTERM: the frame that is under way is the last one. A second one ends the program at once. */
static volatile sig_atomic_t play_interrupted;

static void play_interrupt(int number)
{
    (void)number;
    play_interrupted = 1;
}

static void play_catch_signals(void)
{
    struct sigaction action = {.sa_handler = play_interrupt, .sa_flags = SA_RESTART | (int)SA_RESETHAND};
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
}

/* ---- before the first frame
 * ------------------------------------------------------------------------------------------ */

static bool play_load_motion(play *p)
{
    char text[512];
    bool loaded = motion_load(p->plan.motion, &p->plan.motion_options, &p->motion, text, sizeof text);
    if (!loaded) {
        awtctl_failed("%s", text);
    }
    return loaded;
}

static int64_t play_time_us(const play *p, size_t frame)
{
    return llround((double)(frame + 1) * 1e6 / p->plan.fps);
}

/* How many frames, and which become files. */
static bool play_count_frames(play *p)
{
    double length_s = (double)p->motion.samples[p->motion.sample_count - 1].time_us * 1e-6;
    double frames = p->plan.frames > 0 ? (double)p->plan.frames : floor(length_s * p->plan.fps + 1e-6);
    if (frames < 1 || frames > PLAY_MAX_FRAMES) {
        awtctl_failed("the motion lasts %g s, which is %.0f frames at %g fps: give --frames from 1 to %d", length_s,
                      frames, p->plan.fps, PLAY_MAX_FRAMES);
        return false;
    }
    p->frame_count = (size_t)frames;
    p->every = p->plan.every > 0 ? (size_t)p->plan.every : (p->frame_count + PLAY_FILES - 1) / PLAY_FILES;
    p->record.frames = calloc(p->frame_count, sizeof *p->record.frames);
    if (!p->record.frames) {
        awtctl_failed("not enough memory for the figures of %zu frames", p->frame_count);
    }
    return p->record.frames != NULL;
}

static bool play_prepare(play *p)
{
    char text[512];
    p->text = p->plan.json && strcmp(p->plan.json, "-") == 0 ? stderr : stdout;
    p->record.plan = &p->plan;
    p->record.source = p->plan.groom ? p->plan.groom : p->plan.style;
    p->record.motion = p->motion.description;
    if (!play_load_motion(p) || !play_count_frames(p)) {
        return false;
    }
    if (p->plan.out && !files_make_folder(p->plan.out, text, sizeof text)) {
        awtctl_failed("%s", text);
        return false;
    }
    p->client = awtctl_connect(&p->plan.connection, PLAY_TIMEOUT_MS);
    motion_sample start = motion_at(&p->motion, 0);
    p->created = p->client && play_make_hair(p->client, &p->plan, &start, &p->record.forest);
    return p->created && play_stream_open(p->client, &p->plan, p->record.forest.forest, &p->stream);
}

/* ---- frames
 * ------------------------------------------------------------------------------------------------------------- */

/* Ends the bar and says why a frame, counted from 0, did not come or cannot be kept. Always false. */
static bool play_frame_failed(play *p, size_t frame, const char *why)
{
    progress_hide(&p->progress);
    awtctl_failed("frame %zu: %s", frame + 1, why);
    return false;
}

static bool play_ask_frame(play *p, size_t frame, proto_message *answer, uint32_t *last_write_us)
{
    awtclient_error error;
    int64_t time_us = play_time_us(p, frame);
    motion_sample at = motion_at(&p->motion, time_us);
    proto_message move = {.type = PROTO_MOTION};
    move.as.motion.forest = p->record.forest.forest;
    move.as.motion.epoch = 1;
    move.as.motion.sequence = (uint32_t)frame + 1;
    move.as.motion.time_us = time_us;
    move.as.motion.head = play_wire_pose(&at.head);
    move.as.motion.body = play_wire_pose(&at.body);
    p->record.frames[frame].head = at.head;
    p->record.frames[frame].body = at.body;
    if (!awtclient_send(p->client, &move, &error) ||
        !play_stream_ask(&p->stream, time_us, answer, last_write_us, &error)) {
        return play_frame_failed(p, frame, error.text);
    }
    if (answer->as.frame.time_us != time_us) {
        char text[128];
        snprintf(text, sizeof text, "the daemon answered for %lld us where %lld us were asked for",
                 (long long)answer->as.frame.time_us, (long long)time_us);
        return play_frame_failed(p, frame, text);
    }
    return true;
}

/* After the frame's bytes are done with. */
static bool play_want_next(play *p, size_t frame)
{
    awtclient_error error;
    return play_stream_credit(&p->stream, &error) || play_frame_failed(p, frame, error.text);
}

/* The frame's way is over: its line can be printed. */
static void play_finish_frame(play *p, size_t frame, uint32_t write_us)
{
    p->record.frames[frame].write_us = write_us;
    if (!p->plan.quiet && p->text == stdout) {
        progress_hide(&p->progress);
        play_record_print_frame(&p->record, frame, p->text);
    }
}

static void play_show_progress(play *p, size_t frame)
{
    char text[96];
    const play_frame *f = &p->record.frames[frame];
    double taken_s = (double)(socket_now_us() - p->progress.began_us) * 1e-6;
    snprintf(text, sizeof text, "frame %zu/%zu, %.2f s, %u active, %.1f fps", frame + 1, p->frame_count,
             (double)f->time_us * 1e-6, f->active_nodes, taken_s > 0 ? (double)(frame + 1) / taken_s : 0.0);
    progress_show(&p->progress, (double)(frame + 1) / (double)p->frame_count, text);
}

static bool play_last_write(play *p, uint32_t *write_us)
{
    awtclient_error error;
    proto_message request = {.type = PROTO_STATS}, answer;
    if (!awtclient_call(p->client, &request, &answer, &error)) {
        awtctl_failed("%s", error.text);
        return false;
    }
    *write_us = answer.as.stats_reply.last_write_us;
    return true;
}

static bool play_frames(play *p)
{
    uint32_t write_us = 0;
    p->progress = progress_begin(stderr, "play", p->plan.quiet);
    for (size_t i = 0; i < p->frame_count; i++) {
        const bool write = p->plan.out && (i + 1) % p->every == 0;
        char text[4300];
        proto_message answer;
        if (!play_ask_frame(p, i, &answer, &write_us)) {
            return false;
        }
        const struct proto_frame *frame = &answer.as.frame;
        play_keep_figures(&p->record.frames[i], frame);
        p->record.frame_count = i + 1;
        if (i > 0) {
            play_finish_frame(p, i - 1, write_us);
        }
        if (!play_keep_geometry(&p->record, &p->stream, i, frame, write, text, sizeof text)) {
            return play_frame_failed(p, i, text);
        }
        if (!play_want_next(p, i)) {
            return false;
        }
        play_show_progress(p, i);
        if (play_interrupted) {
            progress_hide(&p->progress);
            awtctl_failed("interrupted after frame %zu of %zu", i + 1, p->frame_count);
            return false;
        }
    }
    progress_hide(&p->progress);
    if (!play_last_write(p, &write_us)) {
        return false;
    }
    play_finish_frame(p, p->frame_count - 1, write_us);
    return true;
}

/* ---- the whole
 * ------------------------------------------------------------------------------------------------------------ */

/* A forest outlives its connection, so it is ended whatever happened; after a failure without waiting for the answer.
 */
static void play_end_forest(play *p, bool wait)
{
    proto_message request = {.type = PROTO_DESTROY}, answer;
    request.as.destroy.forest = p->record.forest.forest;
    if (wait) {
        awtclient_call(p->client, &request, &answer, NULL);
    } else {
        awtclient_send(p->client, &request, NULL);
    }
    p->created = false;
}

static void play_fini(play *p)
{
    if (p->created) {
        play_end_forest(p, false);
    }
    play_stream_close(&p->stream);
    awtclient_close(p->client);
    strandcheck_fini(&p->record.strands);
    free(p->record.frames);
    motion_fini(&p->motion);
}

awtctl_exit awtctl_play(int argc, char *const *argv)
{
    play p = {0};
    awtctl_exit code;
    if (!play_plan_read(argc, argv, &p.plan, &code)) {
        return code;
    }
    code = AWTCTL_FAILED;
    play_catch_signals();
    if (!play_prepare(&p)) {
        goto fail;
    }
    play_record_print_forest(&p.record, p.text);
    fflush(p.text);
    if (!play_frames(&p)) {
        goto fail;
    }
    play_end_forest(&p, true);
    play_record_print_summary(&p.record, p.text);
    if (p.plan.json && !awtctl_write_json(p.plan.json, play_record_json, &p.record)) {
        goto fail;
    }
    code = fflush(p.text) == 0 ? AWTCTL_FINE : awtctl_failed("standard output takes no more");
fail:
    play_fini(&p);
    return code;
}
