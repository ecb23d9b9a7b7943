/* guides.c: see guides.h. */
#include "geom/guides.h"

#include "geom/encode.h" /* GEOM_PATCH_POINTS */

#include <math.h>

/* Cut off and set right, which is floor() without a call: `value` is far below 2^31. */
static int32_t nearest(float value)
{
    const float up = value + 0.5f;
    const int32_t whole = (int32_t)up;
    return whole - (up < (float)whole);
}

static float turn_reach(const geom_binding *binding)
{
    return (float)((1 << (binding->turn_bits - 1)) - 1);
}

/* What a number is worth. */
static float turn_scale(const geom_binding *binding)
{
    return 1.0f / turn_reach(binding);
}

/* The quaternion that three numbers mean; of length 1 whatever they are. */
static quat turn_of(float scale, const int16_t number[3])
{
    const vec3 m = {(float)number[0] * scale, (float)number[1] * scale, (float)number[2] * scale};
    const float square = vec3_dot(m, m), share = 1.0f / (1.0f + square);
    return (quat){2.0f * m.x * share, 2.0f * m.y * share, 2.0f * m.z * share, (1.0f - square) * share};
}

static float dot_of(const quat *from, const quat *to)
{
    return (from->x * to->x + from->y * to->y) + (from->z * to->z + from->w * to->w);
}

/* Three numbers of the turn that quaternion t is. False: it is none. */
static bool put_turn(float reach, quat t, int16_t number[3])
{
    const float length = sqrtf(t.x * t.x + t.y * t.y + t.z * t.z + t.w * t.w);
    const float scale = reach / (t.w < 0 ? t.w - length : t.w + length);
    if (!(length > 0 && isfinite(length) && isfinite(scale))) {
        return false;
    }
    number[0] = (int16_t)nearest(t.x * scale);
    number[1] = (int16_t)nearest(t.y * scale);
    number[2] = (int16_t)nearest(t.z * scale);
    return true;
}

/* Strands go from one section's frame to the next the shorter way round (sim/evaluate.c). Where that is half a turn, a
 * number's rounding would send them the other way, millimetres off: the turn of the second section, node n, is then
 * taken a few numbers farther, so that a reader finds the same way the shorter one. */
static void keep_side(const geom_binding *binding, const quat *rest, const quat *frames, int16_t *turns, size_t n)
{
    enum { FARTHEST = 4 };
    const float near = 2.0f * FARTHEST * guides_turn_step(binding->turn_bits), dot = dot_of(&frames[n - 1], &frames[n]);
    if (!(fabsf(dot) < near)) {
        return;
    }
    const float scale = turn_scale(binding);
    const quat before = quat_mul(turn_of(scale, turns + 3 * n - 3), rest[n - 1]);
    int16_t *number = turns + 3 * n;
    for (int16_t far = 0; far <= FARTHEST; far++) {
        for (int k = 0; k < 6; k++) {
            const int16_t kept = number[k / 2];
            number[k / 2] = (int16_t)(kept + (k % 2 ? far : -far));
            const quat here = quat_mul(turn_of(scale, number), rest[n]);
            const bool flipped = (dot_of(&before, &frames[n - 1]) < 0) != (dot_of(&here, &frames[n]) < 0);
            if (!signbit(dot_of(&before, &here)) == (!signbit(dot) != flipped)) {
                return;
            }
            number[k / 2] = kept;
        }
    }
}

bool guides_turns(const geom_binding *binding, guides_part part, const quat *frames, int16_t *turns)
{
    const quat *rest = binding->rest_frame + (size_t)part.first_wisp * binding->sections;
    const float reach = turn_reach(binding);
    size_t n = 0;
    for (uint32_t w = 0; w < part.wisps; w++) {
        for (uint32_t i = 0; i < binding->sections; i++, n++) {
            if (!put_turn(reach, quat_mul(frames[n], quat_conjugate(rest[n])), turns + 3 * n)) {
                return false;
            }
            if (i > 0) {
                keep_side(binding, rest, frames, turns, n);
            }
        }
    }
    return true;
}

void guides_frames(const geom_binding *binding, guides_part part, const int16_t *turns, quat *frames)
{
    const size_t first = (size_t)part.first_wisp * binding->sections, count = (size_t)part.wisps * binding->sections;
    const float scale = turn_scale(binding);
    for (size_t n = 0; n < count; n++) {
        frames[n] = quat_mul(turn_of(scale, turns + 3 * n), binding->rest_frame[first + n]);
    }
}

/* ---- bound */

uint32_t guides_together(const geom_binding *binding, uint32_t first)
{
    const uint32_t room = GEOM_PATCH_POINTS / binding->sections, left = binding->wisps - first;
    uint32_t count = 1;
    while (count < room && count < left && binding->tree[first + count] == binding->tree[first]) {
        count++;
    }
    return count;
}

enum { NO_NEIGHBOUR = -1 };

/* How many sections before section i of the part's wisp number w its neighbour is; NO_NEIGHBOUR. */
static int32_t neighbour(const geom_binding *binding, guides_part part, uint32_t w, uint32_t i)
{
    const uint32_t *tree = binding->tree + part.first_wisp + w;
    if (w > 0 && tree[0] == tree[-1]) {
        return (int32_t)binding->sections;
    }
    return i > 0 ? 1 : NO_NEIGHBOUR;
}

/* The worth of a turn's number and of a centre's. */
typedef struct bound_scale {
    float turn, step_m;
} bound_scale;

static bound_scale bound_scale_of(const geom_binding *binding)
{
    return (bound_scale){turn_scale(binding), binding->position_step_m};
}

/* Where the section that stands at `rest` at rest is expected, from a neighbour `back` sections before. */
static vec3 predict(bound_scale scale, const vec3 *rest, int32_t back, const vec3 *centre, const int16_t *turn)
{
    if (back == NO_NEIGHBOUR) {
        return *rest;
    }
    const quat t = turn_of(scale.turn, back == 1 ? turn : turn - 3 * back);
    return vec3_add(centre[-back], quat_rotate(t, vec3_sub(*rest, rest[-back])));
}

static int16_t number_of(uint16_t kept)
{
    const int spare_bits = 16 - GUIDES_BITS;
    return (int16_t)((int16_t)(uint16_t)(kept << spare_bits) >> spare_bits);
}

static uint16_t kept_of(int number)
{
    return (uint16_t)((unsigned)number & ((1u << GUIDES_BITS) - 1));
}

static vec3 step_on(bound_scale scale, vec3 from, const uint16_t kept[3])
{
    const vec3 steps = {(float)number_of(kept[0]), (float)number_of(kept[1]), (float)number_of(kept[2])};
    return vec3_mad(from, steps, scale.step_m);
}

/* One coordinate's distance in steps, as far as a number goes. */
static uint16_t steps_to(float way_m, float step_m, bool *too_far)
{
    const float steps = way_m / step_m, most = GUIDES_MOST;
    *too_far = *too_far || !(fabsf(steps) <= most);
    const float low = steps < most ? steps : most; /* not a number: the most */
    return kept_of(nearest(low > -most ? low : -most));
}

/* True: the section is too far from where it is expected. */
static bool bind_section(bound_scale scale, const vec3 *rest, int32_t back, vec3 centre, const int16_t *turn,
                         uint16_t *number, vec3 *rebuilt)
{
    const vec3 from = predict(scale, rest, back, rebuilt, turn), way = vec3_sub(centre, from);
    bool too_far = false;
    number[0] = steps_to(way.x, scale.step_m, &too_far);
    number[1] = steps_to(way.y, scale.step_m, &too_far);
    number[2] = steps_to(way.z, scale.step_m, &too_far);
    for (int k = 0; k < 3; k++) {
        number[3 + k] = kept_of(back == NO_NEIGHBOUR ? turn[k] : turn[k] - turn[k - 3 * back]);
    }
    *rebuilt = step_on(scale, from, number);
    return too_far;
}

uint32_t guides_bind(const geom_binding *binding, guides_part part, const vec3 *centres, const int16_t *turns,
                     uint16_t *numbers, vec3 *rebuilt)
{
    const uint32_t sections = binding->sections;
    const vec3 *rest = binding->rest_centre + (size_t)part.first_wisp * sections;
    const bound_scale scale = bound_scale_of(binding);
    uint32_t clamped = 0;
    size_t n = 0;
    for (uint32_t w = 0; w < part.wisps; w++) {
        for (uint32_t i = 0; i < sections; i++, n++) {
            clamped += bind_section(scale, rest + n, neighbour(binding, part, w, i), centres[n], turns + 3 * n,
                                    numbers + GUIDES_COMPONENTS * n, rebuilt + n);
        }
    }
    return clamped;
}

static void unbind_section(bound_scale scale, const vec3 *rest, int32_t back, const uint16_t *number, int16_t *turn,
                           vec3 *centre)
{
    for (int k = 0; k < 3; k++) {
        turn[k] = (int16_t)(number_of(number[3 + k]) + (back == NO_NEIGHBOUR ? 0 : turn[k - 3 * back]));
    }
    *centre = step_on(scale, predict(scale, rest, back, centre, turn), number);
}

void guides_unbind(const geom_binding *binding, guides_part part, const uint16_t *numbers, int16_t *turns,
                   vec3 *centres)
{
    const uint32_t sections = binding->sections;
    const vec3 *rest = binding->rest_centre + (size_t)part.first_wisp * sections;
    const bound_scale scale = bound_scale_of(binding);
    size_t n = 0;
    for (uint32_t w = 0; w < part.wisps; w++) {
        for (uint32_t i = 0; i < sections; i++, n++) {
            unbind_section(scale, rest + n, neighbour(binding, part, w, i), numbers + GUIDES_COMPONENTS * n,
                           turns + 3 * n, centres + n);
        }
    }
}
