/* session_state.c: SNAPSHOT and RESTORE: a forest's whole state as bytes, and back. */
#include "handlers.h"

void session_snapshot(session *s, const proto_message *message)
{
    resident *r = session_resident(s, message, message->as.snapshot.forest, true);
    if (r && session_push(s, message, r, session_input(s, message, FOREST_STATE))) {
        s->pending++;
    }
}

void session_restore(session *s, const proto_message *message)
{
    const struct proto_restore *restore = &message->as.restore;
    awt_error error = {0};
    recipe *making = NULL;
    if (!session_may_drive(s, message)) {
        return;
    }
    upload *state = session_complete_upload(s, restore->upload);
    if (!state) {
        session_error(s, message->type, message->request, PROTO_ERROR_NO_UPLOAD, "there is no complete upload %lu",
                      (unsigned long)restore->upload);
        return;
    }
    if (recipe_restore(state, 0, restore->name, &making, &error) != AWT_OK) {
        session_error_awt(s, message->type, message->request, &error);
    } else {
        session_make(s, message, making);
    }
}
