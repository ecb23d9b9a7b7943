/* test_e2e_progress.c: a large head of hair is built in seconds, and who asked for it hears how far it has come. */
#include "check.h"
#include "e2e/daemon.h"

#include <string.h>

/* Enough for some tenths of a second of growing alone, on any machine. */
enum { STRANDS = 30000 };

typedef struct heard {
    int count;
    uint8_t first, last;
    float share;
    unsigned stages; /* a bit for each one heard of */
    bool fell;
} heard;

static void hear(void *context, const struct proto_progress *progress)
{
    heard *h = context;
    h->first = h->count == 0 ? progress->stage : h->first;
    h->fell = h->fell || progress->stage < h->last || (progress->stage == h->last && progress->share < h->share);
    h->fell = h->fell || progress->stage > 3 || progress->share < 0 || progress->share > 1;
    h->last = progress->stage;
    h->share = progress->share;
    h->stages |= 1u << (progress->stage & 3);
    h->count++;
}

static proto_message create(void)
{
    proto_message request = {.type = PROTO_CREATE};
    request.as.create.style = proto_str_of("long");
    request.as.create.strands = STRANDS;
    request.as.create.head.orientation[3] = request.as.create.body.orientation[3] = 1;
    return request;
}

TEST(e2e_a_client_hears_how_far_its_hair_has_come)
{
    daemon_process daemon;
    CHECK(daemon_start(&daemon, 1, NULL));
    awtclient *client = daemon_client(&daemon), *second = daemon_client(&daemon);
    proto_message before = create(), request = create(), answer;
    awtclient_error error = {0};
    heard h = {0};
    before.as.create.seed = 1;                      /* other hair: the same would be made once for both */
    CHECK(awtclient_send(second, &before, &error)); /* the only builder has something to do first */
    CHECK(awtclient_create(client, &request, &answer, hear, &h, &error));
    CHECK_TEXT(error.text, "");
    CHECK_INT(answer.as.create_reply.strands, STRANDS);
    CHECK(h.count >= 2);
    CHECK(h.first == 0 || h.first == 1);               /* the two may have come in either order */
    CHECK(!h.fell && (h.stages & 1u << 1));            /* growing is what takes its time */
    CHECK(awtclient_receive(second, &answer, &error)); /* who did not ask hears of the end alone */
    CHECK_INT(answer.type, PROTO_CREATE_REPLY);
    awtclient_close(client);
    awtclient_close(second);
    CHECK_INT(daemon_stop(&daemon), 0);
}
