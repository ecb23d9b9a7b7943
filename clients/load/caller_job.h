/* caller_job.h: what the jobs of callers share. Private to caller*.c. */
#ifndef LOAD_CALLER_JOB_H
#define LOAD_CALLER_JOB_H

#include "awtlink.h"
#include "load/caller.h"

typedef struct caller caller;

typedef struct caller_job {
    member_face face;
    void (*entered)(caller *c);                             /* the daemon has let it in */
    void (*heard)(caller *c, const proto_message *message); /* anything but an ERROR */
    void (*refused)(caller *c, uint64_t request);           /* an ERROR came, which has been counted; may be NULL */
} caller_job;

struct caller {
    member m; /* first; m.face is &job->face */
    const caller_job *job;
    awtlink *link;            /* NULL: there is none just now */
    bool in, settling, dirty; /* settling: caller_settle is at work; dirty: something was queued */
    bool deaf;                /* reads nothing */
    bool stalls;              /* is deaf in laden slices */
    uint32_t head, viewers;
    uint64_t step;                  /* of a driver: the last one asked for */
    int64_t pose_us;                /* of a driver of a head that runs freely: time of its last pose */
    uint64_t request, subscription; /* of a viewer: its SUBSCRIBE, and its handle */
    uint32_t spent;                 /* of a viewer: frames that came since it last gave credit */
    uint64_t visit, forest;         /* of a visitor: the visit it is at, and a maker's own head */
};

/* A caller with its job and its times, without a link. NULL: the book says why. */
caller *caller_create(load_run *run, const caller_job *job, uint32_t head, int64_t phase_ns, int64_t period_ns);
/* Begins to connect. False: the book says why. */
bool caller_connect(caller *c);
/* The same of one that was just made, which is freed where it fails. */
member *caller_connected(caller *c);
void caller_disconnect(caller *c);
/* Something went wrong on its link, which is closed; where the load has not begun, it ends. */
void caller_fail(caller *c, const char *text);

/* Queues a message, which goes out by caller_settle; its request id, 0 where that failed. */
uint64_t caller_send(caller *c, proto_message *message);
/* ATTACH to its head, with that token. */
uint64_t caller_attach(caller *c, const uint8_t token[16]);
/* QUERY of a forest's latest frame. */
uint64_t caller_query(caller *c, uint64_t forest);

/* Sends and receives what there is, and hears it; at the end of all that queues outside of `heard`. */
void caller_settle(caller *c);
/* Takes down what poll is to wait for. */
void caller_listen(caller *c);

/* Faces' parts that are alike for all. */
void caller_turn(member *m, short revents);
void caller_leave(member *m);

#endif
