/* bare.c: see bare.h. */
#include "load/bare.h"

#include "load/floor.h"
#include "load/wait.h"
#include "socket.h"

#include <poll.h>
#include <stdlib.h>
#include <string.h>

enum {
    BARE_ASK = 35,    /* bytes of a QUERY */
    BARE_DRIVE = 190, /* of a MOTION and a QUERY */
    BARE_PIECE = 65536,
    BARE_OUT = MEMBER_WAITING * BARE_DRIVE
};

typedef struct bare {
    member m;                    /* first */
    awtlink_transport transport; /* send NULL: there is no connection just now */
    uint32_t head, viewers;
    uint64_t last; /* request ids, or steps */
    bool visits;
    unsigned char out[BARE_OUT]; /* [out_size] requests that are still to go out */
    size_t out_size;
    uint32_t got, size; /* of the answer that is coming; size 0: its head is not all there */
    unsigned char answer[FLOOR_ANSWER_SIZE];
} bare;

/* ---- the socket -------------------------------------------------------------------------------------------------- */

static bool bare_connect(bare *b)
{
    awtclient_error error;
    if (!socket_begin(b->m.run->floor, &b->transport, &error)) {
        book_error(&b->m.run->book, "the bare server: %s", error.text);
        return false;
    }
    b->m.descriptor = b->transport.descriptor(b->transport.context);
    return true;
}

static void bare_disconnect(bare *b)
{
    if (b->transport.send) {
        b->transport.close(b->transport.context);
    }
    b->transport = (awtlink_transport){.send = NULL};
    b->m.descriptor = -1;
    b->out_size = 0;
    b->got = b->size = 0;
}

static void bare_fail(bare *b, const char *what)
{
    book_error(&b->m.run->book, "the bare server %s", what);
    bare_disconnect(b);
    b->m.waiting_count = 0;
    atomic_store(&b->m.run->failed, true);
}

/* What the socket takes now; at first it is still connecting. */
static void bare_flush(bare *b)
{
    awtclient_error error;
    while (b->out_size > 0) {
        const long sent = b->transport.send(b->transport.context, b->out, b->out_size, &error);
        if (sent == AWTLINK_WANT_WRITE) {
            break;
        }
        if (sent <= 0) {
            bare_fail(b, "takes no requests");
            return;
        }
        memmove(b->out, b->out + sent, b->out_size - (size_t)sent);
        b->out_size -= (size_t)sent;
    }
    b->m.descriptor = b->transport.descriptor(b->transport.context);
    b->m.events = b->out_size > 0 ? POLLIN | POLLOUT : POLLIN;
}

static void bare_send(bare *b, uint32_t what, uint32_t size, uint32_t answer, uint64_t id)
{
    if (b->out_size + size > sizeof b->out) {
        bare_fail(b, "takes no requests");
        return;
    }
    memset(b->out + b->out_size, 0, size);
    floor_request_write(&(floor_request){size, answer, what, b->head, id}, b->out + b->out_size);
    b->out_size += size;
    bare_flush(b);
}

/* ---- answers ----------------------------------------------------------------------------------------------------- */

static void bare_whole(bare *b, const floor_answer *a)
{
    book *to = &b->m.run->book;
    const int64_t now_ns = wait_now_ns();
    int64_t due_ns, sent_ns;
    uint32_t slice;
    member_due due;
    if (!b->m.face->due) {
        if (steps_get(&b->m.run->heads.heads[b->head].steps[LOAD_BARE], a->id, &slice, &due_ns, &sent_ns)) {
            book_answer(to, LOAD_FLOOR, slice, now_ns - due_ns, -1, a->size);
        }
        return;
    }
    if (!member_answered(&b->m, a->id, &due)) {
        bare_fail(b, "answers what was not asked");
        return;
    }
    if (b->viewers == 0) {
        book_answer(to, LOAD_FLOOR, due.slice, now_ns - due.due_ns, -1, a->size);
    }
    if (b->visits && b->m.waiting_count == 0) {
        bare_disconnect(b);
    }
    member_next(&b->m);
}

/* Takes bytes off what came; how many it took. */
static size_t bare_take(bare *b, const unsigned char *bytes, size_t count)
{
    if (b->got < FLOOR_ANSWER_SIZE) {
        const size_t missing = FLOOR_ANSWER_SIZE - b->got, taken = count < missing ? count : missing;
        memcpy(b->answer + b->got, bytes, taken);
        b->got += (uint32_t)taken;
        b->size = b->got == FLOOR_ANSWER_SIZE ? floor_answer_read(b->answer).size : 0;
        if (b->got == FLOOR_ANSWER_SIZE && (b->size < FLOOR_ANSWER_SIZE || b->size > FLOOR_ANSWER_MOST)) {
            bare_fail(b, "is none");
        }
        return taken;
    }
    const size_t missing = b->size - b->got, taken = count < missing ? count : missing;
    b->got += (uint32_t)taken;
    return taken;
}

static void bare_bytes(bare *b, const unsigned char *bytes, size_t count)
{
    while (count > 0 && b->transport.send) {
        const size_t taken = bare_take(b, bytes, count);
        bytes += taken;
        count -= taken;
        if (b->size > 0 && b->got == b->size) {
            b->got = b->size = 0;
            const floor_answer whole = floor_answer_read(b->answer);
            bare_whole(b, &whole);
        }
    }
}

static void bare_turn(member *m, short revents)
{
    bare *b = (bare *)m;
    awtclient_error error;
    unsigned char bytes[BARE_PIECE];
    if (revents & POLLOUT) {
        bare_flush(b);
    }
    if (!b->transport.send || !(revents & ~POLLOUT)) {
        return;
    }
    const long got = b->transport.receive(b->transport.context, bytes, sizeof bytes, &error);
    if (got > 0) {
        bare_bytes(b, bytes, (size_t)got);
    } else if (got != AWTLINK_WANT_READ && got != AWTLINK_WANT_WRITE) {
        bare_fail(b, "has closed a connection");
    }
}

static void bare_leave(member *m)
{
    bare_disconnect((bare *)m);
    free(m);
}

/* ---- what each does ---------------------------------------------------------------------------------------------- */

/* As large as the daemon's frames have been so far. */
static uint32_t bare_frame_size(const bare *b)
{
    const uint64_t mean = book_mean_bytes(&b->m.run->book, LOAD_PLAIN);
    const uint64_t size = mean > 0 ? mean : (uint64_t)atomic_load(&b->m.run->heads.heads[b->head].frame_bytes);
    return size < FLOOR_ANSWER_SIZE ? FLOOR_ANSWER_SIZE : size > FLOOR_ANSWER_MOST ? FLOOR_ANSWER_MOST : (uint32_t)size;
}

static void bare_ask(member *m, uint32_t slice, int64_t due_ns, int64_t now_ns)
{
    bare *b = (bare *)m;
    book_sent(&m->run->book, LOAD_FLOOR, now_ns - due_ns, 1);
    if (b->transport.send && member_sent(m, ++b->last, slice, due_ns, now_ns)) {
        bare_send(b, FLOOR_PING, BARE_ASK, bare_frame_size(b), b->last);
    }
}

static void bare_drive(member *m, uint32_t slice, int64_t due_ns, int64_t now_ns)
{
    bare *b = (bare *)m;
    book_sent(&m->run->book, LOAD_FLOOR, now_ns - due_ns, b->viewers);
    if (b->transport.send && member_sent(m, ++b->last, slice, due_ns, now_ns)) {
        steps_put(&m->run->heads.heads[b->head].steps[LOAD_BARE], b->last, slice, due_ns, now_ns);
        bare_send(b, FLOOR_FAN, BARE_DRIVE, bare_frame_size(b), b->last);
    }
}

/* A visit that is due while the last one is still there joins it. */
static void bare_visit(member *m, uint32_t slice, int64_t due_ns, int64_t now_ns)
{
    bare *b = (bare *)m;
    if (!b->transport.send && !bare_connect(b)) {
        return;
    }
    bare_ask(m, slice, due_ns, now_ns);
}

static member *bare_create(load_run *run, const member_face *face, uint32_t head, int64_t phase_ns, int64_t period_ns)
{
    bare *b = calloc(1, sizeof *b);
    if (!b) {
        book_error(&run->book, "not enough memory");
        return NULL;
    }
    b->m = (member){.face = face,
                    .run = run,
                    .side = LOAD_BARE,
                    .descriptor = -1,
                    .events = POLLIN,
                    .ready = true,
                    .phase_ns = phase_ns,
                    .period_ns = period_ns};
    b->head = head;
    return &b->m;
}

static member *bare_connected(member *m)
{
    if (m && !bare_connect((bare *)m)) {
        bare_leave(m);
        return NULL;
    }
    return m;
}

member *bare_asker_create(load_run *run, uint32_t head, int64_t phase_ns, int64_t period_ns)
{
    static const member_face face = {.due = bare_ask, .turn = bare_turn, .leave = bare_leave};
    return bare_connected(bare_create(run, &face, head, phase_ns, period_ns));
}

member *bare_driver_create(load_run *run, uint32_t head, uint32_t viewers, int64_t phase_ns, int64_t period_ns)
{
    static const member_face face = {.due = bare_drive, .turn = bare_turn, .leave = bare_leave};
    member *m = bare_connected(bare_create(run, &face, head, phase_ns, period_ns));
    if (m) {
        ((bare *)m)->viewers = viewers;
    }
    return m;
}

member *bare_viewer_create(load_run *run, uint32_t head)
{
    static const member_face face = {.turn = bare_turn, .leave = bare_leave};
    member *m = bare_connected(bare_create(run, &face, head, 0, 0));
    if (m) {
        bare_send((bare *)m, FLOOR_JOIN, FLOOR_REQUEST_SIZE, FLOOR_ANSWER_SIZE, 0);
    }
    return m;
}

member *bare_visitor_create(load_run *run, int64_t phase_ns, int64_t period_ns)
{
    static const member_face face = {.due = bare_visit, .turn = bare_turn, .leave = bare_leave};
    member *m = bare_create(run, &face, 0, phase_ns, period_ns);
    if (m) {
        ((bare *)m)->visits = true;
    }
    return m;
}
