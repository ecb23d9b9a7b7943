/* test_strangers_memory.c: what a connection costs the daemon whose client has not shown that it may come in: however
 * many there are, and whatever they send, or begin to send. */
#include "check.h"
#include "connection.h"
#include "unit/heap_seam.h"
#include "unit/server_fixture.h"

#include "base/assert.h"
#include "base/bytes.h"

#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

/* Bytes of heap for each: proto/PROTOCOL.md and server/awtd.8 promise it. */
enum { STRANGERS = 100, PROMISED = 2048 };

typedef struct stranger {
    connection *served;
    int fd;
} stranger;

typedef struct crowd {
    service shared;
    homes homes;
    stranger all[STRANGERS];
} crowd;

static void come(crowd *c, stranger *s)
{
    int ends[2];
    ASSERT(socketpair(AF_UNIX, SOCK_STREAM, 0, ends) == 0);
    for (int k = 0; k < 2; k++) {
        ASSERT(fcntl(ends[k], F_SETFL, fcntl(ends[k], F_GETFL) | O_NONBLOCK) == 0);
    }
    s->fd = ends[1];
    s->served = connection_create(&c->shared, ends[0], "stranger");
    ASSERT(s->served);
    service_lock(&c->shared);
    connection_enter(s->served, homes_cold(&c->homes)); /* where newcomers begin when there are many */
    service_unlock(&c->shared);
}

static void go(crowd *c, stranger *s)
{
    service_lock(&c->shared);
    connection_drop(s->served, "the test is over");
    CHECK(connection_close(s->served));
    service_unlock(&c->shared);
    connection_destroy(s->served);
    close(s->fd);
}

/* Turns for all who have something to do. */
static void settle(crowd *c)
{
    for (connection *told; (told = home_take(homes_cold(&c->homes))) != NULL;) {
        connection_turn(told, 0);
    }
}

/* Each says it byte by byte or whole, and the daemon does with it what it can. */
static int64_t bytes_for_each(const unsigned char *said, size_t size, size_t piece)
{
    static crowd c;
    CHECK(fake_service_init(&c.shared, 0, 1, true));
    CHECK(homes_init(&c.homes, 1));
    heap_watch();
    for (int i = 0; i < STRANGERS; i++) {
        come(&c, &c.all[i]);
        for (size_t at = 0; at < size; at += piece) {
            CHECK(send(c.all[i].fd, said + at, piece < size - at ? piece : size - at, MSG_NOSIGNAL) > 0);
            settle(&c);
            connection_turn(c.all[i].served, POLLIN);
        }
        settle(&c);
    }
    const int64_t most = heap_look().most_bytes;
    for (int i = 0; i < STRANGERS; i++) {
        go(&c, &c.all[i]);
    }
    CHECK_INT(heap_watch_end().blocks, 0);
    homes_fini(&c.homes);
    service_fini(&c.shared);
    return most / STRANGERS;
}

static void check(const char *name, const unsigned char *said, size_t size, size_t piece)
{
    const int64_t each = bytes_for_each(said, size, piece);
    printf("     %s: %lld bytes each\n", name, (long long)each);
    CHECK(each > 0 && each <= PROMISED);
}

TEST(strangers_cost_little_memory_whatever_they_begin_to_send)
{
    unsigned char greeting[PROTO_HEADER_SIZE + PROTO_MAX_GREETING] = {0}, longer[PROTO_HEADER_SIZE] = {0};
    proto_message hello = fake_hello();
    hello.as.hello.client = proto_str_of("one whose name is as long as names may be, and it is this long..");
    hello.as.hello.length = (uint16_t)(proto_encoded_size(&hello) - PROTO_HEADER_SIZE);
    const size_t size = proto_encode(&hello, greeting, sizeof greeting);
    check("nothing", greeting, 0, 1);
    check("half a header", greeting, PROTO_HEADER_SIZE / 2, 1);
    check("HELLO but for a byte", greeting, size - 1, 7);
    check("HELLO", greeting, size, size);
    store_u32(greeting, PROTO_MAX_GREETING);
    check("as much as is taken, but for a byte", greeting, sizeof greeting - 1, 64);
    store_u32(longer, 2 << 20);
    store_u16(longer + 4, PROTO_UPLOAD);
    check("an upload", longer, sizeof longer, sizeof longer);
}
