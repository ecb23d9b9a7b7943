/* cluster.h: items with features grouped into a given number of parts, the same way every time.
 *
 * k-means with k-means++ seeding (Arthur and Vassilvitskii 2007) and a fixed seed. A large number of parts is reached
 * in rounds of at most CLUSTER_WIDTH, so that time grows with the items and hardly with the parts. Items that no round
 * tells apart are dealt out evenly in their order. */
#ifndef GROOM_CLUSTER_H
#define GROOM_CLUSTER_H

#include <stdint.h>

enum {
    CLUSTER_FEATURES = 12, /* numbers that describe an item */
    CLUSTER_WIDTH = 24     /* parts made in one round */
};

/* All arrays are the caller's, [items]. */
typedef struct cluster_set {
    const float *features; /* [items][CLUSTER_FEATURES], finite */
    uint32_t *order;       /* every item once; cluster_split moves the items of a part together */
    uint32_t *part;        /* scratch, by place in `order` */
    uint32_t *moved;       /* scratch */
    double *nearest;       /* scratch: squared distance to the nearest centre, by place in `order` */
} cluster_set;

/* Splits the items at places first .. first+count-1 of `order` into `parts` (1 .. count), none of them empty:
 * part p then holds the next sizes[p] places. Inside a part the items keep the order they had. */
void cluster_split(cluster_set *set, uint32_t first, uint32_t count, uint32_t parts, uint32_t *sizes);

/* Shares `total` out among `groups` in proportion to their sizes: 1 <= shares[g] <= sizes[g], and the sum is `total`.
 * Needs groups <= total <= the sum of the sizes, every size >= 1. */
void cluster_share(const uint32_t *sizes, uint32_t groups, uint32_t total, uint32_t *shares);

#endif
