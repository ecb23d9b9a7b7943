/* framering.c: see framering.h. */
#include "framering.h"

#include "base/error.h"

#include <stdlib.h>

enum { FRAMERING_KEPT = 8 };

typedef struct kept_frame {
    uint64_t sequence; /* 0: none */
    uint8_t kind, level;
    bool numbers; /* guides that came as such: `guides`, else `strands` */
    geom_strands strands;
    geom_guides guides;
} kept_frame;

struct framering {
    geom_delta_reader *reader;
    kept_frame frames[FRAMERING_KEPT + 1]; /* those kept, and the one that is being read */
    uint32_t newest;
    geom_strands evaluated; /* of the newest guides that came as numbers */
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
            geom_guides_fini(&ring->frames[i].guides);
        }
        geom_strands_fini(&ring->evaluated);
        geom_delta_reader_destroy(ring->reader);
        free(ring);
    }
}

/* Where a frame came both as a mesh and as numbers, the form tells which is the base. */
static const kept_frame *find_base(const framering *ring, const struct proto_frame *frame, bool numbers)
{
    for (int i = 0; i <= FRAMERING_KEPT; i++) {
        const kept_frame *kept = &ring->frames[i];
        if (kept->sequence == frame->base && kept->kind == frame->kind && kept->level == frame->level &&
            kept->numbers == numbers) {
            return kept;
        }
    }
    return NULL;
}

static awt_status refuse_delta(const struct proto_frame *frame, awt_error *error)
{
    return error_set(error, AWT_BAD_VALUE, "the frame is a delta against frame %llu, which is not here",
                     (unsigned long long)frame->base);
}

/* Guides as numbers, whole or a delta, and their strands. */
static awt_status read_numbers(framering *ring, const struct proto_frame *frame, const geom_binding *binding,
                               kept_frame *place, awt_error *error)
{
    const kept_frame *base = frame->base != 0 ? find_base(ring, frame, true) : NULL;
    if (!binding) {
        return error_set(error, AWT_BAD_VALUE, "guides are of no use without their binding");
    }
    if (frame->base != 0 && !base) {
        return refuse_delta(frame, error);
    }
    awt_status status = geom_read_guides_delta(ring->reader, binding, frame->glb.bytes, frame->glb.length,
                                               base ? &base->guides : NULL, frame->base, &place->guides, error);
    return status == AWT_OK ? geom_guides_strands(binding, &place->guides, &ring->evaluated, error) : status;
}

static awt_status read_delta(framering *ring, const struct proto_frame *frame, kept_frame *place, awt_error *error)
{
    const kept_frame *base = find_base(ring, frame, false);
    if (!base) {
        return refuse_delta(frame, error);
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
    place->sequence = 0; /* the oldest leaves, whatever comes of this one */
    const bool numbers = frame->kind == GEOM_GUIDES && geom_is_delta(frame->glb.bytes, frame->glb.length);
    awt_status status = numbers            ? read_numbers(ring, frame, binding, place, error)
                        : frame->base != 0 ? read_delta(ring, frame, place, error)
                                           : read_whole(frame, binding, place, error);
    if (status != AWT_OK) {
        return status;
    }
    place->sequence = frame->sequence;
    place->kind = frame->kind;
    place->level = frame->level;
    place->numbers = numbers;
    ring->newest = at;
    *out = numbers ? &ring->evaluated : &place->strands;
    return AWT_OK;
}

uint64_t framering_newest(const framering *ring)
{
    return ring->frames[ring->newest].sequence;
}
