/* handlers.h: what each message does (session_*.c). Called by protocol.c with a decoded message of the right type in a
 * state in which it may come; every one answers, or sends ERROR, or has a worker's result answer later. */
#ifndef HANDLERS_H
#define HANDLERS_H

#include "session.h"

typedef void session_handler(session *s, const proto_message *message);

/* session_greeting.c: how a connection begins and ends */
session_handler session_hello, session_auth, session_ping, session_pong, session_client_bye;

/* session_resume.c */
session_handler session_resume;

/* session_upload.c */
session_handler session_upload;

/* session_forest.c: the life of forests */
session_handler session_create, session_attach_forest, session_detach_forest, session_destroy, session_list;

/* session_motion.c: what goes into a forest */
session_handler session_motion, session_set_params, session_set_clock;

/* session_frames.c: what comes out of a forest */
session_handler session_query, session_step_many, session_binding, session_subscribe, session_unsubscribe,
    session_credit;

/* session_state.c: a forest's whole state */
session_handler session_snapshot, session_restore;

/* session_info.c: about the daemon */
session_handler session_list_styles, session_stats;

#endif
