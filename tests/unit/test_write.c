/* test_write.c: hair into the memory and the axes of engines. */
#include "check.h"
#include "awtspace.h"
#include "awtwrite.h"

#include <math.h>
#include <string.h>

TEST(write_goes_into_an_engines_memory_in_its_format_and_nowhere_else)
{
    const float points[6] = {0.25f, -0.5f, 1, 65519, 6.1e-5f, -1e-7f};
    unsigned char memory[64];
    awtwrite_target target = {.memory = memory, .size = 40, .stride = 20, .format = AWTWRITE_F32};
    float f[3];
    uint16_t h[3];
    memset(memory, 0xEE, sizeof memory);
    CHECK(awtwrite_points(&target, points, 2));
    memcpy(f, memory + 20, sizeof f);
    CHECK_BYTES(f, points + 3, sizeof f);
    for (int i = 12; i < 20; i++) {
        CHECK_INT(memory[i], 0xEE);
    }
    CHECK_INT(memory[32], 0xEE);
    target.size = 31;
    CHECK(!awtwrite_points(&target, points, 2));
    target = (awtwrite_target){.memory = memory, .size = 12, .format = AWTWRITE_F16};
    CHECK(awtwrite_points(&target, points, 2));
    memcpy(h, memory, sizeof h);
    CHECK_INT(h[0], 0x3400);
    CHECK_INT(h[1], 0xB800);
    CHECK_INT(h[2], 0x3C00);
    memcpy(h, memory + 6, sizeof h);
    CHECK_INT(h[0], 0x7BFF); /* 65504, the greatest */
    CHECK_INT(h[1], 0x03FF); /* the greatest below 2^-14 */
    CHECK_INT(h[2], 0x8002);
    target = (awtwrite_target){.memory = memory, .size = 12, .format = AWTWRITE_UNORM16, .space = AWTSPACE_UNREAL};
    CHECK(!awtwrite_points(&target, points, 1)); /* no box */
    for (int i = 0; i < 3; i++) {
        target.box_origin[i] = -100;
        target.box_size[i] = 200;
    }
    CHECK(awtwrite_points(&target, points, 2));
    memcpy(h, memory, sizeof h);
    CHECK_INT(h[0], 65535); /* z: 100 cm */
    CHECK_INT(h[1], 24576); /* -x: -25 cm */
    CHECK_INT(h[2], 16384); /* y: -50 cm */
    memcpy(h, memory + 6, sizeof h);
    CHECK_INT(h[1], 0); /* clamped */
}

TEST(write_turns_to_engines_points_and_turns_alike_and_back)
{
    const awtspace spaces[] = {AWTSPACE_OURS, AWTSPACE_UNREAL, AWTSPACE_UNITY, AWTSPACE_GODOT};
    const float nose[3] = {0, 0, 1}, top[3] = {0, 1, 0}, left[3] = {1, 0, 0};
    float out[3];
    awtspace_points_to(AWTSPACE_UNREAL, nose, out, 1);
    CHECK(out[0] == 100 && out[1] == 0 && out[2] == 0);
    awtspace_points_to(AWTSPACE_UNREAL, top, out, 1);
    CHECK(out[0] == 0 && out[1] == 0 && out[2] == 100);
    awtspace_points_to(AWTSPACE_UNREAL, left, out, 1);
    CHECK(out[0] == 0 && out[1] == -100 && out[2] == 0); /* +Y is to the right */
    awtspace_points_to(AWTSPACE_UNITY, left, out, 1);
    CHECK(out[0] == -1 && out[1] == 0 && out[2] == 0);
    for (int s = 0; s < 4; s++) {
        const double angle = 0.7, axis[3] = {2.0 / 7, 3.0 / 7, 6.0 / 7};
        double position[3] = {0.3, -0.2, 0.5}, turn[4], zero[3] = {0, 0, 0};
        for (int i = 0; i < 3; i++) {
            turn[i] = axis[i] * sin(angle / 2);
        }
        turn[3] = cos(angle / 2);
        /* Rodrigues' formula there must be the mapped result of Rodrigues' formula here. */
        float rotated[3], expected[3], from[3] = {0.3f, -0.2f, 0.5f}, mapped[3];
        double q[4];
        for (int space = 0; space < 2; space++) {
            memcpy(q, turn, sizeof q);
            const float *v = from;
            if (space == 1) {
                awtspace_pose_to(spaces[s], zero, q);
                awtspace_points_to(spaces[s], from, mapped, 1);
                v = mapped;
            }
            const double x = (double)v[0], y = (double)v[1], z = (double)v[2];
            const double tx = 2 * (q[1] * z - q[2] * y), ty = 2 * (q[2] * x - q[0] * z), tz = 2 * (q[0] * y - q[1] * x);
            float *to = space == 0 ? expected : rotated;
            to[0] = (float)(x + q[3] * tx + q[1] * tz - q[2] * ty);
            to[1] = (float)(y + q[3] * ty + q[2] * tx - q[0] * tz);
            to[2] = (float)(z + q[3] * tz + q[0] * ty - q[1] * tx);
        }
        awtspace_points_to(spaces[s], expected, expected, 1);
        for (int i = 0; i < 3; i++) {
            CHECK_NEAR((double)rotated[i], (double)expected[i], 1e-4);
        }
        memcpy(q, turn, sizeof q);
        awtspace_pose_to(spaces[s], position, q);
        awtspace_pose_from(spaces[s], position, q);
        awtspace_points_from(spaces[s], mapped, mapped, 1);
        for (int i = 0; i < 3; i++) {
            CHECK_NEAR((double)mapped[i], (double)from[i], 1e-6);
            CHECK_NEAR(position[i], (double)from[i], 1e-6);
            CHECK_NEAR(q[i], turn[i], 1e-12);
        }
    }
}
