/* framemix.c: see framemix.h.
 *
 * Points are in the head frame, so that a straight line between two frames is a good way for each: the head's own
 * motion, which is most of it, is in the poses. Where the head has jumped, nothing is mixed across the jump. */
#include "framemix.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MIX_JUMP_M 0.05 /* between two frames, beside what this speed makes: a jump */
#define MIX_JUMP_M_S 30.0

void framemix_init(framemix *mix, int64_t extrapolate_us)
{
    *mix = (framemix){.extrapolate_us = extrapolate_us > 0 ? extrapolate_us : 0, .shown_us = INT64_MIN};
}

void framemix_fini(framemix *mix)
{
    for (int i = 0; i < AWTFRAMES_KEPT; i++) {
        free(mix->frames[i].positions);
    }
    free(mix->widths);
    free(mix->shown[0]);
    free(mix->shown[1]);
    framemix_init(mix, mix->extrapolate_us);
}

static size_t floats_of(const framemix *mix)
{
    return (size_t)mix->strand_count * mix->points_per_strand * 3;
}

/* Hair of another shape: all memory anew. Time goes on from what was shown. */
static bool begin_shape(framemix *mix, const geom_strands *strands)
{
    const int64_t shown_us = mix->shown_us;
    uint64_t counts[3];
    memcpy(counts, mix->counts, sizeof counts);
    framemix_fini(mix);
    memcpy(mix->counts, counts, sizeof counts);
    mix->shown_us = shown_us;
    mix->strand_count = strands->strand_count;
    mix->points_per_strand = strands->points_per_strand;
    const size_t size = (floats_of(mix) + 1) * sizeof(float);
    bool made = (mix->widths = malloc((strands->points_per_strand + 1) * sizeof(float))) != NULL;
    for (int i = 0; i < 2; i++) {
        made = (mix->shown[i] = calloc(1, size)) != NULL && made;
    }
    if (!made) {
        framemix_fini(mix);
        mix->strand_count = mix->points_per_strand = 0;
        return false;
    }
    memcpy(mix->widths, strands->widths, strands->points_per_strand * sizeof(float));
    return true;
}

/* Number 0 is the oldest. */
static const mix_frame *frame_at(const framemix *mix, uint32_t number)
{
    return &mix->frames[(mix->first + number) % AWTFRAMES_KEPT];
}

int64_t framemix_newest_us(const framemix *mix)
{
    return mix->count > 0 ? frame_at(mix, mix->count - 1)->time_us : INT64_MIN;
}

/* The oldest frame leaves; while it and the one after it are still ahead of what is shown, that one: then the hair
 * goes on between the oldest and those far ahead, and does not jump to them. */
static void drop_one(framemix *mix)
{
    if (frame_at(mix, 1)->time_us > mix->shown_us) {
        mix_frame *oldest = &mix->frames[mix->first], *next = &mix->frames[(mix->first + 1) % AWTFRAMES_KEPT];
        const mix_frame kept = *oldest;
        *oldest = *next;
        *next = kept;
    }
    mix->first = (mix->first + 1) % AWTFRAMES_KEPT;
    mix->count--;
}

/* Those before the one that was shown last leave: time does not go back. Two stay, to go on beyond by. */
static void drop_shown(framemix *mix)
{
    while (mix->count > 2 && frame_at(mix, 1)->time_us <= mix->shown_us) {
        mix->first = (mix->first + 1) % AWTFRAMES_KEPT;
        mix->count--;
    }
}

/* The place after the newest, with memory: of its own, or of one that has left, or new, so that no more is taken than
 * was wanted at a time. NULL: no memory. */
static mix_frame *free_place(framemix *mix)
{
    mix_frame *place = &mix->frames[(mix->first + mix->count) % AWTFRAMES_KEPT];
    for (uint32_t i = mix->count + 1; i < AWTFRAMES_KEPT && !place->positions; i++) {
        mix_frame *left = &mix->frames[(mix->first + i) % AWTFRAMES_KEPT];
        place->positions = left->positions;
        left->positions = NULL;
    }
    if (!place->positions) {
        place->positions = malloc((floats_of(mix) + 1) * sizeof(float));
    }
    return place->positions ? place : NULL;
}

bool framemix_add(framemix *mix, const geom_strands *strands)
{
    const bool same = mix->shown[0] && mix->strand_count == strands->strand_count &&
                      mix->points_per_strand == strands->points_per_strand;
    if (mix->count > 0 && strands->time_us <= framemix_newest_us(mix)) {
        return true;
    }
    if (!same && !begin_shape(mix, strands)) {
        return false;
    }
    drop_shown(mix);
    if (mix->count == AWTFRAMES_KEPT) {
        drop_one(mix);
    }
    mix_frame *place = free_place(mix);
    if (!place) {
        return false;
    }
    place->time_us = strands->time_us;
    memcpy(place->head.position, strands->head.position, sizeof place->head.position);
    memcpy(place->head.orientation, strands->head.orientation, sizeof place->head.orientation);
    memcpy(place->positions, strands->positions, floats_of(mix) * sizeof(float));
    mix->count++;
    return true;
}

/* ---- between two frames ------------------------------------------------------------------------------------- */

/* The frames to mix, and how much of the second: 0 .. 1 between them, more beyond. */
typedef struct mix_pair {
    const mix_frame *a, *b;
    double share;
    int64_t time_us;
    awtframes_way way;
} mix_pair;

static bool jumped(const mix_frame *a, const mix_frame *b)
{
    double square = 0;
    for (int i = 0; i < 3; i++) {
        const double way = b->head.position[i] - a->head.position[i];
        square += way * way;
    }
    return sqrt(square) > MIX_JUMP_M + MIX_JUMP_M_S * 1e-6 * (double)(b->time_us - a->time_us);
}

static mix_pair hold(const mix_frame *frame)
{
    return (mix_pair){frame, frame, 0, frame->time_us, AWTFRAMES_HELD};
}

/* Beyond the newest: on by its last motion, ever slower: it stands at the bound after twice that time. */
static mix_pair beyond(const framemix *mix, int64_t time_us)
{
    const mix_frame *newest = frame_at(mix, mix->count - 1);
    const mix_frame *before = mix->count > 1 ? frame_at(mix, mix->count - 2) : newest;
    if (before == newest || jumped(before, newest)) {
        return hold(newest);
    }
    const double bound = (double)mix->extrapolate_us, past = (double)time_us - (double)newest->time_us;
    const bool far = past >= 2 * bound;
    const int64_t at_us = newest->time_us + (far ? mix->extrapolate_us : (int64_t)(past - past * past / (4 * bound)));
    const double share = (double)(at_us - before->time_us) / (double)(newest->time_us - before->time_us);
    return (mix_pair){before, newest, share, at_us, far ? AWTFRAMES_HELD : AWTFRAMES_BEYOND};
}

static mix_pair pair_at(const framemix *mix, int64_t time_us)
{
    const mix_frame *oldest = frame_at(mix, 0);
    if (time_us < oldest->time_us) {
        return hold(oldest);
    }
    if (time_us > framemix_newest_us(mix)) {
        return beyond(mix, time_us);
    }
    uint32_t at = mix->count - 1;
    while (frame_at(mix, at)->time_us > time_us) {
        at--;
    }
    const mix_frame *a = frame_at(mix, at), *b = at + 1 < mix->count ? frame_at(mix, at + 1) : a;
    const double length_us = (double)(b->time_us - a->time_us);
    const double share = b == a || jumped(a, b) ? 0 : (double)(time_us - a->time_us) / length_us;
    return (mix_pair){a, b, share, time_us, AWTFRAMES_BETWEEN};
}

/* Linear, on the shorter arc; between poses of neighbouring frames that is as good as the arc itself. */
static proto_pose mix_pose(const proto_pose *a, const proto_pose *b, double share)
{
    proto_pose out;
    double dot = 0, square = 0;
    for (int i = 0; i < 4; i++) {
        dot += a->orientation[i] * b->orientation[i];
    }
    for (int i = 0; i < 3; i++) {
        out.position[i] = a->position[i] + share * (b->position[i] - a->position[i]);
    }
    for (int i = 0; i < 4; i++) {
        const double end = dot < 0 ? -b->orientation[i] : b->orientation[i];
        out.orientation[i] = a->orientation[i] + share * (end - a->orientation[i]);
        square += out.orientation[i] * out.orientation[i];
    }
    if (square < 1e-12) { /* an extrapolated turn can cancel out */
        return *b;
    }
    for (int i = 0; i < 4; i++) {
        out.orientation[i] /= sqrt(square);
    }
    return out;
}

static void mix_points(const mix_pair *pair, size_t points, float *out, float least[3], float greatest[3])
{
    const float *a = pair->a->positions, *b = pair->b->positions;
    const float share = (float)pair->share;
    for (int i = 0; i < 3; i++) {
        least[i] = points > 0 ? INFINITY : 0;
        greatest[i] = points > 0 ? -INFINITY : 0;
    }
    for (size_t p = 0; p < points; p++) {
        for (int i = 0; i < 3; i++) {
            const size_t at = 3 * p + (size_t)i;
            const float value = a[at] + share * (b[at] - a[at]);
            out[at] = value;
            least[i] = value < least[i] ? value : least[i];
            greatest[i] = value > greatest[i] ? value : greatest[i];
        }
    }
}

bool framemix_show(framemix *mix, int64_t time_us, awtframes_shown *shown)
{
    if (mix->count == 0) {
        return false;
    }
    const bool first = mix->heads[0].orientation[3] == 0 && mix->heads[0].orientation[0] == 0 &&
                       mix->heads[0].orientation[1] == 0 && mix->heads[0].orientation[2] == 0;
    const mix_pair pair = pair_at(mix, time_us > mix->shown_us ? time_us : mix->shown_us);
    float *previous = mix->shown[0];
    mix->shown[0] = mix->shown[1];
    mix->shown[1] = previous;
    mix->heads[1] = mix->heads[0];
    mix->heads[0] = mix_pose(&pair.a->head, &pair.b->head, pair.share);
    mix->shown_us = pair.time_us > mix->shown_us ? pair.time_us : mix->shown_us;
    mix->counts[pair.way]++;
    *shown = (awtframes_shown){.way = pair.way,
                               .time_us = mix->shown_us,
                               .strand_count = mix->strand_count,
                               .points_per_strand = mix->points_per_strand,
                               .positions = mix->shown[0],
                               .previous = first ? mix->shown[0] : mix->shown[1],
                               .widths = mix->widths,
                               .head = mix->heads[0],
                               .previous_head = first ? mix->heads[0] : mix->heads[1]};
    mix_points(&pair, floats_of(mix) / 3, mix->shown[0], shown->least, shown->greatest);
    return true;
}
