/* liars_fixture.h: whoever else may listen where a client looks for awtd: programs that lie, stop in the middle, say
 * nothing or never stop. Each face of the client library meets all of them (test_proto_liars.c). */
#ifndef LIARS_FIXTURE_H
#define LIARS_FIXTURE_H

#include "fake_daemon.h"

typedef struct liar {
    const char *name;
    void (*script)(fake *self);
    int timeout_ms; /* that the client is to have: short where nothing else ends it */
    int code;       /* of its error, in the handshake or when it asks for LIST */
} liar;

enum { LIAR_SHORT_MS = 150, LIAR_LONG_MS = FAKE_PATIENCE_MS };

extern const liar LIARS[];
extern const size_t LIAR_COUNT;

/* For a client of that one; it has the token of honest scripts. */
awtclient_options liar_options(const liar *who, const fake *server);

#endif
