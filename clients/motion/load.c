/* load.c: see load.h. */
#include "motion/load.h"

#include "files.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LOAD_MAX_FILE = 512 << 20 /* bytes */ };

bool motion_load(const char *name, const motion_options *options, motion *out, char *error, size_t error_size)
{
    if (motion_builtin(name, out)) {
        return true;
    }
    size_t size;
    unsigned char *bytes = files_read(name, LOAD_MAX_FILE, &size, error, error_size);
    if (!bytes) {
        size_t used = strlen(error);
        snprintf(error + used, error_size - used,
                 " (the built-in motions are lean, lean-forever, jump, run and shake)");
        return false;
    }
    awt_error why;
    awt_status status = motion_read(bytes, size, options, out, &why);
    free(bytes);
    if (status != AWT_OK) {
        snprintf(error, error_size, "%s: %s", name, why.text);
    }
    return status == AWT_OK;
}
