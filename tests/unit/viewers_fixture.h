/* viewers_fixture.h: many viewers of one forest, who decode what they get and acknowledge it at their own speeds. */
#ifndef VIEWERS_FIXTURE_H
#define VIEWERS_FIXTURE_H

#include "server_fixture.h"

#include "framering.h"

enum { VIEWERS_FRAMES = 96 /* sequences that are compared */ };

/* A subscription with what its client keeps: the last frames that it read. */
typedef struct viewer {
    uint64_t handle;
    uint64_t last;            /* sequence of the last frame that came */
    uint64_t had;             /* the newest acknowledged */
    uint32_t whole, deltas;   /* frames that came */
    uint64_t bytes, largest;  /* GLB bytes: all, and of the largest frame */
    struct proto_frame frame; /* the last one, without its GLB */
    framering *ring;
    bool fresh; /* that one is not acknowledged yet */
} viewer;

/* Viewers on as many connections as their number asks for, and the one who drives. */
typedef struct viewers {
    service shared;
    fake_client *driver;
    uint64_t forest;
    int64_t time_us;
    uint32_t sequence; /* of the motions */
    uint32_t count;
    viewer *each; /* [count] */
    struct viewers_link *links;
    uint32_t link_count;
    geom_binding *binding;              /* where they see guides */
    double truth_step_m;                /* from one whole number of the truth to the next */
    geom_strands truth[VIEWERS_FRAMES]; /* the whole frames, by sequence */
    int error;                          /* code of the last ERROR that any viewer got */
} viewers;

/* Viewers with credit 1, all subscribed alike: only kind, deltas, budget and rate of `asked` are taken. */
void viewers_init(viewers *v, uint32_t count, const struct proto_subscribe *asked);
void viewers_fini(viewers *v);

/* Moves the head, where it `moves`, and advances by 10 ms; takes the whole frame as the truth. All frames that viewers
 * get are decoded and compared with it: strands to the bit, those evaluated from guides within the bound of
 * GEOMETRY.md. */
void viewers_advance(viewers *v, bool moves);

/* CREDIT of so many frames, saying that it has `have`. */
void viewers_credit(viewers *v, uint32_t number, uint32_t frames, uint64_t have);
/* Acknowledges the frame that came last, with credit for the next one. Nothing where none came. */
void viewers_acknowledge(viewers *v, uint32_t number);

#endif
