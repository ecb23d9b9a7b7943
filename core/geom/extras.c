/* extras.c: see extras.h. */
#include "geom/extras.h"

#include "base/error.h"
#include "geom/draco_extra.h"
#include "geom/topology.h"
#include "groom/groom.h"

#include <math.h>
#include <stdlib.h>

enum { GREATEST = (1 << DRACO_EXTRA_BITS) - 1 };

/* Numbers of a patch's vertices, in the order of draco_extra_at. */
typedef struct extras_memory {
    uint16_t *strand, *uv, *width; /* [vertices], [vertices][2], [vertices] of the largest patch */
    float *roots;                  /* [strands][2]: of the level, their uv; NULL where nobody asks */
} extras_memory;

void extras_root_uv(const float root[3], float uv[2])
{
    const float flat = root[0] * root[0] + root[2] * root[2], length = sqrtf(flat + root[1] * root[1]);
    const float height = length > 0 ? root[1] / length : 1.0f;
    const float away = 0.5f * sqrtf(fmaxf(0.5f * (1.0f - height), 0)); /* 0 at the crown, 1/2 right below */
    const float ring = sqrtf(flat), share = ring > 0 ? away / ring : 0;
    uv[0] = 0.5f + share * root[0];
    uv[1] = 0.5f + share * root[2];
}

/* From the hair at rest. */
static bool take_roots(const geom_layout *layout, const awt_groom *groom, extras_memory *m)
{
    const size_t a_strand = 3 * (size_t)layout->points_per_strand;
    const size_t first = (size_t)groom_finest_first(groom) * groom->info.sections;
    float *points = malloc(layout->strands * a_strand * sizeof *points);
    float *scratch = malloc(awt_groom_strand_scratch(groom) * sizeof *scratch);
    m->roots = malloc(2 * (size_t)layout->strands * sizeof *m->roots);
    const bool taken = points && scratch && m->roots;
    if (taken) {
        level_evaluate(&layout->level, groom, NULL, &groom->rest_position[first].x, &groom->rest_frame[0].x, scratch,
                       points);
    }
    for (uint32_t s = 0; taken && s < layout->strands; s++) {
        extras_root_uv(points + s * a_strand, m->roots + 2 * (size_t)s);
    }
    free(points);
    free(scratch);
    return taken;
}

static uint16_t number_of(float value, float range)
{
    const float share = range > 0 ? value / range : 0;
    return (uint16_t)(fmaxf(fminf(share, 1.0f), 0) * (float)GREATEST + 0.5f);
}

static void fill_patch(const geom_layout *layout, const geom_patch *patch, float widest, extras_memory *m)
{
    const uint32_t a_point = topology_vertices_a_point(layout->kind), per_strand = layout->points_per_strand;
    size_t at = 0;
    for (uint32_t s = 0; s < patch->strands; s++) {
        const float *root = m->roots ? m->roots + 2 * (size_t)(patch->first_strand + s) : NULL;
        for (uint32_t v = 0; v < per_strand * a_point; v++, at++) {
            m->strand[at] = (uint16_t)s;
            m->uv[2 * at] = root ? number_of(root[0], 1) : 0;
            m->uv[2 * at + 1] = root ? number_of(root[1], 1) : 0;
            m->width[at] = number_of(2 * layout->half_width[v / a_point], widest);
        }
    }
}

awt_status extras_add(geom_layout *layout, const awt_groom *groom, uint32_t attributes, awt_error *error)
{
    const geom_patch largest = {0, layout->largest_patch};
    const size_t vertices = layout_patch_vertices(layout, &largest);
    float widest = 0;
    for (uint32_t i = 0; i < layout->points_per_strand; i++) {
        widest = fmaxf(widest, 2 * layout->half_width[i]);
    }
    extras_memory m = {.strand = malloc(vertices * sizeof *m.strand),
                       .uv = malloc(2 * vertices * sizeof *m.uv),
                       .width = malloc(vertices * sizeof *m.width)};
    bool made = m.strand && m.uv && m.width;
    made = made && (!(attributes & GEOM_ATTRIBUTE_ROOT_UV) || take_roots(layout, groom, &m));
    awt_status status = made ? AWT_OK : error_set(error, AWT_NO_MEMORY, NULL);
    for (uint32_t i = 0; i < layout->patch_count && status == AWT_OK; i++) {
        fill_patch(layout, &layout->patches[i], widest, &m);
        const draco_extra_values values[DRACO_EXTRAS] = {{m.strand, 0}, {m.uv, 1}, {m.width, widest}};
        status = draco_extra_add(&layout->meshes[i], attributes, values, error);
    }
    free(m.strand);
    free(m.uv);
    free(m.width);
    free(m.roots);
    return status;
}
