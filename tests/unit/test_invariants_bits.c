/* test_invariants_bits.c: invariant 11's other half: one bit of an input changes the state, so that equal hashes mean
 * equal inputs; and no parameter is without effect. */
#include "check.h"
#include "groom_fixture.h"
#include "invariant_fixture.h"

#include "base/assert.h"

#include <math.h>
#include <string.h>

/* 0.8 s of motion and `rest_us` of rest. */
static uint64_t hash_after(const awt_groom *groom, const awt_params *params, int64_t rest_us)
{
    awt_forest *f = small_forest(groom, params);
    wild w = wild_make(63, 1.5);
    for (int n = 1; n <= 80; n++) {
        wild_advance(f, &w, (int64_t)n * AWT_STEP_US, NULL);
    }
    ASSERT(awt_forest_advance(f, 80 * AWT_STEP_US + rest_us, NULL, NULL) == AWT_OK);
    uint64_t hash = awt_forest_hash(f);
    awt_forest_destroy(f);
    return hash;
}

static awt_params busy_params(bool springs)
{
    awt_params params = awt_params_default();
    params.links = springs ? 1.0f : 0.0f;
    params.contact = 1;
    params.contact_angle = 20;
    params.split_threshold = 0.05f;
    params.wind_x = 1, params.wind_y = 1, params.wind_z = 1;
    return params;
}

/* ---- poses ---------------------------------------------------------------------------------------------------- */

static void move_head(awt_motion *m)
{
    m->head.position[1] = nextafter(m->head.position[1], 1);
}

static void turn_head(awt_motion *m)
{
    m->head.orientation[2] = nextafter(m->head.orientation[2], 1);
}

static void move_body(awt_motion *m)
{
    m->body.position[0] = nextafter(m->body.position[0], 1);
}

static void turn_body(awt_motion *m)
{
    m->body.orientation[0] = nextafter(m->body.orientation[0], 1);
}

static void delay(awt_motion *m)
{
    m->time_us++;
}

static void teleport(awt_motion *m)
{
    m->teleport = true;
}

TEST(one_bit_of_any_pose_changes_what_comes_of_it_at_once)
{
    static void (*const changes[])(awt_motion *) = {move_head, turn_head, move_body, turn_body, delay, teleport};
    awt_groom *groom = groom_fixture_build_patch(60, 3, 3, 12);
    const awt_params params = busy_params(false);
    for (size_t k = 0; k < sizeof changes / sizeof changes[0]; k++) {
        uint64_t hash[2];
        for (int changed = 0; changed < 2; changed++) {
            awt_forest *f = small_forest(groom, &params);
            wild w = wild_make(63, 1.5);
            awt_motion m = wild_at(&w, AWT_STEP_US);
            if (changed) {
                changes[k](&m);
            }
            ASSERT(awt_forest_move(f, &m, NULL) == AWT_OK);
            ASSERT(awt_forest_advance(f, AWT_STEP_US, NULL, NULL) == AWT_OK);
            hash[changed] = awt_forest_hash(f);
            awt_forest_destroy(f);
        }
        CHECK(hash[0] != hash[1]);
    }
    awt_groom_destroy(groom);
}

/* ---- parameters ------------------------------------------------------------------------------------------------- */

enum { RIGID = 1, SPRINGS = 2, BOTH = 3 };

/* A thousandth more where the parameter acts on every step; another value where it is a threshold. */
typedef struct param_change {
    const char *name;
    float value; /* 0: a thousandth more */
    int links;
} param_change;

TEST(every_parameter_has_its_effect)
{
    static const param_change changes[] = {
        {"split_threshold", 0.1f, BOTH},
        {"split_hysteresis", 0.1f, BOTH},
        {"split_contact", 1, BOTH},
        {"split_wind", 1, BOTH},
        {"merge_velocity", 0.01f, BOTH},

        {"residence", 0.02f, BOTH},
        {"split_budget", 1, BOTH},
        {"acceleration_tau", 0, BOTH},
        {"offset_relaxation", 0, BOTH},
        {"length_relaxation", 0, BOTH},
        {"style_omega", 0, BOTH},
        {"style_damping", 0, BOTH},
        {"rest_gravity", 0.999f, BOTH},
        {"drag", 0, BOTH},
        {"gravity_x", 1e-6f, BOTH},
        {"gravity_y", 0, BOTH},
        {"gravity_z", 1e-6f, BOTH},
        {"wind_x", 0, BOTH},
        {"wind_y", 0, BOTH},
        {"wind_z", 0, BOTH},
        {"wind_gust", 0.3f, BOTH},
        {"speed_limit", 0.3f, BOTH},
        {"settling", 3.0f, BOTH},
        {"links", 1, RIGID},
        {"link_omega", 0, SPRINGS},
        {"link_damping", 0, SPRINGS},
        {"strain_limit", 0.001f, SPRINGS},
        {"link_iterations", 1, RIGID},
        {"contact", 0.1f, BOTH},
        {"friction_alpha", 0, BOTH},
        {"repulsion_omega", 0, BOTH},
        {"contact_angle", 60.0f, BOTH},
        {"relative_motion", 0.1f, BOTH},
        {"obstacle_slip", 0.5f, BOTH},
    };
    awt_groom *groom = groom_fixture_build_patch(60, 3, 3, 12);
    for (int springs = 0; springs < 2; springs++) {
        const awt_params params = busy_params(springs);
        for (size_t k = 0; k < sizeof changes / sizeof changes[0]; k++) {
            const param_change *c = &changes[k];
            if (!(c->links & (springs ? SPRINGS : RIGID))) {
                continue;
            }
            awt_params changed = params;
            float value = c->value, old = 0;
            for (size_t n = 0; n < awt_param_count(); n++) { /* struct awt_params follows the list */
                if (strcmp(awt_param_at(n)->name, c->name) == 0) {
                    memcpy(&old, (const char *)&params + n * sizeof old, sizeof old);
                }
            }
            value = value != 0 ? value : 1.001f * old;
            CHECK_INT(awt_params_set(&changed, c->name, value, NULL), AWT_OK);
            int64_t rest_us = strcmp(c->name, "settling") == 0 ? 2500000 : 600000; /* it begins after 2 s */
            bool differs = hash_after(groom, &changed, rest_us) != hash_after(groom, &params, rest_us);
            CHECK_TEXT(differs ? c->name : "no effect", c->name);
        }
    }
    awt_groom_destroy(groom);
}

/* Of hair that spreads wide: the patch above never leaves its rest radius. */
TEST(merge_slack_has_its_effect)
{
    awt_groom *groom = small_groom("long", 2);
    awt_params params = small_params("long"), changed;
    params.split_threshold = 0.1f;
    changed = params;
    changed.merge_slack = 1.0f;
    CHECK(hash_after(groom, &changed, 600000) != hash_after(groom, &params, 600000));
    awt_groom_destroy(groom);
}
