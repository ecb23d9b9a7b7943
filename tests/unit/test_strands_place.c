/* test_strands_place.c: from a file's units and axes into the head frame, given and guessed. */
#include "check.h"

#include "awt.h"
#include "base/rng.h"
#include "base/vec.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { HEAD_STRANDS = 600, HEAD_POINTS = 8 };

static awt_strands strands_make(uint32_t strands, uint32_t points)
{
    awt_strands made = {.strand_count = strands, .point_count = strands * points};
    made.first_point = calloc((size_t)strands + 1, sizeof *made.first_point);
    made.positions = calloc((size_t)strands * points * 3, sizeof *made.positions);
    for (uint32_t s = 0; made.first_point && s <= strands; s++) {
        made.first_point[s] = s * points;
    }
    return made;
}

static void strand_set(awt_strands *strands, uint32_t strand, uint32_t point, dvec3 p)
{
    float *at = strands->positions + 3 * (size_t)(strands->first_point[strand] + point);
    at[0] = (float)p.x, at[1] = (float)p.y, at[2] = (float)p.z;
}

static dvec3 strand_get(const awt_strands *strands, uint32_t strand, uint32_t point)
{
    const float *at = strands->positions + 3 * (size_t)(strands->first_point[strand] + point);
    return (dvec3){at[0], at[1], at[2]};
}

/* Hair grows above and behind the line from the forehead (y 0.5, z 1) to the nape (y -0.5, z -1) of a unit head. */
static bool scalp_has(dvec3 d)
{
    return d.y > (d.z > 0 ? 0.5 * d.z : 0.5 * d.z - 0.1);
}

static dvec3 scalp_direction(rng *random)
{
    for (;;) {
        dvec3 d = {rng_between(random, -1, 1), rng_between(random, -1, 1), rng_between(random, -1, 1)};
        double length = dvec3_length(d);
        if (length > 0.1 && length < 1) {
            d = dvec3_scale(d, 1 / length);
            if (scalp_has(d)) {
                return d;
            }
        }
    }
}

/* A unit head, face to +Z, of hair two radii long that stands out and falls, with bumps of 3 %. */
static awt_strands head_make(void)
{
    awt_strands made = strands_make(HEAD_STRANDS, HEAD_POINTS);
    rng random = rng_seed(7);
    for (uint32_t s = 0; s < HEAD_STRANDS; s++) {
        dvec3 d = scalp_direction(&random);
        double bump = rng_between(&random, 0.97, 1.03);
        for (uint32_t i = 0; i < HEAD_POINTS; i++) {
            double t = (double)i / (HEAD_POINTS - 1);
            dvec3 p = dvec3_scale(d, bump + 0.5 * t);
            p.y -= 2.0 * t * t;
            strand_set(&made, s, i, p);
        }
    }
    return made;
}

/* The head as some file draws it: turned about its up axis, Z up or Y up, in file units, somewhere. */
static awt_strands head_in_file(double radius, bool z_up, int quarter_turns, dvec3 centre)
{
    awt_strands made = head_make();
    for (uint32_t s = 0; s < HEAD_STRANDS; s++) {
        for (uint32_t i = 0; i < HEAD_POINTS; i++) {
            dvec3 p = dvec3_scale(strand_get(&made, s, i), radius);
            for (int turn = 0; turn < quarter_turns; turn++) {
                p = (dvec3){p.z, p.y, -p.x};
            }
            p = z_up ? (dvec3){p.x, -p.z, p.y} : p;
            strand_set(&made, s, i, dvec3_add(p, centre));
        }
    }
    return made;
}

/* Do the strands stand as head_make made them, on a head of this radius? */
static void check_stands(const awt_strands *placed, double radius_m)
{
    awt_strands expected = head_make();
    double worst = 0;
    for (uint32_t s = 0; s < HEAD_STRANDS; s++) {
        for (uint32_t i = 0; i < HEAD_POINTS; i++) {
            dvec3 off = dvec3_sub(strand_get(placed, s, i), dvec3_scale(strand_get(&expected, s, i), radius_m));
            worst = fmax(worst, dvec3_length(off));
        }
    }
    CHECK_NEAR(worst, 0, 0.04 * radius_m);
    awt_strands_fini(&expected);
}

TEST(strands_place_guesses_every_unit)
{
    static const struct {
        double radius, scale;
    } units[] = {{0.09, 1}, {9.5, 0.01}, {95, 0.001}, {3.75, 0.0254}, {20, 0.095 / 20}, {0.5, 0.095 / 0.5}};
    for (size_t i = 0; i < sizeof units / sizeof units[0]; i++) {
        double radius = units[i].radius;
        awt_strands strands = head_in_file(radius, false, 0, (dvec3){0, 16 * radius, radius});
        awt_placement placement = {0};
        CHECK_INT(awt_strands_place(&strands, &placement, NULL), AWT_OK);
        CHECK(placement.guessed_scale && placement.guessed_up && placement.guessed_head);
        CHECK_NEAR(placement.scale, units[i].scale, 0.03 * units[i].scale);
        CHECK_INT(placement.up, AWT_UP_Y);
        CHECK_NEAR(placement.head_radius, radius, 0.03 * radius);
        CHECK_NEAR(placement.head_centre[1], 16 * radius, 0.03 * radius);
        CHECK_NEAR(placement.head_radius_m, radius * placement.scale, 0.01);
        check_stands(&strands, radius * placement.scale);
        awt_strands_fini(&strands);
    }
}

TEST(strands_place_guesses_up_and_face)
{
    static const double degrees[] = {0, -90, 180, 90};
    for (int z_up = 0; z_up <= 1; z_up++) {
        for (int turns = 0; turns < 4; turns++) {
            awt_strands strands = head_in_file(0.1, z_up, turns, (dvec3){0.3, -0.2, 1.5});
            awt_placement placement = {0};
            CHECK_INT(awt_strands_place(&strands, &placement, NULL), AWT_OK);
            CHECK_INT(placement.up, z_up ? AWT_UP_Z : AWT_UP_Y);
            CHECK_NEAR(placement.turned_degrees, degrees[turns], 0);
            check_stands(&strands, 0.1);
            awt_strands_fini(&strands);
        }
    }
}

TEST(strands_place_takes_what_is_given)
{
    awt_strands strands = head_in_file(0.1, true, 1, (dvec3){1, 2, 3});
    dvec3 before = strand_get(&strands, 17, 3);
    awt_placement placement = {.scale = 2, .up = AWT_UP_Z, .head_centre = {1.01, 2, 3}, .head_radius = 0.11};
    CHECK_INT(awt_strands_place(&strands, &placement, NULL), AWT_OK);
    CHECK(!placement.guessed_scale && !placement.guessed_up && !placement.guessed_head);
    CHECK_NEAR(placement.head_radius_m, 0.22, 1e-12);
    CHECK_NEAR(placement.turned_degrees, 0, 0); /* though the face looks along X */
    dvec3 after = strand_get(&strands, 17, 3);
    CHECK_NEAR(after.x, 2 * (before.x - 1.01), 1e-6);
    CHECK_NEAR(after.y, 2 * (before.z - 3), 1e-6);
    CHECK_NEAR(after.z, -2 * (before.y - 2), 1e-6);
    awt_strands_fini(&strands);
}

TEST(strands_place_on_a_head_of_many_strands_and_of_few)
{
    awt_strands strands = head_in_file(0.1, false, 0, (dvec3){0, 0, 0});
    strands.strand_count = 49; /* the rest stays allocated */
    strands.point_count = 49 * HEAD_POINTS;
    awt_placement placement = {0};
    awt_error error;
    CHECK_INT(awt_strands_place(&strands, &placement, &error), AWT_NO_HEAD);
    strands.strand_count = 120;
    strands.point_count = 120 * HEAD_POINTS;
    CHECK_INT(awt_strands_place(&strands, &placement, &error), AWT_OK);
    CHECK_NEAR(placement.head_radius, 0.1, 0.005);
    awt_strands_fini(&strands);
}

TEST(strands_place_lets_stray_roots_aside)
{
    awt_strands strands = head_in_file(0.1, false, 0, (dvec3){0, 0, 0});
    for (uint32_t i = 0; i < HEAD_STRANDS; i += 60) {
        strand_set(&strands, i, 0, dvec3_scale(strand_get(&strands, i, 0), 1.8));
    }
    awt_placement placement = {0};
    CHECK_INT(awt_strands_place(&strands, &placement, NULL), AWT_OK);
    CHECK_NEAR(placement.head_radius, 0.1, 0.0005);
    awt_strands_fini(&strands);
}

/* Roots in a disc, hair falling from it. */
static awt_strands tail_make(double thickness)
{
    awt_strands made = strands_make(HEAD_STRANDS, HEAD_POINTS);
    rng random = rng_seed(3);
    for (uint32_t s = 0; s < HEAD_STRANDS; s++) {
        dvec3 root = {rng_between(&random, -3, 3), rng_between(&random, 76, 82), 45 + thickness * rng_unit(&random)};
        for (uint32_t i = 0; i < HEAD_POINTS; i++) {
            strand_set(&made, s, i, dvec3_add(root, (dvec3){0, -5.0 * i, i ? 4 : 0}));
        }
    }
    return made;
}

TEST(strands_place_refuses_a_ponytail_without_a_head)
{
    for (double thickness = 0; thickness < 0.5; thickness += 0.2) {
        awt_strands strands = tail_make(thickness);
        dvec3 before = strand_get(&strands, 5, 5);
        awt_placement placement = {0};
        awt_error error = {AWT_OK, ""};
        CHECK_INT(awt_strands_place(&strands, &placement, &error), AWT_NO_HEAD);
        CHECK(strstr(error.text, "--head x,y,z,r") != NULL);
        CHECK_NEAR(strand_get(&strands, 5, 5).y, before.y, 0);
        CHECK_NEAR(placement.scale, 0, 0);

        placement = (awt_placement){.head_centre = {0, 86, 12}, .head_radius = 34};
        CHECK_INT(awt_strands_place(&strands, &placement, NULL), AWT_OK);
        CHECK_INT(placement.up, AWT_UP_Y);
        CHECK_NEAR(placement.head_radius_m, AWT_HEAD_RADIUS_M, 1e-9);
        CHECK(!placement.guessed_head && placement.guessed_scale && placement.guessed_up);
        awt_strands_fini(&strands);
    }
}

TEST(strands_place_refuses_values_that_are_none)
{
    static const struct {
        awt_placement placement;
        const char *about;
    } bad[] = {
        {{.scale = NAN}, "scale"},
        {{.scale = -1}, "scale"},
        {{.scale = 1e-7}, "scale"},
        {{.scale = 1e7}, "scale"},
        {{.head_radius = -0.1}, "radius of -0.1"},
        {{.head_radius = NAN}, "radius"},
        {{.head_radius = INFINITY}, "radius"},
        {{.head_radius = 0.1, .head_centre = {0, NAN, 0}}, "is not finite"},
        {{.head_radius = 0.1, .head_centre = {0, 0, INFINITY}}, "is not finite"},
        {{.head_radius = 0.1, .head_centre = {1e300, 0, 0}, .scale = 1}, "from the head's centre"},
        {{.head_radius = 1e300}, "no unit of length"},
        {{.head_radius = 1e-300}, "no unit of length"},
        {{.head_radius = 101, .scale = 1}, "radius is 101 m"},
        {{.head_radius = 0.001, .scale = 5e4, .up = AWT_UP_Y}, "from the head's centre"},
        {{.up = (awt_up_axis)3}, "up axis"},
    };
    awt_strands strands = head_in_file(0.1, false, 0, (dvec3){0, 0, 0});
    dvec3 before = strand_get(&strands, 5, 5);
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        awt_placement placement = bad[i].placement;
        awt_error error = {AWT_OK, ""};
        CHECK_INT(awt_strands_place(&strands, &placement, &error), AWT_BAD_VALUE);
        CHECK_INT(error.status, AWT_BAD_VALUE);
        CHECK(strstr(error.text, bad[i].about) != NULL);
        CHECK_NEAR(strand_get(&strands, 5, 5).x, before.x, 0);
    }
    strand_set(&strands, 5, 5, (dvec3){3e38, 3e38, 3e38});
    awt_placement placement = {.head_radius = 0.1, .scale = 1};
    CHECK_INT(awt_strands_place(&strands, &placement, NULL), AWT_BAD_VALUE);
    awt_strands_fini(&strands);
}

TEST(strands_place_refuses_no_strands)
{
    awt_strands none = {0};
    awt_placement placement = {0};
    CHECK_INT(awt_strands_place(&none, &placement, NULL), AWT_NO_STRANDS);
}

TEST(strands_place_refuses_a_head_with_hair_underneath)
{
    awt_strands strands = head_in_file(0.1, false, 0, (dvec3){0, 0, 0});
    for (uint32_t i = 0; i < strands.point_count; i++) {
        strands.positions[3 * i + 1] *= -1;
    }
    awt_placement placement = {.up = AWT_UP_Y};
    CHECK_INT(awt_strands_place(&strands, &placement, NULL), AWT_NO_HEAD);
    awt_strands_fini(&strands);
}

static void check_no_head(awt_strands *strands)
{
    awt_placement placement = {0};
    CHECK_INT(awt_strands_place(strands, &placement, NULL), AWT_NO_HEAD);
    awt_strands_fini(strands);
}

TEST(strands_place_refuses_roots_that_make_no_head)
{
    awt_strands strands = head_make(); /* hair that grows inwards */
    for (uint32_t s = 0; s < HEAD_STRANDS; s++) {
        for (uint32_t i = 1; i < HEAD_POINTS; i++) {
            strand_set(&strands, s, i, dvec3_scale(strand_get(&strands, s, 0), 1 - 0.1 * i));
        }
    }
    check_no_head(&strands);

    strands = head_make(); /* roots all through it */
    rng random = rng_seed(5);
    for (uint32_t s = 0; s < HEAD_STRANDS; s++) {
        double depth = rng_between(&random, 0.2, 1);
        for (uint32_t i = 0; i < HEAD_POINTS; i++) {
            strand_set(&strands, s, i, dvec3_scale(strand_get(&strands, s, i), depth));
        }
    }
    check_no_head(&strands);

    strands = head_make(); /* some on a kernel within it */
    for (uint32_t i = 0; i < HEAD_STRANDS; i += 20) {
        strand_set(&strands, i, 0, dvec3_scale(strand_get(&strands, i, 0), 0.5));
    }
    check_no_head(&strands);
}

/* Reads and places a real file; false where it is absent (then the test is skipped) or refused with `expected`. */
static bool place_real(const char *name, awt_status expected, awt_strands *strands, awt_placement *placement)
{
    const char *path = check_data(name);
    if (!path) {
        check_skip(name);
        return false;
    }
    size_t size;
    unsigned char *bytes = check_read_file(path, &size);
    awt_error error = {AWT_OK, ""};
    *strands = (awt_strands){0};
    CHECK_INT(awt_strands_read(bytes, size, strands, &error), AWT_OK);
    free(bytes);
    CHECK_INT(awt_strands_place(strands, placement, &error), expected);
    if (expected != AWT_OK || error.status != AWT_OK) {
        awt_strands_fini(strands);
        return false;
    }
    return true;
}

TEST(strands_place_sintel_in_metres)
{
    awt_strands strands;
    awt_placement placement = {0};
    if (place_real("hair/sintel_16pt.v4.tfx", AWT_OK, &strands, &placement)) {
        CHECK_NEAR(placement.scale, 1, 0);
        CHECK_INT(placement.up, AWT_UP_Y);
        CHECK_NEAR(placement.turned_degrees, 0, 0);
        CHECK_NEAR(placement.head_centre[1], 1.565, 0.01);
        CHECK_NEAR(placement.head_radius_m, 0.0925, 0.003);
        awt_strands_fini(&strands);
    }
}

TEST(strands_place_yuksel_with_z_up_and_its_face_turned)
{
    awt_strands strands;
    awt_placement placement = {0};
    if (place_real("hair/yuksel_straight.hair", AWT_OK, &strands, &placement)) {
        CHECK_INT(placement.up, AWT_UP_Z);
        CHECK_NEAR(placement.turned_degrees, 180, 0);
        CHECK_NEAR(placement.head_radius, 20.4, 0.7);
        CHECK_NEAR(placement.head_radius_m, AWT_HEAD_RADIUS_M, 1e-9);
        awt_strands_fini(&strands);
    }
}

TEST(strands_place_finds_the_head_above_a_mane)
{
    awt_strands strands;
    awt_placement placement = {0};
    if (place_real("hair/ratboy_mohawk.v4.tfx", AWT_OK, &strands, &placement)) {
        CHECK_INT(placement.up, AWT_UP_Y);
        CHECK_NEAR(placement.scale, 1, 0);
        CHECK_NEAR(placement.head_centre[1], 0.80, 0.05);
        CHECK_NEAR(placement.head_radius_m, 0.10, 0.03);
        awt_strands_fini(&strands);
    }
}

TEST(strands_place_refuses_the_real_ponytails_without_a_head)
{
    awt_strands strands;
    awt_placement placement = {0};
    place_real("hair/ponytail_tail.v3.tfx", AWT_NO_HEAD, &strands, &placement);
    place_real("hair/ponytail_front_top.v3.tfx", AWT_NO_HEAD, &strands, &placement);
    placement = (awt_placement){.head_centre = {0, 86, 3}, .head_radius = 34};
    if (place_real("hair/ponytail_tail.v3.tfx", AWT_OK, &strands, &placement)) {
        CHECK_INT(placement.up, AWT_UP_Y);
        awt_strands_fini(&strands);
    }
}
