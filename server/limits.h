/* limits.h: every queue, buffer and count of the daemon that a peer can fill, and every time it can make us wait. The
 * sizes that the library itself bounds are in awt.h, those of the protocol in proto.h. */
#ifndef LIMITS_H
#define LIMITS_H

#include <stdint.h>

enum {
    /* the daemon as a whole; the defaults of the options and the greatest values they take */
    LIMIT_CONNECTIONS = 1024,
    LIMIT_CONNECTIONS_GREATEST = 65536,
    LIMIT_CONNECTIONS_REFUSED = 16, /* beyond the greatest number: those who are being told that there are too many */
    LIMIT_FORESTS = 256,
    LIMIT_FORESTS_GREATEST = 65536,
    LIMIT_WORKERS_GREATEST = 256,
    LIMIT_ACCOUNTS = 64,       /* besides the owner's */
    LIMIT_RESUME_GRACE_S = 60, /* these three: the defaults, seconds, and the greatest value they take */
    LIMIT_FOREST_GRACE_S = 3600,
    LIMIT_QUIET_S = 120,
    LIMIT_GRACE_S_GREATEST = 31536000,
    LIMIT_DRAIN_S = 1, /* the default of another, and its greatest value */
    LIMIT_DRAIN_S_GREATEST = 3600,
    LIMIT_IO_THREADS_GREATEST = 256,
    LIMIT_HOT_SET = 32,            /* busy connections of one I/O thread, before the next one gets any */
    LIMIT_HOT_NEWCOMERS = 128,     /* connections of an I/O thread that takes new ones; beyond, they begin as idle */
    LIMIT_LOCK_TRIES = 200,        /* to get the service\'s lock, before a thread sleeps until it gets it */
    LIMIT_BACKLOG = 1024,          /* connections that wait for accept */
    LIMIT_ADMIN_CONNECTIONS = 16,  /* to the operator's address at once; the oldest makes room */
    LIMIT_ADMIN_REQUEST = 4096,    /* bytes of one request there */
    LIMIT_PATH = 1024,             /* bytes of the state directory's and the token file's path */
    LIMIT_CONFIG_FILE = 64 * 1024, /* bytes of a file of settings, or of accounts */
    LIMIT_TOKEN_FILE = 127,        /* bytes */

    /* one session */
    LIMIT_SESSION_FORESTS = 256, /* forests open on it */
    LIMIT_SESSION_UPLOADS = 4,   /* uploads begun or complete */
    LIMIT_SESSION_SUBSCRIPTIONS = 16,
    LIMIT_PARKED = 1024,        /* sessions kept for RESUME */
    LIMIT_SESSION_PENDING = 16, /* requests that wait for a worker; beyond, its next message waits unread */

    /* one forest: inputs that wait for their turn */
    LIMIT_FOREST_INPUTS = 256, /* motions and changes of parameters */
    LIMIT_FOREST_QUERIES = 64,

    /* what is drawn of one step of a forest */
    LIMIT_DELTA_BASES = 8,    /* frames of a form that deltas can be made against, and frames that a receiver keeps */
    LIMIT_PICTURE_VIEWS = 31, /* forms and deltas drawn by one job */
    LIMIT_SIZE_FRAMES = 64,   /* a form's last size is believed for so many frames */
    LIMIT_PICTURES_SPARE = 4, /* pictures kept to be drawn into again */

    /* one connection's buffers */
    LIMIT_INPUT_OPEN = 16 * 1024,  /* bytes of buffer once the client is in */
    LIMIT_INPUT_KEPT = 64 * 1024,  /* bytes of buffer kept between messages; more is given back */
    LIMIT_OUTPUT_SEGMENTS = 64,    /* unsent messages; beyond, nothing more is read from the connection */
    LIMIT_OUTPUT_BYTES = 16 << 20, /* unsent bytes; likewise */
    LIMIT_OUTPUT_GATHER = 8,       /* messages handed to the socket at once */
    LIMIT_LOG_LINE = 1024,         /* bytes; the rest is cut */
    LIMIT_LOG_EVENTS = 64,         /* kinds of lines that are told apart */
    LIMIT_LOG_BURST = 100,         /* lines of one kind at once */
    LIMIT_LOG_PER_S = 10,          /* lines of one kind a second, from then on */

    /* one turn of the loop, so that no connection keeps the others waiting */
    LIMIT_TURN_ACCEPTS = 16,
    LIMIT_TURN_READ = 256 * 1024,   /* bytes from one connection */
    LIMIT_TURN_WRITE = 1024 * 1024, /* bytes to one connection */
    LIMIT_TURN_MESSAGES = 64,       /* of one connection */

    /* what is idle: a connection that has said nothing but LIMIT_IDLE_MESSAGES in a second, of those that only keep it
     * open, for LIMIT_IDLE_US */
    LIMIT_IDLE_MESSAGES = 3
};

enum { LIMIT_BUSY_RETRY_MS = 100, LIMIT_FULL_RETRY_MS = 2000 }; /* ERROR BUSY's retry_after_ms: one queue; all */

/* Bytes. */
#define LIMIT_UPLOAD_BYTES (UINT64_C(256) << 20)       /* one file */
#define LIMIT_UPLOADS_BYTES (UINT64_C(512) << 20)      /* all uploads of all connections */
#define LIMIT_SAVED_BYTES (UINT64_C(1) << 30)          /* one forest's file in the state directory */
#define LIMIT_KEEPER_BYTES (UINT64_C(512) << 20)       /* that wait to be written there */
#define LIMIT_GROOMS_SPARE_BYTES (UINT64_C(128) << 20) /* grooms that no forest stands on any more */
#define LIMIT_HAIR_BYTES (UINT64_C(4) << 30)           /* forests and grooms; beyond, CREATE is refused */

/* Times, microseconds. */
#define LIMIT_HANDSHAKE_US INT64_C(10000000)   /* from accept until the client is in */
#define LIMIT_WRITE_STALL_US INT64_C(30000000) /* a peer that takes nothing for so long is let go */
#define LIMIT_SLEPT_US INT64_C(2000000) /* what is found overdue by more was slept through: it has its time anew */
#define LIMIT_FOREST_LOOK_US INT64_C(1000000) /* from one look for forests that nobody has open to the next */
#define LIMIT_LINGER_US INT64_C(1000000)      /* after the last byte out, for the peer to close first */
#define LIMIT_STEP_US INT64_C(10000)          /* a request for a step or a look is late after that */
#define LIMIT_IDLE_US INT64_C(2000000)        /* after so long a connection is idle */
#define LIMIT_NEWCOMER_US INT64_C(250000)     /* and after so long, if it has never been busy */
#define LIMIT_SILENT_US INT64_C(200000)       /* who has said nothing for so long gets its frame after the others */
#define LIMIT_FREE_BEHIND_US \
    INT64_C(50000) /* simulated, by which a free-running forest may lag before time is dropped */
#define LIMIT_FREE_UNSEEN_US INT64_C(200000)     /* from one job of a free-running forest to the next: nobody looks; */
#define LIMIT_FREE_ASLEEP_US INT64_C(250000)     /* it is at rest, and somebody looks; */
#define LIMIT_FREE_FORGOTTEN_US INT64_C(1000000) /* it is at rest, and nobody looks */
#define LIMIT_POSE_DELAY_US INT64_C(250000)      /* that a free-running forest's poses are shown later at most */
#define LIMIT_LOAD_LOOK_US INT64_C(500000)       /* from one look at what forests cost to the next */
#define LIMIT_PROGRESS_US INT64_C(100000)        /* from one PROGRESS to the next */
#define LIMIT_ACCEPT_PAUSE_US INT64_C(100000)    /* no accept for so long when descriptors have run out */
#define LIMIT_STOP_FLUSH_US INT64_C(2000000)     /* after SIGTERM, for what is still unsent */
#define LIMIT_OVERLOADED_US INT64_C(5000000)     /* that a look which found too many forests keeps others away */
#define LIMIT_ADMIN_US INT64_C(5000000)          /* from accept to the answer's last byte, at the operator's address */

/* Nanoseconds for each idle connection that pass before all of them are looked at again, so that the looking takes a
 * small part of one processor however many there are. */
#define LIMIT_COLD_PAUSE_NS INT64_C(2500)

#endif
