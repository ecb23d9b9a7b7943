/* session_upload.c: UPLOAD: pieces of files. */
#include "handlers.h"

static upload **upload_place(session *s, uint32_t number)
{
    for (uint32_t i = 0; i < LIMIT_SESSION_UPLOADS; i++) {
        if (s->holds.uploads[i] && s->holds.uploads[i]->number == number) {
            return &s->holds.uploads[i];
        }
    }
    return NULL;
}

static upload **free_place(session *s)
{
    for (uint32_t i = 0; i < LIMIT_SESSION_UPLOADS; i++) {
        if (!s->holds.uploads[i]) {
            return &s->holds.uploads[i];
        }
    }
    return NULL;
}

static void drop(upload **place)
{
    if (place) {
        upload_release(*place);
        *place = NULL;
    }
}

static void reply(session *s, const proto_message *message, uint64_t received)
{
    proto_message answer = {.type = PROTO_UPLOAD_REPLY, .request = message->request};
    answer.as.upload_reply.upload = message->as.upload.upload;
    answer.as.upload_reply.received = received;
    session_send(s, &answer);
}

static void refuse(session *s, const proto_message *message, upload_result result)
{
    static const struct {
        int code;
        const char *text;
    } refusals[] = {
        [UPLOAD_OUT_OF_ORDER] = {PROTO_ERROR_BAD_UPLOAD, "the piece does not follow the last one; begin the upload "
                                                         "anew at offset 0"},
        [UPLOAD_TOO_LONG] = {PROTO_ERROR_BAD_UPLOAD, "the piece goes past the end that the upload announced"},
        [UPLOAD_OVER_BUDGET] = {PROTO_ERROR_BUSY,
                                "uploads need more memory than is set aside for this token, or for all"},
        [UPLOAD_NO_MEMORY] = {PROTO_ERROR_NO_MEMORY, "not enough memory for the upload"},
    };
    session_error(s, message->type, message->request, refusals[result].code, "%s", refusals[result].text);
}

/* A first piece: makes room for the upload it begins. NULL: an ERROR was sent. */
static upload **begin(session *s, const proto_message *message)
{
    const struct proto_upload *piece = &message->as.upload;
    if (piece->total > LIMIT_UPLOAD_BYTES) {
        session_error(s, message->type, message->request, PROTO_ERROR_LIMIT, "a file has %lu MiB at most",
                      (unsigned long)(LIMIT_UPLOAD_BYTES >> 20));
        return NULL;
    }
    upload **place = free_place(s);
    if (!place) {
        session_error(s, message->type, message->request, PROTO_ERROR_LIMIT,
                      "a connection has %d uploads at most; cancel one by sending a piece of total 0",
                      LIMIT_SESSION_UPLOADS);
        return NULL;
    }
    *place = upload_create(piece->upload, piece->total, piece->sha256, &s->who->uploads);
    if (!*place) {
        refuse(s, message, UPLOAD_NO_MEMORY);
        return NULL;
    }
    return place;
}

void session_upload(session *s, const proto_message *message)
{
    const struct proto_upload *piece = &message->as.upload;
    upload **place = upload_place(s, piece->upload);
    if (!session_may_drive(s, message)) {
        return;
    }
    if (piece->total == 0) {
        drop(place);
        reply(s, message, 0);
        return;
    }
    if (piece->offset == 0) { /* begins, or begins anew */
        drop(place);
        place = begin(s, message);
        if (!place) {
            return;
        }
    }
    upload_result result =
        place ? upload_add(*place, piece->total, piece->offset, piece->sha256, piece->piece.bytes, piece->piece.length)
              : UPLOAD_OUT_OF_ORDER;
    if (result != UPLOAD_TAKEN) {
        drop(place);
        refuse(s, message, result);
        return;
    }
    reply(s, message, (*place)->received);
}

upload *session_complete_upload(session *s, uint32_t number)
{
    upload **place = upload_place(s, number);
    return place && upload_is_complete(*place) ? *place : NULL;
}
