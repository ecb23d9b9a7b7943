/* span.h: an array of numbers of one kind, with what each of them may be: how a snapshot lists its arrays once, for
 * writing, reading and checking. */
#ifndef SIM_SPAN_H
#define SIM_SPAN_H

#include "base/codec.h"

/* SPAN_UNIT: floats, every four a unit quaternion. */
typedef enum span_kind { SPAN_U32, SPAN_I64, SPAN_F32, SPAN_UNIT } span_kind;

typedef struct span {
    const char *name; /* of its section */
    span_kind kind;
    void *numbers; /* [count] */
    size_t count;
    double least, most; /* what each number may be; both ends included */
} span;

/* In a snapshot. */
size_t span_bytes(const span *s);
void span_write(const span *s, codec *to);
/* Of a codec over span_bytes. False: a number is out of its range; `numbers` then holds anything. */
bool span_read(const span *s, const codec *from);

#endif
