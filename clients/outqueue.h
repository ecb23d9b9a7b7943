/* outqueue.h: bytes that wait to be sent, in one piece of memory that grows with them. How many may wait is the
 * caller's to say. */
#ifndef CLIENTS_OUTQUEUE_H
#define CLIENTS_OUTQUEUE_H

#include <stddef.h>

/* Zeroed: empty. */
typedef struct outqueue {
    unsigned char *bytes; /* heap; start .. end-1 wait */
    size_t capacity, start, end;
} outqueue;

void outqueue_fini(outqueue *queue);

/* A place for `size` bytes at the end; they belong to the queue after outqueue_filled. NULL: no memory. */
unsigned char *outqueue_room(outqueue *queue, size_t size);
void outqueue_filled(outqueue *queue, size_t size);

size_t outqueue_size(const outqueue *queue);
/* What is to be sent next; *size 0: nothing. */
const unsigned char *outqueue_front(const outqueue *queue, size_t *size);
/* The first `size` bytes have gone. */
void outqueue_taken(outqueue *queue, size_t size);

#endif
