/* connection_send.c: see connection.h: sending, by the loop or by a worker that has the answer. */
#include "connection_parts.h"
#include "net.h"

/* What came of one call to the socket. */
static void count_sent(connection *c, net_result result, size_t sent)
{
    service_counters *counters = &c->talk.shared->counters;
    uint64_t frames = c->out.frames_sent;
    int64_t now_us = connection_now_us(c);
    c->blocked = result == NET_LATER;
    if (sent > 0) {
        output_took(&c->out, sent, now_us);
        c->progress_us = now_us;
    }
    if (c->out.frames_sent > frames) {
        c->busy_us = now_us;
    }
    if (result == NET_FAILED) { /* what it sent before it went may still be read and done */
        c->output_failed = true;
        output_discard(&c->out);
    }
    c->talk.last_write_us = c->out.last_write_us;
    counters->frames_sent += c->out.frames_sent - frames;
    counters->bytes_sent += sent;
}

void connection_send(connection *c)
{
    service *shared = c->talk.shared;
    for (size_t written = 0; c->out.first && !c->blocked && !c->over && written < LIMIT_TURN_WRITE;) {
        struct iovec pieces[LIMIT_OUTPUT_GATHER];
        size_t count = output_gather(&c->out, pieces, connection_now_us(c)), sent = 0;
        service_unlock(shared);
        net_result result = net_send(c->fd, pieces, count, &sent);
        service_lock(shared);
        count_sent(c, result, sent);
        written += sent;
        session_stream(&c->talk);
    }
}

void connections_send_replies(service *shared)
{
    home_link *reply = shared->replies_waiting;
    shared->replies_waiting = NULL; /* from here on the list is this thread's: each of it is claimed */
    while (reply) {
        connection *c = reply->owner;
        reply = reply->next;
        connection_send(c);
        c->sending = false;
        connection_settle(c);
    }
}
