/* receiver.c: frames to strand points and nodes for a host that is not C: numbers and addresses only. Built as
 * WebAssembly, which the browser client decodes by (lib/receiver.js), and for Windows. */
#include "framering.h"

#include <stdlib.h>

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((used, visibility("default"))) /* used: emscripten exports it */
#endif

/* What is read of one forest. */
typedef struct receiver {
    framering *ring;
    geom_binding *binding;       /* NULL until receiver_bind */
    const geom_strands *strands; /* the last frame, NULL: none yet */
    geom_nodes nodes;
    awt_error error;
} receiver;

EXPORT receiver *receiver_create(void);
EXPORT void receiver_destroy(receiver *r);
EXPORT bool receiver_bind(receiver *r, const void *bytes, size_t size);
EXPORT bool receiver_frame(receiver *r, const void *bytes, size_t size, unsigned kind, unsigned level,
                           uint64_t sequence, uint64_t base);
EXPORT bool receiver_nodes(receiver *r, const void *bytes, size_t size);
EXPORT uint64_t receiver_newest(const receiver *r);
EXPORT const float *receiver_positions(const receiver *r);
EXPORT const float *receiver_widths(const receiver *r);
EXPORT uint32_t receiver_strands(const receiver *r);
EXPORT uint32_t receiver_points(const receiver *r);
EXPORT const double *receiver_head(const receiver *r);
EXPORT const awt_node *receiver_node_list(const receiver *r);
EXPORT uint32_t receiver_node_count(const receiver *r);
EXPORT const char *receiver_error(const receiver *r);

/* NULL: no memory. */
receiver *receiver_create(void)
{
    receiver *r = calloc(1, sizeof *r);
    if (r) {
        r->ring = framering_create();
        if (!r->ring) {
            receiver_destroy(r);
            return NULL;
        }
    }
    return r;
}

/* Accepts NULL. */
void receiver_destroy(receiver *r)
{
    if (r) {
        framering_destroy(r->ring);
        geom_binding_destroy(r->binding);
        geom_nodes_fini(&r->nodes);
        free(r);
    }
}

/* The binding of the forest's guides. False here and below: receiver_error says why. */
bool receiver_bind(receiver *r, const void *bytes, size_t size)
{
    geom_binding *binding;
    if (geom_binding_read(bytes, size, &binding, &r->error) != AWT_OK) {
        return false;
    }
    geom_binding_destroy(r->binding);
    r->binding = binding;
    return true;
}

/* The GLB of a FRAME of ribbons, strands or guides, whole or a delta, with what FRAME says of it. */
bool receiver_frame(receiver *r, const void *bytes, size_t size, unsigned kind, unsigned level, uint64_t sequence,
                    uint64_t base)
{
    const struct proto_frame frame = {.kind = (uint8_t)kind,
                                      .level = (uint8_t)level,
                                      .sequence = sequence,
                                      .base = base,
                                      .glb = {bytes, (uint32_t)size}};
    return framering_take(r->ring, &frame, r->binding, &r->strands, &r->error) == AWT_OK;
}

/* The GLB of a FRAME of nodes. */
bool receiver_nodes(receiver *r, const void *bytes, size_t size)
{
    geom_nodes next = {0};
    if (geom_read_nodes(bytes, size, &next, &r->error) != AWT_OK) {
        return false;
    }
    geom_nodes_fini(&r->nodes);
    r->nodes = next;
    return true;
}

/* What CREDIT's `have` may say. */
uint64_t receiver_newest(const receiver *r)
{
    return framering_newest(r->ring);
}

/* Of the last frame: [receiver_strands][receiver_points][3], metres in the head frame; good until the next one. */
const float *receiver_positions(const receiver *r)
{
    return r->strands ? r->strands->positions : NULL;
}

/* [receiver_points]: of every strand from root to tip, metres. */
const float *receiver_widths(const receiver *r)
{
    return r->strands ? r->strands->widths : NULL;
}

uint32_t receiver_strands(const receiver *r)
{
    return r->strands ? r->strands->strand_count : 0;
}

uint32_t receiver_points(const receiver *r)
{
    return r->strands ? r->strands->points_per_strand : 0;
}

/* Position and orientation (x y z w) of the head in the last frame of hair; NULL before there is one. */
const double *receiver_head(const receiver *r)
{
    return r->strands ? r->strands->head.position : NULL;
}

/* [receiver_node_count], 24 bytes each: f32 position[3], f32 radius, u32 level, u32 parent. */
const awt_node *receiver_node_list(const receiver *r)
{
    return r->nodes.nodes;
}

uint32_t receiver_node_count(const receiver *r)
{
    return r->nodes.count;
}

const char *receiver_error(const receiver *r)
{
    return r->error.text;
}
