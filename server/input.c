/* input.c: see input.h. */
#include "input.h"
#include "base/assert.h"
#include "limits.h"

#include <stdlib.h>
#include <string.h>

void input_fini(input *in)
{
    free(in->bytes);
    *in = (input){0};
}

void input_rest(input *in)
{
    if (in->begin == in->end) {
        free(in->bytes);
        in->bytes = NULL;
        in->capacity = in->begin = in->end = 0;
    }
}

static bool resize(input *in, size_t capacity)
{
    unsigned char *bytes = realloc(in->bytes, capacity);
    if (bytes) {
        in->bytes = bytes;
        in->capacity = capacity;
    }
    return bytes != NULL;
}

/* Moves what is there to the front. */
static void compact(input *in)
{
    if (in->begin > 0) {
        memmove(in->bytes, in->bytes + in->begin, in->end - in->begin);
        in->end -= in->begin;
        in->begin = 0;
    }
}

size_t input_room(input *in, size_t capacity, unsigned char **room)
{
    if (in->capacity < capacity && !resize(in, capacity)) {
        return 0;
    }
    compact(in);
    if (in->end == in->capacity) {
        /* full of a message that is longer: twice as much, but never more than it announced */
        size_t whole = PROTO_HEADER_SIZE + in->payload;
        ASSERT(in->header_taken && whole > in->capacity);
        if (!resize(in, in->capacity < whole - in->capacity ? in->capacity * 2 : whole)) {
            return 0;
        }
    }
    *room = in->bytes + in->end;
    return in->capacity - in->end;
}

/* Throws away what is to be skipped and is there. */
static void skip_bytes(input *in)
{
    size_t there = in->end - in->begin;
    size_t now = in->skip < there ? in->skip : there;
    in->begin += now;
    in->skip -= now;
}

void input_came(input *in, size_t size)
{
    ASSERT(size <= in->capacity - in->end);
    in->end += size;
    skip_bytes(in);
}

bool input_ready(const input *in)
{
    size_t needed = PROTO_HEADER_SIZE + (in->header_taken ? in->payload : 0);
    return in->end - in->begin >= needed;
}

input_event input_next(input *in, proto_header *header, const unsigned char **payload)
{
    if (!input_ready(in)) {
        return INPUT_MORE;
    }
    *header = proto_header_read(in->bytes + in->begin);
    *payload = in->bytes + in->begin + PROTO_HEADER_SIZE;
    return in->header_taken ? INPUT_MESSAGE : INPUT_HEADER;
}

void input_take(input *in, const proto_header *header)
{
    in->header_taken = true;
    in->payload = header->length;
}

void input_skip(input *in, const proto_header *header)
{
    in->skip = (size_t)PROTO_HEADER_SIZE + header->length;
    skip_bytes(in);
}

void input_done(input *in)
{
    in->begin += PROTO_HEADER_SIZE + in->payload;
    in->payload = 0;
    in->header_taken = false;
    if (in->capacity > LIMIT_INPUT_KEPT && in->end - in->begin <= LIMIT_INPUT_KEPT) {
        compact(in);
        resize(in, LIMIT_INPUT_KEPT); /* where that fails, the larger buffer stays */
    }
}
