/* published.h: a frame that is finished: made once by a worker, never changed, sent to everyone who asked, freed with
 * the last reference. */
#ifndef PUBLISHED_H
#define PUBLISHED_H

#include "geom/encode.h"
#include "proto.h"

#include <stdatomic.h>

typedef struct published {
    atomic_uint references;
    struct proto_frame frame; /* all but age_us, skipped and last_write_us, which differ from receiver to receiver */
    int64_t stepped_us;       /* monotonic clock at the end of its step: its age counts from here */
    geom_buffer glb;          /* frame.glb points into it */
} published;

/* An empty frame with one reference; the maker fills it before anyone else sees it. NULL: no memory. */
published *published_create(void);
/* One reference more; returns `frame`. Any thread. */
published *published_hold(published *frame);
/* One reference less. Any thread. Accepts NULL. */
void published_release(published *frame);

#endif
