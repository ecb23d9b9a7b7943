/* span.c: see span.h. */
#include "sim/span.h"

#include <math.h>

/* How far from 1 the squared length of a unit quaternion may be: float rounding, many times over. */
#define SPAN_UNIT_SLACK 1e-3

static const size_t kind_bytes[] = {
    [SPAN_U32] = 4,
    [SPAN_I64] = 8,
    [SPAN_F32] = 4,
    [SPAN_UNIT] = 4,
};

size_t span_bytes(const span *s)
{
    return s->count * kind_bytes[s->kind];
}

static void number_store(span_kind kind, unsigned char *out, const void *number)
{
    uint64_t u64;
    uint32_t u32;
    switch (kind) {
    case SPAN_I64:
        memcpy(&u64, number, sizeof u64);
        store_u64(out, u64);
        break;
    case SPAN_U32:
    case SPAN_F32:
    case SPAN_UNIT:
        memcpy(&u32, number, sizeof u32);
        store_u32(out, u32);
        break;
    }
}

/* Gives the number's value too, for the check; beyond 2^53 rounded, which no range reaches. */
static double number_load(span_kind kind, const unsigned char *in, void *number)
{
    uint32_t u32;
    int64_t i64;
    float f32;
    switch (kind) {
    case SPAN_U32:
        u32 = load_u32(in);
        memcpy(number, &u32, sizeof u32);
        return u32;
    case SPAN_I64:
        i64 = load_i64(in);
        memcpy(number, &i64, sizeof i64);
        return (double)i64;
    case SPAN_F32:
    case SPAN_UNIT:
        break;
    }
    f32 = load_f32(in);
    memcpy(number, &f32, sizeof f32);
    return (double)f32;
}

void span_write(const span *s, codec *to)
{
    const size_t width = kind_bytes[s->kind];
    size_t from;
    if (!codec_pass(to, span_bytes(s), &from)) {
        return;
    }
    for (size_t i = 0; i < s->count; i++) {
        number_store(s->kind, to->out + from + i * width, (const unsigned char *)s->numbers + i * width);
    }
}

bool span_read(const span *s, const codec *from)
{
    const size_t width = kind_bytes[s->kind];
    double length2 = 0;
    for (size_t i = 0; i < s->count; i++) {
        double value = number_load(s->kind, from->in + i * width, (unsigned char *)s->numbers + i * width);
        if (!(value >= s->least && value <= s->most)) {
            return false;
        }
        length2 = i % 4 == 0 ? value * value : length2 + value * value;
        if (s->kind == SPAN_UNIT && i % 4 == 3 && !(fabs(length2 - 1.0) <= SPAN_UNIT_SLACK)) {
            return false;
        }
    }
    return true;
}
