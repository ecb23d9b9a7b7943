/* status.h: what the library says, as the wire's errors. */
#ifndef SERVER_STATUS_H
#define SERVER_STATUS_H

#include "awt.h"

/* The PROTO_ERROR_ code of a status that is not AWT_OK. */
int status_wire_error(awt_status status);

#endif
