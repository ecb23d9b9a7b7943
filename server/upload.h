/* upload.h: a file that comes in pieces: strands, or a hierarchy.
 *
 * Memory grows with the bytes that have come, never with what a peer announces; it comes out of a budget, and that
 * out of one for all uploads. A complete upload may be used by several CREATEs, each holding a reference while it waits
 * for its worker; references are counted under the service's lock, the bytes of a complete upload may be read by any.
 * Whether they match their hash is for the worker to find out that uses them: it takes long. */
#ifndef UPLOAD_H
#define UPLOAD_H

#include "auth.h"

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct upload_budget {
    uint64_t used, greatest;     /* bytes */
    struct upload_budget *above; /* that this is a part of; NULL: of none */
} upload_budget;

typedef struct upload {
    unsigned references;
    uint32_t number; /* the client's */
    uint64_t total, received;
    unsigned char *bytes; /* [capacity], heap */
    size_t capacity;
    uint8_t expected[AUTH_HASH_SIZE]; /* the client's hash of the whole file */
    atomic_bool matches;              /* it was found to be right */
    upload_budget *budget;            /* NULL: none */
} upload;

typedef enum upload_result {
    UPLOAD_TAKEN,
    UPLOAD_OUT_OF_ORDER, /* the piece does not begin where the last one ended, or `total` or the hash changed */
    UPLOAD_TOO_LONG,     /* the piece goes past `total` */
    UPLOAD_OVER_BUDGET,
    UPLOAD_NO_MEMORY
} upload_result;

/* An empty upload with one reference. NULL: no memory. The budget must outlive it. */
upload *upload_create(uint32_t number, uint64_t total, const uint8_t expected[AUTH_HASH_SIZE], upload_budget *budget);
/* A complete one of bytes that are there already (heap, taken; freed where it fails), outside of any budget. NULL: no
 * memory. */
upload *upload_of(unsigned char *bytes, size_t size);
upload *upload_hold(upload *up);
/* Accepts NULL. */
void upload_release(upload *up);

/* Whether all bytes are here. */
bool upload_is_complete(const upload *up);
/* Whether the bytes of a complete one match the hash. Any thread, without the lock. */
bool upload_matches(upload *up);

/* Takes the next piece. After anything but UPLOAD_TAKEN the upload is of no further use. */
upload_result upload_add(upload *up, uint64_t total, uint64_t offset, const uint8_t expected[AUTH_HASH_SIZE],
                         const unsigned char *piece, size_t size);

#endif
