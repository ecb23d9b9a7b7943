/* fake_daemon.c: see fake_daemon.h. */
#include "fake_daemon.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

const uint8_t script_token[AUTH_TOKEN_SIZE] = {0xA1, 0xB2, 0xC3};

bool fake_write(fake *self, const void *bytes, size_t size)
{
    const char *next = bytes;
    while (size > 0) {
        ssize_t sent = send(self->peer, next, size, MSG_NOSIGNAL);
        if (sent <= 0) {
            return false;
        }
        next += sent;
        size -= (size_t)sent;
    }
    return true;
}

bool script_send(fake *self, const proto_message *message)
{
    size_t size = proto_encoded_size(message);
    unsigned char *bytes = malloc(size);
    bool sent = bytes && proto_encode(message, bytes, size) == size && fake_write(self, bytes, size);
    free(bytes);
    return sent;
}

static bool fake_take(fake *self, void *bytes, size_t size)
{
    return size == 0 || recv(self->peer, bytes, size, MSG_WAITALL) == (ssize_t)size;
}

bool fake_read(fake *self)
{
    unsigned char bytes[PROTO_HEADER_SIZE];
    if (!fake_take(self, bytes, sizeof bytes)) {
        return false;
    }
    proto_header header = proto_header_read(bytes);
    free(self->in);
    self->in = malloc(header.length + 1);
    return self->in && fake_take(self, self->in, header.length) &&
           proto_decode(&header, self->in, &self->got, NULL) == 0;
}

bool fake_welcome(fake *self, bool auth_required)
{
    proto_message welcome = {.type = PROTO_WELCOME};
    welcome.as.welcome.version = PROTO_VERSION;
    welcome.as.welcome.auth_required = auth_required;
    welcome.as.welcome.greatest_payload = PROTO_MAX_REQUEST;
    memset(welcome.as.welcome.nonce, 0x5A, sizeof welcome.as.welcome.nonce);
    memset(welcome.as.welcome.session, ++self->sessions, sizeof welcome.as.welcome.session);
    return fake_read(self) && self->got.type == PROTO_HELLO && script_send(self, &welcome);
}

bool fake_admit(fake *self, const uint8_t own_token[AUTH_TOKEN_SIZE])
{
    uint8_t nonce[AUTH_NONCE_SIZE], proof[AUTH_HASH_SIZE];
    memset(nonce, 0x5A, sizeof nonce);
    if (!fake_read(self) || self->got.type != PROTO_AUTH) {
        return false;
    }
    auth_client_proof(script_token, nonce, self->got.as.auth.nonce, proof);
    self->proof_good = auth_equal(proof, self->got.as.auth.proof, sizeof proof);
    proto_message reply = {.type = PROTO_AUTH_REPLY};
    auth_server_proof(own_token, nonce, self->got.as.auth.nonce, reply.as.auth_reply.proof);
    return script_send(self, &reply);
}

void fake_error(fake *self, uint64_t request, uint16_t about, uint16_t code, const char *text)
{
    proto_message error = {.type = PROTO_ERROR, .request = request};
    error.as.error.code = code;
    error.as.error.about = about;
    error.as.error.retry = proto_error_retry(code);
    error.as.error.retry_after_ms = 250;
    error.as.error.text = proto_str_of(text);
    script_send(self, &error);
}

static bool accept_one(fake *self)
{
    struct pollfd entry = {.fd = self->listener, .events = POLLIN};
    self->peer = poll(&entry, 1, FAKE_PATIENCE_MS) == 1 ? accept(self->listener, NULL, NULL) : -1;
    return self->peer >= 0;
}

bool fake_hang_up(fake *self)
{
    close(self->peer);
    return accept_one(self);
}

static void *fake_run(void *context)
{
    fake *self = context;
    if (accept_one(self)) {
        self->script(self);
        close(self->peer);
    }
    return NULL;
}

bool fake_start(fake *self, void (*script)(fake *self))
{
    struct sockaddr_in place = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    socklen_t size = sizeof place;
    *self = (fake){.script = script, .listener = socket(AF_INET, SOCK_STREAM, 0)};
    if (self->listener < 0 || bind(self->listener, (struct sockaddr *)&place, sizeof place) != 0 ||
        listen(self->listener, 1) != 0 || getsockname(self->listener, (struct sockaddr *)&place, &size) != 0) {
        return false;
    }
    snprintf(self->address, sizeof self->address, "127.0.0.1:%u", (unsigned)ntohs(place.sin_port));
    self->running = pthread_create(&self->thread, NULL, fake_run, self) == 0;
    return self->running;
}

void fake_stop(fake *self)
{
    if (self->running) {
        pthread_join(self->thread, NULL);
    }
    close(self->listener);
    free(self->in);
    self->in = NULL;
}

awtclient *fake_open(const fake *self, const char *token_file, int timeout_ms, awtclient_error *error)
{
    awtclient_options options = {
        .address = self->address, .token_file = token_file, .name = "test", .timeout_ms = timeout_ms};
    return awtclient_open(&options, error);
}
