/* proto_fill.c: see proto_fill.h. */
#include "proto_fill.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BLOB_MAX = 64 << 20 };

static const char *sample_text(void)
{
    static char text[512];
    static const char pattern[] = "wisp \xC3\xA9\xE2\x82\xAC "; /* ten bytes: ASCII, U+00E9, U+20AC */
    for (size_t i = 0; i < sizeof text; i++) {
        text[i] = pattern[i % (sizeof pattern - 1)];
    }
    return text;
}

/* The longest prefix of the sample that does not cut a character. */
static uint16_t sample_text_length(uint32_t greatest)
{
    const char *text = sample_text();
    uint32_t length = greatest;
    while (length > 0 && ((unsigned char)text[length] & 0xC0) == 0x80) {
        length--;
    }
    return (uint16_t)length;
}

static const unsigned char *sample_blob(void)
{
    static unsigned char *bytes;
    if (!bytes) {
        bytes = malloc(BLOB_MAX);
        for (size_t i = 0; bytes && i < BLOB_MAX; i++) {
            bytes[i] = (unsigned char)(i * 131 >> 3);
        }
    }
    return bytes;
}

static uint64_t sample_integer(rng *random)
{
    switch (rng_u32(random) % 4) {
    case 0:
        return 0;
    case 1:
        return UINT64_MAX;
    default:
        return (uint64_t)rng_u32(random) << 32 | rng_u32(random);
    }
}

static void fill_pose(proto_pose *pose, rng *random)
{
    double square = 0;
    for (int i = 0; i < 3; i++) {
        pose->position[i] = rng_between(random, -1e5, 1e5);
    }
    for (int i = 0; i < 4; i++) {
        pose->orientation[i] = rng_between(random, 0.1, 1);
        square += pose->orientation[i] * pose->orientation[i];
    }
    for (int i = 0; i < 4; i++) {
        pose->orientation[i] /= sqrt(square);
    }
}

static uint32_t least_of(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

static void fill_fields(const proto_layout *layout, void *object, fill_sizes sizes, rng *random);

static void fill_field(const proto_field *field, void *object, fill_sizes sizes, rng *random)
{
    void *member = (char *)object + field->offset;
    uint64_t integer = sample_integer(random);
    switch (field->kind) {
    case PROTO_KIND_u8:
        *(uint8_t *)member = (uint8_t)integer;
        break;
    case PROTO_KIND_u16:
        *(uint16_t *)member = (uint16_t)integer;
        break;
    case PROTO_KIND_u32:
        *(uint32_t *)member = (uint32_t)integer;
        break;
    case PROTO_KIND_u64:
    case PROTO_KIND_i64:
        memcpy(member, &integer, sizeof integer);
        break;
    case PROTO_KIND_f32:
        *(float *)member = (float)rng_between(random, -1e6, 1e6);
        break;
    case PROTO_KIND_f64:
        *(double *)member = rng_between(random, -1e12, 1e12);
        break;
    case PROTO_KIND_raw:
        for (size_t i = 0; i < field->limit; i++) {
            ((uint8_t *)member)[i] = (uint8_t)rng_u32(random);
        }
        break;
    case PROTO_KIND_pose:
        fill_pose(member, random);
        break;
    case PROTO_KIND_str:
        *(proto_str *)member = (proto_str){sample_text(), sample_text_length(least_of(field->limit, sizes.text))};
        break;
    case PROTO_KIND_blob:
        *(proto_blob *)member = (proto_blob){sample_blob(), least_of(field->limit, sizes.blob)};
        break;
    case PROTO_KIND_list:
        *(uint16_t *)member = (uint16_t)least_of(field->limit, sizes.list);
        for (size_t i = 0; i < *(uint16_t *)member; i++) {
            const proto_layout *record = field->record();
            fill_fields(record, (char *)object + field->items + i * record->size, sizes, random);
        }
        break;
    }
}

static void fill_fields(const proto_layout *layout, void *object, fill_sizes sizes, rng *random)
{
    for (const proto_field *field = layout->fields; field->name; field++) {
        fill_field(field, object, sizes, random);
    }
}

void proto_fill(proto_message *message, const proto_layout *layout, fill_sizes sizes, rng *random)
{
    message->type = layout->type;
    message->flags = (uint16_t)rng_u32(random);
    message->request = sample_integer(random);
    fill_fields(layout, &message->as, sizes, random);
    if (layout->type == PROTO_HELLO) {
        message->as.hello.length = (uint16_t)(proto_encoded_size(message) - PROTO_HEADER_SIZE);
    }
}

static const char *fields_difference(const proto_layout *layout, const void *a, const void *b);

static const char *list_difference(const proto_field *field, const char *a, const char *b)
{
    uint16_t count = *(const uint16_t *)(const void *)(a + field->offset);
    const proto_layout *record = field->record();
    if (count != *(const uint16_t *)(const void *)(b + field->offset)) {
        return field->name;
    }
    for (size_t i = 0; i < count; i++) {
        size_t at = field->items + i * record->size;
        const char *difference = fields_difference(record, a + at, b + at);
        if (difference) {
            return difference;
        }
    }
    return NULL;
}

static bool values_same(const proto_field *field, const void *a, const void *b)
{
    if (field->kind == PROTO_KIND_str) {
        const proto_str *left = a, *right = b;
        return left->length == right->length && memcmp(left->text, right->text, left->length) == 0;
    }
    if (field->kind == PROTO_KIND_blob) {
        const proto_blob *left = a, *right = b;
        return left->length == right->length && memcmp(left->bytes, right->bytes, left->length) == 0;
    }
    return memcmp(a, b, proto_field_width(field)) == 0; /* every fixed kind is as wide in memory as on the wire */
}

static const char *fields_difference(const proto_layout *layout, const void *a, const void *b)
{
    for (const proto_field *field = layout->fields; field->name; field++) {
        const char *left = (const char *)a, *right = (const char *)b;
        if (field->kind == PROTO_KIND_list) {
            const char *difference = list_difference(field, left, right);
            if (difference) {
                return difference;
            }
        } else if (!values_same(field, left + field->offset, right + field->offset)) {
            return field->name;
        }
    }
    return NULL;
}

const char *proto_difference(const proto_message *a, const proto_message *b)
{
    if (a->type != b->type || a->flags != b->flags || a->request != b->request) {
        return "header";
    }
    return fields_difference(proto_layout_of(a->type), &a->as, &b->as);
}

unsigned char *proto_payload(const proto_message *message, size_t size, proto_header *header)
{
    size_t whole = proto_encoded_size(message);
    unsigned char *bytes = malloc(whole);
    size_t payload = whole - PROTO_HEADER_SIZE < size ? whole - PROTO_HEADER_SIZE : size;
    unsigned char *out = malloc(payload > 0 ? payload : 1);
    if (!bytes || !out) {
        free(bytes);
        free(out);
        return NULL;
    }
    proto_encode(message, bytes, whole);
    *header = proto_header_read(bytes);
    header->length = (uint32_t)payload;
    memcpy(out, bytes + PROTO_HEADER_SIZE, payload);
    free(bytes);
    return out;
}
