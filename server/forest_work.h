/* forest_work.h: what a worker does with a forest: make it (CREATE), bring it to a time (QUERY) or look at it as it
 * stands, and draw what is wanted of it.
 *
 * A forest_work is wholly the worker's from worker_pool_submit until the job is taken back (registry_take_back), and
 * the service's otherwise; `note` alone is both's. What comes out depends only on the recipe and on the inputs in their
 * order, never on which worker runs it or when. */
#ifndef FOREST_WORK_H
#define FOREST_WORK_H

#include "free_run.h"
#include "groom_cache.h"
#include "keeper.h"
#include "saved.h"
#include "wishes.h"
#include "worker.h"

#include <stdatomic.h>

/* What a worker that makes a forest is at: PROGRESS's `stage`. */
typedef enum forest_stage { FOREST_WAITS, FOREST_STRANDS, FOREST_WISPS, FOREST_DRAWS } forest_stage;

typedef struct forest_work {
    job job;
    atomic_uint note; /* while it is made: how far it has come, see forest_work_stage; written by the worker */

    /* the task; filled in before submitting */
    groom_cache *grooms;   /* never NULL: where the groom is from, and goes */
    const spread *helpers; /* who helps to draw; NULL: nobody */
    recipe *making;        /* CREATE; NULL: the forest is made */
    forest_input *inputs;  /* motions and parameters, and at the end the query that wants them; owned. NULL: no step */
    forest_input *looks;   /* who wants to see what there is then; owned */
    bool runs;             /* by the daemon's clock: `free` is the task, and the inputs have no query behind them */
    free_task free;
    wishes wanted;
    bool wants_binding, wants_state;
    keeper *keeper; /* not NULL: the state is handed to it, with `saving` */
    saved saving;
    uint64_t handle;      /* for FRAME */
    uint64_t sequence;    /* of the forest's present state; a step makes the next one */
    int64_t submitted_us; /* monotonic clock: when the request came */
    picture *spare;       /* a reference: to be drawn into; NULL: a new one is made */

    /* the result; completions.c takes it */
    bool stepped;         /* the forest was made or advanced */
    bool asleep;          /* after its last step nothing of it moves */
    bool kept;            /* the keeper has taken the state */
    picture *drawn;       /* a reference; NULL: nothing was to be drawn, or `error` says why */
    picture *binding;     /* a reference, with the one view PICTURE_BINDING */
    picture *state;       /* likewise PICTURE_STATE */
    awt_error error;      /* why the step failed, where it did */
    awt_error draw_error; /* why a view, or the binding, is missing */
    uint32_t build_us, skipped_strands;
    awt_rebuilt rebuilt;
    uint64_t steps, step_us, encode_us;
    int64_t dropped_us; /* simulated time that was passed over */
    int64_t state_us;   /* the forest's time then: with `runs` up to a step after what is shown */

    /* the hair, NULL until made */
    const made_groom *shared; /* what `groom` is of; NULL: a groom of its own, from a snapshot */
    awt_groom *groom;
    awt_forest *forest;
    awt_groom_info info;
    drawing *draws;
    awt_recorder *recorder;     /* of what moves it while it runs by the daemon's clock; NULL: nobody */
    struct proto_frame figures; /* of the last step */
    int64_t stepped_us;         /* monotonic clock at its end */
} forest_work;

/* The job's function: what the task says. */
void forest_work_run(job *work);

/* What the worker is at, and the share of that which is done. Any thread. */
forest_stage forest_work_stage(forest_work *work, float *share);

/* Frees task, result and hair; accepts a zeroed one. Not while a worker has it. */
void forest_work_fini(forest_work *work);

/* Bytes that the hair holds, without a groom that others may share. */
uint64_t forest_work_bytes(const forest_work *work);

#endif
