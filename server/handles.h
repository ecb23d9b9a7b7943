/* handles.h: numbers for things, that go stale when the thing ends.
 *
 * A handle is the slot's index | its generation << 32. Removing raises the generation, so that an old handle finds
 * nothing even when its slot is taken again. No handle is 0. Handles cross threads and the wire; pointers do not. */
#ifndef HANDLES_H
#define HANDLES_H

#include <stdbool.h>
#include <stdint.h>

typedef struct handle_slot {
    void *item;          /* NULL: free */
    uint32_t generation; /* from 1 */
    uint32_t next_free;
} handle_slot;

typedef struct handle_table {
    handle_slot *slots; /* [capacity], heap */
    uint32_t capacity, first_free;
} handle_table;

/* Room for `capacity` things, >= 1. False: no memory. */
bool handle_table_init(handle_table *table, uint32_t capacity);
/* Accepts a zeroed table; the things themselves are the caller's. */
void handle_table_fini(handle_table *table);

/* The handle of `item` (not NULL); 0: the table is full. */
uint64_t handle_add(handle_table *table, void *item);
/* Puts `item` (not NULL) where that handle says, as it was in another run. False: the table has no such place, or it is
 * taken. */
bool handle_put(handle_table *table, uint64_t handle, void *item);
/* NULL: no such handle, or not any more. */
void *handle_find(const handle_table *table, uint64_t handle);
/* What is in place `index` < capacity; NULL: nothing. */
void *handle_at(const handle_table *table, uint32_t index);
/* Of a handle that handle_find knows. */
void handle_remove(handle_table *table, uint64_t handle);

#endif
