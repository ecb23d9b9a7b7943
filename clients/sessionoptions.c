/* sessionoptions.c: see sessionoptions.h. */
#include "sessionoptions.h"
#include "handshake.h"

#include <stdlib.h>
#include <string.h>

enum { DEFAULT_TIMEOUT_MS = 30000 };

static bool copy_text(char **copy, const char **text)
{
    if (*text) {
        const size_t size = strlen(*text) + 1;
        *copy = malloc(size);
        if (!*copy) {
            return false;
        }
        memcpy(*copy, *text, size);
        *text = *copy;
    }
    return true;
}

bool sessionoptions_copy(sessionoptions *self, const awtsession_options *options, awtclient_error *error)
{
    awtclient_options *link = &self->given.link;
    self->given = *options;
    self->transport_brought = link->transport != NULL;
    if (link->timeout_ms <= 0) {
        link->timeout_ms = DEFAULT_TIMEOUT_MS;
    }
    if (link->routing_key) {
        memcpy(self->routing_key, link->routing_key, sizeof self->routing_key);
    } else if (!handshake_random(self->routing_key, sizeof self->routing_key, error)) {
        return false;
    }
    link->routing_key = self->routing_key; /* the same for all, so that they reach the same daemon */
    return (copy_text(&self->texts[0], &link->address) && copy_text(&self->texts[1], &link->token_file) &&
            copy_text(&self->texts[2], &link->token) && copy_text(&self->texts[3], &link->name)) ||
           awtcodec_fail(error, AWTCLIENT_MEMORY, "not enough memory");
}

void sessionoptions_fini(sessionoptions *self)
{
    for (int i = 0; i < SESSIONOPTIONS_TEXTS; i++) {
        free(self->texts[i]);
    }
    *self = (sessionoptions){.transport_brought = false};
}

awtlink *sessionoptions_connect(sessionoptions *self, int64_t now_us, awtclient_error *error)
{
    awtlink_transport transport;
    awtclient_options options = self->given.link;
    self->given.link.transport = NULL; /* the link takes it over */
    if (!options.transport && self->given.make_transport) {
        if (!self->given.make_transport(self->given.context, &transport, error)) {
            return NULL;
        }
        options.transport = &transport;
    } else if (!options.transport && self->transport_brought) { /* never in the open where it was under TLS */
        awtcodec_fail(error, AWTCLIENT_ADDRESS, "the transport was for one connection: give make_transport");
        return NULL;
    }
    return awtlink_open(&options, now_us, error);
}
