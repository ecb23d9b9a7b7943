/* awtwrite.c: see awtwrite.h. */
#include "awtwrite.h"

#include <math.h>
#include <string.h>

size_t awtwrite_point_size(awtwrite_format format)
{
    return format == AWTWRITE_F32 ? 3 * sizeof(float) : 3 * sizeof(uint16_t);
}

/* To the nearest half, ties to even; what is too large becomes infinite. */
static uint16_t half_of(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    const uint16_t sign = (uint16_t)(bits >> 16 & 0x8000);
    const uint32_t magnitude = bits & 0x7FFFFFFF;
    if (magnitude >= 0x7F800000) {
        return (uint16_t)(sign | (magnitude > 0x7F800000 ? 0x7E00 : 0x7C00));
    }
    if (magnitude >= 0x477FF000) { /* rounds to 65536 */
        return (uint16_t)(sign | 0x7C00);
    }
    if (magnitude < 0x38800000) { /* below 2^-14: steps of 2^-24, which rintf counts */
        return (uint16_t)(sign | (uint16_t)rintf(fabsf(value) * 0x1p24f));
    }
    const uint32_t rounded = magnitude + 0xFFF + (magnitude >> 13 & 1) - 0x38000000;
    return (uint16_t)(sign | (uint16_t)(rounded >> 13));
}

static uint16_t unorm_of(float value, float origin, float size)
{
    const float share = (value - origin) / size;
    return share <= 0 ? 0 : share >= 1 ? 65535 : (uint16_t)(share * 65535.0f + 0.5f);
}

static void write_point(const awtwrite_target *target, unsigned char *place, const float point[3])
{
    uint16_t small[3];
    switch (target->format) {
    case AWTWRITE_F32:
        memcpy(place, point, 3 * sizeof(float));
        return;
    case AWTWRITE_F16:
        for (int i = 0; i < 3; i++) {
            small[i] = half_of(point[i]);
        }
        break;
    case AWTWRITE_UNORM16:
        for (int i = 0; i < 3; i++) {
            small[i] = unorm_of(point[i], target->box_origin[i], target->box_size[i]);
        }
        break;
    }
    memcpy(place, small, sizeof small);
}

static bool target_good(const awtwrite_target *target, size_t stride, size_t count)
{
    const size_t point = awtwrite_point_size(target->format);
    if (target->format == AWTWRITE_UNORM16 &&
        !(target->box_size[0] > 0 && target->box_size[1] > 0 && target->box_size[2] > 0)) {
        return false;
    }
    return stride >= point && (count == 0 || (target->size >= point && (target->size - point) / stride >= count - 1));
}

bool awtwrite_points(const awtwrite_target *target, const float *points, size_t count)
{
    const size_t stride = target->stride > 0 ? target->stride : awtwrite_point_size(target->format);
    if (!target_good(target, stride, count)) {
        return false;
    }
    unsigned char *place = target->memory;
    for (size_t p = 0; p < count; p++) {
        float point[3];
        awtspace_points_to(target->space, points + 3 * p, point, 1);
        write_point(target, place + p * stride, point);
    }
    return true;
}

bool awtwrite_offsets(const awtframes_shown *shown, uint32_t *offsets, size_t capacity)
{
    if (capacity <= shown->strand_count) {
        return false;
    }
    for (uint32_t s = 0; s <= shown->strand_count; s++) {
        offsets[s] = s * shown->points_per_strand;
    }
    return true;
}

bool awtwrite_widths(const awtframes_shown *shown, awtspace space, float *widths, size_t capacity)
{
    const size_t points = shown->points_per_strand, count = (size_t)shown->strand_count * points;
    if (capacity < count) {
        return false;
    }
    for (size_t p = 0; p < count; p++) {
        widths[p] = shown->widths[p % points] * awtspace_units(space);
    }
    return true;
}

void awtwrite_bounds(const awtframes_shown *shown, awtspace space, float least[3], float greatest[3])
{
    float a[3], b[3];
    awtspace_points_to(space, shown->least, a, 1);
    awtspace_points_to(space, shown->greatest, b, 1);
    for (int i = 0; i < 3; i++) {
        least[i] = a[i] < b[i] ? a[i] : b[i];
        greatest[i] = a[i] < b[i] ? b[i] : a[i];
    }
}
