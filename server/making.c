/* making.c: see making.h. */
#include "making.h"
#include "session.h"

int64_t making_due_us(const service *shared)
{
    return shared->forests.telling > 0 ? shared->progress_us : INT64_MAX;
}

static void tell(service *shared, resident *r)
{
    session *asker = session_find(shared, r->creator);
    if (!asker || !asker->sink.drained(asker->sink.context)) {
        return;
    }
    proto_message message = {.type = PROTO_PROGRESS, .request = r->creator.request};
    message.as.progress.stage = (uint8_t)forest_work_stage(&r->work, &message.as.progress.share);
    session_send(asker, &message);
}

void making_tell(service *shared, int64_t now_us)
{
    if (now_us < making_due_us(shared)) {
        return;
    }
    shared->progress_us = now_us + LIMIT_PROGRESS_US;
    for (resident *r = shared->forests.first; r; r = r->next) {
        if (r->tells) {
            tell(shared, r);
        }
    }
}
