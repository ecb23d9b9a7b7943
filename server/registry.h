/* registry.h: the forests that live in the daemon. (turns.h: the order in which they are worked on.)
 *
 * A resident belongs to whoever holds the service's lock, except its `work`, which belongs to a worker while `busy`.
 * Messages that act on it wait in `waiting`, in order, whoever sent them; when it is idle, everything up to and
 * including the first QUERY becomes one job. So a QUERY sees exactly the motions and parameters that came before it,
 * and the result does not depend on how many workers there are. Whoever only wants to see the forest as it stands is
 * answered by the next job, whether it steps or not. A job draws what the forest's subscriptions and those it answers
 * want, and nothing else. */
#ifndef REGISTRY_H
#define REGISTRY_H

#include "accounts.h"
#include "forest_work.h"
#include "handles.h"
#include "load.h"
#include "pose_delay.h"
#include "worker.h"

struct subscription;

enum { REGISTRY_TOKEN_SIZE = 16 };

/* Bytes of the last frame of a form. */
typedef struct form_size {
    uint64_t sequence; /* of that frame; 0: there was none yet */
    size_t bytes;
} form_size;

typedef struct resident {
    uint64_t handle;                  /* 0 once it is doomed */
    struct resident *next, *previous; /* in order of creation */
    uint8_t drive_token[REGISTRY_TOKEN_SIZE], view_token[REGISTRY_TOKEN_SIZE];
    char name[RECIPE_NAME];
    origin creator;         /* whom CREATE is answered to */
    account *account;       /* whose it is */
    bool ready;             /* made; before, nobody but CREATE's answer may touch it */
    bool busy;              /* a worker has `work` */
    bool running;           /* that is a turn by the daemon's clock */
    bool back;              /* the worker is done with it, and its results are being taken */
    bool doomed;            /* ended; freed when the worker hands `work` back */
    bool tells;             /* is being made for someone who wants PROGRESS */
    uint32_t holders;       /* connections, and parked sessions, that have it open (holdings.h) */
    bool keep_due;          /* its state is to be brought to the disk */
    bool keep_lost;         /* the keeper did not get it, or it is not on the disk, or holds no more */
    uint64_t kept_sequence; /* of the state that was handed to the keeper last; 0: none */
    bool restored;          /* it is from the state directory: nobody made it on a connection */
    int64_t left_us;        /* when the last holder left */

    forest_input *waiting, **waiting_end;
    uint32_t waiting_inputs, waiting_queries;
    forest_input *looks; /* FOREST_LATEST, FOREST_BINDING and FOREST_STATE that wait, the latest first */
    uint32_t waiting_looks;
    bool redraw; /* a subscription wants a view that the latest picture lacks */

    sim_clock clock;        /* SET_CLOCK's */
    int64_t state_us;       /* simulated time of the forest, when it was last idle */
    int64_t shown_us;       /* free-running: of its last turn */
    int64_t asked_us;       /* the latest that a QUERY wanted it brought to */
    int64_t moves_until_us; /* free-running: when its last pose is reached */
    pose_delay delay;
    float importance; /* SET_CLOCK's */
    load_meter meter;
    load_measures lowered; /* while there is too much to do */

    /* what MOTION and SET_PARAMS are checked against: as the forest will be once `waiting` is done */
    bool moved;
    uint32_t motion_epoch, motion_sequence;
    int64_t motion_us;
    awt_params params;

    uint64_t sequence;                    /* of the latest picture */
    picture *latest;                      /* a reference */
    picture *binding;                     /* a reference; NULL: nobody has asked for it */
    picture *spare[LIMIT_PICTURES_SPARE]; /* references: earlier pictures, to be drawn into when nobody else has them */
    form_size whole[FORM_COUNT], delta[FORM_COUNT]; /* delta: the largest of that frame's */
    struct subscription *subscriptions;
    uint32_t subscription_count;
    awt_groom_info info;
    uint64_t bytes;                  /* that it holds, when it was last idle */
    bool asleep;                     /* it was then */
    uint64_t form_bytes[FORM_COUNT]; /* of these, what each form takes; it never grows less */

    forest_work work;
} resident;

/* Adds what the subscriptions want of a job: of its step, or of the present state where it `steps` not. */
typedef void registry_wish(const resident *r, bool steps, wishes *out);
/* Between the frames that the subscriptions want of a free-running forest, microseconds; 0: nobody looks. */
typedef int64_t registry_interval(const resident *r);

typedef struct registry {
    handle_table handles;
    resident *first, *last; /* in order of creation; doomed ones too, until they are freed */
    uint32_t alive;         /* doomed ones too: they hold memory */
    uint32_t greatest;
    uint32_t telling;   /* residents that tell */
    uint32_t restoring; /* restored residents that are not ready yet */
    groom_cache *grooms;
    keeper *keeper; /* NULL: nothing is brought to the disk */
    account_book *accounts;
    worker_pool *pool;
    int64_t (*clock_us)(void);
    registry_wish *wish;
    registry_interval *interval_us;
} registry;

typedef struct registry_def {
    uint32_t greatest;         /* forests */
    account_book *accounts;    /* must outlive the registry */
    worker_pool *pool;         /* must outlive every call but registry_fini */
    int64_t (*clock_us)(void); /* monotonic */
    registry_wish *wish;
    registry_interval *interval_us;
} registry_def;

/* False: no memory. */
bool registry_init(registry *reg, const registry_def *def);
/* Frees every resident. After the pool's threads have ended. Accepts a zeroed one. */
void registry_fini(registry *reg);

/* Takes `making` and has a worker make the forest of it, for that account. The result arrives with the job. AWT_LIMIT
 * (too many forests, or as many as the account may have), AWT_NO_MEMORY (or no random bytes); `making` is freed then.
 */
awt_status registry_create(registry *reg, recipe *making, origin from, account *who, int64_t now_us, awt_error *error);

/* Makes a forest again from the state directory, by its own handle and tokens; only before anything else is made.
 * `from` is of the upload's bytes. Errors as above, AWT_BAD_VALUE: its handle is taken or cannot be. */
awt_status registry_restore(registry *reg, const saved *from, upload *file, int64_t now_us, awt_error *error);

/* NULL: no such forest, or it is not made yet. */
resident *registry_find(const registry *reg, uint64_t handle);

/* Ends a resident: its handle is stale at once; it is freed now, or when the worker hands it back. Its subscriptions
 * must have ended. Inputs that still wait are given to the caller, who answers and frees them. */
forest_input *registry_destroy(registry *reg, resident *r);

/* The resident whose job this is, for its results; it stays busy until registry_continue. */
resident *registry_take_back(job *done);
/* After the results are taken: frees the resident if it is doomed, else has its next job run. */
void registry_continue(registry *reg, resident *r);

/* Bytes held by all hair. */
uint64_t registry_bytes(const registry *reg);
/* Forests that are made and not ended. */
uint32_t registry_ready_count(const registry *reg);

#endif
