/* keeper.h: the thread that brings forests to the disk, so that nobody who simulates or serves ever waits for one.
 *
 * Bounded: what waits for a forest is replaced by what is newer of it, and all that waits together has a limit; beyond,
 * the newest is refused and counted, and the next round brings it.
 *
 * What the disk does not take (it is full, the folder is gone) is logged with what to do, and its bytes are freed; the
 * forest is remembered as lost, for the next round to try again. */
#ifndef KEEPER_H
#define KEEPER_H

#include "vault.h"

typedef struct keeper keeper;

typedef struct keeper_counts {
    uint64_t written, removed, failed, refused; /* files; refused: too many bytes waited */
    uint64_t bytes;                             /* written */
    int64_t last_written_us;                    /* monotonic clock; 0: none yet */
    uint32_t waiting;
    uint32_t lost; /* files that are not on the disk, or still there, as they should */
} keeper_counts;

/* Starts the thread. NULL: no memory or no thread. The vault is copied. */
keeper *keeper_create(const vault *v, int64_t (*clock_us)(void));
/* Writes all that waits, ends the thread, frees. Accepts NULL. */
void keeper_destroy(keeper *k);

/* Has the bytes (heap; taken, and freed) written as that forest's file. Any thread, at once. False: they were refused
 * (and freed). */
bool keeper_write(keeper *k, uint64_t handle, unsigned char *bytes, size_t size);
/* Has the forest's file removed, and what waits of it forgotten. */
void keeper_remove(keeper *k, uint64_t handle);

/* Puts the forest's file out of the way (vault_set_aside), now. */
void keeper_set_aside(keeper *k, uint64_t handle);

/* The handle of a forest whose file could not be written or removed, which is forgotten with this call: the caller has
 * it written or removed anew. 0: there is none. Any thread. */
uint64_t keeper_take_lost(keeper *k);

/* Waits until nothing waits. False: something is lost. */
bool keeper_drain(keeper *k);

keeper_counts keeper_count(keeper *k);

#endif
