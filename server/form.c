/* form.c: see form.h. */
#include "form.h"
#include "base/assert.h"
#include "geom/read.h"

static const struct {
    frame_form it;
    const char *name;
} table[FORM_COUNT] = {{{GEOM_RIBBON, GEOM_LEVEL_FULL, false, false, 1}, "ribbon/full"},
                       {{GEOM_RIBBON, GEOM_LEVEL_FIFTH, false, false, 2}, "ribbon/fifth"},
                       {{GEOM_RIBBON, GEOM_LEVEL_GUIDES, false, false, FORM_NONE}, "ribbon/guides"},
                       {{GEOM_STRANDS, GEOM_LEVEL_FULL, true, false, 4}, "strands/full"},
                       {{GEOM_STRANDS, GEOM_LEVEL_FIFTH, true, false, 5}, "strands/fifth"},
                       {{GEOM_STRANDS, GEOM_LEVEL_GUIDES, true, false, FORM_NONE}, "strands/guides"},
                       {{GEOM_GUIDES, GEOM_LEVEL_FULL, false, false, FORM_NONE}, "guides/full"},
                       {{GEOM_NODES, GEOM_LEVEL_FULL, false, false, FORM_NONE}, "nodes/full"},
                       {{GEOM_GUIDES, GEOM_LEVEL_FULL, true, true, FORM_NONE}, "guides/bare"}};

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

int form_find(uint8_t kind, uint8_t level, bool deltas)
{
    int found = FORM_NONE;
    for (int i = 0; i < FORM_COUNT; i++) {
        const frame_form *form = &table[i].it;
        const bool better = found == FORM_NONE || form->has_deltas;
        if (form->kind == kind && form->level == level && better && (deltas || !form->bare)) {
            found = i;
        }
    }
    return found;
}
