/* test_load_floor.c: the bare server that awtd is measured against: what it answers, and that it bears strangers. */
#include "check.h"

#include "e2e/daemon.h"
#include "load/floor.h"

#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

enum { PATIENCE_S = 20, BIG = 3000000 };

static int connect_to(const floor_process *p)
{
    daemon_process place = {.pid = 0};
    const struct timeval patience = {.tv_sec = PATIENCE_S};
    snprintf(place.address, sizeof place.address, "%s", p->address);
    const int descriptor = daemon_socket(&place);
    if (descriptor >= 0) {
        setsockopt(descriptor, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    }
    return descriptor;
}

static void ask(int descriptor, floor_request r)
{
    unsigned char bytes[FLOOR_REQUEST_MOST] = {0};
    floor_request_write(&r, bytes);
    CHECK_INT(send(descriptor, bytes, r.size, MSG_NOSIGNAL), r.size);
}

/* The next whole answer; size 0: the connection has ended. */
static floor_answer answer(int descriptor)
{
    static unsigned char rest[BIG];
    unsigned char head[FLOOR_ANSWER_SIZE];
    if (recv(descriptor, head, sizeof head, MSG_WAITALL) != (ssize_t)sizeof head) {
        return (floor_answer){0, 0};
    }
    const floor_answer a = floor_answer_read(head);
    const size_t left = a.size - sizeof head;
    if (left > sizeof rest || (left > 0 && recv(descriptor, rest, left, MSG_WAITALL) != (ssize_t)left)) {
        return (floor_answer){0, 0};
    }
    return a;
}

static void check_answer(int descriptor, uint32_t size, uint64_t id)
{
    const floor_answer a = answer(descriptor);
    CHECK_U64(a.size, size);
    CHECK_U64(a.id, id);
}

TEST(load_floor_answers_as_many_bytes_as_are_asked_for)
{
    floor_process p;
    char error[256] = "";
    CHECK(floor_start(&p, error, sizeof error));
    CHECK_TEXT(error, "");
    int descriptor = connect_to(&p);
    ask(descriptor, (floor_request){FLOOR_REQUEST_SIZE, FLOOR_ANSWER_SIZE, FLOOR_PING, 0, 7});
    check_answer(descriptor, FLOOR_ANSWER_SIZE, 7);
    ask(descriptor, (floor_request){190, BIG, FLOOR_PING, 0, 8}); /* more than a socket takes at once */
    ask(descriptor, (floor_request){35, 20000, FLOOR_PING, 0, 9});
    check_answer(descriptor, BIG, 8);
    check_answer(descriptor, 20000, 9);
    close(descriptor);
    floor_stop(&p);
}

TEST(load_floor_fans_out_to_those_who_joined_the_group)
{
    floor_process p;
    char error[256];
    CHECK(floor_start(&p, error, sizeof error));
    int driver = connect_to(&p), viewers[3];
    for (uint32_t i = 0; i < 3; i++) {
        viewers[i] = connect_to(&p);
        ask(viewers[i], (floor_request){FLOOR_REQUEST_SIZE, FLOOR_ANSWER_SIZE, FLOOR_JOIN, i == 2 ? 6 : 5, 0});
        ask(viewers[i], (floor_request){FLOOR_REQUEST_SIZE, FLOOR_ANSWER_SIZE, FLOOR_PING, 0, 1}); /* it has joined */
        check_answer(viewers[i], FLOOR_ANSWER_SIZE, 1);
    }
    ask(driver, (floor_request){190, 20000, FLOOR_FAN, 5, 40});
    check_answer(driver, 20000, 40);
    check_answer(viewers[0], 20000, 40);
    check_answer(viewers[1], 20000, 40);
    ask(driver, (floor_request){190, 300, FLOOR_FAN, 6, 41});
    check_answer(viewers[2], 300, 41); /* the first it gets: the other group's was not for it */
    for (int i = 0; i < 3; i++) {
        close(viewers[i]);
    }
    close(driver);
    floor_stop(&p);
}

TEST(load_floor_lets_go_of_who_lies_about_lengths_and_serves_on)
{
    static const floor_request lies[] = {
        {FLOOR_REQUEST_SIZE - 1, 20, FLOOR_PING, 0, 1},
        {FLOOR_REQUEST_MOST + 1, 20, FLOOR_PING, 0, 1},
        {FLOOR_REQUEST_SIZE, FLOOR_ANSWER_SIZE - 1, FLOOR_PING, 0, 1},
        {FLOOR_REQUEST_SIZE, FLOOR_ANSWER_MOST + 1, FLOOR_PING, 0, 1},
        {FLOOR_REQUEST_SIZE, FLOOR_ANSWER_SIZE, 99, 0, 1},
    };
    floor_process p;
    char error[256];
    CHECK(floor_start(&p, error, sizeof error));
    int honest = connect_to(&p);
    for (size_t i = 0; i < sizeof lies / sizeof lies[0]; i++) {
        unsigned char bytes[FLOOR_REQUEST_SIZE];
        int liar = connect_to(&p);
        floor_request_write(&lies[i], bytes);
        CHECK_INT(send(liar, bytes, sizeof bytes, MSG_NOSIGNAL), sizeof bytes);
        CHECK_U64(answer(liar).size, 0);
        close(liar);
        ask(honest, (floor_request){FLOOR_REQUEST_SIZE, 100, FLOOR_PING, 0, i});
        check_answer(honest, 100, i);
    }
    close(honest);
    const floor_process gone = p;
    floor_stop(&p);
    CHECK_INT(connect_to(&gone), -1);
}

TEST(load_floor_says_why_it_cannot_listen)
{
    char bound[FLOOR_ADDRESS], error[256] = "";
    CHECK_INT(floor_listen("nowhere", bound, error, sizeof error), -1);
    CHECK(strstr(error, "HOST:PORT") != NULL);
    CHECK_INT(floor_listen("192.0.2.1:0", bound, error, sizeof error), -1); /* an address of nobody */
    CHECK(strstr(error, "cannot listen at 192.0.2.1:0") != NULL);
}
