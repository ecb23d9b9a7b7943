/* protocol.h: who may say what when, and what answers it. A message goes through here in two steps, so that a header is
 * judged before room is made for its payload. */
#ifndef PROTOCOL_H
#define PROTOCOL_H

#include "input.h"
#include "session.h"

typedef enum protocol_verdict {
    PROTOCOL_TAKE,  /* read the payload, then protocol_receive */
    PROTOCOL_SKIP,  /* read past the payload: an unknown message */
    PROTOCOL_REFUSE /* an ERROR was sent and the session is closing */
} protocol_verdict;

/* Judges length and type by the session's state. */
protocol_verdict protocol_judge(session *s, const proto_header *header);

/* Decodes a payload whose header was PROTOCOL_TAKE, and does what it asks. */
void protocol_receive(session *s, const proto_header *header, const unsigned char *payload);

/* Does the next thing with what has come: judges a header, or carries out a whole message; *done is that one's type, 0
 * where it was a header. False: bytes must come first, or the session is closing. */
bool protocol_step(session *s, input *in, uint16_t *done);

#endif
