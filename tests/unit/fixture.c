/* fixture.c: see fixture.h. */
#include "fixture.h"

#include "base/assert.h"
#include "base/trig.h"
#include "sim/state.h"

#include <string.h>

enum { FIXTURE_KEPT = 64 };

const awt_groom *fixture_groom(const char *style_name, uint32_t strands)
{
    static struct {
        const char *style;
        uint32_t strands;
        awt_groom *groom;
    } kept[FIXTURE_KEPT];
    size_t k = 0;
    while (k < FIXTURE_KEPT && kept[k].groom &&
           (strcmp(kept[k].style, style_name) != 0 || kept[k].strands != strands)) {
        k++;
    }
    ASSERT(k < FIXTURE_KEPT);
    if (!kept[k].groom) {
        const awt_style *style = awt_style_find(style_name);
        ASSERT(style);
        awt_groom_def def = awt_groom_def_of_style(style);
        awt_strands grown;
        ASSERT(awt_style_grow(style, strands, 1, &grown, NULL) == AWT_OK);
        ASSERT(awt_groom_build(&grown, &def, NULL, NULL, &kept[k].groom, NULL) == AWT_OK);
        awt_strands_fini(&grown);
        kept[k].style = style->name;
        kept[k].strands = strands;
    }
    return kept[k].groom;
}

awt_forest *fixture_forest(const awt_groom *groom, const char *style, const double at[3], const double velocity[3])
{
    awt_forest_def def = awt_forest_def_default(groom);
    def.params = awt_style_find(style)->params;
    for (int axis = 0; axis < 3; axis++) {
        def.start.head.position[axis] = def.start.body.position[axis] = at[axis];
    }
    awt_forest *forest;
    ASSERT(awt_forest_create(groom, &def, &forest, NULL) == AWT_OK);
    dvec3 under_way = {velocity[0], velocity[1], velocity[2]};
    forest->frame_velocity = under_way;
    forest->track.last.pose[TRACK_HEAD].velocity = forest->track.last.pose[TRACK_BODY].velocity = under_way;
    return forest;
}

const motion *fixture_clip(const char *name)
{
    static struct {
        const char *name;
        motion clip;
    } kept[FIXTURE_KEPT];
    size_t k = 0;
    while (k < FIXTURE_KEPT && kept[k].name && strcmp(kept[k].name, name) != 0) {
        k++;
    }
    ASSERT(k < FIXTURE_KEPT);
    if (!kept[k].name) {
        ASSERT(motion_builtin(name, &kept[k].clip));
        kept[k].name = name;
    }
    return &kept[k].clip;
}

awt_motion fixture_motion(const motion *clip, int64_t time_us, const double at[3], const double velocity[3])
{
    motion_sample sample = motion_at(clip, time_us);
    motion_sample start = motion_at(clip, 0);
    awt_motion result = {.time_us = time_us, .head = sample.head, .body = sample.body};
    for (int axis = 0; axis < 3; axis++) {
        double shift = at[axis] - start.head.position[axis] + velocity[axis] * (double)time_us * 1e-6;
        result.head.position[axis] += shift;
        result.body.position[axis] += shift;
    }
    return result;
}

void fixture_advance(awt_forest *forest, const motion *clip, int64_t time_us, const double at[3],
                     const double velocity[3], awt_step_stats *stats)
{
    awt_motion pose = fixture_motion(clip, time_us, at, velocity);
    ASSERT(awt_forest_move(forest, &pose, NULL) == AWT_OK);
    ASSERT(awt_forest_advance(forest, time_us, stats, NULL) == AWT_OK);
}

awt_motion fixture_bow(int64_t time_us)
{
    double t = (double)time_us * 1e-6, sine, cosine, turn_sine, turn_cosine;
    trig_sin_cos(5.0 * t, &sine, &cosine);
    trig_sin_cos(0.5 * sine, &turn_sine, &turn_cosine);
    awt_motion m = {.time_us = time_us};
    m.head.position[2] = m.body.position[2] = 0.3 * sine;
    m.head.position[1] = m.body.position[1] = 0.1 * (cosine - 1.0);
    m.head.orientation[0] = m.body.orientation[0] = turn_sine;
    m.head.orientation[3] = m.body.orientation[3] = turn_cosine;
    return m;
}
