/* cluster.c: see cluster.h. Sums in double and in the items' order; ties go to the lower number. */
#include "groom/cluster.h"

#include <stdbool.h>
#include <stddef.h>
#include <string.h>
#include "base/assert.h"
#include "base/rng.h"

enum {
    CLUSTER_ROUNDS = 10, /* of assignment and averaging; more moves hardly a strand */
    CLUSTER_DEPTH = 8    /* rounds one below the other; items that coincide would go on for ever */
};

/* One round's parts: `count` places of the order from `first` on, and `width` centres. */
typedef struct cluster_round {
    cluster_set *set;
    uint32_t first, count, width;
    double centre[CLUSTER_WIDTH][CLUSTER_FEATURES];
    uint32_t size[CLUSTER_WIDTH];
} cluster_round;

static const float *features_at(const cluster_round *round, uint32_t place)
{
    return round->set->features + (size_t)round->set->order[place] * CLUSTER_FEATURES;
}

static double squared_distance(const float *features, const double *centre)
{
    double sum = 0.0;
    for (int f = 0; f < CLUSTER_FEATURES; f++) {
        double d = (double)features[f] - centre[f];
        sum += d * d;
    }
    return sum;
}

static void centre_on(cluster_round *round, uint32_t part, uint32_t place)
{
    const float *features = features_at(round, place);
    for (int f = 0; f < CLUSTER_FEATURES; f++) {
        round->centre[part][f] = features[f];
    }
}

/* The place where the running sum of squared distances passes `target`. */
static uint32_t place_at_weight(const cluster_round *round, double target)
{
    const uint32_t last = round->first + round->count - 1;
    double sum = 0.0;
    for (uint32_t place = round->first; place < last; place++) {
        sum += round->set->nearest[place];
        if (sum > target) {
            return place;
        }
    }
    return last;
}

/* k-means++: each further centre is an item drawn by its squared distance to the centres there are. */
static void seed_centres(cluster_round *round)
{
    rng r = rng_seed(((uint64_t)round->count << 32) | round->first);
    double total = 0.0;
    for (uint32_t part = 0; part < round->width; part++) {
        uint32_t place = part > 0 ? place_at_weight(round, rng_unit(&r) * total)
                                  : round->first + (uint32_t)(rng_unit(&r) * (double)round->count);
        centre_on(round, part, place);
        total = 0.0;
        for (uint32_t p = round->first; p < round->first + round->count; p++) {
            double d = squared_distance(features_at(round, p), round->centre[part]);
            double *nearest = &round->set->nearest[p];
            *nearest = part == 0 || d < *nearest ? d : *nearest;
            total += *nearest;
        }
    }
}

/* Gives every item to its nearest centre. False: nothing changed. */
static bool assign_items(cluster_round *round)
{
    bool changed = false;
    memset(round->size, 0, sizeof round->size);
    for (uint32_t place = round->first; place < round->first + round->count; place++) {
        const float *features = features_at(round, place);
        uint32_t best = 0;
        double least = squared_distance(features, round->centre[0]);
        for (uint32_t part = 1; part < round->width; part++) {
            double d = squared_distance(features, round->centre[part]);
            if (d < least) {
                least = d;
                best = part;
            }
        }
        changed = changed || round->set->part[place] != best;
        round->set->part[place] = best;
        round->set->nearest[place] = least;
        round->size[best]++;
    }
    return changed;
}

static void average_centres(cluster_round *round)
{
    for (uint32_t part = 0; part < round->width; part++) {
        if (round->size[part] > 0) {
            memset(round->centre[part], 0, sizeof round->centre[part]);
        }
    }
    for (uint32_t place = round->first; place < round->first + round->count; place++) {
        const float *features = features_at(round, place);
        uint32_t part = round->set->part[place];
        for (int f = 0; f < CLUSTER_FEATURES; f++) {
            round->centre[part][f] += (double)features[f] / (double)round->size[part];
        }
    }
}

/* Every empty part takes the item that is farthest from its centre, from a part that can spare one. */
static void fill_empty_parts(cluster_round *round)
{
    for (uint32_t part = 0; part < round->width; part++) {
        if (round->size[part] > 0) {
            continue;
        }
        double most = -1.0;
        uint32_t taken = round->first;
        for (uint32_t place = round->first; place < round->first + round->count; place++) {
            if (round->size[round->set->part[place]] > 1 && round->set->nearest[place] > most) {
                most = round->set->nearest[place];
                taken = place;
            }
        }
        round->size[round->set->part[taken]]--;
        round->set->part[taken] = part;
        round->set->nearest[taken] = 0.0;
        round->size[part] = 1;
    }
}

/* Counting sort of the places by part: stable, so that the items of a part keep their order. */
static void gather_parts(cluster_round *round)
{
    uint32_t next[CLUSTER_WIDTH];
    uint32_t place = round->first;
    for (uint32_t part = 0; part < round->width; part++) {
        next[part] = place;
        place += round->size[part];
    }
    for (place = round->first; place < round->first + round->count; place++) {
        round->set->moved[next[round->set->part[place]]++] = round->set->order[place];
    }
    memcpy(round->set->order + round->first, round->set->moved + round->first,
           round->count * sizeof *round->set->order);
}

static void split_once(cluster_set *set, uint32_t first, uint32_t count, uint32_t width, uint32_t *sizes)
{
    cluster_round round = {.set = set, .first = first, .count = count, .width = width};
    seed_centres(&round);
    memset(set->part + first, 0, count * sizeof *set->part);
    for (int i = 0; i < CLUSTER_ROUNDS && assign_items(&round); i++) {
        average_centres(&round);
    }
    fill_empty_parts(&round);
    gather_parts(&round);
    memcpy(sizes, round.size, width * sizeof *sizes);
}

/* How many groups a first round makes on the way to `parts`: about the square root, within the width. */
static uint32_t round_width(uint32_t parts)
{
    uint32_t width = 2;
    while (width < CLUSTER_WIDTH && width * width < parts) {
        width++;
    }
    return width;
}

static void split_evenly(uint32_t count, uint32_t parts, uint32_t *sizes)
{
    for (uint64_t p = 0; p < parts; p++) {
        sizes[p] = (uint32_t)((p + 1) * count / parts - p * count / parts);
    }
}

static void split_rounds(cluster_set *set, uint32_t first, uint32_t count, uint32_t parts, uint32_t depth,
                         uint32_t *sizes)
{
    if (parts == 1 || depth == CLUSTER_DEPTH) {
        split_evenly(count, parts, sizes);
        return;
    }
    if (parts <= CLUSTER_WIDTH) {
        split_once(set, first, count, parts, sizes);
        return;
    }
    uint32_t group_size[CLUSTER_WIDTH], group_parts[CLUSTER_WIDTH];
    uint32_t groups = round_width(parts);
    split_once(set, first, count, groups, group_size);
    cluster_share(group_size, groups, parts, group_parts);
    for (uint32_t g = 0; g < groups; g++) {
        split_rounds(set, first, group_size[g], group_parts[g], depth + 1, sizes);
        first += group_size[g];
        sizes += group_parts[g];
    }
}

void cluster_split(cluster_set *set, uint32_t first, uint32_t count, uint32_t parts, uint32_t *sizes)
{
    ASSERT(parts >= 1 && parts <= count);
    split_rounds(set, first, count, parts, 0, sizes);
}

void cluster_share(const uint32_t *sizes, uint32_t groups, uint32_t total, uint32_t *shares)
{
    uint64_t sum = 0;
    for (uint32_t g = 0; g < groups; g++) {
        sum += sizes[g];
    }
    ASSERT(groups >= 1 && groups <= total && total <= sum);
    /* One each; what is over goes by size less one, rounded along the running sum: no group can get too many. */
    const uint64_t over = total - groups, rest = sum > groups ? sum - groups : 1;
    uint64_t seen = 0;
    for (uint32_t g = 0; g < groups; g++) {
        uint64_t before = over * seen / rest;
        seen += sizes[g] - 1;
        shares[g] = 1 + (uint32_t)(over * seen / rest - before);
    }
}
