/* guides_fixture.h: hair that moves, as sections and as strands, and its frames of guides in each form. */
#ifndef GUIDES_FIXTURE_H
#define GUIDES_FIXTURE_H

#include "geom/encode.h"
#include "geom/receive.h"

/* For any viewer; as numbers against nothing; as numbers against those of the base. */
enum { GUIDES_MESHES, GUIDES_WHOLE, GUIDES_DELTA, GUIDES_FORMS };

typedef struct guides_fixture {
    const awt_groom *groom; /* the caller's */
    awt_groom_info info;
    awt_forest *forest;
    float *centres, *frames, *scratch, *points; /* of the forest as it is */
    unsigned char *binding_bytes;
    size_t binding_size;
    geom_binding *binding;
    geom_layout *layout;
    geom_scratch *encoder;
    geom_quantised *base, *now; /* the base's numbers, at first of hair at rest, and those encoded last */
    uint64_t base_sequence;
    geom_delta_reader *reader;
    geom_guides base_got, got; /* the base as a receiver has it, and what it received last of the forms of numbers */
    geom_buffer frame;
} guides_fixture;

/* The groom at rest. `style` NULL: default parameters. Ends the program where there is no memory. */
void guides_fixture_init(guides_fixture *fixture, const awt_groom *groom, const char *style);
void guides_fixture_fini(guides_fixture *fixture);
/* Moves the hair to time_us of a built-in clip. */
void guides_fixture_move(guides_fixture *fixture, const char *clip, int64_t time_us);
/* Encodes the hair as it is into `frame`; checks that it is well. */
void guides_fixture_encode(guides_fixture *fixture, int form, geom_frame_stats *stats);
/* Strands of `frame`, as a receiver makes them: it has a copy of exactly its size, so that the sanitizers see each byte
 * read beyond it. */
awt_status guides_fixture_receive(guides_fixture *fixture, int form, geom_strands *out, awt_error *error);
/* Greatest and mean distance of these strand points from the server's. */
void guides_fixture_compare(guides_fixture *fixture, int form, double *greatest_m, double *mean_m);
/* What was encoded and received last, of the forms of numbers, becomes the base. */
void guides_fixture_keep(guides_fixture *fixture);

#endif
