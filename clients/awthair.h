/* awthair.h: the short way to hair, by calls that wait: make some, move the head, get strands. For tools and first
 * steps; a loop that cannot wait has awtsession.h and awtframes.h. It uses its client: in the same thread, and no call
 * of either lasts longer than the client's timeout. */
#ifndef AWTHAIR_H
#define AWTHAIR_H

#include "awtframes.h"

#ifdef __cplusplus
extern "C" {
#endif

struct awtclient; /* awtclient.h */

typedef struct awthair awthair;

/* Makes hair of a built-in style on `client`, which must outlive it, at rest at simulated time 0 with head and body at
 * the origin. `strands` 0: the style's number. NULL: `error` says why. The caller owns it: awthair_close. */
awthair *awthair_create(struct awtclient *client, const char *style, uint32_t strands, awtclient_error *error);

/* Moves the head (and the body with it, unless `body` says otherwise; NULL: as the head) to where it is at simulated
 * time `time_us`, later than the last, waits for the hair of then, and gives it; *shown is good until the next call.
 * False: `error` says why: as awtclient_call, or AWTCLIENT_PEER where the frame could not be read, after which the next
 * one may be asked for. */
bool awthair_drive(awthair *hair, int64_t time_us, const proto_pose *head, const proto_pose *body,
                   awtframes_shown *shown, awtclient_error *error);

/* Its handle, for all other requests. */
uint64_t awthair_forest(const awthair *hair);

/* Ends the hair in the daemon, if that can be reached, and frees it. Accepts NULL. */
void awthair_close(awthair *hair);

#ifdef __cplusplus
}
#endif

#endif
