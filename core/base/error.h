/* error.h: writing an awt_error. */
#ifndef BASE_ERROR_H
#define BASE_ERROR_H

#include "awt.h"

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define ERROR_FORMAT __attribute__((format(printf, 3, 4)))
#else
#define ERROR_FORMAT
#endif

/* Writes status and text (printf; NULL: the status' own text) into `error` unless it is NULL; returns `status`. */
awt_status error_set(awt_error *error, awt_status status, const char *format, ...) ERROR_FORMAT;

#ifdef __cplusplus
}
#endif

#endif
