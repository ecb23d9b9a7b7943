/* awtframes.c: see awtframes.h. What waits and is decoded is here; what is shown between frames is framemix.c's. */
#include "awtframes.h"
#include "codec.h"
#include "framemix.h"
#include "framering.h"

#include <stdlib.h>
#include <string.h>

/* A frame that came, with its own copy of the bytes. */
typedef struct waiting_frame {
    struct proto_frame frame; /* glb points into bytes */
    unsigned char *bytes;     /* heap, used again */
    size_t capacity;
} waiting_frame;

struct awtframes {
    framering *ring;
    geom_binding *binding;
    framemix mix;
    waiting_frame waiting[AWTFRAMES_WAITING + 1]; /* a ring; the one that the job has is out of it */
    uint32_t first, count;
    waiting_frame taken; /* the job's */
    bool decoding;
    awt_status status; /* of the job, and what it read */
    awt_error why;
    const geom_strands *read;
    uint64_t have; /* as awtframes_have, while a job may be changing the ring */
};

#define LONGEST_US (INT64_C(1) << 60) /* no simulated time is beyond this, and sums of these do not overflow */

awtframes *awtframes_create(int64_t extrapolate_us)
{
    awtframes *frames = calloc(1, sizeof *frames);
    if (frames) {
        frames->ring = framering_create();
        framemix_init(&frames->mix, extrapolate_us);
    }
    if (frames && !frames->ring) {
        free(frames);
        return NULL;
    }
    return frames;
}

void awtframes_destroy(awtframes *frames)
{
    if (!frames) {
        return;
    }
    for (int i = 0; i <= AWTFRAMES_WAITING; i++) {
        free(frames->waiting[i].bytes);
    }
    free(frames->taken.bytes);
    framering_destroy(frames->ring);
    geom_binding_destroy(frames->binding);
    framemix_fini(&frames->mix);
    free(frames);
}

bool awtframes_bind(awtframes *frames, const void *bytes, size_t size, awtclient_error *error)
{
    geom_binding *binding = NULL;
    awt_error why = {0};
    awt_status status = geom_binding_read(bytes, size, &binding, &why);
    if (status != AWT_OK) {
        return awtcodec_fail(error, status == AWT_NO_MEMORY ? AWTCLIENT_MEMORY : AWTCLIENT_PEER, "the binding: %s",
                             why.text);
    }
    geom_binding_destroy(frames->binding);
    frames->binding = binding;
    return true;
}

/* Room for one more; of too many the oldest is left out. */
static waiting_frame *make_room(awtframes *frames)
{
    if (frames->count == AWTFRAMES_WAITING) {
        frames->first = (frames->first + 1) % (AWTFRAMES_WAITING + 1);
        frames->count--;
    }
    return &frames->waiting[(frames->first + frames->count) % (AWTFRAMES_WAITING + 1)];
}

bool awtframes_take(awtframes *frames, const struct proto_frame *frame, awtclient_error *error)
{
    if (frame->kind > GEOM_GUIDES) {
        return awtcodec_fail(error, AWTCLIENT_PEER, "a frame of kind %u holds no strands", (unsigned)frame->kind);
    }
    waiting_frame *place = make_room(frames);
    if (frame->glb.length > place->capacity) {
        unsigned char *larger = realloc(place->bytes, frame->glb.length);
        if (!larger) {
            return awtcodec_fail(error, AWTCLIENT_MEMORY, "not enough memory for a frame");
        }
        place->bytes = larger;
        place->capacity = frame->glb.length;
    }
    place->frame = *frame;
    if (frame->glb.length > 0) {
        memcpy(place->bytes, frame->glb.bytes, frame->glb.length);
    }
    place->frame.glb.bytes = place->bytes;
    frames->count++;
    return true;
}

bool awtframes_begin(awtframes *frames)
{
    if (frames->decoding || frames->count == 0) {
        return false;
    }
    const waiting_frame old = frames->taken;
    frames->taken = frames->waiting[frames->first];
    frames->waiting[frames->first] = old; /* its memory is used again */
    frames->first = (frames->first + 1) % (AWTFRAMES_WAITING + 1);
    frames->count--;
    frames->decoding = true;
    frames->read = NULL;
    return true;
}

void awtframes_decode(awtframes *frames)
{
    frames->status = framering_take(frames->ring, &frames->taken.frame, frames->binding, &frames->read, &frames->why);
}

bool awtframes_end(awtframes *frames, awtclient_error *error)
{
    frames->decoding = false;
    if (frames->status != AWT_OK) {
        return awtcodec_fail(error, frames->status == AWT_NO_MEMORY ? AWTCLIENT_MEMORY : AWTCLIENT_PEER,
                             "frame %llu: %s", (unsigned long long)frames->taken.frame.sequence, frames->why.text);
    }
    frames->have = framering_newest(frames->ring);
    if (frames->read->time_us <= -LONGEST_US || frames->read->time_us >= LONGEST_US) {
        return awtcodec_fail(error, AWTCLIENT_PEER, "frame %llu is of no possible time",
                             (unsigned long long)frames->have);
    }
    return framemix_add(&frames->mix, frames->read) ||
           awtcodec_fail(error, AWTCLIENT_MEMORY, "not enough memory for a frame");
}

uint64_t awtframes_have(const awtframes *frames)
{
    return frames->have;
}

int64_t awtframes_newest_us(const awtframes *frames)
{
    return framemix_newest_us(&frames->mix);
}

bool awtframes_show(awtframes *frames, int64_t time_us, awtframes_shown *shown)
{
    return framemix_show(&frames->mix, time_us, shown);
}

void awtframes_counts(const awtframes *frames, uint64_t counts[3])
{
    memcpy(counts, frames->mix.counts, sizeof frames->mix.counts);
}
