/* patch_numbers.c: see patch_numbers.h. */
#include "geom/patch_numbers.h"

#include <stdlib.h>

size_t patch_numbers_bytes(size_t count)
{
    return sizeof(patch_numbers) + count * sizeof(uint16_t);
}

patch_numbers *patch_numbers_create(size_t count)
{
    patch_numbers *made = malloc(patch_numbers_bytes(count));
    if (made) {
        made->spares = NULL;
        made->holders = 1;
        made->checksum = 0;
    }
    return made;
}

patch_numbers *patch_numbers_own(patch_numbers *held)
{
    if (held->holders == 1) {
        return held;
    }
    patch_numbers *own = held->spares;
    held->spares = own->spares;
    held->holders--;
    own->spares = NULL;
    own->holders = 1;
    return own;
}

patch_numbers *patch_numbers_share(patch_numbers *held, patch_numbers *other)
{
    if (held != other) {
        patch_numbers *own = patch_numbers_own(held);
        own->spares = other->spares;
        other->spares = own;
        other->holders++;
    }
    return other;
}

void patch_numbers_destroy(patch_numbers *held)
{
    if (held) {
        free(patch_numbers_own(held));
    }
}
