/* style.c: the built-in styles, each in one entry: what it is, how large its hierarchy (the sizes of AWT §5.2 to
 * within 2 %), how it moves and how it looks. */
#include "groom/look.h"

#include <string.h>

typedef struct style_entry {
    awt_style style;
    style_look look;
} style_entry;

/* The defaults of AWT_PARAM_LIST, but for the four that each style has of its own. */
#define SAME_FIELD(a, b) (offsetof(awt_params, a) == offsetof(awt_params, b))
#define STYLE_VALUE(name, value, threshold, omega, springs, slip) \
    .name = SAME_FIELD(name, split_threshold) ? (threshold)       \
            : SAME_FIELD(name, style_omega)   ? (omega)           \
            : SAME_FIELD(name, links)         ? (springs)         \
            : SAME_FIELD(name, obstacle_slip) ? (slip)            \
                                              : (value),
#define SHORT_PARAM(name, value, ...) STYLE_VALUE(name, value, 0.26f, 30.0f, 0.0f, 0.0f)
#define SHORT_CURLY_PARAM(name, value, ...) STYLE_VALUE(name, value, 0.50f, 20.0f, 1.0f, 0.0f)
#define LONG_PARAM(name, value, ...) STYLE_VALUE(name, value, 0.50f, 20.0f, 0.0f, 0.0f)
#define LONG_CURLY_PARAM(name, value, ...) STYLE_VALUE(name, value, 0.50f, 15.0f, 1.0f, 0.9f)

static const style_entry style_table[] = {
    {.style = {.name = "short",
               .description = "short smooth hair around a whorl at the crown",
               .levels = 2,
               .sections = 5,
               .finest_wisps = 1030,
               .top_wisps = 120,
               .points_per_strand = 12,
               .params = {AWT_PARAM_LIST(SHORT_PARAM)}},
     .look = {.length_m = 0.060,
              .edge_length_m = 0.022,
              .lift = 0.6,
              .lift_reach_m = 0.012,
              .comb = 1.0,
              .comb_reach_m = 0.20,
              .fall = 0.55,
              .bend_m = 0.020,
              .layer_m = 0.010,
              .clump = 0.45,
              .length_spread = 0.20,
              .wave_m = 0.0015,
              .wave_length_m = 0.06,
              .flyaway = 0.03}},
    {.style = {.name = "short-curly",
               .description = "short hair in tight ringlets",
               .levels = 2,
               .sections = 6,
               .finest_wisps = 818,
               .top_wisps = 100,
               .points_per_strand = 32,
               .params = {AWT_PARAM_LIST(SHORT_CURLY_PARAM)}},
     .look = {.length_m = 0.070,
              .edge_length_m = 0.040,
              .lift = 1.0,
              .lift_reach_m = 0.030,
              .comb = 0.6,
              .comb_reach_m = 0.10,
              .fall = 0.75,
              .bend_m = 0.030,
              .layer_m = 0.024,
              .clump = 0.80,
              .length_spread = 0.15,
              .wave_m = 0.002,
              .wave_length_m = 0.06,
              .curl_m = 0.006,
              .curl_pitch_m = 0.022,
              .flyaway = 0.03}},
    {.style = {.name = "long",
               .description = "long smooth hair, parted, falling over the shoulders",
               .levels = 3,
               .sections = 12,
               .finest_wisps = 505,
               .top_wisps = 48,
               .points_per_strand = 20,
               .params = {AWT_PARAM_LIST(LONG_PARAM)}},
     .look = {.length_m = 0.48,
              .edge_length_m = 0.38,
              .parting_x = 0.12,
              .parted = true,
              .lift = 0.8,
              .lift_reach_m = 0.012,
              .comb = 1.0,
              .comb_reach_m = 0.10,
              .fall = 1.0,
              .bend_m = 0.025,
              .layer_m = 0.020,
              .clump = 0.45,
              .length_spread = 0.14,
              .wave_m = 0.009,
              .wave_length_m = 0.16,
              .flyaway = 0.025}},
    {.style = {.name = "long-curly",
               .description = "long hair in loose curls, parted",
               .levels = 3,
               .sections = 16,
               .finest_wisps = 616,
               .top_wisps = 56,
               .points_per_strand = 64,
               .params = {AWT_PARAM_LIST(LONG_CURLY_PARAM)}},
     .look = {.length_m = 0.40,
              .edge_length_m = 0.30,
              .parting_x = 0.10,
              .parted = true,
              .lift = 1.0,
              .lift_reach_m = 0.025,
              .comb = 1.0,
              .comb_reach_m = 0.10,
              .fall = 0.9,
              .bend_m = 0.035,
              .layer_m = 0.045,
              .clump = 0.85,
              .length_spread = 0.12,
              .wave_m = 0.006,
              .wave_length_m = 0.15,
              .curl_m = 0.010,
              .curl_pitch_m = 0.052,
              .flyaway = 0.03}},
};

enum { STYLE_COUNT = sizeof style_table / sizeof style_table[0] };

size_t awt_style_count(void)
{
    return STYLE_COUNT;
}

const awt_style *awt_style_at(size_t index)
{
    return &style_table[index].style;
}

static const style_entry *find_entry(const char *name)
{
    for (size_t i = 0; i < STYLE_COUNT; i++) {
        if (strcmp(style_table[i].style.name, name) == 0) {
            return &style_table[i];
        }
    }
    return NULL;
}

const awt_style *awt_style_find(const char *name)
{
    const style_entry *entry = find_entry(name);
    return entry ? &entry->style : NULL;
}

const style_look *style_look_find(const char *name)
{
    const style_entry *entry = find_entry(name);
    return entry ? &entry->look : NULL;
}
