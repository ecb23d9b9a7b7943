/* form.c: see form.h. */
#include "form.h"
#include "base/assert.h"
#include "geom/read.h"

static const struct {
    frame_form it;
    const char *name;
} table[FORM_COUNT] = {
    {{.kind = GEOM_RIBBON, .level = GEOM_LEVEL_FULL, .poorer = 1}, "ribbon/full"},
    {{.kind = GEOM_RIBBON, .level = GEOM_LEVEL_FIFTH, .poorer = 2}, "ribbon/fifth"},
    {{.kind = GEOM_RIBBON, .level = GEOM_LEVEL_GUIDES, .poorer = FORM_NONE}, "ribbon/guides"},
    {{.kind = GEOM_STRANDS, .level = GEOM_LEVEL_FULL, .poorer = 4, .has_deltas = true}, "strands/full"},
    {{.kind = GEOM_STRANDS, .level = GEOM_LEVEL_FIFTH, .poorer = 5, .has_deltas = true}, "strands/fifth"},
    {{.kind = GEOM_STRANDS, .level = GEOM_LEVEL_GUIDES, .poorer = FORM_NONE, .has_deltas = true}, "strands/guides"},
    {{.kind = GEOM_GUIDES, .poorer = FORM_NONE}, "guides/full"},
    {{.kind = GEOM_NODES, .poorer = FORM_NONE}, "nodes/full"},
    {{.kind = GEOM_GUIDES, .poorer = FORM_NONE, .has_deltas = true, .bare = true}, "guides/bare"},
    {{.kind = GEOM_RIBBON, .level = GEOM_LEVEL_FULL, .poorer = 10, .attributed = true}, "ribbon+/full"},
    {{.kind = GEOM_RIBBON, .level = GEOM_LEVEL_FIFTH, .poorer = 11, .attributed = true}, "ribbon+/fifth"},
    {{.kind = GEOM_RIBBON, .level = GEOM_LEVEL_GUIDES, .poorer = FORM_NONE, .attributed = true}, "ribbon+/guides"},
    {{.kind = GEOM_STRANDS, .level = GEOM_LEVEL_FULL, .poorer = 13, .attributed = true}, "strands+/full"},
    {{.kind = GEOM_STRANDS, .level = GEOM_LEVEL_FIFTH, .poorer = 14, .attributed = true}, "strands+/fifth"},
    {{.kind = GEOM_STRANDS, .level = GEOM_LEVEL_GUIDES, .poorer = FORM_NONE, .attributed = true}, "strands+/guides"}};

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

int form_find(uint8_t kind, uint8_t level, unsigned wants)
{
    const bool attributed = wants & FORM_ATTRIBUTES, deltas = wants & FORM_DELTAS;
    int found = FORM_NONE;
    for (int i = 0; i < FORM_COUNT; i++) {
        const frame_form *form = &table[i].it;
        const bool better = found == FORM_NONE || form->has_deltas;
        if (form->kind == kind && form->level == level && form->attributed == attributed && better &&
            (deltas || !form->bare)) {
            found = i;
        }
    }
    return found;
}
