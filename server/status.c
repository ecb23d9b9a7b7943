/* status.c: see status.h. */
#include "status.h"
#include "proto.h"

static const int wire_errors[] = {
    [AWT_OK] = PROTO_ERROR_INTERNAL, /* a failure without a status is a fault of ours */
    [AWT_NO_MEMORY] = PROTO_ERROR_NO_MEMORY,
    [AWT_BAD_FORMAT] = PROTO_ERROR_BAD_STRANDS,
    [AWT_TRUNCATED] = PROTO_ERROR_BAD_STRANDS,
    [AWT_BAD_VALUE] = PROTO_ERROR_BAD_VALUE,
    [AWT_NO_STRANDS] = PROTO_ERROR_BAD_STRANDS,
    [AWT_LIMIT] = PROTO_ERROR_LIMIT,
    [AWT_NO_HEAD] = PROTO_ERROR_NO_HEAD,
    [AWT_NO_STYLE] = PROTO_ERROR_NO_STYLE,
    [AWT_NO_PARAM] = PROTO_ERROR_NO_PARAM,
    [AWT_BAD_TIME] = PROTO_ERROR_BAD_TIME,
    [AWT_OTHER_VERSION] = PROTO_ERROR_NOT_SUPPORTED,
};

#define COUNT_STATUS(name, text) +1
_Static_assert(sizeof wire_errors / sizeof wire_errors[0] == 0 AWT_STATUS_LIST(COUNT_STATUS),
               "every status has its wire error");
#undef COUNT_STATUS

int status_wire_error(awt_status status)
{
    return wire_errors[status];
}
