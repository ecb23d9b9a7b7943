/* codec.c: see codec.h. Everything that comes from the daemon is checked here as if it came from a stranger: another
 * program may listen at that port. */
#include "codec.h"
#include "layout.h"
#include "base/version.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FIRST_CAPACITY = 4 << 10 };

void awtcodec_init(awtcodec *codec)
{
    *codec = (awtcodec){.in = false};
}

void awtcodec_fini(awtcodec *codec)
{
    free(codec->buffer);
    *codec = (awtcodec){.in = false};
}

bool awtcodec_fail(awtclient_error *error, int code, const char *format, ...)
{
    if (error) {
        *error = (awtclient_error){.code = code};
        va_list arguments;
        va_start(arguments, format);
        vsnprintf(error->text, sizeof error->text, format, arguments);
        va_end(arguments);
    }
    return false;
}

bool awtcodec_pass(awtclient_error *error, const awtclient_error *from)
{
    if (error) {
        *error = *from;
    }
    return false;
}

bool awtcodec_fail_by(awtclient_error *error, const struct proto_error *from, uint16_t about)
{
    char text[sizeof error->text];
    proto_str_copy(from->text, text, sizeof text);
    bool elsewhere = from->about != 0 && from->about != about;
    awtcodec_fail(error, from->code, "%s%s%s", elsewhere ? proto_type_name(from->about) : "", elsewhere ? ": " : "",
                  text[0] ? text : proto_error_text(from->code));
    if (error) {
        error->retry = from->retry == 1;
        error->retry_after_ms = from->retry_after_ms;
    }
    return false;
}

/* Bytes of the message at `start`, as far as is known. */
static size_t needed(const awtcodec *codec)
{
    if (codec->end - codec->start < PROTO_HEADER_SIZE) {
        return PROTO_HEADER_SIZE;
    }
    return PROTO_HEADER_SIZE + (size_t)proto_header_read(codec->buffer + codec->start).length;
}

unsigned char *awtcodec_room(awtcodec *codec, size_t *size)
{
    if (codec->start > 0) {
        memmove(codec->buffer, codec->buffer + codec->start, codec->end - codec->start);
        codec->end -= codec->start;
        codec->start = 0;
    }
    if (codec->end == codec->capacity) {
        size_t doubled = codec->capacity > 0 ? 2 * codec->capacity : FIRST_CAPACITY;
        size_t wanted = codec->end > 0 ? needed(codec) : FIRST_CAPACITY;
        size_t capacity = wanted > codec->capacity && wanted < doubled ? wanted : doubled;
        unsigned char *larger = realloc(codec->buffer, capacity);
        if (!larger) {
            return NULL;
        }
        codec->buffer = larger;
        codec->capacity = capacity;
    }
    *size = codec->capacity - codec->end;
    return codec->buffer + codec->end;
}

void awtcodec_filled(awtcodec *codec, size_t size)
{
    codec->end += size;
}

/* Checks a header before anything of its payload is stored. */
static bool header_good(const awtcodec *codec, const proto_header *header, awtclient_error *error)
{
    const proto_layout *layout = proto_layout_of(header->type);
    uint32_t limit = codec->in ? (uint32_t)PROTO_MAX_REPLY : (uint32_t)PROTO_MAX_GREETING;
    if (header->length > limit) {
        return awtcodec_fail(error, AWTCLIENT_PEER,
                             "the other end does not speak awtd's protocol: it announces a message of %lu bytes",
                             (unsigned long)header->length);
    }
    if (!layout && (header->flags & PROTO_FLAG_REQUIRED || !codec->in)) {
        return awtcodec_fail(error, AWTCLIENT_PEER,
                             "the other end sent a message of type 0x%04x, which this version does not know",
                             (unsigned)header->type);
    }
    if (layout && layout->sender[0] == 'C') {
        return awtcodec_fail(error, AWTCLIENT_PEER, "the other end is no daemon: it sent %s, which only clients send",
                             layout->name);
    }
    return true;
}

awtcodec_result awtcodec_ready(const awtcodec *codec, awtclient_error *error)
{
    if (codec->end - codec->start < PROTO_HEADER_SIZE) {
        return AWTCODEC_MORE;
    }
    proto_header header = proto_header_read(codec->buffer + codec->start);
    if (!header_good(codec, &header, error)) {
        return AWTCODEC_BAD;
    }
    return codec->end - codec->start < needed(codec) ? AWTCODEC_MORE : AWTCODEC_MESSAGE;
}

awtcodec_result awtcodec_next(awtcodec *codec, proto_message *message, awtclient_error *error)
{
    for (;;) {
        awtcodec_result ready = awtcodec_ready(codec, error);
        if (ready != AWTCODEC_MESSAGE) {
            return ready;
        }
        const unsigned char *bytes = codec->buffer + codec->start;
        proto_header header = proto_header_read(bytes);
        codec->start += needed(codec);
        if (!proto_type_known(header.type)) {
            continue;
        }
        const char *where = "";
        int code = proto_decode(&header, bytes + PROTO_HEADER_SIZE, message, &where);
        if (code != 0) {
            awtcodec_fail(error, AWTCLIENT_PEER, "the other end sent a %s that does not decode (%s: %s)",
                          proto_type_name(header.type), where, proto_error_text(code));
            return AWTCODEC_BAD;
        }
        return AWTCODEC_MESSAGE;
    }
}

void awtcodec_hello(awtcodec *codec, const char *name, const uint8_t routing_key[AWTCODEC_KEY_SIZE], proto_message *out)
{
    proto_str_copy(proto_str_of(name ? name : "libawtclient " AWTD_VERSION), codec->name, sizeof codec->name);
    *out = (proto_message){.type = PROTO_HELLO, .flags = PROTO_FLAG_REQUIRED};
    struct proto_hello *hello = &out->as.hello;
    memcpy(hello->magic, PROTO_MAGIC, sizeof hello->magic);
    hello->lowest_version = PROTO_VERSION;
    hello->highest_version = PROTO_VERSION;
    memcpy(hello->routing_key, routing_key, sizeof hello->routing_key);
    hello->client = proto_str_of(codec->name);
}

/* Whether `answer` is the wanted step of the handshake. */
static bool handshake_step(const proto_message *answer, uint16_t wanted, uint16_t sent, awtclient_error *error)
{
    if (answer->type == PROTO_ERROR) {
        return awtcodec_fail_by(error, &answer->as.error, sent);
    }
    if (answer->type != wanted) {
        return awtcodec_fail(error, AWTCLIENT_PEER, "the other end answered %s with %s", proto_type_name(sent),
                             proto_type_name(answer->type));
    }
    return true;
}

bool awtcodec_welcome(awtcodec *codec, const proto_message *answer, bool *auth_required, awtclient_error *error)
{
    if (!handshake_step(answer, PROTO_WELCOME, PROTO_HELLO, error)) {
        return false;
    }
    const struct proto_welcome *welcome = &answer->as.welcome;
    if (welcome->version != PROTO_VERSION) {
        return awtcodec_fail(error, AWTCLIENT_PEER,
                             "the daemon chose version %u of the protocol, which was not offered", welcome->version);
    }
    memcpy(codec->server_nonce, welcome->nonce, sizeof codec->server_nonce);
    memcpy(codec->session, welcome->session, sizeof codec->session);
    codec->greatest_payload = welcome->greatest_payload;
    *auth_required = welcome->auth_required != 0;
    codec->in = !*auth_required;
    return true;
}

void awtcodec_auth(awtcodec *codec, const uint8_t token[AUTH_TOKEN_SIZE], const uint8_t nonce[AUTH_NONCE_SIZE],
                   proto_message *out)
{
    memcpy(codec->token, token, sizeof codec->token);
    memcpy(codec->client_nonce, nonce, sizeof codec->client_nonce);
    *out = (proto_message){.type = PROTO_AUTH, .flags = PROTO_FLAG_REQUIRED};
    memcpy(out->as.auth.nonce, nonce, sizeof out->as.auth.nonce);
    auth_client_proof(token, codec->server_nonce, nonce, out->as.auth.proof);
}

bool awtcodec_auth_reply(awtcodec *codec, const proto_message *answer, awtclient_error *error)
{
    if (!handshake_step(answer, PROTO_AUTH_REPLY, PROTO_AUTH, error)) {
        return false;
    }
    uint8_t proof[AUTH_HASH_SIZE];
    auth_server_proof(codec->token, codec->server_nonce, codec->client_nonce, proof);
    if (!auth_equal(proof, answer->as.auth_reply.proof, sizeof proof)) {
        return awtcodec_fail(error, AWTCLIENT_TOKEN,
                             "the other end could not prove that it holds the token: it may not "
                             "be the daemon that the token belongs to");
    }
    codec->in = true;
    return true;
}

uint16_t awtcodec_answer_type(uint16_t type)
{
    switch (type) {
    case PROTO_HELLO:
        return PROTO_WELCOME;
    case PROTO_PING:
        return PROTO_PONG;
    case PROTO_QUERY:
    case PROTO_STEP_MANY:
        return PROTO_FRAME;
    case PROTO_RESTORE:
        return PROTO_CREATE_REPLY;
    default: {
        uint16_t reply = (uint16_t)(type | PROTO_REPLY);
        return reply != type && proto_type_known(reply) ? reply : 0;
    }
    }
}

void awtcodec_number(awtcodec *codec, proto_message *request)
{
    if (request->request == 0) {
        request->request = ++codec->last_request;
    }
    request->flags |= PROTO_FLAG_REQUIRED;
}

awtcodec_match awtcodec_matches(const proto_message *request, const proto_message *message, awtclient_error *error)
{
    bool ours = message->request == request->request;
    if (message->type == PROTO_ERROR && (ours || message->request == 0)) {
        awtcodec_fail_by(error, &message->as.error, request->type);
        return AWTCODEC_FAILED;
    }
    if (!ours) {
        return AWTCODEC_OTHER;
    }
    if (message->type == PROTO_PROGRESS && request->type == PROTO_CREATE) {
        return AWTCODEC_OTHER;
    }
    if (message->type != awtcodec_answer_type(request->type)) {
        awtcodec_fail(error, AWTCLIENT_PEER, "the other end answered %s with %s", proto_type_name(request->type),
                      proto_type_name(message->type));
        return AWTCODEC_FAILED;
    }
    return AWTCODEC_ANSWER;
}
