/* protocol.c: see protocol.h. */
#include "protocol.h"
#include "handlers.h"

#include <stddef.h>

enum { IN_GREETING = 1 << SESSION_GREETING, IN_AUTH = 1 << SESSION_AUTH, IN_OPEN = 1 << SESSION_OPEN };

/* What a client may send. */
static const struct rule {
    uint16_t type;
    unsigned states;
    session_handler *handler;
} rules[] = {
    {PROTO_HELLO, IN_GREETING, session_hello},
    {PROTO_AUTH, IN_AUTH, session_auth},
    {PROTO_BYE, IN_AUTH | IN_OPEN, session_client_bye},
    {PROTO_RESUME, IN_OPEN, session_resume},
    {PROTO_PING, IN_OPEN, session_ping},
    {PROTO_PONG, IN_OPEN, session_pong},
    {PROTO_LIST_STYLES, IN_OPEN, session_list_styles},
    {PROTO_UPLOAD, IN_OPEN, session_upload},
    {PROTO_CREATE, IN_OPEN, session_create},
    {PROTO_ATTACH, IN_OPEN, session_attach_forest},
    {PROTO_DETACH, IN_OPEN, session_detach_forest},
    {PROTO_DESTROY, IN_OPEN, session_destroy},
    {PROTO_LIST, IN_OPEN, session_list},
    {PROTO_MOTION, IN_OPEN, session_motion},
    {PROTO_SET_PARAMS, IN_OPEN, session_set_params},
    {PROTO_QUERY, IN_OPEN, session_query},
    {PROTO_BINDING, IN_OPEN, session_binding},
    {PROTO_SUBSCRIBE, IN_OPEN, session_subscribe},
    {PROTO_UNSUBSCRIBE, IN_OPEN, session_unsubscribe},
    {PROTO_CREDIT, IN_OPEN, session_credit},
    {PROTO_STATS, IN_OPEN, session_stats},
    {PROTO_SET_CLOCK, IN_OPEN, session_set_clock},
    {PROTO_STEP_MANY, IN_OPEN, session_step_many},
    {PROTO_SNAPSHOT, IN_OPEN, session_snapshot},
    {PROTO_RESTORE, IN_OPEN, session_restore},
};

static const struct rule *rule_of(uint16_t type)
{
    for (size_t i = 0; i < sizeof rules / sizeof rules[0]; i++) {
        if (rules[i].type == type) {
            return &rules[i];
        }
    }
    return NULL;
}

/* A message that may not come in this state: the state says how to call that. */
static void refuse(session *s, const proto_header *header)
{
    int code = s->state == SESSION_GREETING ? PROTO_ERROR_BAD_MAGIC
               : s->state == SESSION_AUTH   ? PROTO_ERROR_NO_TOKEN
                                            : PROTO_ERROR_OUT_OF_ORDER;
    session_error(s, header->type, header->request, code, NULL);
}

protocol_verdict protocol_judge(session *s, const proto_header *header)
{
    session_heard(s);
    if (s->shared->stopping && s->state != SESSION_CLOSING) {
        session_error(s, header->type, header->request, PROTO_ERROR_STOPPING, NULL);
        return PROTOCOL_REFUSE;
    }
    if (s->state == SESSION_CLOSING) {
        return PROTOCOL_REFUSE;
    }
    const struct rule *rule = rule_of(header->type);
    bool known = proto_type_known(header->type);
    if (known ? !rule || !(rule->states & 1u << s->state) : s->state != SESSION_OPEN) {
        refuse(s, header);
        return PROTOCOL_REFUSE;
    }
    uint32_t longest = s->state == SESSION_OPEN ? PROTO_MAX_REQUEST : PROTO_MAX_GREETING;
    if (header->length > longest) {
        session_error(s, header->type, header->request, PROTO_ERROR_TOO_LONG,
                      "%s of %lu bytes is longer than the limit of %lu", proto_type_name(header->type),
                      (unsigned long)header->length, (unsigned long)longest);
        return PROTOCOL_REFUSE;
    }
    if (known) {
        return PROTOCOL_TAKE;
    }
    if (header->flags & PROTO_FLAG_REQUIRED) {
        session_error(s, header->type, header->request, PROTO_ERROR_UNKNOWN_MESSAGE, NULL);
    }
    return PROTOCOL_SKIP;
}

void protocol_receive(session *s, const proto_header *header, const unsigned char *payload)
{
    proto_message message;
    const char *where = NULL;
    int code = proto_decode(header, payload, &message, &where);
    if (code != 0) {
        session_error(s, header->type, header->request, code, "%s.%s: %s", proto_type_name(header->type),
                      where ? where : "length", proto_error_text(code));
        return;
    }
    const struct rule *rule = rule_of(header->type);
    rule->handler(s, &message);
}

bool protocol_step(session *s, input *in, uint16_t *done)
{
    proto_header header;
    const unsigned char *payload = NULL;
    *done = 0;
    switch (input_next(in, &header, &payload)) {
    case INPUT_MORE:
        return false;
    case INPUT_HEADER:
        switch (protocol_judge(s, &header)) {
        case PROTOCOL_TAKE:
            input_take(in, &header);
            return true;
        case PROTOCOL_SKIP:
            input_skip(in, &header);
            return true;
        case PROTOCOL_REFUSE:
            return false;
        }
        return false;
    case INPUT_MESSAGE:
        *done = header.type;
        protocol_receive(s, &header, payload);
        input_done(in);
        return true;
    }
    return false;
}
