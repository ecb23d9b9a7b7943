/* draco_extra.c: see draco_extra.h. */
#include "geom/draco_extra.h"

#include "base/bytes.h"

enum { TEX_COORD = 3, GENERIC = 4, UINT16 = 4, FLOAT32 = 9, AS_WHOLE_NUMBERS = 1, AS_QUANTISED = 2 };

static const draco_extra_form forms[DRACO_EXTRAS] = {
    {GEOM_ATTRIBUTE_STRAND, "_STRAND", GENERIC, UINT16, 1, false},
    {GEOM_ATTRIBUTE_ROOT_UV, "TEXCOORD_0", TEX_COORD, FLOAT32, 2, true},
    {GEOM_ATTRIBUTE_WIDTH, "_WIDTH", GENERIC, FLOAT32, 1, true},
};

const draco_extra_form *draco_extra_at(uint32_t index)
{
    return &forms[index];
}

uint32_t draco_extra_count(uint32_t attributes)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < DRACO_EXTRAS; i++) {
        count += (attributes & forms[i].attribute) != 0;
    }
    return count;
}

unsigned char *draco_extra_describe(uint32_t attributes, unsigned char *at)
{
    for (uint32_t i = 0; i < DRACO_EXTRAS; i++) {
        const draco_extra_form *f = &forms[i];
        const unsigned char description[DRACO_EXTRA_DESCRIPTION_BYTES] = {
            1,
            f->type,
            f->data_type,
            f->components,
            0,
            (unsigned char)(i + 1),
            f->quantised ? AS_QUANTISED : AS_WHOLE_NUMBERS};
        if (attributes & f->attribute) {
            at = store_bytes(at, description, sizeof description);
        }
    }
    return at;
}
