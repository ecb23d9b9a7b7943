/* form.c: see form.h. */
#include "form.h"
#include "base/assert.h"
#include "geom/read.h"

enum { LEVEL_FULL = 0 };

/* A form's poorer one stands behind it. */
static const struct {
    frame_form it;
    const char *name;
} table[FORM_COUNT] = {{{GEOM_RIBBON, LEVEL_FULL, false, 1}, "ribbon/full"},
                       {{GEOM_STRANDS, LEVEL_FULL, true, 2}, "strands/full"},
                       {{GEOM_GUIDES, LEVEL_FULL, false, FORM_NONE}, "guides/full"},
                       {{GEOM_NODES, LEVEL_FULL, false, FORM_NONE}, "nodes/full"}};

const frame_form *form_at(int number)
{
    ASSERT(number >= 0 && number < FORM_COUNT);
    return &table[number].it;
}

const char *form_name(int number)
{
    ASSERT(number >= 0 && number < FORM_COUNT);
    return table[number].name;
}

int form_find(uint8_t kind, uint8_t level)
{
    for (int i = 0; i < FORM_COUNT; i++) {
        if (table[i].it.kind == kind && table[i].it.level == level) {
            return i;
        }
    }
    return FORM_NONE;
}
