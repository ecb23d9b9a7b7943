/* What an obstacle does to the velocity of hair on it (AWT §4.3, and params.obstacle_slip). */
#include "check.h"
#include "fixture.h"

#include "sim/obstacle.h"
#include "sim/state.h"

static const double zero[3] = {0, 0, 0};

/* A still sphere lies against the second node of the first tree, which comes along its side. The velocity that the
 * node has after it, against the surface's normal there and as it is. */
static vec3 velocity_on_sphere(float slip, float *into)
{
    awt_forest *f = fixture_forest(fixture_groom("long", 1000), "long", zero, zero);
    const tree *t = &f->trees[0];
    const uint32_t k = t->first + 1, node = f->active_node[k];
    f->params.obstacle_slip = slip;
    for (uint32_t n = t->first; n < t->first + t->count; n++) {
        f->next[n] = f->position[f->active_node[n]];
        f->tangent[n] = (vec3){0, -1, 0};
    }
    vec3 link = vec3_sub(f->next[k], f->next[t->first]), side = vec3_unit(vec3_orthogonal(link), link);
    vec3 along = vec3_unit(vec3_cross(link, side), side), centre = vec3_mad(f->next[k], side, -0.010f);
    f->collider_count = 1;
    f->obstacles[0] =
        (obstacle){.a = centre, .b = centre, .middle = centre, .radius_a = 0.012f, .radius_b = 0.012f, .reach = 0.013f};
    f->next[k] = vec3_mad(f->next[k], along, 0.002f);
    obstacle_settle(f, t, 0.01f);
    CHECK(f->touching[k]);
    vec3 velocity = f->velocity[node];
    *into = vec3_dot(velocity, vec3_unit(vec3_sub(f->next[k], centre), side));
    awt_forest_destroy(f);
    return velocity;
}

TEST(hair_on_an_obstacle_takes_its_velocity_or_slips_along_it)
{
    float into;
    CHECK_NEAR(vec3_length(velocity_on_sphere(0.0f, &into)), 0, 1e-9);
    float whole = vec3_length(velocity_on_sphere(1.0f, &into));
    CHECK(whole > 0.1f);
    CHECK_NEAR(into, 0, 1e-5 * (double)whole);
    CHECK_NEAR(vec3_length(velocity_on_sphere(0.5f, &into)), 0.5 * (double)whole, 1e-5);
}
