/* awtframes.h: the frames of one stream, decoded where the caller wants, and hair for any time between them: an engine
 * at 144 Hz shows even motion from a stream of 60 Hz, and a late frame stalls nothing. Standard C only.
 *
 * Three steps. The owner's thread gives each FRAME that comes (awtframes_take), which copies its bytes. A job of the
 * caller's, on any thread, decodes them (awtframes_decode) between awtframes_begin and awtframes_end, which the owner's
 * thread calls; no lock is taken, since a job system orders these three by itself. The owner's thread then asks for the
 * hair at its own time (awtframes_show). While a job decodes, all others may be called. */
#ifndef AWTFRAMES_H
#define AWTFRAMES_H

#include "awtlink.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
    AWTFRAMES_KEPT = 16,  /* decoded frames to show from, at most; memory is taken for as many as come ahead */
    AWTFRAMES_WAITING = 8 /* frames to decode; of more the oldest is left out: nothing builds on what is not decoded */
};

typedef struct awtframes awtframes;

/* Beyond the newest frame motion goes on as it was, ever slower, until the hair stands, after twice `extrapolate_us`,
 * that far beyond; so a late frame is a moment of slower hair. 0: it stands at once. NULL: no memory. The caller owns
 * it: awtframes_destroy. */
awtframes *awtframes_create(int64_t extrapolate_us);
/* Not while a job decodes. Accepts NULL. */
void awtframes_destroy(awtframes *frames);

/* What guides are evaluated with: BINDING_REPLY's bytes. Before the first frame of guides; not while a job decodes.
 * False: `error` says why (AWTCLIENT_PEER: they are damaged). */
bool awtframes_bind(awtframes *frames, const void *bytes, size_t size, awtclient_error *error);

/* Copies a frame of ribbons, strands or guides, whole or a delta, to be decoded. AWTCLIENT_MEMORY, AWTCLIENT_PEER (a
 * kind that holds no strands). */
bool awtframes_take(awtframes *frames, const struct proto_frame *frame, awtclient_error *error);

/* Whether there is something to decode and no job has it: then the caller owes awtframes_decode, awtframes_end. */
bool awtframes_begin(awtframes *frames);
/* Decodes one frame. On any thread. */
void awtframes_decode(awtframes *frames);
/* What was decoded can be shown. False: the frame could not be read, `error` says why (AWTCLIENT_PEER,
 * AWTCLIENT_MEMORY), and it is as if it had not come: the next whole one, or one against an older base, goes on. */
bool awtframes_end(awtframes *frames, awtclient_error *error);

/* What CREDIT's `have` may say: the sequence of the newest frame decoded; 0: none. */
uint64_t awtframes_have(const awtframes *frames);
/* Simulated time of the newest frame that can be shown; INT64_MIN: none. */
int64_t awtframes_newest_us(const awtframes *frames);

typedef enum awtframes_way {
    AWTFRAMES_BETWEEN, /* between two frames, or at one */
    AWTFRAMES_BEYOND,  /* beyond the newest, by its motion, slowing down */
    AWTFRAMES_HELD     /* the hair stands: too far beyond, or before the oldest, or there is one frame only */
} awtframes_way;

/* Hair to be shown, in the head frame, metres; good until the next call of awtframes_show. */
typedef struct awtframes_shown {
    awtframes_way way;
    int64_t time_us; /* that it is of; never less than that shown before */
    uint32_t strand_count, points_per_strand;
    const float *positions; /* [strand_count][points_per_strand][3] */
    const float *previous;  /* likewise, as shown the last time, for motion vectors; of the first the same */
    const float *widths;    /* [points_per_strand], of every strand from root to tip */
    proto_pose head, previous_head;
    float least[3], greatest[3]; /* bounds of positions */
} awtframes_shown;

/* The hair at simulated time `time_us`. False: no frame has been decoded yet, or no memory. */
bool awtframes_show(awtframes *frames, int64_t time_us, awtframes_shown *shown);

/* How often each way was shown since the beginning: [way]. */
void awtframes_counts(const awtframes *frames, uint64_t counts[3]);

#ifdef __cplusplus
}
#endif

#endif
