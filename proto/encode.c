/* encode.c: a message to bytes, by walking its layout.
 *
 * There is one writer. With no buffer behind it, it only counts: that is where sizes come from, so that a size and what
 * is written cannot disagree. Bytes are made by shifts, so that the machine's own byte order does not matter. */
#include "layout.h"

#include <string.h>

enum { HELLO_LENGTH_AT = PROTO_HEADER_SIZE + 6 }; /* of HELLO's own `length`, behind magic and versions */

typedef struct writer {
    unsigned char *bytes; /* NULL: counting only */
    size_t used, capacity;
    size_t left_out;   /* bytes of blobs, with `without_tail` */
    bool without_tail; /* leave out a blob's bytes */
    bool refused;      /* a text, blob or list is over its limit, or there is no room; nothing more is written */
} writer;

/* Where the next `size` bytes go; NULL: they are only counted, or there is no room. */
static inline unsigned char *advance(writer *w, size_t size)
{
    if (w->bytes && (w->refused || size > w->capacity - w->used)) {
        w->refused = true;
        return NULL;
    }
    unsigned char *at = w->bytes ? w->bytes + w->used : NULL;
    w->used += size;
    return at;
}

static void write_bytes(writer *w, const void *bytes, size_t size)
{
    unsigned char *at = advance(w, size);
    if (at && size > 0) {
        memcpy(at, bytes, size);
    }
}

static inline void write_integer(writer *w, uint64_t value, size_t width)
{
    unsigned char *at = advance(w, width);
    if (!at) {
        return;
    }
    switch (width) { /* of what they store at once compilers make one instruction */
    case 8:
        at[7] = (unsigned char)(value >> 56);
        at[6] = (unsigned char)(value >> 48);
        at[5] = (unsigned char)(value >> 40);
        at[4] = (unsigned char)(value >> 32);
        /* fall through */
    case 4:
        at[3] = (unsigned char)(value >> 24);
        at[2] = (unsigned char)(value >> 16);
        /* fall through */
    case 2:
        at[1] = (unsigned char)(value >> 8);
        /* fall through */
    default:
        at[0] = (unsigned char)value;
    }
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
        if (write_length(w, field, blob->length) && w->without_tail) {
            w->left_out += blob->length;
        } else if (!w->refused) {
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

/* Header and payload. HELLO's own `length`, like the header's, is known only behind it: whatever the caller put there,
 * the truth goes out. False: it cannot be written. */
static bool write_message(writer *w, const proto_message *message)
{
    const proto_layout *layout = proto_layout_of(message->type);
    if (!layout) {
        return false;
    }
    write_integer(w, 0, 4);
    write_integer(w, message->type, 2);
    write_integer(w, message->flags, 2);
    write_integer(w, message->request, 8);
    write_fields(w, layout, &message->as);
    if (w->refused || !w->bytes) {
        return !w->refused;
    }
    const size_t length = w->used + w->left_out - PROTO_HEADER_SIZE;
    writer patch = {.bytes = w->bytes, .capacity = w->used};
    write_integer(&patch, length, 4);
    if (message->type == PROTO_HELLO) {
        patch.used = HELLO_LENGTH_AT;
        write_integer(&patch, length, 2);
    }
    return true;
}

static size_t encode(const proto_message *message, unsigned char *bytes, size_t capacity, bool without_tail)
{
    writer w = {.bytes = bytes, .capacity = capacity, .without_tail = without_tail};
    return write_message(&w, message) ? w.used : 0;
}

size_t proto_encoded_size(const proto_message *message)
{
    return encode(message, NULL, 0, false);
}

void proto_begin(proto_message *message, uint16_t type)
{
    const proto_layout *layout = proto_layout_of(type);
    message->type = type;
    message->flags = 0;
    message->request = 0;
    memset(&message->as, 0, layout ? layout->size : sizeof message->as);
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
