/* handshake.c: see handshake.h. */
#include "handshake.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool handshake_random(void *bytes, size_t size, awtclient_error *error)
{
    FILE *file = fopen("/dev/urandom", "rb");
    size_t got = 0;
    if (file) {
        setvbuf(file, NULL, _IONBF, 0); /* take no more from it than is used */
        got = fread(bytes, 1, size, file);
        fclose(file);
    }
    return got == size || awtcodec_fail(error, AWTCLIENT_TOKEN, "/dev/urandom cannot be read: no random numbers");
}

static bool copy_options(handshake *self, const awtclient_options *options, awtclient_error *error)
{
    if (options->token) {
        self->token_given = auth_token_parse(options->token, self->token);
        return self->token_given ||
               awtcodec_fail(error, AWTCLIENT_TOKEN, "the token given is none: that is 32 hexadecimal digits");
    }
    if (options->token_file) {
        size_t size = strlen(options->token_file) + 1;
        self->token_file = malloc(size);
        if (!self->token_file) {
            return awtcodec_fail(error, AWTCLIENT_MEMORY, "not enough memory");
        }
        memcpy(self->token_file, options->token_file, size);
    }
    return true;
}

bool handshake_init(handshake *self, awtcodec *codec, const awtclient_options *options, proto_message *hello,
                    awtclient_error *error)
{
    uint8_t key[AWTCODEC_KEY_SIZE];
    if (!copy_options(self, options, error) || (!options->routing_key && !handshake_random(key, sizeof key, error))) {
        return false;
    }
    awtcodec_hello(codec, options->name, options->routing_key ? options->routing_key : key, hello);
    return true;
}

void handshake_fini(handshake *self)
{
    free(self->token_file);
    *self = (handshake){.welcomed = false};
}

static bool read_token(const char *path, uint8_t token[AUTH_TOKEN_SIZE], awtclient_error *error)
{
    FILE *file = fopen(path, "rb");
    if (!file && errno == ENOENT) {
        return awtcodec_fail(error, AWTCLIENT_TOKEN, "awtd wants a token; looked in %.150s: give --token-file", path);
    }
    if (!file) {
        return awtcodec_fail(error, AWTCLIENT_TOKEN,
                             "awtd wants a token; %.120s cannot be read (%.40s): give --token-file", path,
                             strerror(errno));
    }
    char text[256] = "";
    size_t size = fread(text, 1, sizeof text - 1, file);
    fclose(file);
    text[size] = '\0';
    if (!auth_token_parse(text, token)) {
        return awtcodec_fail(error, AWTCLIENT_TOKEN, "%.150s holds no token: that is 32 hexadecimal digits", path);
    }
    return true;
}

/* The token file's name; without one given, that of the place where awtd leaves it. False: no such place. */
static bool token_path(const handshake *self, char *path, size_t size)
{
    if (self->token_file) {
        snprintf(path, size, "%s", self->token_file);
        return true;
    }
    return auth_token_path(NULL, path, size);
}

static handshake_result authenticate(handshake *self, awtcodec *codec, proto_message *reply, awtclient_error *error)
{
    char path[4096];
    uint8_t nonce[AUTH_NONCE_SIZE];
    if (!self->token_given && !token_path(self, path, sizeof path)) {
        awtcodec_fail(error, AWTCLIENT_TOKEN,
                      "awtd wants a token, and neither AWTD_STATE_DIR nor HOME says where: give --token-file");
        return HANDSHAKE_FAILED;
    }
    if (!self->token_given && !read_token(path, self->token, error)) {
        return HANDSHAKE_FAILED;
    }
    if (!handshake_random(nonce, sizeof nonce, error)) {
        return HANDSHAKE_FAILED;
    }
    awtcodec_auth(codec, self->token, nonce, reply);
    return HANDSHAKE_SEND;
}

static void tell_wrong_token(const handshake *self, awtclient_error *error)
{
    char path[4096];
    if (self->token_given || !token_path(self, path, sizeof path)) {
        awtcodec_fail(error, PROTO_ERROR_WRONG_TOKEN, "the token given is not that of this daemon");
        return;
    }
    awtcodec_fail(error, PROTO_ERROR_WRONG_TOKEN,
                  "the token in %.120s is not that of this daemon: give its --token-file", path);
}

handshake_result handshake_take(handshake *self, awtcodec *codec, const proto_message *answer, proto_message *reply,
                                awtclient_error *error)
{
    if (!self->welcomed) {
        bool auth_required;
        if (!awtcodec_welcome(codec, answer, &auth_required, error)) {
            return HANDSHAKE_FAILED;
        }
        self->welcomed = true;
        return auth_required ? authenticate(self, codec, reply, error) : HANDSHAKE_DONE;
    }
    if (answer->type == PROTO_ERROR && answer->as.error.code == PROTO_ERROR_WRONG_TOKEN) {
        tell_wrong_token(self, error);
        return HANDSHAKE_FAILED;
    }
    return awtcodec_auth_reply(codec, answer, error) ? HANDSHAKE_DONE : HANDSHAKE_FAILED;
}
