/* framering.h: the frames that a client keeps, so that it can read deltas: the newest 8, as the protocol has it
 * (PROTOCOL.md, Deltas). Memory is taken for the frames that come and used again. */
#ifndef CLIENTS_FRAMERING_H
#define CLIENTS_FRAMERING_H

#include "geom/receive.h"
#include "proto.h"

typedef struct framering framering;

/* NULL: no memory. */
framering *framering_create(void);
/* Accepts NULL. */
void framering_destroy(framering *ring);

/* Reads a FRAME of ribbons, of strands or, by `binding` (NULL for others), of guides, whole, as a mesh or as numbers,
 * or a delta, and keeps it under its sequence. *out are its strands, of guides evaluated here, good until the next
 * call. AWT_BAD_VALUE (a delta against a frame that is not here, or a kind without strands), and what the readers of
 * geom/receive.h say. */
awt_status framering_take(framering *ring, const struct proto_frame *frame, const geom_binding *binding,
                          const geom_strands **out, awt_error *error);

/* What CREDIT's `have` may say: the sequence of the newest frame kept; 0: none. */
uint64_t framering_newest(const framering *ring);

#endif
