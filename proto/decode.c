/* decode.c: bytes to a message, by walking its layout. The bytes are a stranger's.
 *
 * The reader never looks behind its end: a field first asks for its bytes and is refused if they are not there. The
 * first thing that is wrong ends the decoding. */
#include "layout.h"

#include <math.h>
#include <string.h>

typedef struct reader {
    const unsigned char *next;
    size_t left;
    int code;          /* PROTO_ERROR_ of what is wrong; 0 so far */
    const char *where; /* the field that was wrong */
} reader;

static bool refuse(reader *r, int code)
{
    r->code = code;
    return false;
}

/* The next `size` bytes, which the reader then has passed; NULL: there are not so many left. */
static const unsigned char *read_bytes(reader *r, size_t size)
{
    if (size > r->left) {
        refuse(r, PROTO_ERROR_BAD_FRAME);
        return NULL;
    }
    const unsigned char *bytes = r->next;
    r->next += size;
    r->left -= size;
    return bytes;
}

static uint64_t integer_of(const unsigned char *bytes, size_t width)
{
    uint64_t value = 0;
    for (size_t i = 0; i < width; i++) {
        value |= (uint64_t)bytes[i] << (8 * i);
    }
    return value;
}

static bool read_integer(reader *r, size_t width, uint64_t *value)
{
    const unsigned char *bytes = read_bytes(r, width);
    if (bytes) {
        *value = integer_of(bytes, width);
    }
    return bytes != NULL;
}

static bool read_f32(reader *r, float *value)
{
    uint64_t integer;
    if (!read_integer(r, 4, &integer)) {
        return false;
    }
    uint32_t bits = (uint32_t)integer;
    memcpy(value, &bits, sizeof bits);
    return isfinite(*value) || refuse(r, PROTO_ERROR_BAD_VALUE);
}

static bool read_f64(reader *r, double *value)
{
    uint64_t bits;
    if (!read_integer(r, 8, &bits)) {
        return false;
    }
    memcpy(value, &bits, sizeof bits);
    return isfinite(*value) || refuse(r, PROTO_ERROR_BAD_VALUE);
}

/* A huge component makes the square infinite, which no comparison lets through. */
static bool unit_length(const double q[4])
{
    double square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    return square >= (1 - 1e-3) * (1 - 1e-3) && square <= (1 + 1e-3) * (1 + 1e-3);
}

static bool read_pose(reader *r, proto_pose *pose)
{
    for (int i = 0; i < 3; i++) {
        if (!read_f64(r, &pose->position[i])) {
            return false;
        }
    }
    for (int i = 0; i < 4; i++) {
        if (!read_f64(r, &pose->orientation[i])) {
            return false;
        }
    }
    return unit_length(pose->orientation) || refuse(r, PROTO_ERROR_BAD_VALUE);
}

/* Bytes of the UTF-8 character at `bytes` (RFC 3629: no overlong form, no surrogate, not above U+10FFFF); 0: it is
 * none, or it is NUL. */
static size_t utf8_character(const unsigned char *bytes, size_t left)
{
    unsigned char first = bytes[0];
    if (first < 0x80) {
        return first != 0;
    }
    size_t size = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
    if (first < 0xC2 || first > 0xF4 || size > left) {
        return 0;
    }
    for (size_t i = 1; i < size; i++) {
        if ((bytes[i] & 0xC0) != 0x80) {
            return 0;
        }
    }
    bool overlong = (first == 0xE0 && bytes[1] < 0xA0) || (first == 0xF0 && bytes[1] < 0x90);
    bool beyond = (first == 0xED && bytes[1] > 0x9F) || (first == 0xF4 && bytes[1] > 0x8F);
    return overlong || beyond ? 0 : size;
}

static bool utf8_valid(const unsigned char *bytes, size_t size)
{
    for (size_t i = 0, step; i < size; i += step) {
        step = utf8_character(bytes + i, size - i);
        if (step == 0) {
            return false;
        }
    }
    return true;
}

/* The length before a text, blob or list, within the field's limit. */
static bool read_length(reader *r, const proto_field *field, uint32_t *length)
{
    uint64_t value;
    if (!read_integer(r, proto_field_width(field), &value)) {
        return false;
    }
    *length = (uint32_t)value;
    return *length <= field->limit || refuse(r, PROTO_ERROR_LIMIT);
}

static bool read_str(reader *r, const proto_field *field, proto_str *str)
{
    uint32_t length;
    const unsigned char *bytes = read_length(r, field, &length) ? read_bytes(r, length) : NULL;
    if (!bytes) {
        return false;
    }
    *str = (proto_str){(const char *)bytes, (uint16_t)length};
    return utf8_valid(bytes, length) || refuse(r, PROTO_ERROR_BAD_VALUE);
}

static bool read_blob(reader *r, const proto_field *field, proto_blob *blob)
{
    uint32_t length;
    const unsigned char *bytes = read_length(r, field, &length) ? read_bytes(r, length) : NULL;
    if (bytes) {
        *blob = (proto_blob){bytes, length};
    }
    return bytes != NULL;
}

static size_t least_width(const proto_layout *layout)
{
    size_t width = 0;
    for (const proto_field *field = layout->fields; field->name; field++) {
        width += proto_field_width(field);
    }
    return width;
}

static bool read_fields(reader *r, const proto_layout *layout, void *object);

static bool read_list(reader *r, const proto_field *field, void *object, uint16_t *count)
{
    uint32_t length;
    if (!read_length(r, field, &length)) {
        return false;
    }
    const proto_layout *record = field->record();
    if (length > r->left / least_width(record)) {
        return refuse(r, PROTO_ERROR_BAD_FRAME);
    }
    *count = (uint16_t)length;
    for (size_t i = 0; i < length; i++) {
        if (!read_fields(r, record, (char *)object + field->items + i * record->size)) {
            return false;
        }
    }
    return true;
}

static bool read_raw(reader *r, size_t size, void *member)
{
    const unsigned char *bytes = read_bytes(r, size);
    if (bytes) {
        memcpy(member, bytes, size);
    }
    return bytes != NULL;
}

/* An integer into a member of its own width. */
static bool read_number(reader *r, const proto_field *field, void *member)
{
    uint64_t value;
    if (!read_integer(r, proto_field_width(field), &value)) {
        return false;
    }
    switch (field->kind) {
    case PROTO_KIND_u8:
        *(uint8_t *)member = (uint8_t)value;
        break;
    case PROTO_KIND_u16:
        *(uint16_t *)member = (uint16_t)value;
        break;
    case PROTO_KIND_u32:
        *(uint32_t *)member = (uint32_t)value;
        break;
    case PROTO_KIND_i64:
        memcpy(member, &value, sizeof value); /* two's complement, without the conversion that C leaves open */
        break;
    default:
        *(uint64_t *)member = value;
        break;
    }
    return true;
}

static bool read_field(reader *r, const proto_field *field, void *object)
{
    void *member = (char *)object + field->offset;
    switch (field->kind) {
    case PROTO_KIND_f32:
        return read_f32(r, member);
    case PROTO_KIND_f64:
        return read_f64(r, member);
    case PROTO_KIND_raw:
        return read_raw(r, field->limit, member);
    case PROTO_KIND_pose:
        return read_pose(r, member);
    case PROTO_KIND_str:
        return read_str(r, field, member);
    case PROTO_KIND_blob:
        return read_blob(r, field, member);
    case PROTO_KIND_list:
        return read_list(r, field, object, member);
    default:
        return read_number(r, field, member);
    }
}

static bool read_fields(reader *r, const proto_layout *layout, void *object)
{
    for (const proto_field *field = layout->fields; field->name; field++) {
        if (!read_field(r, field, object)) {
            r->where = r->where ? r->where : field->name;
            return false;
        }
    }
    return true;
}

/* What may stand behind the last field: nothing, except in HELLO, whose `length` lets a later version append. */
static bool read_end(reader *r, const proto_header *header, const proto_message *message)
{
    if (header->type == PROTO_HELLO && message->as.hello.length != header->length) {
        r->where = "length";
        return refuse(r, PROTO_ERROR_BAD_FRAME);
    }
    if (header->type != PROTO_HELLO && r->left > 0) {
        r->where = "bytes behind the last field";
        return refuse(r, PROTO_ERROR_BAD_FRAME);
    }
    return true;
}

proto_header proto_header_read(const unsigned char *bytes)
{
    return (proto_header){.length = (uint32_t)integer_of(bytes, 4),
                          .type = (uint16_t)integer_of(bytes + 4, 2),
                          .flags = (uint16_t)integer_of(bytes + 6, 2),
                          .request = integer_of(bytes + 8, 8)};
}

int proto_decode(const proto_header *header, const unsigned char *payload, proto_message *out, const char **where)
{
    reader r = {.next = payload, .left = header->length};
    const proto_layout *layout = proto_layout_of(header->type);
    out->type = header->type;
    out->flags = header->flags;
    out->request = header->request;
    if (!layout) {
        r.where = "type";
        refuse(&r, PROTO_ERROR_UNKNOWN_MESSAGE);
    } else if (read_fields(&r, layout, &out->as)) {
        read_end(&r, header, out);
    }
    if (where && r.code != 0) {
        *where = r.where;
    }
    return r.code;
}

void proto_str_copy(proto_str from, char *to, size_t size)
{
    if (size == 0) {
        return;
    }
    size_t length = from.length < size ? from.length : size - 1;
    /* Where it has to be cut, not inside of a character. */
    while (length < from.length && length > 0 && ((unsigned char)from.text[length] & 0xC0) == 0x80) {
        length--;
    }
    if (length > 0) {
        memcpy(to, from.text, length);
    }
    to[length] = '\0';
}
