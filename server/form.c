/* form.c: see form.h. */
#include "form.h"
#include "base/assert.h"
#include "geom/read.h"

static const struct {
    frame_form it;
    const char *name;
} table[FORM_COUNT] = {{{GEOM_RIBBON, GEOM_LEVEL_FULL, false, 1}, "ribbon/full"},
                       {{GEOM_RIBBON, GEOM_LEVEL_FIFTH, false, 2}, "ribbon/fifth"},
                       {{GEOM_RIBBON, GEOM_LEVEL_GUIDES, false, FORM_NONE}, "ribbon/guides"},
                       {{GEOM_STRANDS, GEOM_LEVEL_FULL, true, 4}, "strands/full"},
                       {{GEOM_STRANDS, GEOM_LEVEL_FIFTH, true, 5}, "strands/fifth"},
                       {{GEOM_STRANDS, GEOM_LEVEL_GUIDES, true, FORM_NONE}, "strands/guides"},
                       {{GEOM_GUIDES, GEOM_LEVEL_FULL, false, FORM_NONE}, "guides/full"},
                       {{GEOM_NODES, GEOM_LEVEL_FULL, false, FORM_NONE}, "nodes/full"}};

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
