/* member.h: one connection of the load, whatever it does; and what all of them share. A member belongs to one hand
 * (crew.h), whose thread alone calls it. */
#ifndef LOAD_MEMBER_H
#define LOAD_MEMBER_H

#include "load/book.h"
#include "load/heads.h"
#include "load/plan.h"
#include "load/timeline.h"

enum { MEMBER_WAITING = 64 };

/* What the whole load shares. */
typedef struct load_run {
    const load_plan *plan;
    timeline line;
    int64_t begin_ns; /* of the line, by the clock of wait.h */
    book book;
    double busy_s[LOAD_MODES]; /* in which requests were due */
    uint32_t idle;             /* connections that say nothing, in fact */
    char idle_end[BOOK_TEXT];  /* why there are no more of them, where fewer came than were asked for */
    load_heads heads;          /* the daemon's */
    const char *floor;         /* the bare server's address; NULL: it is not measured */
    atomic_bool failed;        /* nothing can go on; the book has the error */
} load_run;

/* When a request was due. */
typedef struct member_due {
    uint64_t request; /* its id */
    int64_t due_ns, sent_ns;
    uint32_t slice;
} member_due;

typedef struct member member;

typedef struct member_face {
    /* Its request of that slice was due at `due_ns`. NULL: it sends nothing by the clock. */
    void (*due)(member *m, uint32_t slice, int64_t due_ns, int64_t now_ns);
    /* Its descriptor is ready. */
    void (*turn)(member *m, short revents);
    /* Now and then, at least once a slice; may be NULL. */
    void (*tick)(member *m, uint32_t slice);
    /* Closes and frees it. */
    void (*leave)(member *m);
} member_face;

struct member {
    const member_face *face;
    load_run *run;
    load_side side;
    int descriptor; /* -1: there is none just now */
    short events;   /* that poll is to wait for */
    bool ready;     /* it may be measured */
    uint64_t ticks; /* requests that were due so far */
    int64_t phase_ns, period_ns;
    member_due waiting[MEMBER_WAITING]; /* [waiting_count], in no order */
    uint32_t waiting_count;
};

/* The mode of a slice. */
load_mode member_mode(const member *m, uint32_t slice);

/* Writes down that a request goes out, with so many answers to come. False: too many wait already (which is counted as
 * an error). */
bool member_sent(member *m, uint64_t request, uint32_t slice, int64_t due_ns, int64_t now_ns);
/* Takes what waits for the answer to `request`. False: nothing does. */
bool member_answered(member *m, uint64_t request, member_due *due);

/* Where the load is closed: sends the next request at once, while its side's turn lasts. */
void member_next(member *m);

#endif
