/* test_schedule.c: which job is next, and that a pool's threads run each once. */
#include "check.h"
#include "clock.h"
#include "worker.h"

#include <stdatomic.h>
#include <time.h>

static void no_run(job *work)
{
    (void)work;
}

static job make(int64_t not_before_us, int64_t deadline_us)
{
    return (job){.run = no_run, .not_before_us = not_before_us, .deadline_us = deadline_us};
}

TEST(schedule_gives_the_earliest_deadline_first)
{
    enum { COUNT = 200 };
    schedule s;
    job jobs[COUNT];
    CHECK(schedule_init(&s, COUNT));
    for (int i = 0; i < COUNT; i++) {
        jobs[i] = make(0, i * 7919 % COUNT / 2); /* every deadline twice, in no order */
        schedule_add(&s, &jobs[i]);
    }
    int64_t deadline_us = -1;
    uint64_t serial = 0;
    for (int i = 0; i < COUNT; i++) {
        job *taken = schedule_take(&s, 0, 0);
        CHECK(taken != NULL);
        if (!taken) {
            break;
        }
        CHECK(taken->deadline_us > deadline_us || (taken->deadline_us == deadline_us && taken->serial > serial));
        deadline_us = taken->deadline_us;
        serial = taken->serial;
    }
    CHECK(schedule_take(&s, 0, 0) == NULL);
    schedule_fini(&s);
}

TEST(schedule_gives_nothing_before_its_time)
{
    schedule s;
    job soon = make(1000, 9000), later = make(2000, 3000), built = make(0, 0);
    built.class = JOB_LONG;
    CHECK(schedule_init(&s, 3));
    schedule_add(&s, &later);
    schedule_add(&s, &soon);
    schedule_add(&s, &built);
    CHECK_INT(schedule_next_us(&s), 1000);
    CHECK(schedule_take(&s, 999, 1) == NULL);
    CHECK(!schedule_is_due(&s, 999));
    CHECK(schedule_is_due(&s, 1000));
    CHECK(schedule_take(&s, 2000, 1) == &later); /* due later, wanted earlier */
    CHECK(schedule_take(&s, 2000, 1) == &soon);
    CHECK(schedule_take(&s, 2000, 1) == NULL); /* a long one is not for those who step */
    CHECK(schedule_take_long(&s) == &built);
    CHECK(schedule_take_long(&s) == NULL);
    schedule_fini(&s);
}

TEST(schedule_lets_a_worker_keep_its_forest_where_deadlines_are_close)
{
    schedule s;
    job other = make(0, 1000), own = make(0, 1500), far = make(0, 900000);
    own.last_worker = far.last_worker = 2;
    other.last_worker = 1;
    CHECK(schedule_init(&s, 3));
    schedule_add(&s, &other);
    schedule_add(&s, &own);
    schedule_add(&s, &far);
    CHECK(schedule_take(&s, 0, 2) == &own);
    CHECK(schedule_take(&s, 0, 2) == &other); /* the far one can wait */
    CHECK(schedule_take(&s, 0, 1) == &far);
    schedule_fini(&s);
}

TEST(schedule_gives_back_what_waits)
{
    enum { COUNT = 20 };
    schedule s;
    job jobs[COUNT];
    CHECK(schedule_init(&s, COUNT));
    for (int i = 0; i < COUNT; i++) {
        jobs[i] = make(i % 3 ? 0 : 100, i * 7 % COUNT);
        schedule_add(&s, &jobs[i]);
    }
    job *first = schedule_take(&s, 0, 0); /* has sorted the others by deadline */
    CHECK(!schedule_remove(&s, first));
    for (int i = 0; i < COUNT; i += 2) {
        CHECK(&jobs[i] == first || schedule_remove(&s, &jobs[i]));
    }
    for (int64_t last = -1, left = first == &jobs[0] ? 10 : 9; left > 0; left--) {
        const job *taken = schedule_take(&s, 100, 0);
        CHECK(taken && (taken - jobs) % 2 == 1 && taken->deadline_us > last);
        last = taken ? taken->deadline_us : last;
    }
    CHECK(schedule_take(&s, 100, 0) == NULL);
    schedule_fini(&s);
}

/* ---- threads ----------------------------------------------------------------------------------------------------- */

enum { JOBS = 60, LONG_JOBS = 3 };

typedef struct run_job {
    job work; /* first */
    atomic_int runs;
    int64_t begun_us;
    atomic_int *let_go; /* NULL, or it waits for that */
} run_job;

static void nobody_waits(void *context)
{
    (void)context;
}

static void pause_ms(void)
{
    nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL);
}

static void run(job *work)
{
    run_job *r = (run_job *)(void *)work;
    r->begun_us = clock_monotonic_us();
    while (r->let_go && !atomic_load(r->let_go)) {
        pause_ms();
    }
    atomic_fetch_add(&r->runs, 1);
}

static void submit(worker_pool *pool, run_job *r, job_class class, int64_t not_before_us)
{
    r->work = (job){.run = run, .class = class, .not_before_us = not_before_us, .deadline_us = not_before_us};
    worker_pool_submit(pool, &r->work);
}

static int take_done(worker_pool *pool)
{
    int count = 0;
    for (const job *done = worker_pool_take_done(pool); done; done = done->next) {
        count++;
    }
    return count;
}

TEST(worker_pool_runs_each_job_once_and_none_before_its_time)
{
    static run_job jobs[JOBS];
    const worker_pool_def def = {.workers = 3, .greatest = JOBS, .clock_us = clock_monotonic_us, .wake = nobody_waits};
    worker_pool *pool = worker_pool_create(&def);
    CHECK(pool != NULL);
    const int64_t now_us = clock_monotonic_us();
    for (int i = 0; i < JOBS; i++) {
        submit(pool, &jobs[i], JOB_STEP, now_us + (JOBS - i) % 7 * 1000); /* the watch is moved to and fro */
    }
    for (int done = 0; done < JOBS; done += take_done(pool)) {
        pause_ms();
    }
    for (int i = 0; i < JOBS; i++) {
        CHECK_INT(atomic_load(&jobs[i].runs), 1);
        CHECK(jobs[i].begun_us >= jobs[i].work.not_before_us && jobs[i].work.ended_us >= jobs[i].begun_us);
    }
    worker_pool_destroy(pool);
}

TEST(worker_pool_steps_while_long_jobs_hold_every_builder)
{
    static run_job built[LONG_JOBS], step, withdrawn;
    atomic_int let_go = 0;
    const worker_pool_def def = {
        .workers = 1, .greatest = LONG_JOBS + 2, .clock_us = clock_monotonic_us, .wake = nobody_waits};
    worker_pool *pool = worker_pool_create(&def);
    CHECK(pool != NULL);
    for (int i = 0; i < LONG_JOBS; i++) {
        built[i].let_go = &let_go;
        submit(pool, &built[i], JOB_LONG, 0);
    }
    submit(pool, &withdrawn, JOB_STEP, clock_monotonic_us() + 3600000000);
    CHECK(worker_pool_withdraw(pool, &withdrawn.work));
    submit(pool, &step, JOB_STEP, 0);
    while (atomic_load(&step.runs) == 0) {
        pause_ms();
    }
    for (int i = 0; i < LONG_JOBS; i++) {
        CHECK_INT(atomic_load(&built[i].runs), 0);
    }
    atomic_store(&let_go, 1);
    for (int done = 0; done < LONG_JOBS + 1; done += take_done(pool)) {
        pause_ms();
    }
    CHECK(!worker_pool_withdraw(pool, &step.work));
    CHECK_INT(atomic_load(&withdrawn.runs), 0);
    worker_pool_destroy(pool);
}
