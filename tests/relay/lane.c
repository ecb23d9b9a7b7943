/* lane.c: see lane.h. */
#include "relay/lane.h"

#include <stdlib.h>

bool lane_init(lane *self, const lane_rules *rules, uint64_t seed)
{
    *self = (lane){.rules = *rules, .random = seed};
    self->capacity = rules->queue / LANE_PIECE > 0 ? rules->queue / LANE_PIECE : 1;
    self->pieces = malloc(self->capacity * sizeof *self->pieces);
    return self->pieces != NULL;
}

void lane_fini(lane *self)
{
    free(self->pieces);
    *self = (lane){.pieces = NULL};
}

/* Uniform in [0, 1): a linear congruential generator's upper bits are enough for jitter. */
static double lane_random(lane *self)
{
    self->random = self->random * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(self->random >> 11) * 0x1p-53;
}

unsigned char *lane_room(lane *self)
{
    return self->count < self->capacity ? self->pieces[(self->first + self->count) % self->capacity].bytes : NULL;
}

void lane_put(lane *self, size_t size, int64_t now_us)
{
    lane_piece *piece = &self->pieces[(self->first + self->count) % self->capacity];
    const int64_t begin_us = self->free_us > now_us ? self->free_us : now_us;
    self->free_us = begin_us + (self->rules.rate > 0 ? (int64_t)((double)size / self->rules.rate * 1e6) : 0);
    const int64_t jitter_us = (int64_t)((double)self->rules.jitter_us * lane_random(self));
    const int64_t due_us = self->free_us + self->rules.delay_us + jitter_us;
    piece->due_us = self->last_due_us = due_us > self->last_due_us ? due_us : self->last_due_us;
    piece->size = (uint32_t)size;
    piece->sent = 0;
    self->count++;
}

const unsigned char *lane_due(const lane *self, int64_t now_us, size_t *size)
{
    const lane_piece *piece = &self->pieces[self->first];
    *size = self->count > 0 && piece->due_us <= now_us ? piece->size - piece->sent : 0;
    return *size > 0 ? piece->bytes + piece->sent : NULL;
}

void lane_sent(lane *self, size_t size)
{
    lane_piece *piece = &self->pieces[self->first];
    piece->sent += (uint32_t)size;
    if (piece->sent == piece->size) {
        self->first = (self->first + 1) % self->capacity;
        self->count--;
    }
}

int64_t lane_next_us(const lane *self)
{
    return self->count > 0 ? self->pieces[self->first].due_us : INT64_MAX;
}
