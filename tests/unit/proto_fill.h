/* proto_fill.h: messages with made-up contents, and whether two messages say the same, both from the layouts: no test
 * has to be taught a new field. */
#ifndef PROTO_FILL_H
#define PROTO_FILL_H

#include "base/rng.h"
#include "layout.h"

/* How long texts, blobs and lists are: their limit or this, whichever is less. */
typedef struct fill_sizes {
    uint32_t text, blob, list;
} fill_sizes;

/* Texts and blobs point into static storage. A HELLO's length is the true one. */
void proto_fill(proto_message *message, const proto_layout *layout, fill_sizes sizes, rng *random);

/* The name of the first field in which two messages of one type differ; NULL: they say the same. */
const char *proto_difference(const proto_message *a, const proto_message *b);

/* The message's payload in heap memory of exactly its size (so that a sanitizer sees a read behind it), cut to
 * `size` bytes or, with SIZE_MAX, whole. */
unsigned char *proto_payload(const proto_message *message, size_t size, proto_header *header);

#endif
