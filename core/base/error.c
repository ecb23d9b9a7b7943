/* error.c: the texts of awt_status, and errors with words of their own. */
#include "base/error.h"

#include <stdarg.h>
#include <stdio.h>

const char *awt_status_text(awt_status status)
{
    switch (status) {
#define STATUS_CASE(name, text) \
    case name:                  \
        return text;
        AWT_STATUS_LIST(STATUS_CASE)
#undef STATUS_CASE
    }
    return "unknown status";
}

awt_status error_set(awt_error *error, awt_status status, const char *format, ...)
{
    if (!error) {
        return status;
    }
    error->status = status;
    if (!format) {
        snprintf(error->text, sizeof error->text, "%s", awt_status_text(status));
        return status;
    }
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(error->text, sizeof error->text, format, arguments);
    va_end(arguments);
    return status;
}
