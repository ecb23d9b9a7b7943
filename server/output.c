/* output.c: see output.h. */
#include "output.h"
#include "base/assert.h"
#include "clock.h"
#include "limits.h"
#include "metrics.h"

#include <stdlib.h>

enum { OUTPUT_FRAME_HEAD = 256 }; /* more than the FRAME's fields before its GLB */

struct output_segment {
    output_segment *next;
    picture *shown; /* NULL: a message, whole in `bytes` */
    const view *v;  /* of `shown` */
    delivery to;
    size_t size; /* of `bytes`; of a frame that has not begun: 0 */
    unsigned char bytes[];
};

static size_t segment_blob(const output_segment *segment)
{
    return segment->shown ? segment->v->glb.size : 0;
}

static void change_unsent(output *out, size_t bytes, bool more)
{
    out->bytes = more ? out->bytes + bytes : out->bytes - bytes;
    metrics_add(METRIC_UNSENT_BYTES, more ? (int64_t)bytes : -(int64_t)bytes);
}

static void append(output *out, output_segment *segment)
{
    *(out->last ? &out->last->next : &out->first) = segment;
    out->last = segment;
    out->segments++;
    change_unsent(out, segment->size + segment_blob(segment), true);
}

static void remove_first(output *out)
{
    output_segment *segment = out->first;
    change_unsent(out, segment->size + segment_blob(segment), false);
    out->segments--;
    out->sent = 0;
    out->first = segment->next;
    out->last = out->first ? out->last : NULL;
    picture_release(segment->shown);
    free(segment);
}

void output_discard(output *out)
{
    while (out->first) {
        remove_first(out);
    }
}

void output_fini(output *out)
{
    output_discard(out);
    *out = (output){0};
}

bool output_add_message(output *out, const proto_message *message)
{
    size_t size = proto_encoded_size(message);
    ASSERT(size > 0); /* the daemon's own texts and lists keep their limits */
    output_segment *segment = malloc(sizeof *segment + size);
    if (!segment) {
        return false;
    }
    *segment = (output_segment){.size = size};
    size_t written = proto_encode(message, segment->bytes, size);
    ASSERT(written == size);
    append(out, segment);
    return true;
}

bool output_add_picture(output *out, picture *shown, const view *v, const delivery *to)
{
    output_segment *segment = malloc(sizeof *segment + OUTPUT_FRAME_HEAD);
    if (!segment) {
        picture_release(shown);
        return false;
    }
    *segment = (output_segment){.shown = shown, .v = v, .to = *to};
    append(out, segment);
    return true;
}

/* The fields of the frame that goes out now. */
static void begin_frame(output *out, output_segment *segment, int64_t now_us)
{
    proto_message message;
    picture_message(segment->shown, segment->v, &segment->to, &message);
    if (message.type == PROTO_FRAME) {
        message.as.frame.age_us = clock_between_us(segment->shown->stepped_us, now_us);
        message.as.frame.last_write_us = out->last_write_us;
    }
    segment->size = proto_encode_head(&message, segment->bytes, OUTPUT_FRAME_HEAD);
    ASSERT(segment->size > 0);
    change_unsent(out, segment->size, true);
}

/* Adds what is left of the bytes behind `skip`, and lessens `skip` by what it passed. */
static void gather(struct iovec *pieces, size_t *count, unsigned char *bytes, size_t size, size_t *skip)
{
    if (*skip >= size) {
        *skip -= size;
        return;
    }
    pieces[*count] = (struct iovec){.iov_base = bytes + *skip, .iov_len = size - *skip};
    *count += 1;
    *skip = 0;
}

static void gather_frame(const output *out, struct iovec *pieces, size_t *count)
{
    size_t skip = out->sent;
    gather(pieces, count, out->first->bytes, out->first->size, &skip);
    gather(pieces, count, out->first->v->glb.bytes, out->first->v->glb.size, &skip);
}

static void gather_messages(const output *out, struct iovec *pieces, size_t *count)
{
    size_t skip = out->sent;
    for (output_segment *s = out->first; s && !s->shown && *count < LIMIT_OUTPUT_GATHER; s = s->next) {
        gather(pieces, count, s->bytes, s->size, &skip);
    }
}

size_t output_gather(output *out, struct iovec pieces[LIMIT_OUTPUT_GATHER], int64_t now_us)
{
    size_t count = 0;
    out->begun_us = out->sent == 0 ? now_us : out->begun_us;
    if (!out->first->shown) {
        gather_messages(out, pieces, &count);
        return count;
    }
    if (out->first->size == 0) {
        begin_frame(out, out->first, now_us);
    }
    gather_frame(out, pieces, &count); /* alone, so that its own times are true */
    return count;
}

static void count_frame(output *out, int64_t now_us)
{
    uint32_t took_us = clock_between_us(out->begun_us, now_us);
    out->last_write_us = took_us ? took_us : 1; /* 0 says that there was none */
    out->frames_sent++;
    metrics_count(METRIC_FRAMES_SENT, 1);
    metrics_observe(METRIC_WRITE, took_us);
    metrics_observe(METRIC_FRAME_AGE, clock_between_us(out->first->shown->stepped_us, now_us));
}

void output_took(output *out, size_t sent, int64_t now_us)
{
    out->bytes_sent += sent;
    out->sent += sent;
    metrics_count(METRIC_BYTES_SENT, sent);
    while (out->first && out->first->size > 0 && out->sent >= out->first->size + segment_blob(out->first)) {
        size_t rest = out->sent - out->first->size - segment_blob(out->first);
        if (out->first->shown && out->first->v->name.form != PICTURE_BINDING) {
            count_frame(out, now_us);
        }
        remove_first(out);
        out->sent = rest;
    }
}
