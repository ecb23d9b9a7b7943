/* snapshot_params.c: parameters as bytes: for each the length of its name, the name, the value. */
#include "sim/snapshot.h"

#include "base/error.h"

enum { PARAM_NAME_SIZE = 64 };

static void walk_param(codec *c, char name[PARAM_NAME_SIZE], float *value)
{
    unsigned char length = (unsigned char)strlen(name);
    codec_bytes(c, &length, 1);
    if (length >= PARAM_NAME_SIZE) {
        c->spent = true;
        return;
    }
    codec_bytes(c, name, length);
    name[length] = '\0';
    codec_f32(c, value);
}

void snapshot_write_params(codec *to, const awt_params *params){
#define PARAM_WRITE(name, value, least, greatest, unit, text)                                \
    {                                                                                        \
        _Static_assert(sizeof #name <= PARAM_NAME_SIZE, "a parameter's name fits its room"); \
        char named[PARAM_NAME_SIZE] = #name;                                                 \
        float number = params->name;                                                         \
        walk_param(to, named, &number);                                                      \
    }
    AWT_PARAM_LIST(PARAM_WRITE)
#undef PARAM_WRITE
}

awt_status snapshot_read_params(codec *from, bool skip_unknown, awt_params *out, awt_error *error)
{
    awt_params params = awt_params_default();
    while (from->at < from->size) {
        char name[PARAM_NAME_SIZE] = "";
        float value = 0;
        walk_param(from, name, &value);
        if (from->spent) {
            return error_set(error, AWT_BAD_VALUE, "the list of parameters is damaged");
        }
        awt_error own = {0};
        awt_status status = awt_params_set(&params, name, value, &own);
        if (status != AWT_OK && !(status == AWT_NO_PARAM && skip_unknown)) {
            return error_set(error, status, "%s", own.text);
        }
    }
    *out = params;
    return AWT_OK;
}
