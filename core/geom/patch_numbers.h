/* patch_numbers.h: the whole numbers of one patch, shared by the frames in which nothing of it moved (for core/geom
 * alone). Frames that hold the same block have the same numbers, and nobody needs to compare or to copy them.
 *
 * Every frame brings one block of each patch into being and takes one away with it. A block that n frames hold keeps
 * the n - 1 others that they would have had: who leaves it to write numbers of its own takes one of these. So nothing
 * is allocated but when a frame is made. Frames that share belong to one thread. */
#ifndef GEOM_PATCH_NUMBERS_H
#define GEOM_PATCH_NUMBERS_H

#include <stddef.h>
#include <stdint.h>

typedef struct patch_numbers {
    struct patch_numbers *spares; /* holders - 1 of them, one linked to the next */
    uint32_t holders;             /* frames, at least 1 */
    uint32_t checksum;            /* CRC-32C of the numbers */
    uint16_t numbers[];
} patch_numbers;

/* Bytes of one with so many numbers. */
size_t patch_numbers_bytes(size_t count);
/* Of one holder, numbers not set. NULL: no memory. */
patch_numbers *patch_numbers_create(size_t count);
/* A holder goes, and one block with it. Accepts NULL. */
void patch_numbers_destroy(patch_numbers *held);

/* The holder of `held` holds `other` from now on, of as many numbers; it may be the same. Returns `other`. */
patch_numbers *patch_numbers_share(patch_numbers *held, patch_numbers *other);
/* The holder of `held` alone holds what this returns, and may write there; what the numbers are then is not said. */
patch_numbers *patch_numbers_own(patch_numbers *held);

#endif
