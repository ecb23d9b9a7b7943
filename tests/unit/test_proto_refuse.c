/* test_proto_refuse.c: what a stranger may send. Every payload stands in heap memory of exactly its size, so that the
 * sanitizer build sees any read behind it. */
#include "check.h"
#include "proto_fill.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static proto_message message, decoded;

/* "MOTION: 203 at head", for a check that says which message was treated how. */
static const char *verdict(const char *name, int code, const char *where)
{
    static char texts[2][128];
    static unsigned turn;
    char *text = texts[turn++ % 2];
    snprintf(text, sizeof texts[0], "%s: %d at %s", name, code, where);
    return text;
}

static const char *decode_verdict(const proto_header *header, const unsigned char *payload)
{
    const char *where = "nothing";
    int code = proto_decode(header, payload, &decoded, &where);
    return verdict(proto_type_name(header->type), code, where);
}

/* What the decoder says to `message` as it stands. */
static const char *message_verdict(void)
{
    proto_header header;
    unsigned char *payload = proto_payload(&message, SIZE_MAX, &header);
    const char *text = decode_verdict(&header, payload);
    free(payload);
    return text;
}

TEST(proto_every_truncation_of_every_message_is_refused)
{
    rng random = rng_seed(11);
    for (size_t i = 0; proto_layout_at(i); i++) {
        proto_fill(&message, proto_layout_at(i), (fill_sizes){17, 40, 3}, &random);
        size_t whole = proto_encoded_size(&message) - PROTO_HEADER_SIZE;
        for (size_t size = 0; size < whole; size++) {
            proto_header header;
            unsigned char *payload = proto_payload(&message, size, &header);
            int code = proto_decode(&header, payload, &decoded, NULL);
            if (code != PROTO_ERROR_BAD_FRAME) {
                CHECK_TEXT(verdict(proto_layout_at(i)->name, code, "a cut"), verdict("every message", 102, "a cut"));
            }
            free(payload);
        }
    }
}

TEST(proto_bytes_behind_the_last_field_are_refused_except_in_hello)
{
    rng random = rng_seed(12);
    for (size_t i = 0; proto_layout_at(i); i++) {
        const proto_layout *layout = proto_layout_at(i);
        proto_fill(&message, layout, (fill_sizes){5, 5, 1}, &random);
        proto_header header;
        unsigned char *payload = proto_payload(&message, SIZE_MAX, &header);
        unsigned char *longer = malloc(header.length + 1);
        if (payload && longer) {
            memcpy(longer, payload, header.length);
            longer[header.length++] = 0;
            const char *where = layout->type == PROTO_HELLO ? "length" : "bytes behind the last field";
            CHECK_TEXT(decode_verdict(&header, longer), verdict(layout->name, PROTO_ERROR_BAD_FRAME, where));
        }
        if (payload && longer && layout->type == PROTO_HELLO) {
            longer[6] = (unsigned char)header.length; /* a later version that appended a byte and says so */
            CHECK_TEXT(decode_verdict(&header, longer), "HELLO: 0 at nothing");
        }
        free(payload);
        free(longer);
    }
}

/* Puts `value` into component `component` of the number at `member`; false: there is no such component. */
static bool spoil(const proto_field *field, void *member, int component, double value)
{
    if (field->kind == PROTO_KIND_f32 && component == 0) {
        *(float *)member = (float)value;
        return true;
    }
    if (field->kind == PROTO_KIND_f64 && component == 0) {
        *(double *)member = value;
        return true;
    }
    if (field->kind == PROTO_KIND_pose && component < 7) {
        proto_pose *pose = member;
        *(component < 3 ? &pose->position[component] : &pose->orientation[component - 3]) = value;
        return true;
    }
    return false;
}

/* Each number of the object at `object` inside `message`, one after the other, is made infinite or no number. */
static int spoil_fields(const proto_layout *layout, const proto_layout *fields, void *object, rng *random)
{
    int spoiled = 0;
    for (const proto_field *field = fields->fields; field->name; field++) {
        for (int component = 0; component < 7; component++) {
            const double values[] = {NAN, INFINITY, -INFINITY};
            proto_fill(&message, layout, (fill_sizes){4, 4, 2}, random);
            if (spoil(field, (char *)object + field->offset, component, values[component % 3])) {
                CHECK_TEXT(message_verdict(), verdict(layout->name, PROTO_ERROR_BAD_VALUE, field->name));
                spoiled++;
            }
        }
    }
    return spoiled;
}

TEST(proto_numbers_that_are_not_finite_are_refused)
{
    rng random = rng_seed(13);
    int spoiled = 0;
    for (size_t i = 0; proto_layout_at(i); i++) {
        const proto_layout *layout = proto_layout_at(i);
        spoiled += spoil_fields(layout, layout, &message.as, &random);
        for (const proto_field *field = layout->fields; field->name; field++) {
            if (field->kind == PROTO_KIND_list) {
                char *second = (char *)&message.as + field->items + field->record()->size;
                spoiled += spoil_fields(layout, field->record(), second, &random);
            }
        }
    }
    CHECK(spoiled > 60);
}

TEST(proto_quaternions_off_unit_length_are_refused)
{
    static const struct {
        double length;
        bool good;
    } cases[] = {{1, true},       {0.9991, true}, {1.0009, true}, {0.9989, false},
                 {1.0011, false}, {0, false},     {1e200, false}, {-1, true}};
    rng random = rng_seed(14);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        proto_fill(&message, proto_layout_of(PROTO_MOTION), (fill_sizes){0, 0, 2}, &random);
        double *q = message.as.motion.colliders.items[1].pose.orientation;
        for (int k = 0; k < 4; k++) {
            q[k] *= cases[i].length;
        }
        CHECK_TEXT(message_verdict(), cases[i].good ? "MOTION: 0 at nothing" : "MOTION: 203 at pose");
    }
}

TEST(proto_texts_that_are_not_utf8_are_refused)
{
    static const struct {
        const char *text;
        uint16_t length;
        bool good;
    } cases[] = {
        {"", 0, true},
        {"plain", 5, true},
        {"\xC2\x80", 2, true},
        {"\xDF\xBF\xE0\xA0\x80\xED\x9F\xBF\xEE\x80\x80", 11, true},
        {"\xF0\x90\x80\x80\xF4\x8F\xBF\xBF", 8, true},
        {"nul\0inside", 10, false},
        {"\x80", 1, false},                 /* a continuation alone */
        {"\xC3", 1, false},                 /* cut off */
        {"\xE2\x82", 2, false},             /* cut off */
        {"a\xC3(", 3, false},               /* no continuation */
        {"\xC0\xAF", 2, false},             /* overlong */
        {"\xC1\xBF", 2, false},             /* overlong */
        {"\xE0\x9F\xBF", 3, false},         /* overlong */
        {"\xF0\x8F\xBF\xBF", 4, false},     /* overlong */
        {"\xED\xA0\x80", 3, false},         /* a surrogate */
        {"\xF4\x90\x80\x80", 4, false},     /* above U+10FFFF */
        {"\xF5\x80\x80\x80", 4, false},     /* above U+10FFFF */
        {"\xF8\x88\x80\x80\x80", 5, false}, /* five bytes */
        {"\xFF", 1, false},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        message = (proto_message){.type = PROTO_BYE};
        message.as.bye.reason = (proto_str){cases[i].text, cases[i].length};
        CHECK_TEXT(message_verdict(), cases[i].good ? "BYE: 0 at nothing" : "BYE: 203 at reason");
    }
}

/* What the decoder says where `length` is announced, `at` bytes into the payload of `message`, and nothing follows. */
static const char *verdict_with_length(size_t at, size_t width, uint32_t length)
{
    proto_header header;
    unsigned char *payload = proto_payload(&message, at + width, &header);
    for (size_t i = 0; payload && i < width; i++) {
        payload[at + i] = (unsigned char)(length >> (8 * i));
    }
    const char *text = decode_verdict(&header, payload);
    free(payload);
    return text;
}

TEST(proto_counts_are_checked_against_limit_and_remaining_bytes)
{
    rng random = rng_seed(15);
    for (size_t i = 0; proto_layout_at(i); i++) {
        const proto_layout *layout = proto_layout_at(i);
        size_t at = 0;
        for (const proto_field *field = layout->fields; field->name; field++) {
            proto_fill(&message, layout, (fill_sizes){0, 0, 0}, &random);
            size_t width = proto_field_width(field);
            if (!proto_kind_fixed(field->kind)) {
                uint32_t greatest = width == 2 ? UINT16_MAX : UINT32_MAX;
                CHECK_TEXT(verdict_with_length(at, width, field->limit + 1),
                           verdict(layout->name, PROTO_ERROR_LIMIT, field->name));
                CHECK_TEXT(verdict_with_length(at, width, greatest),
                           verdict(layout->name, PROTO_ERROR_LIMIT, field->name));
                CHECK_TEXT(verdict_with_length(at, width, field->limit),
                           verdict(layout->name, PROTO_ERROR_BAD_FRAME, field->name));
            }
            at += width;
        }
    }
}

/* Whatever is accepted has exactly one encoding: what came. */
static void decode_stranger(const proto_header *header, const unsigned char *payload, int *accepted)
{
    if (proto_decode(header, payload, &decoded, NULL) != 0) {
        return;
    }
    size_t size = header->length + PROTO_HEADER_SIZE;
    unsigned char *bytes = malloc(size);
    size_t written = bytes ? proto_encode(&decoded, bytes, size) : 0;
    if (header->type == PROTO_HELLO) {
        CHECK(written > 0 && written <= size); /* a later version's fields are dropped */
    } else {
        CHECK_INT(written, size);
        CHECK_BYTES(bytes + PROTO_HEADER_SIZE, payload, header->length);
    }
    free(bytes);
    ++*accepted;
}

TEST(proto_random_bytes_are_refused_or_understood_whole)
{
    rng random = rng_seed(16);
    int accepted = 0;
    for (size_t i = 0; proto_layout_at(i); i++) {
        for (int turn = 0; turn < 500; turn++) {
            size_t size = rng_u32(&random) % 300;
            unsigned char *payload = malloc(size > 0 ? size : 1);
            for (size_t k = 0; payload && k < size; k++) {
                payload[k] = (unsigned char)(rng_u32(&random) % 4 == 0 ? rng_u32(&random) : 0);
            }
            proto_header header = {.length = (uint32_t)size, .type = proto_layout_at(i)->type};
            decode_stranger(&header, payload, &accepted);
            free(payload);
        }
    }
    CHECK(accepted > 0);
}

TEST(proto_damaged_messages_are_refused_or_understood_whole)
{
    rng random = rng_seed(17);
    int accepted = 0, tried = 0;
    for (size_t i = 0; proto_layout_at(i); i++) {
        for (int turn = 0; turn < 300; turn++) {
            proto_fill(&message, proto_layout_at(i), (fill_sizes){9, 20, 3}, &random);
            proto_header header;
            unsigned char *payload = proto_payload(&message, SIZE_MAX, &header);
            for (uint32_t k = 0; payload && header.length > 0 && k < 1 + rng_u32(&random) % 3; k++) {
                payload[rng_u32(&random) % header.length] ^= (unsigned char)(1u << rng_u32(&random) % 8);
            }
            decode_stranger(&header, payload, &accepted);
            tried++;
            free(payload);
        }
    }
    CHECK(accepted > 0 && accepted < tried);
}

TEST(proto_a_type_that_is_not_in_the_list_is_unknown)
{
    proto_header header = {.length = 0, .type = 0x7777};
    CHECK_TEXT(decode_verdict(&header, (const unsigned char *)""), "unknown: 104 at type");
}
