/* schedule.c: see schedule.h. Three binary heaps: steps that are due, by deadline; steps to come, by their time; long
 * jobs, by their coming. */
#include "schedule.h"
#include "base/assert.h"

#include <stdlib.h>

enum {
    AFFINITY_LOOK = 7, /* jobs at the top of the heap among which a worker looks for one of its own */
    AFFINITY_US = 2000 /* by which such a job's deadline may lie behind the earliest */
};

bool schedule_init(schedule *s, uint32_t room)
{
    *s = (schedule){.room = room};
    for (int q = QUEUE_NONE + 1; q < QUEUE_COUNT; q++) {
        s->heaps[q].jobs = calloc(room ? room : 1, sizeof *s->heaps[q].jobs);
        if (!s->heaps[q].jobs) {
            schedule_fini(s);
            return false;
        }
    }
    return true;
}

void schedule_fini(schedule *s)
{
    for (int q = 0; q < QUEUE_COUNT; q++) {
        free(s->heaps[q].jobs);
    }
    *s = (schedule){0};
}

/* ---- one heap ---------------------------------------------------------------------------------------------------- */

static int64_t key_of(const job *work)
{
    return work->queue == QUEUE_READY ? work->deadline_us : work->queue == QUEUE_LATER ? work->not_before_us : 0;
}

static bool is_before(const job *a, const job *b)
{
    const int64_t x = key_of(a), y = key_of(b);
    return x != y ? x < y : a->serial < b->serial;
}

static void put(job_heap *heap, uint32_t place, job *work)
{
    heap->jobs[place] = work;
    work->place = place;
}

/* Lets the job rise, or sink, to its place from the free one at `place`. */
static void settle(job_heap *heap, uint32_t place, job *work)
{
    while (place > 0 && is_before(work, heap->jobs[(place - 1) / 2])) {
        put(heap, place, heap->jobs[(place - 1) / 2]);
        place = (place - 1) / 2;
    }
    for (;;) {
        uint32_t child = 2 * place + 1;
        child += child + 1 < heap->count && is_before(heap->jobs[child + 1], heap->jobs[child]);
        if (child >= heap->count || !is_before(heap->jobs[child], work)) {
            break;
        }
        put(heap, place, heap->jobs[child]);
        place = child;
    }
    put(heap, place, work);
}

static void heap_push(schedule *s, job_queue queue, job *work)
{
    job_heap *heap = &s->heaps[queue];
    ASSERT(heap->count < s->room);
    work->queue = queue;
    settle(heap, heap->count++, work);
}

static job *heap_take(schedule *s, job_queue queue, uint32_t place)
{
    job_heap *heap = &s->heaps[queue];
    job *taken = heap->jobs[place], *last = heap->jobs[--heap->count];
    if (last != taken) {
        settle(heap, place, last);
    }
    taken->queue = QUEUE_NONE;
    return taken;
}

/* ---- the schedule ------------------------------------------------------------------------------------------------ */

void schedule_add(schedule *s, job *work)
{
    ASSERT(work->queue == QUEUE_NONE && work->run);
    work->serial = ++s->serial;
    heap_push(s, work->class == JOB_LONG ? QUEUE_LONG : QUEUE_LATER, work);
}

bool schedule_remove(schedule *s, job *work)
{
    if (work->queue == QUEUE_NONE) {
        return false;
    }
    heap_take(s, work->queue, work->place);
    return true;
}

/* What has become due is sorted by deadline from then on. */
static void ripen(schedule *s, int64_t now_us)
{
    while (schedule_next_us(s) <= now_us) {
        heap_push(s, QUEUE_READY, heap_take(s, QUEUE_LATER, 0));
    }
}

job *schedule_take(schedule *s, int64_t now_us, unsigned worker)
{
    ripen(s, now_us);
    const job_heap *ready = &s->heaps[QUEUE_READY];
    if (ready->count == 0) {
        return NULL;
    }
    uint32_t chosen = 0;
    const int64_t close_us = ready->jobs[0]->deadline_us + AFFINITY_US;
    for (uint32_t i = 0; worker != 0 && i < ready->count && i < AFFINITY_LOOK; i++) {
        const job *own = ready->jobs[i];
        if (own->last_worker == worker && own->deadline_us <= close_us) {
            chosen = i;
            break;
        }
    }
    return heap_take(s, QUEUE_READY, chosen);
}

job *schedule_take_long(schedule *s)
{
    return s->heaps[QUEUE_LONG].count > 0 ? heap_take(s, QUEUE_LONG, 0) : NULL;
}

bool schedule_is_due(const schedule *s, int64_t now_us)
{
    return s->heaps[QUEUE_READY].count > 0 || schedule_next_us(s) <= now_us;
}

int64_t schedule_next_us(const schedule *s)
{
    return s->heaps[QUEUE_LATER].count > 0 ? s->heaps[QUEUE_LATER].jobs[0]->not_before_us : INT64_MAX;
}
