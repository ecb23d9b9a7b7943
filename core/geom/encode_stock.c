/* encode_stock.c: see encode_stock.h. */
#include "geom/encode_stock.h"

#include "geom/buffer.h"
#include "geom/draco_shim.h"
#include "geom/encode_window.h"

#include <math.h>

/* Vertices of a patch, set onto the bounds: what our own encoder does while it quantises. */
static awt_status take_vertices(const geom_layout *layout, const geom_frame_def *def, const geom_patch *patch,
                                float *vertices, uint32_t *clamped, awt_error *error)
{
    const float *points = encode_points_of(layout, def, patch);
    const size_t count = (size_t)patch->strands * layout->points_per_strand;
    if (layout->kind == GEOM_RIBBON) {
        bool taken = ribbon_vertices(&layout->shape, points, patch->strands, vertices, clamped);
        return taken ? AWT_OK : encode_refuse_points(layout, patch, error);
    }
    for (size_t i = 0; i < 3 * count; i++) {
        if (!isfinite(points[i])) {
            return encode_refuse_points(layout, patch, error);
        }
        vertices[i] = fminf(fmaxf(points[i], layout->bounds.least[i % 3]), layout->bounds.greatest[i % 3]);
    }
    *clamped += quantise_count_outside(&layout->bounds, points, count);
    return AWT_OK;
}

/* The bounds that a decoder will find: rounding to the quantisation grid keeps the order, so that the rounded bounds
 * are the bounds of the rounded positions, exactly. */
static void find_bounds(const draco_box *box, const float *vertices, size_t count, glb_patch *place)
{
    for (int k = 0; k < 3; k++) {
        float least = vertices[k], greatest = vertices[k];
        for (size_t i = 1; i < count; i++) {
            float value = vertices[3 * i + (size_t)k];
            least = value < least ? value : least;
            greatest = value > greatest ? value : greatest;
        }
        place->min[k] = draco_shim_round(box, k, least);
        place->max[k] = draco_shim_round(box, k, greatest);
    }
}

awt_status encode_stock(const geom_layout *layout, const geom_frame_def *def, float *vertices, geom_buffer *out,
                        geom_frame_stats *stats, awt_error *error)
{
    awt_status status = AWT_OK;
    for (uint32_t i = 0; i < layout->patch_count && status == AWT_OK; i++) {
        const draco_mesh *mesh = &layout->meshes[i];
        glb_patch place = {.offset = out->size - layout->frame.size};
        status = take_vertices(layout, def, &layout->patches[i], vertices, &stats->clamped_points, error);
        if (status == AWT_OK) {
            find_bounds(&layout->box, vertices, mesh->vertices, &place);
            status =
                draco_shim_encode(&layout->box, vertices, mesh->vertices, layout->indices, mesh->triangles, out, error);
        }
        if (status == AWT_OK) {
            place.size = out->size - layout->frame.size - place.offset;
            glb_template_patch(&layout->frame, i, &place, out);
            stats->encoded_patches++;
            status = geom_buffer_align(out, error);
        }
    }
    return status;
}
