/* test_server_parts.c: the small parts of the daemon: handles, input, output, log text. */
#include "check.h"
#include "clock.h"
#include "handles.h"
#include "input.h"
#include "limits.h"
#include "log.h"
#include "output.h"

#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

TEST(server_handles_go_stale)
{
    handle_table table;
    int a = 0, b = 0;
    CHECK(handle_table_init(&table, 2));
    CHECK(handle_find(&table, 0) == NULL);
    uint64_t first = handle_add(&table, &a), second = handle_add(&table, &b);
    CHECK(first != 0 && second != 0 && first != second);
    CHECK(handle_add(&table, &a) == 0);
    CHECK(handle_find(&table, first) == &a);
    CHECK(handle_find(&table, second) == &b);
    handle_remove(&table, first);
    CHECK(handle_find(&table, first) == NULL);
    uint64_t third = handle_add(&table, &b);
    CHECK(third != first);
    CHECK((third & UINT32_MAX) == (first & UINT32_MAX));
    CHECK(handle_find(&table, first) == NULL);
    CHECK(handle_find(&table, third) == &b);
    CHECK(handle_find(&table, UINT64_MAX) == NULL);
    table.slots[0].generation = UINT32_MAX; /* after four thousand million lives: round again, but never 0 */
    handle_remove(&table, (uint64_t)UINT32_MAX << 32);
    CHECK(handle_add(&table, &a) == UINT64_C(1) << 32);
    handle_table_fini(&table);
}

/* Two messages and between them one that is skipped. */
static size_t make_stream(unsigned char *bytes, size_t capacity)
{
    proto_message ping = {.type = PROTO_PING, .request = 1};
    ping.as.ping.sent_us = 42;
    size_t size = proto_encode(&ping, bytes, capacity);
    size_t skipped = proto_encode(&ping, bytes + size, capacity - size);
    bytes[size + 4] = 0x77; /* an unknown type */
    size += skipped;
    ping.as.ping.sent_us = 43;
    return size + proto_encode(&ping, bytes + size, capacity - size);
}

/* What comes out when bytes come in steps of `step`: the pings' times as digits. */
static int read_in_steps(const unsigned char *bytes, size_t size, size_t step)
{
    input in = {0};
    int seen = 0;
    for (size_t at = 0; at < size;) {
        unsigned char *room = NULL;
        size_t space = input_room(&in, PROTO_HEADER_SIZE + PROTO_MAX_GREETING, &room);
        size_t now = size - at < step ? size - at : step;
        now = now < space ? now : space;
        memcpy(room, bytes + at, now);
        input_came(&in, now);
        at += now;
        proto_header header;
        const unsigned char *payload = NULL;
        for (input_event event; (event = input_next(&in, &header, &payload)) != INPUT_MORE;) {
            if (event == INPUT_MESSAGE) {
                seen = seen * 100 + payload[0];
                input_done(&in);
            } else if (header.type == PROTO_PING) {
                input_take(&in, &header);
            } else {
                input_skip(&in, &header);
            }
        }
    }
    CHECK(!input_ready(&in));
    input_fini(&in);
    return seen;
}

TEST(server_input_is_the_same_however_it_is_cut)
{
    unsigned char bytes[256];
    size_t size = make_stream(bytes, sizeof bytes);
    CHECK_U64(size, 3 * (PROTO_HEADER_SIZE + 8));
    for (size_t step = 1; step <= size; step++) {
        CHECK_INT(read_in_steps(bytes, size, step), 4243);
    }
}

TEST(server_input_grows_with_the_bytes_that_come)
{
    input in = {0};
    unsigned char *room = NULL;
    proto_header header = {0};
    const unsigned char *payload = NULL;
    const size_t announced = PROTO_MAX_REQUEST;
    CHECK(input_room(&in, PROTO_HEADER_SIZE, &room) >= PROTO_HEADER_SIZE);
    const unsigned char head[PROTO_HEADER_SIZE] = {0, 0, PROTO_MAX_REQUEST >> 16, 0, PROTO_UPLOAD};
    memcpy(room, head, sizeof head);
    input_came(&in, sizeof head);
    CHECK_INT(input_next(&in, &header, &payload), INPUT_HEADER);
    CHECK_INT(header.length, announced);
    input_take(&in, &header);
    for (size_t came = 0; came < announced;) {
        size_t space = input_room(&in, PROTO_HEADER_SIZE, &room);
        CHECK(space > 0 && in.capacity <= 2 * (PROTO_HEADER_SIZE + came + 1));
        size_t now = space < announced - came ? space : announced - came;
        memset(room, 0x33, now);
        input_came(&in, now);
        came += now;
    }
    CHECK_U64(in.capacity, PROTO_HEADER_SIZE + announced);
    CHECK_INT(input_next(&in, &header, &payload), INPUT_MESSAGE);
    CHECK_INT(payload[announced - 1], 0x33);
    input_done(&in);
    CHECK(in.capacity <= LIMIT_INPUT_KEPT);
    input_fini(&in);
}

static int64_t test_clock_us(void)
{
    static int64_t now_us = 1000;
    return now_us += 10;
}

/* A picture with one view, a GLB of `size` bytes. */
static picture *make_picture(size_t size)
{
    picture *p = picture_create();
    CHECK(p != NULL);
    view *v = picture_add(p, (view_name){0});
    v->glb.bytes = malloc(size);
    CHECK(v->glb.bytes != NULL);
    v->glb.size = v->glb.capacity = size;
    for (size_t i = 0; i < size; i++) {
        v->glb.bytes[i] = (unsigned char)(i * 7);
    }
    p->stepped_us = 900;
    return p;
}

/* Two ends that never block. */
static void make_pair(int ends[2])
{
    CHECK(socketpair(AF_UNIX, SOCK_STREAM, 0, ends) == 0);
    CHECK(fcntl(ends[0], F_SETFL, O_NONBLOCK) == 0);
    CHECK(fcntl(ends[1], F_SETFL, O_NONBLOCK) == 0);
}

/* Reads what is there and appends it. */
static size_t drain(int fd, unsigned char *bytes, size_t used, size_t capacity)
{
    for (ssize_t got; (got = recv(fd, bytes + used, capacity - used, 0)) > 0;) {
        used += (size_t)got;
    }
    return used;
}

/* Sends until all is sent or the socket takes no more. */
static net_result write_out(output *out, int fd)
{
    net_result result = NET_DONE;
    while (out->first && result == NET_DONE) {
        struct iovec pieces[LIMIT_OUTPUT_GATHER];
        size_t sent = 0, count = output_gather(out, pieces, test_clock_us());
        result = net_send(fd, pieces, count, &sent);
        output_took(out, sent, test_clock_us());
    }
    return result;
}

TEST(server_output_sends_frames_whole_through_a_narrow_socket)
{
    enum { GLB = 3 * 1000 * 1000, CAPACITY = 2 * GLB + 4096 };
    int ends[2];
    make_pair(ends);
    output out = {0};
    proto_message ping = {.type = PROTO_PING};
    picture *shown = make_picture(GLB);
    CHECK(output_add_message(&out, &ping));
    CHECK(output_add_picture(&out, picture_hold(shown), shown->views, &(delivery){.request = 5, .skipped = 2}));
    CHECK(output_add_picture(&out, picture_hold(shown), shown->views, &(delivery){.request = 6}));
    CHECK(out.bytes > 2 * (size_t)GLB);
    unsigned char *bytes = malloc(CAPACITY);
    size_t used = 0;
    int calls = 0, refusals = 0;
    for (; out.first && calls < 100000; calls++) {
        refusals += write_out(&out, ends[0]) == NET_LATER;
        used = drain(ends[1], bytes, used, CAPACITY);
    }
    CHECK(refusals > 0); /* it was narrow */
    used = drain(ends[1], bytes, used, CAPACITY);
    CHECK_U64(out.frames_sent, 2);
    CHECK_U64(out.bytes, 0);
    CHECK_U64(out.bytes_sent, used);
    CHECK(out.last_write_us > 0);

    size_t at = PROTO_HEADER_SIZE + 8;
    for (uint64_t request = 5; request <= 6; request++) {
        proto_message message;
        proto_header header = proto_header_read(bytes + at);
        CHECK_U64(header.request, request);
        CHECK_INT(proto_decode(&header, bytes + at + PROTO_HEADER_SIZE, &message, NULL), 0);
        CHECK_INT(message.as.frame.skipped, request == 5 ? 2 : 0);
        CHECK((message.as.frame.last_write_us > 0) == (request == 6));
        CHECK(message.as.frame.age_us > 0);
        CHECK_BYTES(message.as.frame.glb.bytes, shown->views[0].glb.bytes, GLB);
        at += PROTO_HEADER_SIZE + header.length;
    }
    CHECK_U64(at, used);
    picture_release(shown);
    output_fini(&out);
    free(bytes);
    close(ends[0]);
    close(ends[1]);
}

TEST(server_output_to_a_peer_that_is_gone_fails_without_a_signal)
{
    int ends[2];
    make_pair(ends);
    close(ends[1]);
    output out = {0};
    picture *shown = make_picture(100);
    CHECK(output_add_picture(&out, shown, shown->views, &(delivery){.request = 1}));
    CHECK_INT(write_out(&out, ends[0]), NET_FAILED);
    output_fini(&out); /* frees the picture */
    close(ends[0]);
}

TEST(server_log_text_cannot_forge_a_line)
{
    char out[LOG_QUOTED];
    CHECK_TEXT(log_quote("plain text", 10, out), "\"plain text\"");
    CHECK_TEXT(log_quote("a\n2025 error \"x\\", 16, out), "\"a\\x0a2025 error \\\"x\\\\\"");
    CHECK_TEXT(log_quote("\x1b[0m\xc3\xa9", 6, out), "\"\\x1b[0m\\xc3\\xa9\"");
    char longest[1000];
    memset(longest, 1, sizeof longest);
    CHECK(strlen(log_quote(longest, sizeof longest, out)) < LOG_QUOTED);
    CHECK(out[strlen(out) - 1] == '"');
}

TEST(server_sleeps_a_minute_at_most_where_something_is_due_in_a_year)
{
    const int64_t now_us = 5000000, year_us = INT64_C(31536000) * 1000000;
    CHECK_INT(clock_poll_ms(now_us, INT64_MAX), -1);
    CHECK_INT(clock_poll_ms(now_us, now_us - 1), 0);
    CHECK_INT(clock_poll_ms(now_us, now_us), 0);
    CHECK_INT(clock_poll_ms(now_us, now_us + 1), 1); /* never too early */
    CHECK_INT(clock_poll_ms(now_us, now_us + 2500), 3);
    CHECK_INT(clock_poll_ms(now_us, now_us + year_us), 60000); /* in an int of milliseconds it would be negative */
}
