/* awt.h: the public face of libawt, the Adaptive Wisp Tree of Bertails, Kim, Cani and Neumann (2003).
 *
 * Reading order: strands (what hair is), groom (the wisp hierarchy built from them, immutable), forest
 * (the moving state of one head), advance (simulate), guides and strands (read the hair back).
 *
 * Conventions, everywhere in this library:
 *   - metres, seconds (times are int64 microseconds), kilograms; right-handed, +Y up, the face looks along +Z;
 *   - quaternions are x y z w and turn head (or body) coordinates into world coordinates;
 *   - the head frame's origin is the centre of the head; at rest head frame and body frame coincide;
 *   - nothing here locks, opens a file, reads a clock or writes a log line. A groom may be read by any number
 *     of threads at once; a forest belongs to one thread at a time;
 *   - the same calls with the same values give the same bits, on any compiler and any thread.
 */
#ifndef AWT_H
#define AWT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- errors ------------------------------------------------------------------------------------------- */

/* Every status of the library with its plain text; the enumeration and awt_status_text come from this list. */
#define AWT_STATUS_LIST(X)                                                                        \
    X(AWT_OK, "no error")                                                                         \
    X(AWT_NO_MEMORY, "not enough memory")                                                         \
    X(AWT_BAD_FORMAT, "not a strand file that awt reads (TressFX .tfx 3.0 or 4.0, cyHair .hair)") \
    X(AWT_TRUNCATED, "the file ends before what its header announces")                            \
    X(AWT_BAD_VALUE, "a number is not finite or outside its range")                               \
    X(AWT_NO_STRANDS, "no usable strand")                                                         \
    X(AWT_LIMIT, "more than the limit allows")                                                    \
    X(AWT_NO_HEAD, "the head cannot be told from the roots: give its centre and radius")          \
    X(AWT_NO_STYLE, "no built-in style of that name")                                             \
    X(AWT_NO_PARAM, "no parameter of that name")                                                  \
    X(AWT_BAD_TIME, "time does not run backwards")                                                \
    X(AWT_OTHER_VERSION, "made by another version of awt")

typedef enum awt_status {
#define AWT_STATUS_ENUM(name, text) name,
    AWT_STATUS_LIST(AWT_STATUS_ENUM)
#undef AWT_STATUS_ENUM
} awt_status;

/* The plain text of a status. Static storage. */
const char *awt_status_text(awt_status status);

/* What went wrong and where, in words for the person who gave the input. The caller owns it; functions that
 * take one accept NULL and write it only when they fail. */
typedef struct awt_error {
    awt_status status;
    char text[240];
} awt_error;

/* ---- limits: every size that input can ask for, in one place ------------------------------------------- */

enum {
    AWT_MAX_STRANDS = 200000,          /* strands of a groom */
    AWT_MAX_POINTS_PER_STRAND = 256,   /* points of a strand, in a file and out */
    AWT_MAX_POINTS = 16 * 1000 * 1000, /* points of a groom, all strands together */
    AWT_MAX_LEVELS = 4,                /* levels of the wisp hierarchy */
    AWT_MAX_SECTIONS = 64,             /* cross-sections of a generalised cylinder */
    AWT_MAX_NODES = 1000 * 1000,       /* nodes of the finest level of a groom */
    AWT_MAX_COLLIDERS = 16,            /* obstacles of a forest */
    AWT_MAX_QUEUED_POSES = 256         /* poses given ahead of the simulated time */
};

/* ---- strands: polylines, as a file or a built-in style gives them ---------------------------------------- */

typedef struct awt_strands {
    uint32_t strand_count;
    uint32_t point_count;   /* of all strands together */
    uint32_t *first_point;  /* [strand_count + 1], the points of strand s are first_point[s] .. first_point[s+1]-1 */
    float *positions;       /* [point_count][3], root to tip */
    uint32_t skipped_count; /* strands left out: zero length, or fewer than two distinct points */
    uint32_t *file_strand;  /* [strand_count], rising: which strand of the file each one is; NULL: all are there */
    float colour[3];        /* of all the hair, linear, each 0 .. 1; all 0: the file names none */
} awt_strands;

/* Reads a strand file (format recognised by its content, DATA.md). `out` is written on success only and then
 * owns heap memory: awt_strands_fini. Positions stay in the file's units and axes.
 * AWT_BAD_FORMAT, AWT_TRUNCATED, AWT_BAD_VALUE, AWT_LIMIT, AWT_NO_STRANDS, AWT_NO_MEMORY. */
awt_status awt_strands_read(const void *bytes, size_t size, awt_strands *out, awt_error *error);

/* Frees what a read or a style made; accepts a zeroed object. */
void awt_strands_fini(awt_strands *strands);

/* A hierarchy that comes with the strands (§2.1: the modeller's): which wisp each strand belongs to, level by level.
 * The numbers only say which strands belong together; strands that share a wisp share one at every coarser level. */
typedef struct awt_hierarchy {
    uint32_t levels; /* 1 .. AWT_MAX_LEVELS */
    uint32_t
        strand_count; /* of the file: those that awt_strands_read leaves out count, though their rows say nothing */
    uint32_t *wisps;  /* [strand_count][levels], coarsest level first, any numbers */
} awt_hierarchy;

/* Reads a hierarchy file: text with one line a strand, in the strand file's order, of as many whole numbers as there
 * are levels, with spaces, tabs, commas or semicolons between; empty lines and what follows a # are passed over. `out`
 * is written on success only and then owns heap memory: awt_hierarchy_fini. Whether it fits the strands shows in
 * awt_groom_build. AWT_BAD_VALUE (the text names the line), AWT_LIMIT, AWT_NO_MEMORY. */
awt_status awt_hierarchy_read(const void *bytes, size_t size, awt_hierarchy *out, awt_error *error);

/* Frees what a read made; accepts a zeroed object. */
void awt_hierarchy_fini(awt_hierarchy *hierarchy);

typedef enum awt_up_axis { AWT_UP_GUESS, AWT_UP_Y, AWT_UP_Z } awt_up_axis;

/* Where a file's strands stand: what the caller knows of it, and, after awt_strands_place, what was taken. */
typedef struct awt_placement {
    double scale;                                 /* metres per file unit; 0: guess */
    awt_up_axis up;                               /* AWT_UP_GUESS: guess */
    double head_centre[3];                        /* file units and axes; read only if head_radius > 0 */
    double head_radius;                           /* file units; 0: guess from the roots */
    bool guessed_scale, guessed_up, guessed_head; /* written by awt_strands_place */
    double head_radius_m;                         /* written by awt_strands_place: the radius in metres after scaling */
    double turned_degrees;                        /* written by awt_strands_place: 0, 90, -90 or 180; see there */
} awt_placement;

/* Brings strands from a file's units and axes into the head frame (metres, +Y up, origin at the head's
 * centre), in place, guessing what `placement` leaves open and writing into it what was taken. Z up becomes Y up by
 * (x, y, z) -> (x, z, -y); unless up and head are both given, the strands are then turned about +Y by
 * `turned_degrees` so that the side where no hair grows, the face, looks along +Z, if the roots show that side clearly.
 * On an error strands and placement are unchanged. AWT_NO_HEAD where the roots do not show a head (a ponytail, fur);
 * AWT_BAD_VALUE, AWT_NO_STRANDS, AWT_NO_MEMORY. */
awt_status awt_strands_place(awt_strands *strands, awt_placement *placement, awt_error *error);

/* ---- parameters -------------------------------------------------------------------------------------------- */

/* name, default, least, greatest, unit, meaning. struct awt_params, the checks and the names users type all
 * come from this list. Sources: the paper's §§ and PHYSICS.md's table. */
#define AWT_PARAM_LIST(X)                                                                                              \
    X(split_threshold, 0.30f, 0.0f, 1e9f, "m2/s2", "AWT 3.1: a node splits where |a| * radius exceeds this")           \
    X(split_hysteresis, 0.7f, 0.0f, 1.0f, "", "merge only where |a| * radius is under this share of the threshold")    \
    X(split_contact, 0.0f, 0.0f, 10.0f, "",                                                                            \
      "AWT 5.3: weight of what contacts between wisps do to a node, beside |a|; 0: none")                              \
    X(split_wind, 0.0f, 0.0f, 10.0f, "",                                                                               \
      "AWT 5.3: weight of gusts and of motion through the air, beside |a|; 0: none")                                   \
    X(merge_velocity, 0.15f, 0.0f, 100.0f, "m/s", "AWT 3.2: greatest relative speed of nodes that merge")              \
    X(merge_slack, 1.5f, 1.0f, 100.0f, "", "AWT 3.2: nodes merge within this many radii of their super-node")          \
    X(residence, 0.08f, 0.0f, 10.0f, "s", "least time between two events of one wisp")                                 \
    X(split_budget, 0.0f, 0.0f, 1e6f, "",                                                                              \
      "most splits of the whole head in a step, rounded up; what is left over splits in the next ones; 0: no limit")   \
    X(acceleration_tau, 0.040f, 0.0f, 1.0f, "s", "time constant of the filtered acceleration")                         \
    X(offset_relaxation, 1.5f, 0.0f, 1000.0f, "s",                                                                     \
      "merged offsets return to rest with this time constant; 0: frozen (AWT 3.2)")                                    \
    X(length_relaxation, 0.15f, 0.001f, 10.0f, "s",                                                                    \
      "link lengths changed by an event return to rest with this time constant")                                       \
    X(style_omega, 15.0f, 0.0f, 100.0f, "rad/s", "style spring towards the rest shape; 0: none")                       \
    X(style_damping, 0.8f, 0.0f, 10.0f, "", "damping ratio of the style spring")                                       \
    X(rest_gravity, 1.0f, 0.0f, 1.0f, "", "share of gravity that the rest shape already carries")                      \
    X(drag, 0.6f, 0.0f, 100.0f, "1/s", "drag towards the air, which moves with the head plus the wind")                \
    X(gravity_x, 0.0f, -100.0f, 100.0f, "m/s2", "gravity, world axes")                                                 \
    X(gravity_y, -9.81f, -100.0f, 100.0f, "m/s2", "gravity, world axes")                                               \
    X(gravity_z, 0.0f, -100.0f, 100.0f, "m/s2", "gravity, world axes")                                                 \
    X(wind_x, 0.0f, -100.0f, 100.0f, "m/s", "wind relative to the head's own motion, world axes")                      \
    X(wind_y, 0.0f, -100.0f, 100.0f, "m/s", "wind relative to the head's own motion, world axes")                      \
    X(wind_z, 0.0f, -100.0f, 100.0f, "m/s", "wind relative to the head's own motion, world axes")                      \
    X(wind_gust, 0.0f, 0.0f, 10.0f, "", "strongest gust, as a share of the wind; gusts travel with it; 0: none")       \
    X(gust_period, 3.0f, 0.1f, 600.0f, "s", "gusts: time from one to the next, roughly")                               \
    X(speed_limit, 20.0f, 0.1f, 1000.0f, "m/s", "nodes never move faster than this relative to the head")              \
    X(settling, 5.0f, 0.0f, 1000.0f, "1/s2",                                                                           \
      "drag that comes up once head and obstacles have been still for 1.5 s; 0: none")                                 \
    X(links, 0.0f, 0.0f, 1.0f, "", "AWT 2.3: 0 rigid links, 1 viscous springs")                                        \
    X(link_omega, 400.0f, 1.0f, 2000.0f, "rad/s", "spring links: frequency under the mass that hangs on each")         \
    X(link_damping, 0.8f, 0.0f, 10.0f, "", "spring links: damping ratio")                                              \
    X(strain_limit, 0.2f, 0.0f, 1.0f, "", "spring links: never stretched or shortened by more than this share")        \
    X(link_iterations, 2.0f, 1.0f, 16.0f, "", "AWT 2.3: rounds of the exact rigid-link projection in a step")          \
    X(contact, 1.0f, 0.0f, 1.0f, "", "AWT 4: 1 lets wisps touch each other, 0 does not")                               \
    X(contact_packing, 1.0f, 0.0f, 1.0f, "",                                                                           \
      "0: wisps touch with all of their radius (AWT 4.1); 1: with what their neighbours at rest leave room for")       \
    X(friction_alpha, 30.0f, 0.0f, 1000.0f, "1/s", "AWT 4.2 (1): friction between wisps, k_f = alpha * mass")          \
    X(repulsion_omega, 30.0f, 0.0f, 300.0f, "rad/s", "AWT 4.2 (2): repulsion of crossing wisps, k_r = omega^2 * mass") \
    X(contact_angle, 35.0f, 0.0f, 90.0f, "deg",                                                                        \
      "AWT 4.2: wisps that cross at a greater angle than this repel each other")                                       \
    X(obstacle_slip, 0.0f, 0.0f, 1.0f, "",                                                                             \
      "share of its motion along an obstacle that hair keeps there; 0: it takes the obstacle's velocity (AWT 4.3)")    \
    X(relative_motion, 0.01f, 0.0f, 10.0f, "m/s", "AWT 4.1: wisps slower than this against each other do not touch")

typedef struct awt_params {
#define AWT_PARAM_FIELD(name, value, least, greatest, unit, text) float name;
    AWT_PARAM_LIST(AWT_PARAM_FIELD)
#undef AWT_PARAM_FIELD
} awt_params;

typedef struct awt_param_info {
    const char *name, *unit, *text;
    float value, least, greatest; /* value: the default */
} awt_param_info;

/* The defaults of AWT_PARAM_LIST. */
awt_params awt_params_default(void);
size_t awt_param_count(void);
/* Parameter `index` < awt_param_count(), in the list's order. Static storage. */
const awt_param_info *awt_param_at(size_t index);
/* Sets one parameter by name. AWT_NO_PARAM, AWT_BAD_VALUE (not finite or out of range); `params` unchanged then. */
awt_status awt_params_set(awt_params *params, const char *name, float value, awt_error *error);

/* ---- built-in styles ------------------------------------------------------------------------------------------ */

typedef struct awt_style {
    const char *name;           /* what users type: "short", "short-curly", "long", "long-curly" */
    const char *description;    /* one line */
    uint32_t levels;            /* L of the paper's table (§5.2) */
    uint32_t sections;          /* M: cross-sections of each generalised cylinder */
    uint32_t finest_wisps;      /* generalised cylinders of the finest level: N = finest_wisps * sections */
    uint32_t top_wisps;         /* trees */
    uint32_t points_per_strand; /* enough to draw a curl round */
    awt_params params;
} awt_style;

enum { AWT_DEFAULT_STRANDS = 10000 }; /* §5.1: "about 10,000 individual hair strands" */

size_t awt_style_count(void);
/* Style `index` < awt_style_count(). Static storage. */
const awt_style *awt_style_at(size_t index);
/* NULL if there is none of that name. Static storage. */
const awt_style *awt_style_find(const char *name);

/* Grows the strands of a built-in style on a head of AWT_HEAD_RADIUS_M, in the head frame. `out` as for
 * awt_strands_read; the same seed gives the same bits. AWT_NO_STYLE (a name of no built-in style), AWT_NO_STRANDS (0
 * are asked for), AWT_LIMIT, AWT_NO_MEMORY. */
awt_status awt_style_grow(const awt_style *style, uint32_t strand_count, uint64_t seed, awt_strands *out,
                          awt_error *error);

/* ---- groom: strands and the hierarchy of generalised cylinders above them (§2.1), immutable ---------------------- */

typedef struct awt_groom awt_groom;

#define AWT_HEAD_RADIUS_M 0.095

typedef struct awt_groom_def {
    uint32_t levels;            /* L, 1 .. AWT_MAX_LEVELS */
    uint32_t sections;          /* M, 2 .. AWT_MAX_SECTIONS; 0: chosen from the strands */
    uint32_t finest_wisps;      /* 0: chosen from the number of strands */
    uint32_t top_wisps;         /* 0: chosen from finest_wisps and levels */
    uint32_t points_per_strand; /* of the strands that come out; 0: as many as the strands have */
    double head_radius_m;       /* collision and quantisation; the head is a sphere about the origin */
    /* NULL: built from the strands. Else only read while building; it gives levels, finest_wisps and top_wisps, which
     * are then not looked at. */
    const awt_hierarchy *hierarchy;
} awt_groom_def;

/* levels 3, head AWT_HEAD_RADIUS_M, the rest chosen. */
awt_groom_def awt_groom_def_default(void);
/* What a style asks for. */
awt_groom_def awt_groom_def_of_style(const awt_style *style);

typedef struct awt_groom_info {
    uint32_t strand_count, points_per_strand;
    uint32_t levels, sections;
    uint32_t wisp_count[AWT_MAX_LEVELS]; /* generalised cylinders of each level, coarsest first */
    uint32_t coarse_nodes, finest_nodes; /* nodes of the first and the last level */
    double mass_kg;
    double head_radius_m;
    double longest_strand_m, median_strand_m;
    double mean_radius_m[AWT_MAX_LEVELS];
    float box_min[3], box_max[3]; /* head frame: no point of a strand ever leaves it (CONTRACT.md, Geometry) */
    float colour[3];              /* the strands' */
    size_t bytes;                 /* memory held */
} awt_groom_info;

/* Builds the hierarchy: clusters strands by root place and shape into top-level wisps, refines them into
 * `levels` levels, moves every super-GC to the centre-of-mass curve of its sub-GCs and fits its radius.
 * With def->hierarchy the wisps are those of the hierarchy, in the order in which each one's first strand comes, inside
 * the wisp above; one that is not nested, or not of these strands, is AWT_BAD_VALUE, with strand and level in the text.
 * `strands` is in the head frame and is only read. `progress` (may be NULL) hears shares from 0 to 1, in even time.
 * The caller owns *out: awt_groom_destroy, after every forest on it.
 * AWT_NO_STRANDS, AWT_BAD_VALUE, AWT_LIMIT, AWT_NO_MEMORY; *out is then NULL. */
awt_status awt_groom_build(const awt_strands *strands, const awt_groom_def *def,
                           void (*progress)(void *context, double share), void *context, awt_groom **out,
                           awt_error *error);
void awt_groom_destroy(awt_groom *groom);
void awt_groom_get_info(const awt_groom *groom, awt_groom_info *info);

/* How far the strands at rest, as awt_groom_strands gives them, are from those that awt_groom_build was given. A strand
 * of points_per_strand points is compared point for point; of another, each of its points with the nearest place on the
 * way that came of it. */
typedef struct awt_rebuilt {
    bool known;           /* false of a groom from a snapshot: what it was built from is not there */
    double max_m, mean_m; /* over all points of the strands given */
} awt_rebuilt;

/* Measured by awt_groom_build. */
awt_rebuilt awt_groom_rebuilt(const awt_groom *groom);

/* ---- motion
 * ---------------------------------------------------------------------------------------------------------- */

/* A rigid motion into the world. */
typedef struct awt_pose {
    double position[3];
    double orientation[4]; /* x y z w, of length 1 to 1e-3; normalised on entry */
} awt_pose;

typedef enum awt_frame { AWT_FRAME_HEAD, AWT_FRAME_BODY, AWT_FRAME_OWN } awt_frame;

/* A sphere (a == b, radii equal) or a tapered capsule, in the coordinates of its frame. */
typedef struct awt_collider {
    uint32_t id;
    awt_frame frame;
    float a[3], b[3];
    float radius_a, radius_b;
} awt_collider;

/* Fills `out` with a head and body of the given head radius (cranium, jaw, neck, shoulders, chest) and
 * returns how many, at most AWT_MAX_COLLIDERS. */
uint32_t awt_colliders_default(double head_radius_m, awt_collider out[AWT_MAX_COLLIDERS]);

/* Simulated time goes this far to either side of 0: about 30 years, exact in a double. */
#define AWT_MAX_TIME_US INT64_C(1000000000000000)

/* All poses of one instant. */
typedef struct awt_motion {
    int64_t time_us;
    awt_pose head, body;
    bool teleport;           /* the state is carried rigidly to this pose (CONTRACT.md) */
    uint32_t collider_count; /* poses of AWT_FRAME_OWN colliders; one left out stays where it was */
    struct {
        uint32_t id;
        awt_pose pose;
    } colliders[AWT_MAX_COLLIDERS];
} awt_motion;

/* ---- forest: one head of hair in motion, one AWT per top-level wisp (§2.3)
 * ---------------------------------------------- */

typedef struct awt_forest awt_forest;

typedef struct awt_forest_def {
    awt_params params;
    uint32_t collider_count;
    awt_collider colliders[AWT_MAX_COLLIDERS];
    awt_motion start; /* time and poses at which the hair is at rest */
} awt_forest_def;

/* Default parameters with a style_omega that suits the length of its segments, identity poses at time 0, and the
 * default head and body of the groom's head radius; the head alone where the groom grows beyond the head (a mane, fur):
 * every root rides the head, and the body would move through its own hair. */
awt_forest_def awt_forest_def_default(const awt_groom *groom);

/* `groom` is shared and must outlive the forest. All memory is taken here; nothing later allocates.
 * AWT_BAD_VALUE, AWT_NO_MEMORY; *out is then NULL. */
awt_status awt_forest_create(const awt_groom *groom, const awt_forest_def *def, awt_forest **out, awt_error *error);
void awt_forest_destroy(awt_forest *forest);

/* Gives the poses of an instant later than any given before. Between two instants the motion is a causal
 * Hermite curve; after the last one the head holds still. AWT_BAD_TIME, AWT_BAD_VALUE, AWT_LIMIT (too many
 * poses wait for awt_forest_advance); the forest is unchanged then. */
awt_status awt_forest_move(awt_forest *forest, const awt_motion *motion, awt_error *error);

/* Replaces all parameters, from the next step on. AWT_BAD_VALUE; the forest is unchanged then. */
awt_status awt_forest_set_params(awt_forest *forest, const awt_params *params, awt_error *error);
awt_params awt_forest_params(const awt_forest *forest);
/* Copies the obstacles into `out`; how many there are. */
uint32_t awt_forest_colliders(const awt_forest *forest, awt_collider out[AWT_MAX_COLLIDERS]);

/* What happened in one awt_forest_advance, and the state after it. */
typedef struct awt_step_stats {
    int64_t time_us;
    uint32_t steps;
    uint32_t active_nodes;       /* of all trees, roots included */
    uint32_t asleep_trees;       /* trees at rest that cost nothing (they wake when something moves) */
    uint32_t splits, merges;     /* nodes split into their sub-nodes, sets of sub-nodes merged */
    uint32_t unreached_contacts; /* nodes that their link kept inside an obstacle (AWT 4.3, PHYSICS.md 7) */
    uint32_t clamped_speeds;
    uint32_t contacts;          /* pairs of wisp segments in contact (AWT 4.1), summed over the steps */
    uint32_t contacts_left_out; /* of these, those beyond the room for them, which had no effect */
    float link_error;           /* greatest |length - target| / target after the exact pass; links from 5 mm */
    float kinetic_energy_j;     /* relative to the head */
} awt_step_stats;

/* Longest time one awt_forest_advance goes: 60 s. */
#define AWT_MAX_ADVANCE_US INT64_C(60000000)
/* Longest sub-step: a request of T runs ceil(T / 10 ms) equal ones, landing exactly on `time_us`. */
#define AWT_STEP_US INT64_C(10000)

/* Simulates to `time_us` (no work if it is the forest's time already). Never allocates.
 * AWT_BAD_TIME (earlier than the forest's time), AWT_LIMIT (too far ahead). `stats` may be NULL. */
awt_status awt_forest_advance(awt_forest *forest, int64_t time_us, awt_step_stats *stats, awt_error *error);

/* Passes over the time to `time_us` without simulating it: what a machine that cannot keep up leaves out. The head goes
 * where its poses say, and the hair rides along as a solid. AWT_BAD_TIME (earlier than the forest's time). */
awt_status awt_forest_skip(awt_forest *forest, int64_t time_us, awt_error *error);

int64_t awt_forest_time(const awt_forest *forest);
/* The head's pose at the forest's time. */
awt_pose awt_forest_head(const awt_forest *forest);
const awt_groom *awt_forest_groom(const awt_forest *forest);
size_t awt_forest_bytes(const awt_forest *forest);

/* Hash of the whole simulation state: equal inputs give equal hashes (PHYSICS.md, invariant 11). */
uint64_t awt_forest_hash(const awt_forest *forest);

/* ---- exact state: snapshots and recordings ----------------------------------------------------------------------- */

/* Goes up whenever the same inputs give other bits than before, or the state holds more than before. */
#define AWT_PHYSICS_VERSION 5

/* Writes everything that the forest's future depends on, its groom included: restored, in another process or on
 * another machine, it goes on to the bit as if it had never stopped, poses that wait included. *size is always set to
 * the bytes needed; with `bytes` NULL nothing else happens. AWT_LIMIT where `capacity` is less. */
awt_status awt_forest_snapshot(const awt_forest *forest, void *bytes, size_t capacity, size_t *size, awt_error *error);

/* Makes the groom and the forest of a snapshot; the caller owns both and destroys the forest first. The bytes may come
 * from anywhere: whatever awt_forest_snapshot could not have written is refused, with memory in proportion to `size`.
 * AWT_BAD_FORMAT (not a snapshot), AWT_TRUNCATED, AWT_BAD_VALUE (damaged), AWT_OTHER_VERSION (of the physics:
 * awt_snapshot_read_groom still reads it; or of the format), AWT_LIMIT, AWT_NO_MEMORY. *groom and *forest are NULL
 * then. */
awt_status awt_snapshot_restore(const void *bytes, size_t size, awt_groom **groom, awt_forest **forest,
                                awt_error *error);

/* The groom and the parameters alone, from a snapshot of any physics version: parameters that this version has not are
 * passed over, those that the snapshot has not keep their defaults. Errors as above; *groom is NULL then and `params`
 * unchanged. */
awt_status awt_snapshot_read_groom(const void *bytes, size_t size, awt_groom **groom, awt_params *params,
                                   awt_error *error);

/* A recording is a snapshot of the start and every input after it, with the state's hash after each advance. The
 * recorder is the caller's; it holds no memory and writes nothing but through `write`, once for each record. */
typedef struct awt_recorder {
    awt_forest *forest;
    void (*write)(void *context, const void *bytes, size_t size);
    void *context;
} awt_recorder;

/* Begins a recording: writes the snapshot of the forest as it stands. From then on the forest is driven through the
 * recorder. AWT_NO_MEMORY; nothing is written then. */
awt_status awt_recorder_begin(awt_recorder *recorder, awt_error *error);
/* awt_forest_move, awt_forest_set_params, awt_forest_advance and awt_forest_skip, written down where they succeed. */
awt_status awt_recorder_move(awt_recorder *recorder, const awt_motion *motion, awt_error *error);
awt_status awt_recorder_set_params(awt_recorder *recorder, const awt_params *params, awt_error *error);
awt_status awt_recorder_advance(awt_recorder *recorder, int64_t time_us, awt_step_stats *stats, awt_error *error);
awt_status awt_recorder_skip(awt_recorder *recorder, int64_t time_us, awt_error *error);

typedef struct awt_replay awt_replay;

/* Begins to run a recording again from its start. `bytes` stays the caller's until awt_replay_destroy. Errors as
 * awt_snapshot_restore; *out is NULL then. */
awt_status awt_replay_create(const void *bytes, size_t size, awt_replay **out, awt_error *error);
/* Runs the recording through its next advance and compares the hash. *more is false at the end, where nothing ran.
 * One call runs at most AWT_MAX_ADVANCE_US of simulated time: a caller that does not trust the recording can stop
 * between calls. AWT_BAD_VALUE (another hash, with the number of the step in the text, or a damaged record),
 * AWT_TRUNCATED (it ends within a record: whoever wrote it was stopped), what an input was refused for. */
awt_status awt_replay_next(awt_replay *replay, bool *more, awt_error *error);
/* The forest as it stands; the replay's own. */
const awt_forest *awt_replay_forest(const awt_replay *replay);
/* Advances that ran and had the recorded hash. */
uint64_t awt_replay_steps(const awt_replay *replay);
void awt_replay_destroy(awt_replay *replay);

/* ---- reading the hair back
 * -------------------------------------------------------------------------------------------- */

/* Finest-level cross-sections, active or not (§3.3), in the head frame:
 * centres [finest_nodes][3], frames [finest_nodes][4] (section frame to head frame; e_y along the wisp). */
void awt_forest_guides(const awt_forest *forest, float *centres, float *frames);
/* The same for the sections under the top-level wisps that wisps [wisp_count[0]] names; the others stay as they are. */
void awt_forest_guides_of(const awt_forest *forest, const bool *wisps, float *centres, float *frames);

/* What moved: sub-steps that the forest has made since it was created or restored, and moved [wisp_count[0]]: has
 * anything of a top-level wisp moved in the head frame after sub-step number `since`? What sleeps moves only while its
 * offsets relax. Returns how many moved. */
uint64_t awt_forest_sub_steps(const awt_forest *forest);
uint32_t awt_forest_moved(const awt_forest *forest, uint64_t since, bool *moved);

/* One active node of an AWT (§2.3). */
typedef struct awt_node {
    float position[3]; /* head frame */
    float radius_m;
    uint32_t level;  /* of its wisp, 0: coarsest */
    uint32_t parent; /* number in the list, below its own; of a root: its own */
} awt_node;

/* The active nodes of all trees, tree by tree, into `out`, which has room for finest_nodes: there are never more.
 * Returns how many. */
uint32_t awt_forest_nodes(const awt_forest *forest, awt_node *out);

/* Strand points [strand_count][points_per_strand][3] in the head frame, from the guides of the same groom.
 * `scratch` holds awt_groom_strand_scratch(groom) floats. */
void awt_groom_strands(const awt_groom *groom, const float *centres, const float *frames, float *scratch,
                       float *points);
/* The same for strands under the top-level wisps that wisps [wisp_count[0]] names; the others stay as they are. */
void awt_groom_strands_of(const awt_groom *groom, const bool *wisps, const float *centres, const float *frames,
                          float *scratch, float *points);
size_t awt_groom_strand_scratch(const awt_groom *groom);

#ifdef __cplusplus
}
#endif

#endif
