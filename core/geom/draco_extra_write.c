/* draco_extra_write.c: draco_extra_add (draco_extra.h). */
#include "geom/draco_extra.h"

#include "base/bytes.h"
#include "base/error.h"

#include <stdlib.h>

enum { ALPHABET = 1 << DRACO_EXTRA_BITS, MOST_COMPONENTS = 2 };

/* Working memory of one attribute's symbols. */
typedef struct extra_memory {
    uint16_t *symbols; /* [MOST_COMPONENTS * vertices] */
    uint32_t *counts;  /* [4][ALPHABET] */
    uint16_t *used;    /* [ALPHABET] */
    rans_entry *entries;
    unsigned char *coded; /* [symbols_bound] */
} extra_memory;

static bool take_memory(extra_memory *m, uint32_t vertices)
{
    const size_t most = MOST_COMPONENTS * (size_t)vertices;
    m->symbols = malloc(most * sizeof *m->symbols);
    m->counts = malloc(4 * ALPHABET * sizeof *m->counts);
    m->used = malloc(ALPHABET * sizeof *m->used);
    m->entries = malloc(ALPHABET * sizeof *m->entries);
    m->coded = malloc(symbols_bound(ALPHABET, most));
    return m->symbols && m->counts && m->used && m->entries && m->coded;
}

static void free_memory(extra_memory *m)
{
    free(m->symbols);
    free(m->counts);
    free(m->used);
    free(m->entries);
    free(m->coded);
}

/* Each number's difference to the vertex before, modulo 2^bits to the nearest of 0, its sign in the lowest bit. */
static void make_symbols(const uint16_t *numbers, uint32_t vertices, uint32_t components, uint16_t *symbols)
{
    const int all = ALPHABET, half = all / 2;
    for (size_t i = 0; i < (size_t)vertices * components; i++) {
        int difference = numbers[i] - (i < components ? 0 : numbers[i - components]);
        difference += difference < -half ? all : difference >= half ? -all : 0;
        symbols[i] = (uint16_t)(difference < 0 ? -2 * difference - 1 : 2 * difference);
    }
}

static unsigned char *put_extra(const draco_extra_form *form, const draco_extra_values *values, uint32_t vertices,
                                extra_memory *m, unsigned char *at)
{
    make_symbols(values->numbers, vertices, form->components, m->symbols);
    symbols_run runs[RANS_LANES] = {{.scheme = SYMBOLS_RAW,
                                     .symbols = m->symbols,
                                     .count = (size_t)vertices * form->components,
                                     .alphabet = ALPHABET,
                                     .counts = m->counts,
                                     .used = m->used,
                                     .entries = m->entries,
                                     .bytes = m->coded}};
    symbols_write(runs);
    at = store_bytes(store_bytes(at, DRACO_DIFFERENCES, sizeof DRACO_DIFFERENCES), m->coded, runs[0].size);
    store_u32(at, 0);
    store_u32(at + 4, ALPHABET - 1);
    at += DRACO_BOUNDS_BYTES;
    for (uint32_t k = 0; k < form->components && form->quantised; k++, at += 4) {
        store_f32(at, 0);
    }
    if (form->quantised) {
        store_f32(at, values->range);
        at[4] = DRACO_EXTRA_BITS;
        at += 5;
    }
    return at;
}

/* The descriptions go before the prediction of the positions, which ends the head; the number of decoders begins what
 * describes the positions. */
static bool describe(draco_mesh *mesh, uint32_t attributes)
{
    const size_t before = mesh->head_size - sizeof DRACO_DIFFERENCES;
    const size_t positions = before - sizeof DRACO_POSITION;
    unsigned char *head = realloc(mesh->head, mesh->head_size + DRACO_EXTRAS * DRACO_EXTRA_DESCRIPTION_BYTES);
    if (!head) {
        return false;
    }
    mesh->head = head;
    head[positions] = (unsigned char)(head[positions] + draco_extra_count(attributes));
    unsigned char *at = draco_extra_describe(attributes, head + before);
    at = store_bytes(at, DRACO_DIFFERENCES, sizeof DRACO_DIFFERENCES);
    mesh->head_size = (size_t)(at - head);
    return true;
}

awt_status draco_extra_add(draco_mesh *mesh, uint32_t attributes, const draco_extra_values *values, awt_error *error)
{
    const size_t most = symbols_bound(ALPHABET, MOST_COMPONENTS * (size_t)mesh->vertices) + DRACO_AROUND_BYTES;
    extra_memory memory = {0};
    unsigned char *tail = malloc(DRACO_EXTRAS * most);
    if (!take_memory(&memory, mesh->vertices) || !tail || !describe(mesh, attributes)) {
        free_memory(&memory);
        free(tail);
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    unsigned char *at = tail;
    for (uint32_t i = 0; i < DRACO_EXTRAS; i++) {
        if (attributes & draco_extra_at(i)->attribute) {
            at = put_extra(draco_extra_at(i), &values[i], mesh->vertices, &memory, at);
        }
    }
    mesh->tail_size = (size_t)(at - tail);
    unsigned char *fitting = realloc(tail, mesh->tail_size + 1);
    mesh->tail = fitting ? fitting : tail;
    free_memory(&memory);
    return AWT_OK;
}
