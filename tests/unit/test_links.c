/* test_links.c: both link models against what can be computed by hand: pendulums, and springs that carry weight. */
#include "check.h"

#include "base/trig.h"
#include "sim/state.h"

#include <math.h>
#include <stdlib.h>

#define G 9.81
#define LINK_M 0.2

/* One strand from the head's surface through links that hang at the given angles from the vertical. */
static awt_groom *chain_groom(uint32_t links, const double *angles)
{
    float positions[3 * 9];
    uint32_t first_point[2] = {0, links + 1};
    double x = 0, y = -0.1;
    for (uint32_t i = 0; i <= links; i++) {
        positions[3 * i] = (float)x, positions[3 * i + 1] = (float)y, positions[3 * i + 2] = 0;
        double s, c;
        trig_sin_cos(i < links ? angles[i] : 0, &s, &c);
        x += LINK_M * s;
        y -= LINK_M * c;
    }
    awt_strands strands = {
        .strand_count = 1, .point_count = links + 1, .first_point = first_point, .positions = positions};
    awt_groom_def def = awt_groom_def_default();
    def.levels = 1;
    def.sections = links + 1;
    awt_groom *groom = NULL;
    CHECK_INT(awt_groom_build(&strands, &def, NULL, NULL, &groom, NULL), AWT_OK);
    return groom;
}

/* A forest on it that only links and gravity move. */
static awt_forest *chain_forest(const awt_groom *groom, bool springs)
{
    awt_forest_def def = awt_forest_def_default(groom);
    def.collider_count = 0;
    def.params.style_omega = 0;
    def.params.rest_gravity = 0;
    def.params.drag = 0;
    def.params.settling = 0;
    def.params.links = springs ? 1 : 0;
    awt_forest *f = NULL;
    CHECK_INT(awt_forest_create(groom, &def, &f, NULL), AWT_OK);
    return f;
}

/* Mean period and the last amplitude of node 1's swing, over `periods`. */
static double measured_period(awt_forest *f, int periods, double *amplitude)
{
    double first = 0, last = 0, before = (double)f->position[1].x;
    int crossings = 0;
    *amplitude = 0;
    for (int n = 1; n < 4000 && crossings <= periods; n++) {
        awt_forest_advance(f, (int64_t)n * AWT_STEP_US, NULL, NULL);
        double x = (double)f->position[1].x;
        if (before < 0 && x >= 0) { /* upwards through the middle */
            double at = (double)n * 0.01 - 0.01 * x / (x - before);
            first = crossings == 0 ? at : first;
            last = at;
            crossings++;
            if (crossings <= periods) {
                *amplitude = 0;
            }
        }
        *amplitude = fabs(x) > *amplitude ? fabs(x) : *amplitude;
        before = x;
    }
    CHECK_INT(crossings, periods + 1);
    return (last - first) / periods;
}

static void check_pendulum(uint32_t links, const double *angles, double omega2)
{
    awt_groom *groom = chain_groom(links, angles);
    awt_forest *f = chain_forest(groom, false);
    double start = fabs((double)f->position[1].x), amplitude;
    double period = measured_period(f, 5, &amplitude), expected = 2 * TRIG_PI / sqrt(omega2);
    CHECK_NEAR(period / expected, 1.0, 0.01);
    CHECK(amplitude > 0.8 * start && amplitude < 1.02 * start);
    awt_forest_destroy(f);
    awt_groom_destroy(groom);
}

TEST(a_pendulum_of_one_rigid_link_has_its_period)
{
    const double angles[] = {0.05};
    check_pendulum(1, angles, G / LINK_M);
}

TEST(a_pendulum_of_two_rigid_links_has_the_period_of_its_slow_mode)
{
    const double angles[] = {0.04, 0.04 * 1.41421356};
    check_pendulum(2, angles, (2 - sqrt(2.0)) * G / LINK_M);
}

TEST(a_spring_link_stretches_by_the_weight_it_carries)
{
    const double angles[] = {0, 0, 0};
    awt_groom *groom = chain_groom(3, angles);
    awt_forest *f = chain_forest(groom, true);
    f->params.link_omega = 60;
    f->params.length_relaxation = 10;
    CHECK_INT(awt_forest_advance(f, 5000000, NULL, NULL), AWT_OK);
    for (uint32_t i = 1; i <= 3; i++) { /* its stiffness is that of the mass that hangs on it, so all stretch alike */
        double stretch = (double)(vec3_distance(f->position[i], f->position[i - 1]) - f->link_length[i]);
        CHECK_NEAR(stretch / (G / (60.0 * 60.0)), 1.0, 0.01);
    }
    awt_forest_destroy(f);
    awt_groom_destroy(groom);
}

TEST(a_spring_link_never_stretches_beyond_its_strain_limit)
{
    const double angles[] = {0, 0, 0};
    awt_groom *groom = chain_groom(3, angles);
    awt_forest *f = chain_forest(groom, true);
    f->params.link_omega = 5; /* far too soft for its weight */
    f->params.strain_limit = 0.1f;
    double longest = 0;
    for (int n = 1; n <= 300; n++) {
        awt_motion m = {.time_us = (int64_t)n * AWT_STEP_US};
        m.head.orientation[3] = m.body.orientation[3] = 1;
        double s, c;
        trig_sin_cos(0.05 * n, &s, &c);
        m.head.position[1] = 0.5 * s;
        awt_forest_move(f, &m, NULL);
        awt_forest_advance(f, m.time_us, NULL, NULL);
        for (uint32_t i = 1; i <= 3; i++) {
            double share = (double)(vec3_distance(f->position[i], f->position[i - 1]) / f->link_length[i]);
            longest = share > longest ? share : longest;
        }
    }
    CHECK(longest > 1.09);
    CHECK(longest <= 1.1 + 1e-4);
    awt_forest_destroy(f);
    awt_groom_destroy(groom);
}
