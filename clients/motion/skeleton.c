/* skeleton.c: see skeleton.h. One word after the other; the joint whose braces are open is `open`, so nesting costs no
 * stack however deep a file goes. */
#include "motion/skeleton.h"

#include "base/error.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static awt_status skeleton_ended(awt_error *error)
{
    return error_set(error, AWT_TRUNCATED, "the BVH file ends inside its HIERARCHY");
}

static awt_status skeleton_unexpected(const text_cursor *text, text_span word, const char *wanted, awt_error *error)
{
    return error_set(error, AWT_BAD_FORMAT, "BVH line %zu: %s expected, not \"%.*s\"", text->line, wanted,
                     text_shown(word), word.text);
}

static awt_status skeleton_take(text_cursor *text, const char *wanted, awt_error *error)
{
    text_span word;
    if (!text_next_word(text, &word)) {
        return skeleton_ended(error);
    }
    return text_is(word, wanted) ? AWT_OK : skeleton_unexpected(text, word, wanted, error);
}

/* ROOT name {, JOINT name { or End Site {; the new joint is the open one. */
static awt_status skeleton_open(text_cursor *text, skeleton *s, int *open, bool end_site, awt_error *error)
{
    text_span name;
    if (s->joint_count == SKELETON_MAX_JOINTS) {
        return error_set(error, AWT_LIMIT, "the BVH file has more than %d joints", SKELETON_MAX_JOINTS);
    }
    if (!text_next_word(text, &name)) {
        return skeleton_ended(error);
    }
    skeleton_joint *joint = &s->joints[s->joint_count];
    *joint = (skeleton_joint){.parent = *open, .first_channel = s->channel_count};
    if (end_site && !text_is(name, "Site")) {
        return skeleton_unexpected(text, name, "Site", error);
    }
    if (!end_site) {
        if (name.length > SKELETON_MAX_NAME) {
            return error_set(error, AWT_LIMIT, "BVH line %zu: a joint's name is longer than %d bytes", text->line,
                             SKELETON_MAX_NAME);
        }
        memcpy(joint->name, name.text, name.length);
    }
    *open = (int)s->joint_count++;
    return skeleton_take(text, "{", error);
}

static awt_status skeleton_offset(text_cursor *text, skeleton *s, int open, awt_error *error)
{
    double offset[3];
    for (int i = 0; i < 3; i++) {
        text_span word;
        if (!text_next_word(text, &word)) {
            return skeleton_ended(error);
        }
        if (!text_real(word, &offset[i]) || fabs(offset[i]) > 1e9) {
            return error_set(error, AWT_BAD_VALUE, "BVH line %zu: \"%.*s\" is no usable offset", text->line,
                             text_shown(word), word.text);
        }
    }
    skeleton_joint *joint = &s->joints[open];
    joint->has_offset = true;
    joint->offset = (dvec3){offset[0], offset[1], offset[2]};
    joint->bind = joint->parent < 0 ? joint->offset : dvec3_add(s->joints[joint->parent].bind, joint->offset);
    return AWT_OK;
}

static awt_status skeleton_channels(text_cursor *text, skeleton *s, int open, awt_error *error)
{
    static const char *const names[] = {"Xposition", "Yposition", "Zposition", "Xrotation", "Yrotation", "Zrotation"};
    skeleton_joint *joint = &s->joints[open];
    text_span word;
    int64_t count;
    if (!text_next_word(text, &word)) {
        return skeleton_ended(error);
    }
    if (!text_integer(word, &count) || count < 0 || count > SKELETON_MAX_CHANNELS || joint->channel_count > 0) {
        return error_set(error, AWT_BAD_VALUE, "BVH line %zu: a joint has from 0 to %d channels, given once",
                         text->line, SKELETON_MAX_CHANNELS);
    }
    joint->first_channel = s->channel_count;
    for (int64_t i = 0; i < count; i++) {
        if (!text_next_word(text, &word)) {
            return skeleton_ended(error);
        }
        int channel = CHANNEL_X;
        while (channel <= CHANNEL_TURN_Z && !text_is(word, names[channel])) {
            channel++;
        }
        if (channel > CHANNEL_TURN_Z) {
            return skeleton_unexpected(text, word, "a channel such as Xposition or Zrotation", error);
        }
        joint->channels[joint->channel_count++] = (skeleton_channel)channel;
    }
    s->channel_count += joint->channel_count;
    return AWT_OK;
}

/* One word of the hierarchy and what belongs to it. `*more` is false after MOTION. */
static awt_status skeleton_item(text_cursor *text, skeleton *s, int *open, bool *more, awt_error *error)
{
    text_span word;
    if (!text_next_word(text, &word)) {
        return skeleton_ended(error);
    }
    bool inside = *open >= 0, in_joint = inside && s->joints[*open].name[0] != '\0';
    bool ready = inside && s->joints[*open].has_offset;
    if (text_is(word, "ROOT") && !inside) {
        return skeleton_open(text, s, open, false, error);
    }
    if (text_is(word, "JOINT") && in_joint && ready) {
        return skeleton_open(text, s, open, false, error);
    }
    if (text_is(word, "End") && in_joint && ready) {
        return skeleton_open(text, s, open, true, error);
    }
    if (text_is(word, "OFFSET") && inside && !ready) {
        return skeleton_offset(text, s, *open, error);
    }
    if (text_is(word, "CHANNELS") && in_joint) {
        return skeleton_channels(text, s, *open, error);
    }
    if (text_is(word, "}") && ready) {
        *open = s->joints[*open].parent;
        return AWT_OK;
    }
    if (text_is(word, "MOTION") && !inside && s->joint_count > 0) {
        *more = false;
        return AWT_OK;
    }
    return skeleton_unexpected(text, word, inside ? "OFFSET, CHANNELS, JOINT, End Site or }" : "ROOT or MOTION", error);
}

awt_status skeleton_read(text_cursor *text, skeleton *out, awt_error *error)
{
    *out = (skeleton){0};
    out->joints = malloc(SKELETON_MAX_JOINTS * sizeof *out->joints);
    if (!out->joints) {
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    int open = -1;
    bool more = true;
    awt_status status = skeleton_take(text, "HIERARCHY", error);
    while (status == AWT_OK && more) {
        status = skeleton_item(text, out, &open, &more, error);
    }
    return status;
}

void skeleton_fini(skeleton *s)
{
    free(s->joints);
    *s = (skeleton){0};
}

/* The first joint whose name passes; -1: none. */
static int skeleton_search(const skeleton *s, bool (*passes)(const char *, const char *), const char *name)
{
    for (uint32_t i = 0; i < s->joint_count; i++) {
        if (s->joints[i].name[0] && passes(s->joints[i].name, name)) {
            return (int)i;
        }
    }
    return -1;
}

static bool name_same(const char *name, const char *wanted)
{
    return strcmp(name, wanted) == 0;
}

static bool name_same_but_case(const char *name, const char *wanted)
{
    return strcasecmp(name, wanted) == 0;
}

static bool name_contains(const char *name, const char *wanted)
{
    size_t length = strlen(wanted);
    for (; *name; name++) {
        if (strncasecmp(name, wanted, length) == 0) {
            return true;
        }
    }
    return false;
}

static int skeleton_guess_head(const skeleton *s)
{
    int head = skeleton_search(s, name_same, "Head");
    return head >= 0 ? head : skeleton_search(s, name_contains, "head");
}

/* "there is no joint X; there are A, B, C ..., as many as the error's text holds. */
static awt_status skeleton_no_joint(const skeleton *s, const char *name, awt_error *error)
{
    char text[sizeof error->text];
    int head = skeleton_guess_head(s);
    int used = name ? snprintf(text, sizeof text, "the BVH file has no joint \"%.*s\"%s%s; there are", 40, name,
                               head >= 0 ? ", the head may be " : "", head >= 0 ? s->joints[head].name : "")
                    : snprintf(text, sizeof text, "no joint has \"head\" in its name, name it; there are");
    size_t at = (size_t)used;
    for (uint32_t i = 0; i < s->joint_count; i++) {
        const char *joint = s->joints[i].name;
        if (joint[0] && at + strlen(joint) + sizeof ", ..." < sizeof text) {
            at += (size_t)snprintf(text + at, sizeof text - at, " %s,", joint);
        } else if (joint[0]) {
            at += (size_t)snprintf(text + at, sizeof text - at, " ...");
            break;
        }
    }
    if (text[at - 1] == ',') {
        text[at - 1] = '\0';
    }
    return error_set(error, AWT_BAD_VALUE, "%s", text);
}

awt_status skeleton_find(const skeleton *s, const char *name, int *joint, awt_error *error)
{
    *joint = name ? skeleton_search(s, name_same, name) : skeleton_guess_head(s);
    if (*joint < 0 && name) {
        *joint = skeleton_search(s, name_same_but_case, name);
    }
    return *joint >= 0 ? AWT_OK : skeleton_no_joint(s, name, error);
}

int skeleton_ancestor(const skeleton *s, int joint, int steps)
{
    for (; steps > 0 && s->joints[joint].parent >= 0; steps--) {
        joint = s->joints[joint].parent;
    }
    return joint;
}

double skeleton_extent(const skeleton *s)
{
    dvec3 low = s->joints[0].bind, high = low;
    for (uint32_t i = 1; i < s->joint_count; i++) {
        dvec3 p = s->joints[i].bind;
        low = (dvec3){fmin(low.x, p.x), fmin(low.y, p.y), fmin(low.z, p.z)};
        high = (dvec3){fmax(high.x, p.x), fmax(high.y, p.y), fmax(high.z, p.z)};
    }
    dvec3 size = dvec3_sub(high, low);
    return fmax(size.x, fmax(size.y, size.z));
}
