/* measure.c: see measure.h. */
#include "geom/measure.h"

#include <math.h>

/* Full width of a ribbon at its middle, for AWT_DEFAULT_STRANDS strands on a head of AWT_HEAD_RADIUS_M: a ribbon
 * stands for the dozen hairs that a real head has for each of ours. Fewer strands are wider, so that the hair covers
 * the same part of the head, though no wider than a lock. */
#define WIDTH_M 0.0016f
#define WIDTH_GREATEST_M 0.005f
/* Draco's stock encoder takes origin and range as text of six decimals; multiples of 1/64 pass through unchanged. */
#define BOX_GRID 64.0f

/* Share of the middle width at t in [0, 1] from root to tip. */
static float width_profile(float t)
{
    if (t < 0.15f) {
        return 0.7f + 2.0f * t;
    }
    if (t < 0.5f) {
        return 1.0f;
    }
    float u = (t - 0.5f) * 2.0f;
    return 1.0f - 0.9f * u * u;
}

float measure_middle(const awt_groom_info *info, float growth)
{
    float head = (float)(info->head_radius_m / AWT_HEAD_RADIUS_M);
    float density = sqrtf((float)AWT_DEFAULT_STRANDS / (float)info->strand_count);
    float width = WIDTH_M * head * density;
    float greatest = WIDTH_GREATEST_M * head;
    return 0.5f * growth * (width < greatest ? width : greatest);
}

draco_box measure_box(const awt_groom_info *info, float half_width, int bits)
{
    draco_box box = {.bits = bits};
    float widest = 0;
    for (int k = 0; k < 3; k++) {
        float extent = info->box_max[k] - info->box_min[k];
        widest = extent > widest ? extent : widest;
    }
    float margin =
        half_width + (widest + 2 * half_width + 1.0f / BOX_GRID) * (MEASURE_LEAST_STEPS / (float)(1 << bits));
    for (int k = 0; k < 3; k++) {
        box.origin[k] = floorf((info->box_min[k] - margin) * BOX_GRID) / BOX_GRID;
        float extent = ceilf((info->box_max[k] + margin - box.origin[k]) * BOX_GRID) / BOX_GRID;
        box.range = extent > box.range ? extent : box.range;
    }
    return box;
}

void measure_half_widths(const awt_groom_info *info, float growth, float least, float *half_width)
{
    const float middle = measure_middle(info, growth);
    for (uint32_t i = 0; i < info->points_per_strand; i++) {
        float half = middle * width_profile((float)i / (float)(info->points_per_strand - 1));
        half_width[i] = half > least ? half : least;
    }
}
