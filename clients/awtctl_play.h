/* awtctl_play.h: the parts of awtctl play: what is asked for (plan), what came of it (record). Private to awtctl*.c. */
#ifndef CLIENTS_AWTCTL_PLAY_H
#define CLIENTS_AWTCTL_PLAY_H

#include "awtctl.h"
#include "framering.h"
#include "motion/motion.h"
#include "strandcheck.h"

/* ---- the plan: checked options ------------------------------------------------------------------------------- */

enum { PLAY_MAX_PARAMS = 64 };

typedef struct play_param {
    char name[33];
    float value;
} play_param;

typedef struct play_plan {
    awtctl_connection connection;
    const char *style, *groom; /* one of them is NULL */
    const char *hierarchy;     /* of the groom; NULL: made of its strands */
    double scale;              /* of the groom; 0: guess */
    awt_up_axis up;
    double head[4]; /* centre and radius, file units; radius 0: guess */
    long long strands, seed;
    const char *motion; /* a built-in clip's name or a file */
    motion_options motion_options;
    double fps;
    long long frames, every; /* 0: the whole clip; 0: so that about 20 files come out */
    uint8_t kind, level;     /* as in QUERY */
    bool deltas;             /* against the frames before */
    bool attributes;         /* of vertices */
    long long budget;        /* bytes of a frame; 0: none */
    const char *out;         /* folder; NULL: no files */
    const char *json;        /* file, "-" or NULL */
    bool quiet, check;
    size_t param_count;
    play_param params[PLAY_MAX_PARAMS];
} play_plan;

/* Fills `plan`, whose texts point into argv. False: the program ends here with *code. */
bool play_plan_read(int argc, char *const *argv, play_plan *plan, awtctl_exit *code);

/* ---- the hair: strand file and hierarchy to the daemon, which makes a forest of them or of the style ------------ */

/* Shows how far it has come. False: why has been said. */
bool play_make_hair(awtclient *client, const play_plan *plan, const motion_sample *start,
                    struct proto_create_reply *forest);

proto_pose play_wire_pose(const awt_pose *pose);

/* ---- the stream: how frames come --------------------------------------------------------------------------------- */

/* Zeroed: closed. */
typedef struct play_stream {
    awtclient *client;
    const play_plan *plan;
    uint64_t forest;
    uint64_t subscription, request; /* of deltas, or within a budget; 0: frames answer QUERYs */
    framering *ring;
    geom_binding *binding; /* of guides; else NULL */
} play_stream;

/* False: why has been said; play_stream_close is due all the same. */
bool play_stream_open(awtclient *client, const play_plan *plan, uint64_t forest, play_stream *s);
void play_stream_close(play_stream *s);

/* Advances the forest; the frame is good until the next call of the client. *last_write_us: of the frame before. */
bool play_stream_ask(play_stream *s, int64_t time_us, proto_message *frame, uint32_t *last_write_us,
                     awtclient_error *error);
/* Decodes it: strands until the next call, or NULL where the kind has none. */
awt_status play_stream_read(play_stream *s, const struct proto_frame *frame, const geom_strands **strands,
                            awt_error *error);
/* The next frame may come, against the last one that was read. */
bool play_stream_credit(play_stream *s, awtclient_error *error);

/* ---- the record: every frame's figures -------------------------------------------------------------------------- */

typedef struct play_frame {
    int64_t time_us;
    uint32_t active_nodes, splits, merges, steps;
    uint32_t queue_us, step_us, encode_us, write_us; /* write_us: known one frame later */
    uint32_t unreached_contacts, clamped_points, clamped_speeds;
    float link_error, kinetic_energy_j;
    size_t bytes;
    bool written; /* to a file */
    bool delta;
    awt_pose head, body;
} play_frame;

typedef struct play_record {
    const play_plan *plan;
    const char *source;               /* style or file */
    const char *motion;               /* what was taken of it */
    struct proto_create_reply forest; /* what the daemon said of it */
    size_t frame_count;               /* frames that have come */
    play_frame *frames;               /* heap, as many as will come */
    strandcheck strands;
} play_record;

/* The four stages of a frame's way, in its order; microseconds. */
enum { PLAY_STAGE_QUEUE, PLAY_STAGE_STEP, PLAY_STAGE_ENCODE, PLAY_STAGE_WRITE, PLAY_STAGES };
extern const char *const PLAY_STAGE_NAMES[PLAY_STAGES];
uint32_t play_frame_stage(const play_frame *frame, int stage);

/* Of all frames. */
typedef struct play_summary {
    struct {
        double p50, p99, mean;
    } stages[PLAY_STAGES];
    uint32_t active_min, active_max;
    double active_mean, bytes_mean;
    uint64_t deltas;
    uint64_t splits, merges, steps, unreached_contacts, clamped_points, clamped_speeds;
    float link_error, last_kinetic_energy_j;
} play_summary;

play_summary play_record_summarise(const play_record *record);

/* Path of a frame's file. */
void play_frame_path(const play_record *record, size_t frame, char *path, size_t size);

/* Fills the frame's figures, all but its poses and what it took to write. */
void play_keep_figures(play_frame *frame, const struct proto_frame *from);
/* Writes and measures what is to be; each frame that others are deltas against is read. False: `why` says why. */
bool play_keep_geometry(play_record *record, play_stream *stream, size_t frame, const struct proto_frame *from,
                        bool write, char *why, size_t size);

void play_record_print_forest(const play_record *record, FILE *file);
void play_record_print_frame(const play_record *record, size_t frame, FILE *file);
void play_record_print_summary(const play_record *record, FILE *file);
/* For awtctl_write_json; `context` is the record. */
void play_record_json(jsonout *json, const void *context);

#endif
