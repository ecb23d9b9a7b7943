/* hair_file.c: see hair_file.h. */
#include "unit/hair_file.h"

#include "base/bytes.h"
#include "unit/server_fixture.h"

#include <string.h>

const char hair_file_hierarchy[] = "0,0\n0,0\n0,1\n0,1\n0,2\n0,2\n0,3\n0,3\n1,4\n1,4\n1,5\n1,5\n1,6\n1,6\n1,7\n1,7\n";

void hair_file_write(unsigned char bytes[HAIR_FILE_SIZE])
{
    enum { STRANDS = 16, POINTS = 10, HEADER = 128 };
    memset(bytes, 0, HAIR_FILE_SIZE);
    memcpy(bytes, "HAIR", 4);
    store_u32(bytes + 4, STRANDS);
    store_u32(bytes + 8, STRANDS * POINTS);
    store_u32(bytes + 12, 2); /* points alone */
    store_u32(bytes + 16, POINTS - 1);
    for (int i = 0; i < STRANDS * POINTS; i++) {
        const float x = 0.02f * (float)(i / POINTS % 4) - 0.03f, z = 0.02f * (float)(i / POINTS / 4) - 0.03f;
        const float out = 1 + 0.1f * (float)(i % POINTS);
        store_f32(bytes + HEADER + 12 * i, x * out);
        store_f32(bytes + HEADER + 12 * i + 4, 0.09f * out);
        store_f32(bytes + HEADER + 12 * i + 8, z * out);
    }
}

proto_message hair_file_create(uint32_t strands, uint32_t hierarchy)
{
    proto_message message = fake_create(1);
    struct proto_create *c = &message.as.create;
    c->source = RECIPE_FROM_UPLOAD;
    c->upload = strands;
    c->finest_wisps = c->top_wisps = 0;
    c->scale = 1;
    c->up = 1;
    c->head_radius = 0.1;
    c->own_hierarchy = 1;
    c->hierarchy = hierarchy;
    return message;
}
