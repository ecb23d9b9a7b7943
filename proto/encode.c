/* encode.c: a message to bytes, by walking its layout.
 *
 * There is one writer. With no buffer behind it, it only counts: that is where sizes come from, so that a size and what
 * is written cannot disagree. Bytes are made by shifts, so that the machine's own byte order does not matter. */
#include "layout.h"

#include <string.h>

enum { HELLO_LENGTH_AT = PROTO_HEADER_SIZE + 6 }; /* of HELLO's own `length`, behind magic and versions */

typedef struct writer {
    unsigned char *bytes; /* NULL: counting only */
    size_t used;
    bool without_tail; /* leave out a blob's bytes */
    bool refused;      /* a text, blob or list is over its limit */
} writer;

static void write_bytes(writer *w, const void *bytes, size_t size)
{
    if (w->bytes && size > 0) {
        memcpy(w->bytes + w->used, bytes, size);
    }
    w->used += size;
}

static void write_integer(writer *w, uint64_t value, size_t width)
{
    unsigned char bytes[8];
    for (size_t i = 0; i < width; i++) {
        bytes[i] = (unsigned char)(value >> (8 * i));
    }
    write_bytes(w, bytes, width);
}

static void write_f64(writer *w, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    write_integer(w, bits, 8);
}

static void write_f32(writer *w, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    write_integer(w, bits, 4);
}

static void write_pose(writer *w, const proto_pose *pose)
{
    for (int i = 0; i < 3; i++) {
        write_f64(w, pose->position[i]);
    }
    for (int i = 0; i < 4; i++) {
        write_f64(w, pose->orientation[i]);
    }
}

static bool write_length(writer *w, const proto_field *field, uint32_t length)
{
    if (length > field->limit) {
        w->refused = true;
        return false;
    }
    write_integer(w, length, proto_field_width(field));
    return true;
}

static void write_fields(writer *w, const proto_layout *layout, const void *object);

static void write_list(writer *w, const proto_field *field, const void *object, uint16_t count)
{
    if (!write_length(w, field, count)) {
        return;
    }
    const proto_layout *record = field->record();
    for (size_t i = 0; i < count; i++) {
        write_fields(w, record, (const char *)object + field->items + i * record->size);
    }
}

static void write_field(writer *w, const proto_field *field, const void *object)
{
    const void *member = (const char *)object + field->offset;
    switch (field->kind) {
    case PROTO_KIND_u8:
        write_integer(w, *(const uint8_t *)member, 1);
        break;
    case PROTO_KIND_u16:
        write_integer(w, *(const uint16_t *)member, 2);
        break;
    case PROTO_KIND_u32:
        write_integer(w, *(const uint32_t *)member, 4);
        break;
    case PROTO_KIND_u64:
        write_integer(w, *(const uint64_t *)member, 8);
        break;
    case PROTO_KIND_i64:
        write_integer(w, (uint64_t) * (const int64_t *)member, 8);
        break;
    case PROTO_KIND_f32:
        write_f32(w, *(const float *)member);
        break;
    case PROTO_KIND_f64:
        write_f64(w, *(const double *)member);
        break;
    case PROTO_KIND_raw:
        write_bytes(w, member, field->limit);
        break;
    case PROTO_KIND_pose:
        write_pose(w, member);
        break;
    case PROTO_KIND_str: {
        const proto_str *str = member;
        if (write_length(w, field, str->length)) {
            write_bytes(w, str->text, str->length);
        }
        break;
    }
    case PROTO_KIND_blob: {
        const proto_blob *blob = member;
        if (write_length(w, field, blob->length) && !w->without_tail) {
            write_bytes(w, blob->bytes, blob->length);
        }
        break;
    }
    case PROTO_KIND_list:
        write_list(w, field, object, *(const uint16_t *)member);
        break;
    }
}

static void write_fields(writer *w, const proto_layout *layout, const void *object)
{
    for (const proto_field *field = layout->fields; field->name && !w->refused; field++) {
        write_field(w, field, object);
    }
}

/* Header and payload of `length` bytes. HELLO's own `length` is known only here: whatever the caller put there, the
 * truth goes out. */
static void write_message(writer *w, const proto_layout *layout, const proto_message *message, size_t length)
{
    write_integer(w, length, 4);
    write_integer(w, message->type, 2);
    write_integer(w, message->flags, 2);
    write_integer(w, message->request, 8);
    write_fields(w, layout, &message->as);
    if (message->type == PROTO_HELLO && w->bytes) {
        writer patch = {.bytes = w->bytes + HELLO_LENGTH_AT};
        write_integer(&patch, length, 2);
    }
}

/* The least room for what proto_encode or, without the tail, proto_encode_head writes; 0: it cannot be encoded. */
static size_t count_message(const proto_message *message, bool without_tail)
{
    const proto_layout *layout = proto_layout_of(message->type);
    writer counter = {.without_tail = without_tail};
    if (layout) {
        write_message(&counter, layout, message, 0);
    }
    return counter.refused ? 0 : counter.used;
}

static size_t encode(const proto_message *message, unsigned char *bytes, size_t capacity, bool without_tail)
{
    size_t whole = count_message(message, false);
    size_t room = without_tail ? count_message(message, true) : whole;
    if (room == 0 || room > capacity) {
        return 0;
    }
    writer w = {.bytes = bytes, .without_tail = without_tail};
    write_message(&w, proto_layout_of(message->type), message, whole - PROTO_HEADER_SIZE);
    return w.used;
}

size_t proto_encoded_size(const proto_message *message)
{
    return count_message(message, false);
}

size_t proto_encode(const proto_message *message, unsigned char *bytes, size_t capacity)
{
    return encode(message, bytes, capacity, false);
}

size_t proto_encode_head(const proto_message *message, unsigned char *bytes, size_t capacity)
{
    return encode(message, bytes, capacity, true);
}

proto_str proto_str_of(const char *text)
{
    size_t length = text ? strlen(text) : 0;
    return (proto_str){text, (uint16_t)(length < UINT16_MAX ? length : UINT16_MAX)};
}
