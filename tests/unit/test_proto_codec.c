/* test_proto_codec.c: the client's codec, without a socket: a stream of bytes from whoever is at the other end. */
#include "check.h"
#include "codec.h"

#include <string.h>

static void feed(awtcodec *codec, const unsigned char *bytes, size_t size)
{
    while (size > 0) {
        size_t room = 0;
        unsigned char *place = awtcodec_room(codec, &room);
        size_t take = room < size ? room : size;
        memcpy(place, bytes, take);
        awtcodec_filled(codec, take);
        bytes += take;
        size -= take;
    }
}

TEST(client_codec_takes_messages_cut_anywhere)
{
    static proto_message got;
    static unsigned char stream[4096];
    proto_message goaway = {.type = PROTO_GOAWAY, .request = 5};
    goaway.as.goaway.reason = proto_str_of("upgrade");
    size_t size = proto_encode(&goaway, stream, sizeof stream);
    memcpy(stream + size, "\x03\0\0\0\x77\x77\0\0\0\0\0\0\0\0\0\0abc", 19); /* of a later version, not required */
    size += 19;
    goaway.request = 6;
    size += proto_encode(&goaway, stream + size, sizeof stream - size);
    for (size_t piece = 1; piece <= size; piece++) {
        awtcodec codec;
        awtcodec_init(&codec);
        codec.in = true;
        uint64_t seen = 0;
        for (size_t at = 0; at < size; at += piece) {
            feed(&codec, stream + at, size - at < piece ? size - at : piece);
            while (awtcodec_next(&codec, &got, NULL) == AWTCODEC_MESSAGE) {
                CHECK_INT(got.as.goaway.reason.length, 7);
                seen = seen * 10 + got.request;
            }
        }
        CHECK_U64(seen, 56);
        awtcodec_fini(&codec);
    }
}

TEST(client_codec_refuses_an_unknown_message_that_must_be_understood)
{
    static proto_message got;
    awtcodec codec;
    awtclient_error error;
    awtcodec_init(&codec);
    codec.in = true;
    feed(&codec, (const unsigned char *)"\0\0\0\0\x77\x77\x01\0\0\0\0\0\0\0\0\0", PROTO_HEADER_SIZE);
    CHECK_INT(awtcodec_next(&codec, &got, &error), AWTCODEC_BAD);
    CHECK_INT(error.code, AWTCLIENT_PEER);
    awtcodec_fini(&codec);
}

TEST(client_codec_refuses_what_only_clients_send)
{
    static proto_message got;
    awtcodec codec;
    awtclient_error error;
    awtcodec_init(&codec);
    codec.in = true;
    feed(&codec, (const unsigned char *)"\0\0\0\0\x16\0\0\0\0\0\0\0\0\0\0\0", PROTO_HEADER_SIZE);
    CHECK_INT(awtcodec_next(&codec, &got, &error), AWTCODEC_BAD);
    CHECK_TEXT(error.text, "the other end is no daemon: it sent LIST, which only clients send");
    awtcodec_fini(&codec);
}

TEST(client_codec_memory_follows_what_came_not_what_was_announced)
{
    static proto_message got;
    static const unsigned char zeros[100000];
    awtcodec codec;
    awtcodec_init(&codec);
    codec.in = true;
    feed(&codec, (const unsigned char *)"\0\0\0\x04\x34\0\0\0\0\0\0\0\0\0\0\0", PROTO_HEADER_SIZE); /* FRAME, 64 MiB */
    for (size_t came = sizeof zeros; came < 4000000; came += sizeof zeros) {
        CHECK_INT(awtcodec_next(&codec, &got, NULL), AWTCODEC_MORE);
        feed(&codec, zeros, sizeof zeros);
        CHECK(codec.capacity <= 2 * came + (64 << 10));
    }
    awtcodec_fini(&codec);
}
