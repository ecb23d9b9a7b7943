/* framering.c: see framering.h. */
#include "framering.h"

#include "base/error.h"

#include <stdlib.h>

enum { FRAMERING_KEPT = 8 };

typedef struct kept_frame {
    uint64_t sequence; /* 0: none */
    uint8_t kind, level;
    geom_strands strands;
} kept_frame;

struct framering {
    geom_delta_reader *reader;
    kept_frame frames[FRAMERING_KEPT + 1]; /* those kept, and the one that is being read */
    uint32_t newest;
};

framering *framering_create(void)
{
    framering *ring = calloc(1, sizeof *ring);
    if (ring && geom_delta_reader_create(&ring->reader, NULL) != AWT_OK) {
        free(ring);
        return NULL;
    }
    return ring;
}

void framering_destroy(framering *ring)
{
    if (ring) {
        for (int i = 0; i <= FRAMERING_KEPT; i++) {
            geom_strands_fini(&ring->frames[i].strands);
        }
        geom_delta_reader_destroy(ring->reader);
        free(ring);
    }
}

static const kept_frame *find_base(const framering *ring, const struct proto_frame *frame)
{
    for (int i = 0; i <= FRAMERING_KEPT; i++) {
        const kept_frame *kept = &ring->frames[i];
        if (kept->sequence == frame->base && kept->kind == frame->kind && kept->level == frame->level) {
            return kept;
        }
    }
    return NULL;
}

static awt_status read_delta(framering *ring, const struct proto_frame *frame, kept_frame *place, awt_error *error)
{
    const kept_frame *base = find_base(ring, frame);
    if (!base || base == place) {
        return error_set(error, AWT_BAD_VALUE, "the frame is a delta against frame %llu, which is not here",
                         (unsigned long long)frame->base);
    }
    return geom_read_delta(ring->reader, frame->glb.bytes, frame->glb.length, &base->strands, base->sequence,
                           &place->strands, error);
}

static awt_status read_whole(const struct proto_frame *frame, const geom_binding *binding, kept_frame *place,
                             awt_error *error)
{
    geom_strands read = {0};
    awt_status status = geom_receive_frame(binding, frame->glb.bytes, frame->glb.length, &read, error);
    if (status == AWT_OK) {
        geom_strands_fini(&place->strands);
        place->strands = read;
    }
    return status;
}

awt_status framering_take(framering *ring, const struct proto_frame *frame, const geom_binding *binding,
                          const geom_strands **out, awt_error *error)
{
    const uint32_t at = (ring->newest + 1) % (FRAMERING_KEPT + 1);
    kept_frame *place = &ring->frames[at];
    awt_status status =
        frame->base != 0 ? read_delta(ring, frame, place, error) : read_whole(frame, binding, place, error);
    if (status != AWT_OK) {
        return status;
    }
    place->sequence = frame->sequence;
    place->kind = frame->kind;
    place->level = frame->level;
    ring->newest = at;
    *out = &place->strands;
    return AWT_OK;
}

uint64_t framering_newest(const framering *ring)
{
    return ring->frames[ring->newest].sequence;
}
