/* bvh.c: BVH motion capture (DATA.md) to head and body poses.
 *
 * A joint's world motion is its parent's, times T(offset + position channels), times its rotation channels in the
 * order listed. D(t) = W(t) * W(bind)^-1 is what happened to everything fixed to the joint since the bind pose, in
 * which no channel says anything; the bind of a BVH has no rotation, so W(bind) is a translation. Head and body pose
 * are D of the head joint and D of the body joint, both applied to one point: the head's centre at bind. So they
 * coincide at bind, as motion.h says, whatever way the joints' own axes lie. */
#include "motion/formats.h"

#include "base/error.h"
#include "base/trig.h"
#include "motion/skeleton.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* From the head joint, which turns where the neck ends, to the centre of the head: up and a little forward. */
static const dvec3 BVH_HEAD_CENTRE_M = {0, 0.08, 0.02};

enum { BVH_BODY_ANCESTOR = 3 };

/* A joint of which the motion is wanted, with the joints between it and the root. */
typedef struct bvh_chain {
    int joints[SKELETON_MAX_JOINTS]; /* root first */
    int count;
    dvec3 point_m; /* what rides with it, in metres from its place at bind */
} bvh_chain;

typedef struct bvh_clip {
    skeleton skeleton;
    bvh_chain head, body;
    double scale;
    bool guessed_scale;
    awt_up_axis up;
    size_t frame_count;
    double frame_time_s;
    double *row; /* [channel_count], heap */
} bvh_clip;

static awt_status bvh_ended(awt_error *error)
{
    return error_set(error, AWT_TRUNCATED, "the BVH file ends before its last announced frame");
}

/* Metres per unit by the size of a person; files name none. */
static awt_status bvh_guess_scale(bvh_clip *clip, awt_error *error)
{
    double extent = skeleton_extent(&clip->skeleton);
    clip->guessed_scale = true;
    clip->scale = extent > 1000 ? 0.001 : extent > 10 ? 0.01 : extent > 3 ? 0.3048 : 1;
    if (extent < 0.3 || extent > 1e4) {
        return error_set(error, AWT_BAD_VALUE,
                         "the BVH skeleton is %g units large, so its unit cannot be guessed: give the motion's scale "
                         "in metres per unit",
                         extent);
    }
    return AWT_OK;
}

static void bvh_chain_init(bvh_chain *chain, const skeleton *s, int joint)
{
    chain->count = 0;
    for (int j = joint; j >= 0; j = s->joints[j].parent) {
        chain->count++;
    }
    int at = chain->count;
    for (int j = joint; j >= 0; j = s->joints[j].parent) {
        chain->joints[--at] = j;
    }
}

/* Which joints move what, and by what scale. */
static awt_status bvh_choose(bvh_clip *clip, const motion_options *options, awt_error *error)
{
    const skeleton *s = &clip->skeleton;
    int head = -1, body = -1;
    awt_status status = skeleton_find(s, options->joint, &head, error);
    if (status == AWT_OK && options->body_joint) {
        status = skeleton_find(s, options->body_joint, &body, error);
    } else if (status == AWT_OK) {
        body = skeleton_ancestor(s, head, BVH_BODY_ANCESTOR);
    }
    clip->up = options->up == AWT_UP_Z ? AWT_UP_Z : AWT_UP_Y;
    clip->scale = options->scale;
    if (status == AWT_OK && options->scale == 0) {
        status = bvh_guess_scale(clip, error);
    }
    if (status != AWT_OK) {
        return status;
    }
    bvh_chain_init(&clip->head, s, head);
    bvh_chain_init(&clip->body, s, body);
    rigid apart = {dquat_identity(), dvec3_sub(s->joints[head].bind, s->joints[body].bind)};
    clip->head.point_m = BVH_HEAD_CENTRE_M;
    clip->body.point_m = dvec3_add(motion_to_metres(apart, clip->scale, clip->up).move, BVH_HEAD_CENTRE_M);
    return AWT_OK;
}

/* "Frames: N" and "Frame Time: S", against the bytes that are there. */
static awt_status bvh_read_counts(text_cursor *text, bvh_clip *clip, awt_error *error)
{
    static const char *const words[] = {"Frames:", NULL, "Frame", "Time:", NULL};
    text_span word, numbers[2];
    for (size_t i = 0, found = 0; i < sizeof words / sizeof words[0]; i++) {
        if (!text_next_word(text, &word)) {
            return bvh_ended(error);
        }
        if (!words[i]) {
            numbers[found++] = word;
        } else if (!text_is(word, words[i])) {
            return error_set(error, AWT_BAD_FORMAT, "BVH line %zu: \"%s\" expected, not \"%.*s\"", text->line, words[i],
                             text_shown(word), word.text);
        }
    }
    int64_t frames;
    if (!text_integer(numbers[0], &frames) || frames < 1 || !text_real(numbers[1], &clip->frame_time_s) ||
        clip->frame_time_s < 1e-4 || clip->frame_time_s > 10) {
        return error_set(error, AWT_BAD_VALUE,
                         "the BVH file says \"Frames: %.*s\" and \"Frame Time: %.*s\": at least one frame, and from "
                         "0.0001 to 10 s for each, are wanted",
                         text_shown(numbers[0]), numbers[0].text, text_shown(numbers[1]), numbers[1].text);
    }
    if (frames > MOTION_MAX_SAMPLES) {
        return error_set(error, AWT_LIMIT, "the BVH file has more than %d frames", MOTION_MAX_SAMPLES);
    }
    if (clip->skeleton.channel_count == 0) {
        return error_set(error, AWT_BAD_FORMAT, "no joint of the BVH file has a channel, so nothing moves");
    }
    clip->frame_count = (size_t)frames;
    uint64_t least = (uint64_t)frames * clip->skeleton.channel_count * 2; /* a digit and a blank each */
    if (least > (uint64_t)(text->end - text->at) + 1) {
        return error_set(error, AWT_TRUNCATED, "the BVH file announces %lld frames of %u numbers and ends before them",
                         (long long)frames, clip->skeleton.channel_count);
    }
    return AWT_OK;
}

static awt_status bvh_read_row(text_cursor *text, bvh_clip *clip, awt_error *error)
{
    for (uint32_t i = 0; i < clip->skeleton.channel_count; i++) {
        text_span word;
        if (!text_next_word(text, &word)) {
            return bvh_ended(error);
        }
        if (!text_real(word, &clip->row[i])) {
            return error_set(error, AWT_BAD_VALUE, "BVH line %zu: \"%.*s\" is no finite number", text->line,
                             text_shown(word), word.text);
        }
    }
    return AWT_OK;
}

/* Where the joint's channels put it relative to its parent. */
static rigid bvh_joint_motion(const skeleton_joint *joint, const double *row)
{
    rigid r = {dquat_identity(), joint->offset};
    for (uint32_t i = 0; i < joint->channel_count; i++) {
        double value = row[joint->first_channel + i];
        double half = value * (TRIG_PI / 360), s = sin(half), c = cos(half);
        switch (joint->channels[i]) {
        case CHANNEL_X:
            r.move.x += value;
            break;
        case CHANNEL_Y:
            r.move.y += value;
            break;
        case CHANNEL_Z:
            r.move.z += value;
            break;
        case CHANNEL_TURN_X:
            r.turn = dquat_mul(r.turn, (dquat){s, 0, 0, c});
            break;
        case CHANNEL_TURN_Y:
            r.turn = dquat_mul(r.turn, (dquat){0, s, 0, c});
            break;
        case CHANNEL_TURN_Z:
            r.turn = dquat_mul(r.turn, (dquat){0, 0, s, c});
            break;
        }
    }
    return r;
}

/* The pose of what rides with the chain's last joint. */
static awt_pose bvh_chain_pose(const bvh_chain *chain, const bvh_clip *clip)
{
    rigid world = {dquat_identity(), {0, 0, 0}};
    for (int i = 0; i < chain->count; i++) {
        world = rigid_mul(world, bvh_joint_motion(&clip->skeleton.joints[chain->joints[i]], clip->row));
    }
    rigid metres = motion_to_metres(world, clip->scale, clip->up);
    return motion_pose((rigid){metres.turn, rigid_apply(metres, chain->point_m)});
}

static bool bvh_pose_usable(const awt_pose *pose)
{
    const double *p = pose->position;
    return fabs(p[0]) <= MOTION_MAX_DISTANCE_M && fabs(p[1]) <= MOTION_MAX_DISTANCE_M &&
           fabs(p[2]) <= MOTION_MAX_DISTANCE_M;
}

static awt_status bvh_read_frames(text_cursor *text, bvh_clip *clip, motion_sample *samples, awt_error *error)
{
    for (size_t i = 0; i < clip->frame_count; i++) {
        awt_status status = bvh_read_row(text, clip, error);
        if (status != AWT_OK) {
            return status;
        }
        samples[i].time_us = llround((double)i * clip->frame_time_s * 1e6);
        samples[i].head = bvh_chain_pose(&clip->head, clip);
        samples[i].body = bvh_chain_pose(&clip->body, clip);
        if (!bvh_pose_usable(&samples[i].head) || !bvh_pose_usable(&samples[i].body)) {
            return error_set(error, AWT_BAD_VALUE,
                             "BVH frame %zu puts the head more than %g km away: is the scale right?", i + 1,
                             MOTION_MAX_DISTANCE_M / 1000);
        }
    }
    text_span word;
    if (text_next_word(text, &word)) {
        return error_set(error, AWT_BAD_FORMAT,
                         "BVH line %zu: there is more than the %zu frames that \"Frames:\" announces", text->line,
                         clip->frame_count);
    }
    return AWT_OK;
}

static void bvh_describe(const bvh_clip *clip, motion *out)
{
    const skeleton *s = &clip->skeleton;
    snprintf(out->description, sizeof out->description,
             "BVH, %zu frames at %.4g fps, head joint %s, body joint %s, %g m per unit%s, %s up", clip->frame_count,
             1 / clip->frame_time_s, s->joints[clip->head.joints[clip->head.count - 1]].name,
             s->joints[clip->body.joints[clip->body.count - 1]].name, clip->scale,
             clip->guessed_scale ? " (guessed)" : "", clip->up == AWT_UP_Z ? "Z" : "Y");
}

awt_status bvh_read(text_cursor text, const motion_options *options, motion *out, awt_error *error)
{
    motion_sample *samples = NULL;
    bvh_clip *clip = calloc(1, sizeof *clip);
    if (!clip) {
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    awt_status status = skeleton_read(&text, &clip->skeleton, error);
    if (status != AWT_OK || (status = bvh_choose(clip, options, error)) != AWT_OK ||
        (status = bvh_read_counts(&text, clip, error)) != AWT_OK) {
        goto fail;
    }
    samples = malloc(clip->frame_count * sizeof *samples);
    clip->row = malloc((clip->skeleton.channel_count + 1) * sizeof *clip->row);
    if (!samples || !clip->row) {
        status = error_set(error, AWT_NO_MEMORY, NULL);
        goto fail;
    }
    if ((status = bvh_read_frames(&text, clip, samples, error)) != AWT_OK) {
        goto fail;
    }
    *out = (motion){.sample_count = clip->frame_count, .samples = samples};
    samples = NULL;
    bvh_describe(clip, out);
fail:
    free(samples);
    free(clip->row);
    skeleton_fini(&clip->skeleton);
    free(clip);
    return status;
}
