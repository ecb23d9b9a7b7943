/* guides_fixture.h: hair that moves, as sections and as strands, with layouts of both forms of guides. */
#ifndef GUIDES_FIXTURE_H
#define GUIDES_FIXTURE_H

#include "geom/encode.h"
#include "geom/receive.h"

enum { GUIDES_FORMS = 2 }; /* as they are, and bound */

typedef struct guides_fixture {
    const awt_groom *groom; /* the caller's */
    awt_groom_info info;
    awt_forest *forest;
    float *centres, *frames, *scratch, *points; /* of the forest as it is */
    unsigned char *binding_bytes;
    size_t binding_size;
    geom_binding *binding;
    geom_layout *layouts[GUIDES_FORMS];
    geom_scratch *scratches[GUIDES_FORMS];
    geom_buffer frame;
} guides_fixture;

/* The groom at rest. `style` NULL: default parameters. Ends the program where there is no memory. */
void guides_fixture_init(guides_fixture *fixture, const awt_groom *groom, const char *style);
void guides_fixture_fini(guides_fixture *fixture);
/* Moves the hair to time_us of a built-in clip. */
void guides_fixture_move(guides_fixture *fixture, const char *clip, int64_t time_us);
/* Encodes the hair as it is into `frame`; checks that it is well. */
void guides_fixture_encode(guides_fixture *fixture, int form, geom_frame_stats *stats);
/* Greatest and mean distance of strand points of `frame`, as a receiver makes them, from the server's. */
void guides_fixture_compare(const guides_fixture *fixture, double *greatest_m, double *mean_m);

#endif
