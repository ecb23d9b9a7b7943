/* embed.c: see embed.h. */
#include "sim/embed.h"

#include "sim/hanging.h"
#include "sim/relax.h"

void embed_measure(awt_forest *f, const tree *t)
{
    const vec3 *rest = f->groom->rest_position;
    f->active_chord[t->first] = t->first;
    f->active_rest_chord[t->first] = vec3_make(0, 1, 0);
    f->active_turn_share[t->first] = 0.0f;
    for (uint32_t k = t->first + 1; k < t->first + t->count; k++) {
        float radius = f->groom->rest_radius[f->active_node[k]], along = f->active_rest_length[k];
        uint32_t from = f->active_parent[k];
        while (along < radius && from != t->first) {
            along += f->active_rest_length[from];
            from = f->active_parent[from];
        }
        vec3 chord = vec3_sub(rest[f->active_node[k]], rest[f->active_node[from]]);
        float length = vec3_length(chord);
        f->active_chord[k] = from;
        f->active_rest_chord[k] = vec3_unit(chord, f->active_rest_tangent[k]);
        f->active_turn_share[k] = length < radius ? length / radius : 1.0f;
    }
}

/* Present direction of slot k's chord, in the head frame. A root has none. */
static vec3 chord_direction(const awt_forest *f, const tree *t, uint32_t k)
{
    uint32_t node = f->active_node[k];
    if (k == t->first) {
        return f->reference[node];
    }
    vec3 chord = vec3_sub(f->position[node], f->position[f->active_node[f->active_chord[k]]]);
    return vec3_unit(state_to_head(f, chord), f->reference[node]);
}

static quat chord_turn(const awt_forest *f, uint32_t k, vec3 from, vec3 to)
{
    quat turn = quat_between(from, to);
    return f->active_turn_share[k] < 1.0f ? quat_blend(quat_identity(), turn, f->active_turn_share[k]) : turn;
}

/* The turn of what hangs on slot k, from the offsets as they were taken to now, in the head frame. */
static quat embed_turn(const awt_forest *f, const tree *t, uint32_t k)
{
    return chord_turn(f, k, f->reference[f->active_node[k]], chord_direction(f, t, k));
}

/* Index of a finest node in the arrays of the finest level. */
static uint32_t finest_index(const awt_groom *groom, uint32_t node)
{
    return node - groom_finest_first(groom) * groom->info.sections;
}

void embed_rest(awt_forest *f)
{
    const awt_groom *groom = f->groom;
    const uint32_t sections = groom->info.sections;
    for (uint32_t g = 0; g < groom->gc_count; g++) {
        for (uint32_t i = 0; i < sections; i++) {
            uint32_t node = g * sections + i, super = groom->gc_super[g] * sections + i;
            f->offset[node] = vec3_sub(groom->rest_position[node], groom->rest_position[super]);
        }
    }
    for (uint32_t k = 0; k < groom->info.finest_nodes; k++) {
        f->frame[k] = groom->rest_frame[k];
    }
    for (uint32_t t = 0; t < groom->info.wisp_count[0]; t++) {
        for (uint32_t k = f->trees[t].first; k < f->trees[t].first + f->trees[t].count; k++) {
            f->reference[f->active_node[k]] = f->active_rest_chord[k];
        }
    }
}

void embed_bake(awt_forest *f, const tree *t)
{
    const awt_groom *groom = f->groom;
    const uint32_t sections = groom->info.sections;
    for (uint32_t k = t->first; k < t->first + t->count; k++) {
        quat turn = embed_turn(f, t, k);
        uint32_t g = f->active_node[k] / sections, i = f->active_node[k] % sections;
        uint32_t lo = g, hi = g + 1;
        while (groom_descend(groom, &lo, &hi)) {
            for (uint32_t s = lo; s < hi; s++) {
                f->offset[s * sections + i] = quat_rotate(turn, f->offset[s * sections + i]);
            }
        }
        for (uint32_t s = lo; s < hi; s++) {
            quat *frame = &f->frame[finest_index(groom, s * sections + i)];
            *frame = quat_unit(quat_mul(turn, *frame));
        }
    }
}

void embed_refer(awt_forest *f, const tree *t)
{
    f->reference[f->active_node[t->first]] = f->active_rest_chord[t->first];
    for (uint32_t k = t->first + 1; k < t->first + t->count; k++) {
        f->reference[f->active_node[k]] = chord_direction(f, t, k);
    }
}

static bool quat_near(quat a, quat b)
{
    float sign = a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w < 0 ? -1.0f : 1.0f;
    return fabsf(a.x - sign * b.x) < EMBED_SETTLED_TURN && fabsf(a.y - sign * b.y) < EMBED_SETTLED_TURN &&
           fabsf(a.z - sign * b.z) < EMBED_SETTLED_TURN && fabsf(a.w - sign * b.w) < EMBED_SETTLED_TURN;
}

/* The turn of what hangs on slot k, from the rest shape to the offsets as they were taken. */
static quat rest_turn(const awt_forest *f, uint32_t k)
{
    return chord_turn(f, k, f->active_rest_chord[k], f->reference[f->active_node[k]]);
}

static bool radius_relax(awt_forest *f, uint32_t node, float share)
{
    float way = f->groom->rest_radius[node] - f->radius[node];
    f->radius[node] += way * share;
    return fabsf(way) < EMBED_SETTLED_M;
}

/* What hangs on slot k goes by `share` towards rest. True: all of it was near. */
static bool embed_relax_slot(awt_forest *f, uint32_t k, float share)
{
    const awt_groom *groom = f->groom;
    const uint32_t sections = groom->info.sections, node = f->active_node[k], i = node % sections;
    quat turn = rest_turn(f, k);
    mat3 turned = mat3_of_quat(turn);
    bool near = radius_relax(f, node, share);
    uint32_t lo = node / sections, hi = lo + 1;
    while (groom_descend(groom, &lo, &hi)) {
        for (uint32_t s = lo; s < hi; s++) {
            uint32_t n = s * sections + i;
            vec3 rest = vec3_sub(groom->rest_position[n], groom->rest_position[groom->gc_super[s] * sections + i]);
            vec3 way = vec3_sub(mat3_apply(turned, rest), f->offset[n]);
            near = near && vec3_dot(way, way) < EMBED_SETTLED_M * EMBED_SETTLED_M;
            f->offset[n] = vec3_mad(f->offset[n], way, share);
        }
    }
    for (uint32_t s = lo; s < hi; s++) {
        uint32_t n = finest_index(groom, s * sections + i);
        quat rest = quat_mul(turn, groom->rest_frame[n]);
        near = near && quat_near(f->frame[n], rest);
        f->frame[n] = quat_blend(f->frame[n], rest, share);
    }
    return near;
}

/* What hangs on the whole tree, likewise. */
static bool embed_relax_tree(awt_forest *f, const tree *t, float share)
{
    bool near = true;
    if (hanging_is_even(f, t)) {
        quat turn[AWT_MAX_SECTIONS];
        turn[0] = quat_identity(); /* the root's section stays */
        for (uint32_t i = 1; i < t->count; i++) {
            turn[i] = rest_turn(f, t->first + i);
            near = radius_relax(f, f->active_node[t->first + i], share) && near;
        }
        return hanging_relax(f, t, turn, share) && near;
    }
    for (uint32_t k = t->first + 1; k < t->first + t->count; k++) {
        near = embed_relax_slot(f, k, share) && near;
    }
    return near;
}

void embed_relax(awt_forest *f, tree *t, float dt_s)
{
    if (f->params.offset_relaxation <= 0.0f || !t->loose) {
        t->unrelaxed_s = 0.0f;
        return;
    }
    t->unrelaxed_s += dt_s;
    if (t->unrelaxed_s < (t->asleep ? EMBED_RELAX_ASLEEP_S : EMBED_RELAX_S)) {
        return;
    }
    float share = relaxation_share(t->unrelaxed_s, f->params.offset_relaxation);
    t->unrelaxed_s = 0.0f;
    t->moved = f->sub_steps;
    if (embed_relax_tree(f, t, share)) {
        embed_relax_tree(f, t, 1.0f);
        t->loose = false;
    }
}

/* Centres and frames of the finest nodes at section i at and below GC g, which hangs at `centre` turned by `turn`. */
static void embed_place(const awt_forest *f, uint32_t g, uint32_t i, vec3 centre, quat turn, vec3 *centres,
                        quat *frames)
{
    const awt_groom *groom = f->groom;
    const uint32_t sections = groom->info.sections;
    if (groom->gc_sub_count[g] == 0) {
        uint32_t n = finest_index(groom, g * sections + i);
        centres[n] = centre;
        frames[n] = quat_mul(turn, f->frame[n]);
        return;
    }
    for (uint32_t s = groom->gc_sub_first[g]; s < groom->gc_sub_first[g] + groom->gc_sub_count[g]; s++) {
        vec3 below = vec3_add(centre, quat_rotate(turn, f->offset[s * sections + i]));
        embed_place(f, s, i, below, turn, centres, frames);
    }
}

void awt_forest_guides(const awt_forest *f, float *centres, float *frames)
{
    awt_forest_guides_of(f, NULL, centres, frames);
}

void awt_forest_guides_of(const awt_forest *f, const bool *wisps, float *centres, float *frames)
{
    const uint32_t sections = f->groom->info.sections;
    for (uint32_t t = 0; t < f->groom->info.wisp_count[0]; t++) {
        const tree *tr = &f->trees[t];
        if (wisps && !wisps[t]) {
            continue;
        }
        for (uint32_t k = tr->first; k < tr->first + tr->count; k++) {
            uint32_t node = f->active_node[k];
            embed_place(f, node / sections, node % sections, state_to_head(f, f->position[node]), embed_turn(f, tr, k),
                        (vec3 *)(void *)centres, (quat *)(void *)frames);
        }
    }
}
