/* test_proto_roundtrip.c: what the encoder writes is what the decoder reads, for every message in the list, and the
 * bytes are those that PROTOCOL.md promises, whatever the machine's own byte order. */
#include "check.h"
#include "proto_fill.h"

#include <stdlib.h>
#include <string.h>

static void round_trip(const proto_layout *layout, fill_sizes sizes, rng *random)
{
    static proto_message sent, got;
    proto_header header;
    proto_fill(&sent, layout, sizes, random);
    unsigned char *payload = proto_payload(&sent, SIZE_MAX, &header);
    const char *where = "nothing";
    int code = payload ? proto_decode(&header, payload, &got, &where) : -1;
    CHECK_INT(code, 0);
    if (code != 0) {
        CHECK_TEXT(layout->name, where);
    } else {
        const char *difference = proto_difference(&sent, &got);
        CHECK_TEXT(difference ? difference : layout->name, layout->name);
    }
    free(payload);
}

TEST(proto_every_message_round_trips_at_least_and_greatest_sizes)
{
    rng random = rng_seed(1);
    for (size_t i = 0; proto_layout_at(i); i++) {
        round_trip(proto_layout_at(i), (fill_sizes){0, 0, 0}, &random);
        round_trip(proto_layout_at(i), (fill_sizes){UINT32_MAX, UINT32_MAX, UINT32_MAX}, &random);
    }
}

TEST(proto_every_message_round_trips_with_many_values)
{
    rng random = rng_seed(2);
    for (size_t i = 0; proto_layout_at(i); i++) {
        for (uint32_t turn = 0; turn < 50; turn++) {
            round_trip(proto_layout_at(i), (fill_sizes){turn, 3 * turn, turn % 5}, &random);
        }
    }
}

TEST(proto_size_and_writer_agree_to_the_byte)
{
    static proto_message message;
    rng random = rng_seed(3);
    for (size_t i = 0; proto_layout_at(i); i++) {
        proto_fill(&message, proto_layout_at(i), (fill_sizes){20, 100, 2}, &random);
        size_t size = proto_encoded_size(&message);
        unsigned char *bytes = malloc(size);
        if (bytes) {
            CHECK_INT(proto_encode(&message, bytes, size), size);
            CHECK_INT(proto_header_read(bytes).length, size - PROTO_HEADER_SIZE);
            CHECK_INT(proto_encode(&message, bytes, size - 1), 0);
        }
        free(bytes);
    }
}

TEST(proto_head_leaves_out_nothing_but_the_tail)
{
    static proto_message message;
    static unsigned char whole[8192], head[8192];
    rng random = rng_seed(4);
    for (size_t i = 0; proto_layout_at(i); i++) {
        proto_fill(&message, proto_layout_at(i), (fill_sizes){20, 100, 2}, &random);
        const proto_blob *tail = proto_tail(&message);
        size_t tail_size = tail ? tail->length : 0;
        size_t size = proto_encode(&message, whole, sizeof whole);
        CHECK(size > 0);
        CHECK_INT(proto_encode_head(&message, head, size - tail_size - 1), 0);
        CHECK_INT(proto_encode_head(&message, head, size - tail_size), size - tail_size);
        CHECK_BYTES(head, whole, size - tail_size);
        if (tail) {
            CHECK_BYTES(whole + size - tail_size, tail->bytes, tail_size);
        }
    }
    message = (proto_message){.type = PROTO_FRAME};
    CHECK(proto_tail(&message) == &message.as.frame.glb);
}

TEST(proto_bytes_are_little_endian_and_packed)
{
    proto_message hello = {.type = PROTO_HELLO, .flags = 1, .request = UINT64_C(0x1122334455667788)};
    memcpy(hello.as.hello.magic, PROTO_MAGIC, 4);
    hello.as.hello.lowest_version = 1;
    hello.as.hello.highest_version = 3;
    memcpy(hello.as.hello.routing_key, "0123456789abcdef", 16);
    hello.as.hello.client = proto_str_of("me");
    static const unsigned char hello_bytes[] = "\x1C\0\0\0\x01\0\x01\0\x88\x77\x66\x55\x44\x33\x22\x11"
                                               "AWTD\x01\x03\x1C\0"
                                               "0123456789abcdef\x02\0me";
    unsigned char bytes[128];
    CHECK_INT(proto_encode(&hello, bytes, sizeof bytes), sizeof hello_bytes - 1);
    CHECK_BYTES(bytes, hello_bytes, sizeof hello_bytes - 1);
    CHECK_BYTES(bytes + 24, "0123456789abcdef", 16); /* where balancers look */

    proto_message clock = {.type = PROTO_SET_CLOCK};
    clock.as.set_clock.forest = 2;
    clock.as.set_clock.mode = 1;
    clock.as.set_clock.rate = -0.5f;
    static const unsigned char clock_payload[] = "\x02\0\0\0\0\0\0\0\x01\0\0\0\xBF\0\0\x80\x3F";
    clock.as.set_clock.importance = 1;
    CHECK_INT(proto_encode(&clock, bytes, sizeof bytes), PROTO_HEADER_SIZE + 17);
    CHECK_BYTES(bytes + PROTO_HEADER_SIZE, clock_payload, 17);

    proto_message upload = {.type = PROTO_UPLOAD};
    upload.as.upload.piece = (proto_blob){(const unsigned char *)"xyz", 3};
    CHECK_INT(proto_encode(&upload, bytes, sizeof bytes), PROTO_HEADER_SIZE + 59);
    CHECK_BYTES(bytes + PROTO_HEADER_SIZE + 52, "\x03\0\0\0xyz", 7);
}

TEST(proto_encoder_refuses_what_is_over_its_limit)
{
    static proto_message message;
    static char text[UINT16_MAX + 2];
    unsigned char bytes[512];
    memset(text, 'a', sizeof text - 1);
    message = (proto_message){.type = PROTO_BYE};
    message.as.bye.reason = (proto_str){text, 160};
    CHECK_INT(proto_encoded_size(&message), PROTO_HEADER_SIZE + 2 + 160);
    message.as.bye.reason.length = 161;
    CHECK_INT(proto_encoded_size(&message), 0);
    CHECK_INT(proto_encode(&message, bytes, sizeof bytes), 0);
    CHECK_INT(proto_encode_head(&message, bytes, sizeof bytes), 0);
    CHECK_INT(proto_str_of(text).length, UINT16_MAX);

    message = (proto_message){.type = PROTO_MOTION};
    message.as.motion.colliders.count = 17;
    CHECK_INT(proto_encoded_size(&message), 0);
    message = (proto_message){.type = PROTO_UPLOAD};
    message.as.upload.piece.length = 1048577;
    CHECK_INT(proto_encoded_size(&message), 0);
    message = (proto_message){.type = 0x7777};
    CHECK_INT(proto_encoded_size(&message), 0);
}

TEST(proto_names_and_errors_come_from_the_lists)
{
    CHECK_TEXT(proto_type_name(PROTO_MOTION), "MOTION");
    CHECK_TEXT(proto_type_name(PROTO_CREATE_REPLY), "CREATE_REPLY");
    CHECK_TEXT(proto_type_name(0x7777), "unknown");
    CHECK(proto_type_known(PROTO_FRAME) && !proto_type_known(0));
    CHECK_TEXT(proto_error_text(PROTO_ERROR_NO_FOREST), "no such forest");
    CHECK(proto_error_retry(PROTO_ERROR_BUSY) && !proto_error_closes(PROTO_ERROR_BUSY));
    CHECK(!proto_error_retry(PROTO_ERROR_BAD_FRAME) && proto_error_closes(PROTO_ERROR_BAD_FRAME));
    CHECK_TEXT(proto_error_text(7), "an error that this version does not know");
}

/* proto_encode_head and the daemon's shared frames rest on it. */
TEST(proto_blobs_stand_last_and_only_in_messages)
{
    for (size_t i = 0; proto_layout_at(i); i++) {
        for (const proto_field *field = proto_layout_at(i)->fields; field->name; field++) {
            CHECK(field->kind != PROTO_KIND_blob || !field[1].name);
        }
    }
    for (size_t i = 0; proto_record_at(i); i++) {
        for (const proto_field *field = proto_record_at(i)->fields; field->name; field++) {
            CHECK(field->kind != PROTO_KIND_blob && field->kind != PROTO_KIND_list);
        }
    }
}

TEST(proto_text_is_cut_between_characters)
{
    char out[8];
    proto_str_copy(proto_str_of("ab\xE2\x82\xAC"), out, sizeof out);
    CHECK_TEXT(out, "ab\xE2\x82\xAC");
    proto_str_copy(proto_str_of("ab\xE2\x82\xAC"), out, 5);
    CHECK_TEXT(out, "ab");
    proto_str_copy(proto_str_of("abcdefghijk"), out, sizeof out);
    CHECK_TEXT(out, "abcdefg");
    proto_str_copy((proto_str){NULL, 0}, out, sizeof out);
    CHECK_TEXT(out, "");
}
