/* published.c: see published.h. */
#include "published.h"

#include <stdlib.h>

published *published_create(void)
{
    published *frame = calloc(1, sizeof *frame);
    if (frame) {
        atomic_init(&frame->references, 1);
    }
    return frame;
}

published *published_hold(published *frame)
{
    atomic_fetch_add(&frame->references, 1);
    return frame;
}

void published_release(published *frame)
{
    if (frame && atomic_fetch_sub(&frame->references, 1) == 1) {
        geom_buffer_fini(&frame->glb);
        free(frame);
    }
}
