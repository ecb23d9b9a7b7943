/* awtctl_hair.c: the head of hair that awtctl play moves: its files go up, and the daemon makes a forest. */
#include "awtctl_play.h"

#include "files.h"
#include "progress.h"
#include "socket.h"

#include <stdlib.h>
#include <string.h>

enum {
    HAIR_MAX_FILE = 512 << 20,
    HAIR_UPLOAD_STRANDS = 1, /* our numbers of the uploads */
    HAIR_UPLOAD_HIERARCHY = 2
};

static void show_upload(void *context, double share)
{
    progress_show(context, share, "uploading");
}

static bool upload_file(awtclient *client, const char *path, uint32_t number, bool quiet)
{
    char text[512];
    size_t size;
    awtclient_error error;
    unsigned char *bytes = files_read(path, HAIR_MAX_FILE, &size, text, sizeof text);
    if (!bytes) {
        awtctl_failed("%s", text);
        return false;
    }
    progress shown = progress_begin(stderr, path, quiet);
    bool sent = awtclient_upload(client, number, bytes, size, show_upload, &shown, &error);
    progress_hide(&shown);
    free(bytes);
    if (!sent) {
        awtctl_failed("%s: %s", path, error.text);
    }
    return sent;
}

static bool upload_files(awtclient *client, const play_plan *plan)
{
    return (!plan->groom || upload_file(client, plan->groom, HAIR_UPLOAD_STRANDS, plan->quiet)) &&
           (!plan->hierarchy || upload_file(client, plan->hierarchy, HAIR_UPLOAD_HIERARCHY, plan->quiet));
}

static const char *source_of(const play_plan *plan)
{
    return plan->groom ? plan->groom : plan->style;
}

proto_pose play_wire_pose(const awt_pose *pose)
{
    proto_pose wire;
    memcpy(wire.position, pose->position, sizeof wire.position);
    memcpy(wire.orientation, pose->orientation, sizeof wire.orientation);
    return wire;
}

static void fill_create(const play_plan *plan, const motion_sample *start, struct proto_create *create)
{
    const char *slash = strrchr(source_of(plan), '/'), *name = slash ? slash + 1 : source_of(plan);
    create->source = plan->groom ? 1 : 0;
    create->style = proto_str_of(plan->style ? plan->style : "");
    create->upload = HAIR_UPLOAD_STRANDS;
    create->own_hierarchy = plan->hierarchy ? 1 : 0;
    create->hierarchy = HAIR_UPLOAD_HIERARCHY;
    create->name = strlen(name) <= 64 ? proto_str_of(name) : proto_str_of("a strand file");
    create->seed = (uint64_t)plan->seed;
    create->strands = (uint32_t)plan->strands;
    create->scale = plan->scale;
    create->up = (uint8_t)plan->up;
    create->head_x = plan->head[0];
    create->head_y = plan->head[1];
    create->head_z = plan->head[2];
    create->head_radius = plan->head[3];
    create->params.count = (uint16_t)plan->param_count;
    for (size_t i = 0; i < plan->param_count; i++) {
        create->params.items[i].name = proto_str_of(plan->params[i].name);
        create->params.items[i].value = plan->params[i].value;
    }
    create->head = play_wire_pose(&start->head);
    create->body = play_wire_pose(&start->body);
}

typedef struct making {
    progress shown;
    bool grows; /* a style */
} making;

/* What the daemon is at, and for how long; the stages begin about there in the whole. */
static void show_making(void *context, const struct proto_progress *heard)
{
    static const struct {
        const char *name;
        double begins;
    } stages[] = {{"waiting for a worker", 0.0},
                  {"reading the strands", 0.0},
                  {"building the wisps", 0.4},
                  {"preparing to draw", 0.7},
                  {"done", 1.0}};
    enum { LAST = sizeof stages / sizeof stages[0] - 2 };
    making *m = context;
    char text[64];
    const size_t stage = heard->stage < LAST ? heard->stage : LAST;
    const double width = stages[stage + 1].begins - stages[stage].begins;
    const double share = heard->share < 0 ? 0 : heard->share > 1 ? 1 : (double)heard->share;
    snprintf(text, sizeof text, "%s, %.1f s", stage == 1 && m->grows ? "growing the strands" : stages[stage].name,
             (double)(socket_now_us() - m->shown.began_us) * 1e-6);
    progress_show(&m->shown, stages[stage].begins + width * share, text);
}

bool play_make_hair(awtclient *client, const play_plan *plan, const motion_sample *start,
                    struct proto_create_reply *forest)
{
    awtclient_error error;
    proto_message request = {.type = PROTO_CREATE}, answer;
    if (plan->style && strlen(plan->style) > 32) {
        awtctl_failed("no style has so long a name (awtctl styles lists them)");
        return false;
    }
    if (!upload_files(client, plan)) {
        return false;
    }
    fill_create(plan, start, &request.as.create);
    making m = {.shown = progress_begin(stderr, "hair", plan->quiet), .grows = plan->style != NULL};
    bool made = awtclient_create(client, &request, &answer, show_making, &m, &error);
    progress_hide(&m.shown);
    if (!made) {
        awtctl_failed("%s: %s", source_of(plan), error.text);
        return false;
    }
    *forest = answer.as.create_reply;
    return true;
}
