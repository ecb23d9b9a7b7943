/* kept.c: see kept.h. */
#include "e2e/kept.h"

#include "base/crc32c.h"
#include "check.h"

#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

enum { STRANDS = 200 };

struct proto_create_reply kept_create(awtclient *client, uint64_t seed)
{
    proto_message request = {.type = PROTO_CREATE}, answer = {0};
    awtclient_error error = {0};
    request.as.create.style = proto_str_of("long");
    request.as.create.seed = seed;
    request.as.create.strands = STRANDS;
    request.as.create.head.orientation[3] = request.as.create.body.orientation[3] = 1;
    CHECK(awtclient_call(client, &request, &answer, &error));
    CHECK_TEXT(error.text, "");
    return answer.as.create_reply;
}

int64_t kept_attach(awtclient *client, const struct proto_create_reply *forest)
{
    proto_message request = {.type = PROTO_ATTACH}, answer = {0};
    awtclient_error error = {0};
    request.as.attach.forest = forest->forest;
    memcpy(request.as.attach.token, forest->drive_token, sizeof request.as.attach.token);
    CHECK(awtclient_call(client, &request, &answer, &error));
    CHECK_TEXT(error.text, "");
    return answer.as.attach_reply.time_us;
}

bool kept_drive(awtclient *client, uint64_t forest, int from, int to, uint32_t *sum)
{
    *sum = 0;
    for (int n = from; n <= to; n++) {
        proto_message motion = {.type = PROTO_MOTION}, query = {.type = PROTO_QUERY}, answer = {0};
        awtclient_error error = {0};
        motion.as.motion.forest = query.as.query.forest = forest;
        motion.as.motion.sequence = (uint32_t)n;
        motion.as.motion.time_us = query.as.query.time_us = (int64_t)n * KEPT_STEP_US;
        motion.as.motion.head.position[0] = motion.as.motion.body.position[0] = 0.02 * (n % 7);
        motion.as.motion.head.orientation[3] = motion.as.motion.body.orientation[3] = 1;
        if (!awtclient_send(client, &motion, &error) || !awtclient_call(client, &query, &answer, &error)) {
            return false;
        }
        *sum = crc32c_more(*sum, answer.as.frame.glb.bytes, answer.as.frame.glb.length);
    }
    return true;
}

uint64_t kept_hash(awtclient *client, uint64_t forest)
{
    proto_message request = {.type = PROTO_SNAPSHOT}, answer = {0};
    awtclient_error error = {0};
    request.as.snapshot.forest = forest;
    CHECK(awtclient_call(client, &request, &answer, &error));
    CHECK_TEXT(error.text, "");
    return answer.as.snapshot_reply.hash;
}

ino_t kept_file(const daemon_process *daemon, uint64_t forest)
{
    char path[160];
    struct stat about;
    snprintf(path, sizeof path, "%s/forests/%016llx.forest", daemon->state_directory, (unsigned long long)forest);
    return stat(path, &about) == 0 ? about.st_ino : 0;
}

void kept_save(const daemon_process *daemon, uint64_t forest)
{
    const ino_t before = kept_file(daemon, forest);
    kill(daemon->pid, SIGUSR1);
    for (int n = 0; n < KEPT_PATIENCE && kept_file(daemon, forest) == before; n++) {
        nanosleep(&(struct timespec){.tv_nsec = 10000000}, NULL);
    }
    CHECK(kept_file(daemon, forest) != before);
}
