/* params.c: the parameters that AWT_PARAM_LIST lists: defaults, checks, names. */
#include "awt.h"
#include "base/error.h"

#include <math.h>
#include <string.h>

static const awt_param_info param_table[] = {
#define PARAM_INFO(name, value, least, greatest, unit, text) {#name, unit, text, value, least, greatest},
    AWT_PARAM_LIST(PARAM_INFO)
#undef PARAM_INFO
};

/* struct awt_params is the list's floats in the list's order. */
static const size_t param_offset[] = {
#define PARAM_OFFSET(name, value, least, greatest, unit, text) offsetof(awt_params, name),
    AWT_PARAM_LIST(PARAM_OFFSET)
#undef PARAM_OFFSET
};

size_t awt_param_count(void)
{
    return sizeof param_table / sizeof param_table[0];
}

const awt_param_info *awt_param_at(size_t index)
{
    return &param_table[index];
}

awt_params awt_params_default(void)
{
    return (awt_params){
#define PARAM_DEFAULT(name, value, least, greatest, unit, text) .name = value,
        AWT_PARAM_LIST(PARAM_DEFAULT)
#undef PARAM_DEFAULT
    };
}

awt_status awt_params_set(awt_params *params, const char *name, float value, awt_error *error)
{
    for (size_t i = 0; i < awt_param_count(); i++) {
        const awt_param_info *info = &param_table[i];
        if (strcmp(info->name, name) != 0) {
            continue;
        }
        if (!(value >= info->least && value <= info->greatest)) {
            return error_set(error, AWT_BAD_VALUE, "%s goes from %g to %g %s, not %g", name, (double)info->least,
                             (double)info->greatest, info->unit, (double)value);
        }
        memcpy((char *)params + param_offset[i], &value, sizeof value);
        return AWT_OK;
    }
    return error_set(error, AWT_NO_PARAM, "there is no parameter \"%.40s\"", name);
}
