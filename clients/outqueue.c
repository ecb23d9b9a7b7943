/* outqueue.c: see outqueue.h. */
#include "outqueue.h"

#include <stdlib.h>
#include <string.h>

enum { FIRST_CAPACITY = 1024, KEPT_CAPACITY = 64 << 10 };

void outqueue_fini(outqueue *queue)
{
    free(queue->bytes);
    *queue = (outqueue){.bytes = NULL};
}

unsigned char *outqueue_room(outqueue *queue, size_t size)
{
    if (queue->start > 0 && queue->capacity - queue->end < size) {
        memmove(queue->bytes, queue->bytes + queue->start, queue->end - queue->start);
        queue->end -= queue->start;
        queue->start = 0;
    }
    if (queue->capacity - queue->end < size) {
        size_t capacity = queue->capacity > 0 ? queue->capacity : FIRST_CAPACITY;
        while (capacity - queue->end < size) {
            capacity *= 2;
        }
        unsigned char *larger = realloc(queue->bytes, capacity);
        if (!larger) {
            return NULL;
        }
        queue->bytes = larger;
        queue->capacity = capacity;
    }
    return queue->bytes + queue->end;
}

void outqueue_filled(outqueue *queue, size_t size)
{
    queue->end += size;
}

size_t outqueue_size(const outqueue *queue)
{
    return queue->end - queue->start;
}

const unsigned char *outqueue_front(const outqueue *queue, size_t *size)
{
    *size = queue->end - queue->start;
    return *size > 0 ? queue->bytes + queue->start : NULL;
}

void outqueue_taken(outqueue *queue, size_t size)
{
    queue->start += size;
    if (queue->start < queue->end) {
        return;
    }
    queue->start = queue->end = 0;
    if (queue->capacity > KEPT_CAPACITY) { /* what an upload took is not kept for motion */
        outqueue_fini(queue);
    }
}
