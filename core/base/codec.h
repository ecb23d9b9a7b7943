/* codec.h: one walk over values that counts, writes or reads them, so that the three cannot disagree.
 *
 * A walk calls codec_u32 and its like on every value in turn. Reading fills them from bytes, never beyond their end;
 * writing stores them; a codec with neither input nor output counts. `at` is then the size needed. Whoever walks to
 * write may hand over values that are not to change: writing and counting only read them. */
#ifndef BASE_CODEC_H
#define BASE_CODEC_H

#include "base/bytes.h"

#include <stdbool.h>
#include <stddef.h>

typedef struct codec {
    const unsigned char *in; /* reading */
    unsigned char *out;      /* writing; neither: counting */
    size_t at, size;         /* size: of the input, or room for the output */
    bool spent;              /* the input ended early, or the room was too small; nothing is touched beyond it */
} codec;

static inline codec codec_reading(const void *bytes, size_t size)
{
    return (codec){.in = bytes, .size = size};
}

/* Counts where `bytes` is NULL. */
static inline codec codec_writing(void *bytes, size_t capacity)
{
    return (codec){.out = bytes, .size = capacity};
}

/* Reading: everything was there, and nothing else. */
static inline bool codec_ends(const codec *c)
{
    return !c->spent && c->at == c->size;
}

/* Goes on by `bytes`, which begin at *from. False: not to be touched (spent, or only counted). */
static inline bool codec_pass(codec *c, size_t bytes, size_t *from)
{
    if (c->in && (c->spent || bytes > c->size - c->at)) {
        c->spent = true;
        return false;
    }
    *from = c->at;
    c->at += bytes;
    if (c->out && c->at > c->size) {
        c->spent = true;
    }
    return !c->spent && (c->in || c->out);
}

#define CODEC_VALUE(suffix, type, bytes)                     \
    static inline void codec_##suffix(codec *c, type *value) \
    {                                                        \
        size_t from;                                         \
        if (codec_pass(c, bytes, &from)) {                   \
            if (c->in) {                                     \
                *value = load_##suffix(c->in + from);        \
            } else {                                         \
                store_##suffix(c->out + from, *value);       \
            }                                                \
        }                                                    \
    }
CODEC_VALUE(u16, uint16_t, 2)
CODEC_VALUE(u32, uint32_t, 4)
CODEC_VALUE(u64, uint64_t, 8)
CODEC_VALUE(i64, int64_t, 8)
CODEC_VALUE(f32, float, 4)
CODEC_VALUE(f64, double, 8)
#undef CODEC_VALUE

/* `size` bytes as they are. */
static inline void codec_bytes(codec *c, void *bytes, size_t size)
{
    size_t from;
    if (codec_pass(c, size, &from) && size > 0) {
        if (c->in) {
            memcpy(bytes, c->in + from, size);
        } else {
            memcpy(c->out + from, bytes, size);
        }
    }
}

/* A truth value in one byte; reading, anything but 0 and 1 ends the walk. */
static inline void codec_bool(codec *c, bool *value)
{
    unsigned char byte = *value ? 1 : 0;
    codec_bytes(c, &byte, 1);
    if (c->in) {
        c->spent = c->spent || byte > 1;
        *value = byte == 1;
    }
}

#endif
