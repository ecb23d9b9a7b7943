/* awthair.c: see awthair.h. */
#include "awthair.h"
#include "awtclient.h"
#include "codec.h"

#include <stdlib.h>

enum { HAIR_STRANDS = 1 };

struct awthair {
    awtclient *client;
    awtframes *frames;
    uint64_t forest;
    uint32_t sequence;
    proto_message request, answer;
};

static bool make(awthair *hair, const char *style, uint32_t strands, awtclient_error *error)
{
    hair->request = (proto_message){.type = PROTO_CREATE};
    struct proto_create *create = &hair->request.as.create;
    create->style = proto_str_of(style);
    create->seed = 1;
    create->strands = strands;
    create->head.orientation[3] = create->body.orientation[3] = 1;
    if (!awtclient_call(hair->client, &hair->request, &hair->answer, error)) {
        return false;
    }
    hair->forest = hair->answer.as.create_reply.forest;
    return true;
}

awthair *awthair_create(struct awtclient *client, const char *style, uint32_t strands, awtclient_error *error)
{
    awthair *hair = calloc(1, sizeof *hair);
    if (hair) {
        hair->client = client;
        hair->frames = awtframes_create(0);
    }
    if (!hair || !hair->frames) {
        awtcodec_fail(error, AWTCLIENT_MEMORY, "not enough memory");
        awthair_close(hair);
        return NULL;
    }
    if (!make(hair, style, strands, error)) {
        awthair_close(hair);
        return NULL;
    }
    return hair;
}

static bool move(awthair *hair, int64_t time_us, const proto_pose *head, const proto_pose *body, awtclient_error *error)
{
    hair->request = (proto_message){.type = PROTO_MOTION};
    hair->request.as.motion = (struct proto_motion){.forest = hair->forest, .sequence = ++hair->sequence};
    hair->request.as.motion.time_us = time_us;
    hair->request.as.motion.head = *head;
    hair->request.as.motion.body = body ? *body : *head;
    return awtclient_send(hair->client, &hair->request, error);
}

bool awthair_drive(awthair *hair, int64_t time_us, const proto_pose *head, const proto_pose *body,
                   awtframes_shown *shown, awtclient_error *error)
{
    if (!move(hair, time_us, head, body, error)) {
        return false;
    }
    hair->request = (proto_message){.type = PROTO_QUERY};
    hair->request.as.query = (struct proto_query){.forest = hair->forest, .time_us = time_us, .kind = HAIR_STRANDS};
    if (!awtclient_call(hair->client, &hair->request, &hair->answer, error) ||
        !awtframes_take(hair->frames, &hair->answer.as.frame, error) || !awtframes_begin(hair->frames)) {
        return false;
    }
    awtframes_decode(hair->frames);
    return awtframes_end(hair->frames, error) &&
           (awtframes_show(hair->frames, time_us, shown) ||
            awtcodec_fail(error, AWTCLIENT_MEMORY, "not enough memory for the hair"));
}

uint64_t awthair_forest(const awthair *hair)
{
    return hair->forest;
}

void awthair_close(awthair *hair)
{
    if (hair && hair->forest != 0) {
        hair->request = (proto_message){.type = PROTO_DESTROY};
        hair->request.as.destroy.forest = hair->forest;
        awtclient_call(hair->client, &hair->request, &hair->answer, NULL);
    }
    if (hair) {
        awtframes_destroy(hair->frames);
        free(hair);
    }
}
