/* test_adapt.c: what must hold of splits and merges: invariants 1, 2, 3 and 7 of the physics.
 *
 * The forest is stepped with splitting and merging held off, and then adapted alone, so that what an event changes is
 * seen apart from what the motion changes. */
#include "check.h"
#include "fixture.h"

#include "sim/adapt.h"
#include "sim/tree.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STRANDS = 2000, STEPS = 600 };

typedef struct totals {
    double mass; /* in mass units: sums of integers, exact */
    dvec3 momentum, centre;
    double energy;
} totals;

static totals tree_totals(const awt_forest *f, uint32_t t)
{
    totals sum = {0};
    for (uint32_t k = f->trees[t].first; k < f->trees[t].first + f->trees[t].count; k++) {
        uint32_t node = f->active_node[k];
        double m = (double)f->active_mass[k];
        dvec3 x = dvec3_of_vec3(f->position[node]), v = dvec3_of_vec3(f->velocity[node]);
        sum.mass += m;
        sum.momentum = dvec3_add(sum.momentum, dvec3_scale(v, m));
        sum.centre = dvec3_add(sum.centre, dvec3_scale(x, m));
        sum.energy += 0.5 * m * dvec3_dot(v, v);
    }
    sum.centre = dvec3_scale(sum.centre, 1.0 / sum.mass);
    return sum;
}

static void strands_of(const awt_forest *f, float *centres, float *frames, float *scratch, float *points)
{
    awt_forest_guides(f, centres, frames);
    awt_groom_strands(f->groom, centres, frames, scratch, points);
}

static double greatest_distance(const float *a, const float *b, size_t points)
{
    double worst = 0;
    for (size_t i = 0; i < points; i++) {
        double dx = (double)a[3 * i] - (double)b[3 * i], dy = (double)a[3 * i + 1] - (double)b[3 * i + 1];
        double dz = (double)a[3 * i + 2] - (double)b[3 * i + 2];
        double d = sqrt(dx * dx + dy * dy + dz * dz);
        worst = d > worst ? d : worst;
    }
    return worst;
}

/* Active ancestors (itself included) of each finest section. */
static uint32_t wrongly_governed_sections(const awt_forest *f)
{
    const awt_groom *groom = f->groom;
    const uint32_t sections = groom->info.sections;
    uint32_t wrong = 0;
    for (uint32_t g = groom_finest_first(groom); g < groom->gc_count; g++) {
        for (uint32_t i = 0; i < sections; i++) {
            uint32_t active = 0;
            for (uint32_t a = g;; a = groom->gc_super[a]) {
                uint32_t node = a * sections + i, slot = f->slot_of_node[node];
                const tree *t = &f->trees[groom->gc_tree[g]];
                active += slot >= t->first && slot < t->first + t->count && f->active_node[slot] == node;
                if (groom->gc_super[a] == a) {
                    break;
                }
            }
            wrong += active != 1;
        }
    }
    return wrong;
}

typedef struct watched {
    uint32_t splits, merges, bad_partition, bad_count, bad_order, bad_measure, first_not_at_tip;
    double mass, momentum, centre, energy_split, energy_merge_rise, pop;
} watched;

/* Is the node that stands for the sub-nodes of (g, i) quiet enough, and as agitated as they were on the average? */
static bool merged_in_peace(const awt_forest *f, uint32_t g, uint32_t i)
{
    const awt_groom *groom = f->groom;
    const uint32_t sections = groom->info.sections, node = g * sections + i;
    double agitation = 0, mass = 0;
    for (uint32_t s = groom->gc_sub_first[g]; s < groom->gc_sub_first[g] + groom->gc_sub_count[g]; s++) {
        agitation += (double)f->agitation[s * sections + i] * groom->gc_strand_count[s];
        mass += groom->gc_strand_count[s];
    }
    float measure = (vec3_length(f->acceleration[node]) + f->agitation[node]) * f->radius[node];
    return measure <= f->params.split_threshold * f->params.split_hysteresis &&
           fabs((double)f->agitation[node] - agitation / mass) <= 1e-6 * agitation / mass;
}

static void worse(double *worst, double value)
{
    *worst = value > *worst ? value : *worst;
}

/* One tree's adaptation, before against after. */
static void watch_tree(awt_forest *f, uint32_t t, watched *w)
{
    const awt_groom *groom = f->groom;
    const uint32_t sections = groom->info.sections;
    uint32_t *before = malloc(groom->gc_count * sizeof *before);
    float *measure = malloc((size_t)groom->gc_count * sections * sizeof *measure);
    memcpy(before, f->first_split, groom->gc_count * sizeof *before);
    for (uint32_t n = 0; n < groom->gc_count * sections; n++) {
        measure[n] = (vec3_length(f->acceleration[n]) + f->agitation[n]) * f->radius[n];
    }
    totals old = tree_totals(f, t);
    adapt_counts counts = adapt_tree(f, t, UINT32_MAX);
    totals now = tree_totals(f, t);

    uint32_t splits = 0, merges = 0;
    for (uint32_t g = 0; g < groom->gc_count; g++) {
        uint32_t i = f->first_split[g];
        if (i == before[g] || groom->gc_tree[g] != t) {
            continue;
        }
        if (i < before[g]) { /* tip to root, its measure over the threshold, its child split already */
            splits++;
            w->bad_order += i + 1 != before[g] || i < 1;
            bool was_active = groom->gc_super[g] == g || i >= before[groom->gc_super[g]];
            w->bad_measure += was_active && !(measure[g * sections + i] > f->params.split_threshold);
        } else { /* root to tip */
            merges++;
            w->bad_order += i != before[g] + 1;
            w->bad_measure += !merged_in_peace(f, g, before[g]);
        }
        w->bad_order += groom->gc_super[g] != g && f->first_split[groom->gc_super[g]] > i;
    }
    w->bad_count += splits != counts.splits || merges != counts.merges;
    w->splits += counts.splits;
    w->merges += counts.merges;
    worse(&w->mass, fabs(now.mass - old.mass));
    double scale = sqrt(2.0 * old.energy * old.mass) + 1e-9;
    worse(&w->momentum, dvec3_length(dvec3_sub(now.momentum, old.momentum)) / scale);
    worse(&w->centre, dvec3_length(dvec3_sub(now.centre, old.centre)));
    if (counts.merges == 0) {
        worse(&w->energy_split, fabs(now.energy - old.energy) / (old.energy + 1e-9));
    } else if (counts.splits == 0) {
        worse(&w->energy_merge_rise, (now.energy - old.energy) / (old.energy + 1e-9));
    }
    free(before);
    free(measure);
}

/* `weight`: of contact and air in the split measure. */
static watched watch_lean(const char *style, float weight, const double at[3], const double velocity[3])
{
    const awt_groom *groom = fixture_groom(style, STRANDS);
    awt_forest *f = fixture_forest(groom, style, at, velocity);
    f->params.split_contact = f->params.split_wind = weight;
    const awt_params wanted = f->params;
    size_t points = (size_t)groom->info.strand_count * groom->info.points_per_strand;
    float *centres = malloc((size_t)groom->info.finest_nodes * 3 * sizeof(float));
    float *frames = malloc((size_t)groom->info.finest_nodes * 4 * sizeof(float));
    float *scratch = malloc(awt_groom_strand_scratch(groom) * sizeof(float));
    float *before = malloc(points * 3 * sizeof(float)), *after = malloc(points * 3 * sizeof(float));
    watched w = {0};
    for (int n = 1; n <= STEPS; n++) {
        f->params.residence = 1e9f; /* nothing adapts by itself */
        fixture_advance(f, fixture_clip("lean"), (int64_t)n * AWT_STEP_US, at, velocity, NULL);
        f->params = wanted;
        strands_of(f, centres, frames, scratch, before);
        uint32_t events = w.splits + w.merges;
        for (uint32_t t = 0; t < groom->info.wisp_count[0]; t++) {
            watch_tree(f, t, &w);
        }
        if (w.splits + w.merges > events) {
            strands_of(f, centres, frames, scratch, after);
            worse(&w.pop, greatest_distance(before, after, points));
            w.bad_partition += wrongly_governed_sections(f);
        }
    }
    free(centres), free(frames), free(scratch), free(before), free(after);
    awt_forest_destroy(f);
    return w;
}

static void check_watched(const watched *w)
{
    CHECK(w->splits > 100);
    CHECK(w->merges > 100);
    CHECK_INT(w->bad_partition, 0);
    CHECK_INT(w->bad_count, 0);
    CHECK_INT(w->bad_order, 0);
    CHECK_INT(w->bad_measure, 0);
    CHECK_NEAR(w->mass, 0, 0);
    CHECK_NEAR(w->momentum, 0, 1e-7);
    CHECK_NEAR(w->centre, 0, 1e-8);
    CHECK_NEAR(w->energy_split, 0, 1e-9);
    CHECK(w->energy_merge_rise <= 1e-7);
    CHECK_NEAR(w->pop, 0, 1e-6);
}

TEST(splits_and_merges_keep_partition_mass_momentum_centre_energy_and_every_strand)
{
    const double still[3] = {0, 0, 0}, home[3] = {0, 0, 0};
    const char *const styles[] = {"long", "long-curly"};
    for (int k = 0; k < check_rounds(2); k++) {
        watched w = watch_lean(styles[k], 0, home, still);
        check_watched(&w);
    }
}

TEST(splits_and_merges_keep_all_that_at_ten_metres_a_second_100_km_from_zero)
{
    const double fast[3] = {10, 0, 0}, far_away[3] = {1e5, 0, -1e5};
    watched w = watch_lean("long", 0, far_away, fast);
    check_watched(&w);
}

TEST(splits_and_merges_keep_all_that_where_contact_and_air_split_too)
{
    const double still[3] = {0, 0, 0}, home[3] = {0, 0, 0};
    watched w = watch_lean("long", 1, home, still);
    check_watched(&w);
}

/* Replays a forest's events from what awt_forest_advance counts. */
TEST(counted_splits_and_merges_account_for_the_active_set)
{
    const double zero[3] = {0, 0, 0};
    const awt_groom *groom = fixture_groom("long", STRANDS);
    awt_forest *f = fixture_forest(groom, "long", zero, zero);
    uint32_t splits = 0, merges = 0, most = 0;
    for (int n = 1; n <= 400; n++) {
        awt_step_stats stats;
        fixture_advance(f, fixture_clip("jump"), (int64_t)n * AWT_STEP_US, zero, zero, &stats);
        splits += stats.splits;
        merges += stats.merges;
        most = stats.active_nodes > most ? stats.active_nodes : most;
        uint32_t open = 0; /* sections by which all GCs together are split */
        for (uint32_t g = 0; g < groom->gc_count; g++) {
            open += groom->info.sections - f->first_split[g];
        }
        CHECK_INT(splits - merges, open);
    }
    CHECK(most > groom->info.coarse_nodes + 100);
    awt_forest_destroy(f);
}

TEST(an_infinite_threshold_never_splits)
{
    const double zero[3] = {0, 0, 0};
    awt_forest *f = fixture_forest(fixture_groom("long", STRANDS), "long", zero, zero);
    awt_params params = awt_forest_params(f);
    CHECK_INT(awt_params_set(&params, "split_threshold", 1e9f, NULL), AWT_OK);
    awt_forest_set_params(f, &params, NULL);
    uint32_t splits = 0;
    for (int n = 1; n <= 400; n++) {
        awt_step_stats stats;
        fixture_advance(f, fixture_clip("lean"), (int64_t)n * AWT_STEP_US, zero, zero, &stats);
        splits += stats.splits;
    }
    CHECK_INT(splits, 0);
    awt_forest_destroy(f);
}

/* What an inactive node held when it was last active must not come back when it is active again. */
TEST(a_wisp_that_opens_again_remembers_nothing_of_its_last_opening)
{
    const double zero[3] = {0, 0, 0};
    const awt_groom *groom = fixture_groom("long", STRANDS);
    awt_forest *clean = fixture_forest(groom, "long", zero, zero), *stale = fixture_forest(groom, "long", zero, zero);
    clean->params.split_contact = clean->params.split_wind = 1;
    stale->params = clean->params;
    float shortest = 1;
    for (int n = 1; n <= 500; n++) {
        for (uint32_t k = 0; k < groom->gc_count * groom->info.sections; k++) {
            uint32_t slot = stale->slot_of_node[k];
            const tree *t = &stale->trees[groom->gc_tree[k / groom->info.sections]];
            bool active = slot >= t->first && slot < t->first + t->count && stale->active_node[slot] == k;
            if (!active) {
                stale->link_length[k] = 7.0f;
                stale->radius[k] = 8.0f;
                stale->agitation[k] = 9.0f;
                stale->position[k] = stale->velocity[k] = stale->acceleration[k] = (vec3){9, 9, 9};
            }
        }
        fixture_advance(clean, fixture_clip("jump"), (int64_t)n * AWT_STEP_US, zero, zero, NULL);
        fixture_advance(stale, fixture_clip("jump"), (int64_t)n * AWT_STEP_US, zero, zero, NULL);
        const tree *first = &clean->trees[0];
        for (uint32_t k = first->first + 1; k < first->first + first->count; k++) {
            float length = clean->link_length[clean->active_node[k]];
            shortest = length < shortest ? length : shortest;
        }
    }
    CHECK_U64(awt_forest_hash(stale), awt_forest_hash(clean));
    CHECK(shortest > 0.001f); /* nor does a node that opens for the first time begin with no link */
    awt_forest_destroy(clean);
    awt_forest_destroy(stale);
}
