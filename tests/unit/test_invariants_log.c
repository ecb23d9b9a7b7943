/* test_invariants_log.c: invariants 1, 2 and 7 on a log of events: what the public face runs, step by step, with
 * contact, is written down and replayed on a set of active nodes that knows nothing of first_split; and every merge
 * takes the energy that its formula says. */
#include "check.h"
#include "fixture.h"
#include "invariant_fixture.h"

#include "base/assert.h"
#include "sim/adapt.h"

#include <stdlib.h>
#include <string.h>

/* ---- the log and its replay (invariants 1 and 7) ----------------------------------------------------------------- */

typedef struct event {
    uint32_t gc, section;
    bool split; /* or merge */
} event;

/* A replay: the active set, by node, and what was wrong with the log. */
typedef struct replay {
    const awt_groom *groom;
    bool *active;      /* [nodes] */
    uint32_t *deepest; /* [gcs]; section of the split nearest to the root; the number of sections where there is none */
    uint32_t impossible, not_from_tip, not_from_root;
} replay;

static replay replay_begin(const awt_groom *groom)
{
    replay r = {.groom = groom};
    const uint32_t sections = groom->info.sections;
    r.active = calloc((size_t)groom->gc_count * sections, sizeof *r.active);
    r.deepest = calloc(groom->gc_count, sizeof *r.deepest);
    ASSERT(r.active && r.deepest);
    for (uint32_t g = 0; g < groom->gc_count; g++) {
        r.deepest[g] = sections;
        for (uint32_t i = 0; i < sections; i++) {
            r.active[g * sections + i] = groom->gc_super[g] == g; /* §2.3: only the coarsest at first */
        }
    }
    return r;
}

static void replay_fini(replay *r)
{
    free(r->active), free(r->deepest);
}

/* Replaces the node by its sub-nodes, or these by it; all that is replaced has to be active. */
static void replay_run(replay *r, const event *e)
{
    const awt_groom *groom = r->groom;
    const uint32_t sections = groom->info.sections, first = groom->gc_sub_first[e->gc];
    uint32_t node = e->gc * sections + e->section;
    r->impossible += r->active[node] != e->split;
    r->active[node] = !e->split;
    for (uint32_t s = first; s < first + groom->gc_sub_count[e->gc]; s++) {
        r->impossible += r->active[s * sections + e->section] == e->split;
        r->active[s * sections + e->section] = e->split;
    }
    if (e->split) { /* the tip, or beside what has split already */
        r->not_from_tip += e->section + 1 != r->deepest[e->gc];
        r->deepest[e->gc] = e->section;
    } else {
        r->not_from_root += e->section != r->deepest[e->gc];
        r->deepest[e->gc] = e->section + 1;
    }
}

/* Nodes in which the forest and the set differ. */
static uint32_t replay_differences(const replay *r, const awt_forest *f)
{
    uint32_t in_both = 0, in_set = 0, in_forest = 0;
    for (uint32_t n = 0; n < r->groom->gc_count * r->groom->info.sections; n++) {
        in_set += r->active[n];
    }
    for (uint32_t t = 0; t < r->groom->info.wisp_count[0]; t++) {
        in_forest += f->trees[t].count;
        for (uint32_t k = f->trees[t].first; k < f->trees[t].first + f->trees[t].count; k++) {
            in_both += r->active[f->active_node[k]];
        }
    }
    return in_set + in_forest - 2 * in_both;
}

/* Finest sections that do not have exactly one active ancestor (or themselves). */
static uint32_t replay_ungoverned(const replay *r)
{
    const awt_groom *groom = r->groom;
    const uint32_t sections = groom->info.sections;
    uint32_t wrong = 0;
    for (uint32_t g = groom_finest_first(groom); g < groom->gc_count; g++) {
        for (uint32_t i = 0; i < sections; i++) {
            uint32_t active = r->active[g * sections + i];
            for (uint32_t a = g; groom->gc_super[a] != a; a = groom->gc_super[a]) {
                active += r->active[groom->gc_super[a] * sections + i];
            }
            wrong += active != 1;
        }
    }
    return wrong;
}

/* What one step did, coarse wisps first, as the step did it; returns how many events. `before` is first_split. */
static uint32_t log_step(const awt_forest *f, const uint32_t *before, event *events, uint32_t *odd)
{
    uint32_t count = 0;
    for (uint32_t g = 0; g < f->groom->gc_count; g++) {
        uint32_t now = f->first_split[g];
        bool changed = now != before[g];
        *odd += changed && now + 1 != before[g] && now != before[g] + 1; /* one event a step */
        *odd += changed != (f->event_us[g] == f->time_us);
        if (changed) {
            events[count++] = (event){g, now < before[g] ? now : before[g], now < before[g]};
        }
    }
    return count;
}

/* `weight`: of contact and air in the split measure. */
static void check_log(const char *style, bool contact, float weight)
{
    awt_groom *groom = small_groom(style, 8);
    const uint32_t sections = groom->info.sections;
    awt_params params = small_params(style);
    params.contact = contact ? 1.0f : 0.0f;
    params.split_threshold = 0.15f;
    params.split_contact = params.split_wind = weight;
    awt_forest *f = small_forest(groom, &params);
    replay r = replay_begin(groom);
    uint32_t *before = malloc(groom->gc_count * sizeof *before), splits = 0, merges = 0, odd = 0, under = 0, tips = 0;
    event *events = malloc(groom->gc_count * sizeof *events);
    ASSERT(before && events);
    wild w = wild_make(21, 1.2);
    float worst_link = 0;
    for (int n = 1; n <= 250; n++) {
        memcpy(before, f->first_split, groom->gc_count * sizeof *before);
        awt_step_stats stats;
        if (n <= 120) {
            wild_advance(f, &w, (int64_t)n * AWT_STEP_US, &stats);
        } else { /* held still: merges */
            ASSERT(awt_forest_advance(f, (int64_t)n * AWT_STEP_US, &stats, NULL) == AWT_OK);
        }
        uint32_t count = log_step(f, before, events, &odd), step_splits = 0;
        for (uint32_t k = 0; k < count; k++) {
            replay_run(&r, &events[k]);
            /* what has split keeps the acceleration, agitation and radius with which it did */
            uint32_t node = events[k].gc * sections + events[k].section;
            float measure = (vec3_length(f->acceleration[node]) + f->agitation[node]) * f->radius[node];
            under += events[k].split && !(measure > f->params.split_threshold);
            step_splits += events[k].split;
            tips += events[k].split && events[k].section == sections - 1;
        }
        CHECK_INT(step_splits, stats.splits);
        worst_link = stats.link_error > worst_link ? stats.link_error : worst_link;
        CHECK_INT(count - step_splits, stats.merges);
        CHECK_INT(replay_differences(&r, f), 0);
        CHECK_INT(replay_ungoverned(&r), 0);
        splits += stats.splits;
        merges += stats.merges;
    }
    CHECK(splits > 100);
    CHECK(merges > 100);
    CHECK(tips > 20);
    CHECK_NEAR(worst_link, 0, 1e-5); /* invariant 8: rigid links, whatever touches them */
    CHECK_INT(odd, 0);
    CHECK_INT(under, 0);
    CHECK_INT(r.impossible, 0);
    CHECK_INT(r.not_from_tip, 0);
    CHECK_INT(r.not_from_root, 0);
    replay_fini(&r);
    free(before), free(events);
    awt_forest_destroy(f);
    awt_groom_destroy(groom);
}

TEST(the_log_of_splits_and_merges_replays_to_the_active_set_after_every_step)
{
    check_log("long", false, 0);
    check_log("long", true, 0);
    check_log("long-curly", false, 0);
    check_log("long", true, 1);
}

/* ---- energy and mass (invariant 2) ----------------------------------------------------------------------------------
 */

/* What the merge of the sub-nodes of (g, i) has to take: half the sum of m |v - v_mean|^2. Mass units. */
static double merge_loss(const awt_forest *f, uint32_t g, uint32_t i)
{
    const awt_groom *groom = f->groom;
    double mass = 0, energy = 0;
    dvec3 momentum = {0, 0, 0};
    for (uint32_t s = groom->gc_sub_first[g]; s < groom->gc_sub_first[g] + groom->gc_sub_count[g]; s++) {
        dvec3 v = dvec3_of_vec3(f->velocity[s * groom->info.sections + i]);
        double m = groom->gc_strand_count[s];
        mass += m;
        energy += 0.5 * m * dvec3_dot(v, v);
        momentum = dvec3_add(momentum, dvec3_scale(v, m));
    }
    return energy - 0.5 * dvec3_dot(momentum, momentum) / mass;
}

static double tree_energy(const awt_forest *f, const tree *t, double *mass)
{
    double energy = 0;
    *mass = 0;
    for (uint32_t k = t->first; k < t->first + t->count; k++) {
        dvec3 v = dvec3_of_vec3(f->velocity[f->active_node[k]]);
        energy += 0.5 * (double)f->active_mass[k] * dvec3_dot(v, v);
        *mass += (double)f->active_mass[k];
    }
    return energy;
}

typedef struct ledger {
    uint32_t merges, splits;
    double worst_error, greatest_loss; /* shares of the tree's energy */
    uint32_t lost_mass, raised;
} ledger;

static void ledger_adapt(ledger *l, awt_forest *f, uint32_t t, uint32_t *before)
{
    const awt_groom *groom = f->groom;
    double mass, mass_after, energy = tree_energy(f, &f->trees[t], &mass), loss = 0;
    memcpy(before, f->first_split, groom->gc_count * sizeof *before);
    adapt_counts counts = adapt_tree(f, t, UINT32_MAX);
    if (counts.merges + counts.splits == 0) {
        return;
    }
    for (uint32_t g = 0; g < groom->gc_count; g++) {
        if (groom->gc_tree[g] == t && f->first_split[g] > before[g]) {
            loss += merge_loss(f, g, before[g]); /* merged nodes keep the velocities with which they did */
        }
    }
    double after = tree_energy(f, &f->trees[t], &mass_after), error = fabs(energy - loss - after) / (energy + 1e-12);
    l->merges += counts.merges;
    l->splits += counts.splits;
    l->worst_error = error > l->worst_error ? error : l->worst_error;
    l->greatest_loss = loss / (energy + 1e-12) > l->greatest_loss ? loss / (energy + 1e-12) : l->greatest_loss;
    l->raised += after > energy * (1 + 1e-7);
    l->lost_mass += mass != mass_after || mass != (double)groom->gc_strand_count[t] * groom->info.sections;
}

static void check_ledger(const char *style, const double at[3], const double velocity[3])
{
    awt_groom *groom = small_groom(style, 4);
    awt_forest *f = fixture_forest(groom, style, at, velocity);
    awt_params wanted = small_params(style), held = wanted;
    wanted.merge_velocity = 1.0f; /* so that merges have something to lose */
    wanted.merge_slack = 10.0f;
    wanted.split_threshold = 0.2f;
    held = wanted;
    held.residence = 1e9f; /* nothing adapts by itself */
    uint32_t *before = malloc(groom->gc_count * sizeof *before);
    ASSERT(before);
    ledger l = {0};
    for (int n = 1; n <= 500; n++) {
        f->params = held;
        fixture_advance(f, fixture_clip("lean"), (int64_t)n * AWT_STEP_US, at, velocity, NULL);
        f->params = wanted;
        for (uint32_t t = 0; t < groom->info.wisp_count[0]; t++) {
            ledger_adapt(&l, f, t, before);
        }
    }
    CHECK(l.merges > 100);
    CHECK(l.splits > 100);
    CHECK(l.greatest_loss > 1e-3);
    CHECK_NEAR(l.worst_error, 0, 1e-7);
    CHECK_INT(l.raised, 0);
    CHECK_INT(l.lost_mass, 0);
    free(before);
    awt_forest_destroy(f);
    awt_groom_destroy(groom);
}

TEST(a_merge_takes_the_energy_of_its_formula_and_a_split_none)
{
    static const double home[3] = {0, 0, 0}, still[3] = {0, 0, 0}, fast[3] = {10, 0, 0}, far_away[3] = {1e5, 0, -1e5};
    check_ledger("long", home, still);
    check_ledger("long-curly", home, fast);
    check_ledger("long", far_away, still);
}
