/* handles.c: see handles.h. */
#include "handles.h"
#include "base/assert.h"

#include <stdlib.h>

bool handle_table_init(handle_table *table, uint32_t capacity)
{
    *table = (handle_table){.slots = calloc(capacity, sizeof *table->slots), .capacity = capacity};
    if (!table->slots) {
        return false;
    }
    for (uint32_t i = 0; i < capacity; i++) {
        table->slots[i] = (handle_slot){.generation = 1, .next_free = i + 1};
    }
    return true;
}

void handle_table_fini(handle_table *table)
{
    free(table->slots);
    *table = (handle_table){0};
}

uint64_t handle_add(handle_table *table, void *item)
{
    ASSERT(item);
    uint32_t index = table->first_free;
    if (index >= table->capacity) {
        return 0;
    }
    handle_slot *slot = &table->slots[index];
    table->first_free = slot->next_free;
    slot->item = item;
    return (uint64_t)slot->generation << 32 | index;
}

bool handle_put(handle_table *table, uint64_t handle, void *item)
{
    const uint64_t index = handle & UINT32_MAX;
    ASSERT(item);
    if (index >= table->capacity || handle >> 32 == 0 || table->slots[index].item) {
        return false;
    }
    uint32_t *link = &table->first_free;
    while (*link != index) {
        link = &table->slots[*link].next_free;
    }
    handle_slot *slot = &table->slots[index];
    *link = slot->next_free;
    slot->item = item;
    slot->generation = (uint32_t)(handle >> 32);
    return true;
}

static handle_slot *slot_of(const handle_table *table, uint64_t handle)
{
    uint64_t index = handle & UINT32_MAX;
    if (index >= table->capacity || table->slots[index].generation != handle >> 32) {
        return NULL;
    }
    return &table->slots[index];
}

void *handle_find(const handle_table *table, uint64_t handle)
{
    const handle_slot *slot = slot_of(table, handle);
    return slot ? slot->item : NULL;
}

void *handle_at(const handle_table *table, uint32_t index)
{
    ASSERT(index < table->capacity);
    return table->slots[index].item;
}

void handle_remove(handle_table *table, uint64_t handle)
{
    handle_slot *slot = slot_of(table, handle);
    ASSERT(slot && slot->item);
    slot->item = NULL;
    slot->generation = slot->generation == UINT32_MAX ? 1 : slot->generation + 1;
    slot->next_free = table->first_free;
    table->first_free = (uint32_t)(slot - table->slots);
}
