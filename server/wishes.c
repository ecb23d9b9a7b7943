/* wishes.c: see wishes.h. */
#include "wishes.h"
#include "base/assert.h"

enum { WISHES_DELTAS = LIMIT_PICTURE_VIEWS - FORM_COUNT };
_Static_assert(WISHES_DELTAS >= (int)LIMIT_DELTA_BASES, "every base of one form has its place");

void wishes_add(wishes *w, view_name name)
{
    uint32_t deltas = 0;
    for (uint32_t i = 0; i < w->count; i++) {
        if (w->names[i].form == name.form && w->names[i].base == name.base) {
            return;
        }
        deltas += w->names[i].base != 0;
    }
    if (name.base != 0 && deltas == WISHES_DELTAS) {
        wishes_add(w, (view_name){.form = name.form});
        return;
    }
    ASSERT(w->count < LIMIT_PICTURE_VIEWS);
    w->names[w->count++] = name;
}
