/* sessionbook.c: see sessionbook.h. */
#include "sessionbook.h"

#include <string.h>

/* Number of the forest; `count`: it is not in the book. */
static uint32_t find(const sessionbook *book, uint64_t forest)
{
    uint32_t number = 0;
    while (number < book->count && book->forests[number].forest != forest) {
        number++;
    }
    return number;
}

static uint32_t find_request(const sessionbook *book, uint64_t request)
{
    uint32_t number = 0;
    while (number < book->count && (book->states[number] != BOOK_ASKED || book->requests[number] != request)) {
        number++;
    }
    return number;
}

static void forget(sessionbook *book, uint32_t number)
{
    if (number < book->count) {
        const uint32_t last = --book->count;
        book->forests[number] = book->forests[last];
        book->states[number] = book->states[last];
        book->requests[number] = book->requests[last];
        book->known[number] = book->known[last];
    }
}

static void set_state(sessionbook *book, uint32_t number, book_state state)
{
    book->states[number] = state;
    book->known[number] = book->known[number] || state == BOOK_OPEN;
    book->forests[number].open = state == BOOK_OPEN;
}

/* A forest beyond those that a daemon lets one have is not remembered. */
static void add(sessionbook *book, uint64_t forest, const uint8_t token[16], book_state state, uint64_t request)
{
    const uint32_t number = find(book, forest);
    if (number == AWTSESSION_FORESTS) {
        return;
    }
    if (number == book->count) {
        book->count++;
        book->known[number] = false;
        book->forests[number] = (awtsession_forest){.forest = forest};
    }
    memcpy(book->forests[number].token, token, sizeof book->forests[number].token);
    book->requests[number] = request;
    set_state(book, number, state);
}

void sessionbook_sent(sessionbook *book, const proto_message *message)
{
    switch (message->type) {
    case PROTO_ATTACH:
        add(book, message->as.attach.forest, message->as.attach.token, BOOK_ASKED, message->request);
        break;
    case PROTO_DETACH:
        forget(book, find(book, message->as.detach.forest));
        break;
    case PROTO_DESTROY:
        forget(book, find(book, message->as.destroy.forest));
        break;
    default:
        break;
    }
}

/* An ATTACH has failed: one of the caller's own is the caller's to tell, a forest that was open before is gone. */
static void refused(sessionbook *book, uint32_t number)
{
    if (number < book->count && book->known[number]) {
        set_state(book, number, BOOK_GONE);
    } else {
        forget(book, number);
    }
}

void sessionbook_came(sessionbook *book, const proto_message *message)
{
    const uint32_t number = message->request != 0 ? find_request(book, message->request) : book->count;
    if (message->type == PROTO_CREATE_REPLY) {
        const struct proto_create_reply *reply = &message->as.create_reply;
        add(book, reply->forest, reply->drive_token, BOOK_OPEN, 0);
        const uint32_t made = find(book, reply->forest);
        if (made < book->count) {
            book->forests[made].may_drive = true;
        }
    } else if (number < book->count && message->type == PROTO_ATTACH_REPLY) {
        book->forests[number].may_drive = message->as.attach_reply.may_drive == 1;
        set_state(book, number, BOOK_OPEN);
    } else if (message->type == PROTO_ERROR) {
        refused(book, number);
    }
}

void sessionbook_lost(sessionbook *book, bool told)
{
    for (uint32_t i = 0; i < book->count;) {
        if (!book->known[i] || (told && book->states[i] == BOOK_GONE)) {
            forget(book, i);
            continue;
        }
        if (book->states[i] != BOOK_GONE) {
            set_state(book, i, BOOK_CLOSED);
        }
        i++;
    }
}

void sessionbook_resumed(sessionbook *book, const struct proto_resume_reply *reply)
{
    for (uint16_t i = 0; i < reply->forests.count; i++) {
        const uint32_t number = find(book, reply->forests.items[i].forest);
        if (number < book->count) {
            book->forests[number].may_drive = reply->forests.items[i].may_drive == 1;
            set_state(book, number, BOOK_OPEN);
        }
    }
}

bool sessionbook_next_attach(sessionbook *book, proto_message *attach, uint32_t *number)
{
    for (uint32_t i = 0; i < book->count; i++) {
        if (book->states[i] == BOOK_CLOSED) {
            *attach = (proto_message){.type = PROTO_ATTACH};
            attach->as.attach.forest = book->forests[i].forest;
            memcpy(attach->as.attach.token, book->forests[i].token, sizeof attach->as.attach.token);
            *number = i;
            return true;
        }
    }
    return false;
}

void sessionbook_asked(sessionbook *book, uint32_t number, uint64_t request)
{
    book->requests[number] = request;
    set_state(book, number, BOOK_ASKED);
}

bool sessionbook_settled(const sessionbook *book)
{
    for (uint32_t i = 0; i < book->count; i++) {
        if (book->known[i] && (book->states[i] == BOOK_CLOSED || book->states[i] == BOOK_ASKED)) {
            return false;
        }
    }
    return true;
}
