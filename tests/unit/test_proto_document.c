/* test_proto_document.c: PROTOCOL.md says what the code does: the tables of messages, records and errors are those of
 * the lists, and the worked exchange is byte for byte what the encoder writes. A check that fails prints the line that
 * the document should have. */
#include "auth.h"
#include "check.h"
#include "proto_fill.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char document_path[] = "proto/PROTOCOL.md"; /* tests run in the root of the checkout */

/* The whole document as a text in heap memory; NULL: it is not there, and a check has failed. */
static char *document_read(void)
{
    size_t size = 0;
    unsigned char *bytes = check_read_file(document_path, &size);
    char *text = bytes ? malloc(size + 1) : NULL;
    if (text) {
        memcpy(text, bytes, size);
        text[size] = '\0';
    }
    free(bytes);
    CHECK_TEXT(text ? document_path : "no file", document_path);
    return text;
}

/* The section under the heading `heading`, from there to the next heading; NULL: there is none, and a check failed. */
static char *section_of(const char *document, const char *heading)
{
    const char *start = strstr(document, heading);
    CHECK_TEXT(start ? heading : "no such heading", heading);
    if (!start) {
        return NULL;
    }
    const char *end = strstr(start + strlen(heading), "\n#");
    size_t size = end ? (size_t)(end - start) : strlen(start);
    char *section = malloc(size + 1);
    if (section) {
        memcpy(section, start, size);
        section[size] = '\0';
    }
    return section;
}

static void check_holds(const char *text, const char *wanted)
{
    CHECK_TEXT(text && strstr(text, wanted) ? wanted : "not in PROTOCOL.md", wanted);
}

/* ---- tables ----------------------------------------------------------------------------------------------- */

static void kind_text(const proto_field *field, char *text, size_t size)
{
    static const char *const names[] = {"u8",  "u16", "u32",  "u64", "i64",  "f32",
                                        "f64", "raw", "pose", "str", "blob", "list"};
    unsigned long limit = field->limit;
    switch (field->kind) {
    case PROTO_KIND_raw:
        snprintf(text, size, "raw[%lu]", limit);
        break;
    case PROTO_KIND_str:
    case PROTO_KIND_blob:
        snprintf(text, size, "%s <= %lu", names[field->kind], limit);
        break;
    case PROTO_KIND_list:
        snprintf(text, size, "list of %s <= %lu", field->record()->name, limit);
        break;
    default:
        snprintf(text, size, "%s", names[field->kind]);
        break;
    }
}

/* Each field's row begins with offset, name and kind; its meaning stands behind. */
static void check_rows(const char *section, const proto_layout *layout)
{
    size_t at = 0;
    bool fixed = true;
    for (const proto_field *field = layout->fields; field->name; field++) {
        char kind[64], offset[24] = "then", row[160];
        kind_text(field, kind, sizeof kind);
        if (fixed) {
            snprintf(offset, sizeof offset, "%zu", at);
        }
        snprintf(row, sizeof row, "\n| %s | `%s` | %s | ", offset, field->name, kind);
        check_holds(section, row);
        at += proto_field_width(field);
        fixed = fixed && proto_kind_fixed(field->kind);
    }
}

TEST(document_lists_every_message_with_its_fields_and_offsets)
{
    char *document = document_read();
    for (size_t i = 0; document && proto_layout_at(i); i++) {
        const proto_layout *layout = proto_layout_at(i);
        const char *who = *layout->sender == 'C' ? "client" : *layout->sender == 'S' ? "daemon" : "both";
        char heading[80];
        snprintf(heading, sizeof heading, "\n### %s (0x%04x, %s)\n", layout->name, (unsigned)layout->type, who);
        char *section = section_of(document, heading);
        check_rows(section, layout);
        free(section);
    }
    free(document);
}

TEST(document_lists_every_record_with_its_fields_and_offsets)
{
    char *document = document_read();
    for (size_t i = 0; document && proto_record_at(i); i++) {
        char heading[80];
        snprintf(heading, sizeof heading, "\n### record %s\n", proto_record_at(i)->name);
        char *section = section_of(document, heading);
        check_rows(section, proto_record_at(i));
        free(section);
    }
    free(document);
}

TEST(document_lists_every_error)
{
    char *document = document_read();
    char *section = document ? section_of(document, "\n## Errors\n") : NULL;
    if (section) {
        char row[200];
#define ERROR_ROW(NAME, number, retry, closes, text)                                                 \
    snprintf(row, sizeof row, "\n| %d | %s | %s | %s | %s |", number, #NAME, (retry) ? "yes" : "no", \
             (closes) ? "yes" : "no", text);                                                         \
    check_holds(section, row);
        PROTO_ERRORS(ERROR_ROW)
#undef ERROR_ROW
    }
    free(section);
    free(document);
}

/* ---- the worked exchange ------------------------------------------------------------------------------------ */

static void count_up(uint8_t *bytes, size_t size, uint8_t first)
{
    for (size_t i = 0; i < size; i++) {
        bytes[i] = (uint8_t)(first + i);
    }
}

static proto_pose pose_at(double x, double y, double z)
{
    return (proto_pose){.position = {x, y, z}, .orientation = {0, 0, 0, 1}};
}

static void example_hello(proto_message *m)
{
    *m = (proto_message){.type = PROTO_HELLO, .flags = PROTO_FLAG_REQUIRED, .request = 1};
    memcpy(m->as.hello.magic, PROTO_MAGIC, 4);
    m->as.hello.lowest_version = m->as.hello.highest_version = PROTO_VERSION;
    count_up(m->as.hello.routing_key, 16, 0x10);
    m->as.hello.client = proto_str_of("demo 1");
}

static void example_welcome(proto_message *m)
{
    *m = (proto_message){.type = PROTO_WELCOME, .request = 1};
    m->as.welcome.version = PROTO_VERSION;
    m->as.welcome.auth_required = 1;
    count_up(m->as.welcome.nonce, 32, 0x20);
    m->as.welcome.greatest_payload = PROTO_MAX_REQUEST;
    count_up(m->as.welcome.session, 16, 0x80);
    m->as.welcome.server = proto_str_of("awtd 0.1.0");
}

static void example_auth(proto_message *m)
{
    uint8_t token[AUTH_TOKEN_SIZE], server_nonce[AUTH_NONCE_SIZE];
    count_up(token, sizeof token, 0x00);
    count_up(server_nonce, sizeof server_nonce, 0x20);
    *m = (proto_message){.type = PROTO_AUTH, .flags = PROTO_FLAG_REQUIRED, .request = 2};
    count_up(m->as.auth.nonce, 32, 0x40);
    auth_client_proof(token, server_nonce, m->as.auth.nonce, m->as.auth.proof);
}

static void example_auth_reply(proto_message *m)
{
    uint8_t token[AUTH_TOKEN_SIZE], server_nonce[AUTH_NONCE_SIZE], client_nonce[AUTH_NONCE_SIZE];
    count_up(token, sizeof token, 0x00);
    count_up(server_nonce, sizeof server_nonce, 0x20);
    count_up(client_nonce, sizeof client_nonce, 0x40);
    *m = (proto_message){.type = PROTO_AUTH_REPLY, .request = 2};
    auth_server_proof(token, server_nonce, client_nonce, m->as.auth_reply.proof);
}

static void example_create(proto_message *m)
{
    *m = (proto_message){.type = PROTO_CREATE, .flags = PROTO_FLAG_REQUIRED, .request = 3};
    struct proto_create *c = &m->as.create;
    c->style = proto_str_of("long");
    c->name = proto_str_of("ada");
    c->seed = 1;
    c->params.count = 1;
    c->params.items[0] = (struct proto_param){.name = proto_str_of("wind_x"), .value = 1.5f};
    c->head = c->body = pose_at(0, 1.7, 0);
}

static void example_create_reply(proto_message *m)
{
    *m = (proto_message){.type = PROTO_CREATE_REPLY, .request = 3};
    struct proto_create_reply *c = &m->as.create_reply;
    c->forest = UINT64_C(0x0000000100000001);
    count_up(c->drive_token, 16, 0x60);
    count_up(c->view_token, 16, 0x70);
    c->strands = 10000;
    c->points_per_strand = 16;
    c->levels = 3;
    c->sections = 10;
    c->top_wisps = 48;
    c->finest_wisps = 600;
    c->coarse_nodes = 480;
    c->finest_nodes = 6000;
    c->mass_kg = 0.75;
    c->longest_strand_m = 0.5;
    c->median_strand_m = 0.4375;
    c->box_min_x = c->box_min_y = c->box_min_z = -0.75f;
    c->box_max_x = c->box_max_y = c->box_max_z = 0.75f;
    c->scale = 1;
    c->up = 1;
    c->head_radius = c->head_radius_m = 0.095;
    c->rebuilt_max_m = 1.0f / (1 << 24);
    c->rebuilt_mean_m = 1.0f / (1 << 28);
    c->wisp_levels.count = 3;
    c->wisp_levels.items[0] = (struct proto_wisp_level){.wisps = 48, .mean_radius_m = 0.03125f};
    c->wisp_levels.items[1] = (struct proto_wisp_level){.wisps = 170, .mean_radius_m = 0.015625f};
    c->wisp_levels.items[2] = (struct proto_wisp_level){.wisps = 600, .mean_radius_m = 0.0078125f};
    c->colliders.count = 1;
    c->colliders.items[0] = (struct proto_collider){.id = 1, .radius_a = 0.09375f, .radius_b = 0.09375f};
    c->build_us = 250000;
}

static void example_motion(proto_message *m)
{
    *m = (proto_message){.type = PROTO_MOTION};
    struct proto_motion *motion = &m->as.motion;
    motion->forest = UINT64_C(0x0000000100000001);
    motion->epoch = 1;
    motion->sequence = 1;
    motion->time_us = 40000;
    motion->head = pose_at(0.0625, 1.7, 0);
    motion->body = pose_at(0, 1.7, 0);
}

static void example_query(proto_message *m)
{
    *m = (proto_message){.type = PROTO_QUERY, .flags = PROTO_FLAG_REQUIRED, .request = 4};
    m->as.query.forest = UINT64_C(0x0000000100000001);
    m->as.query.time_us = 40000;
}

static void example_frame(proto_message *m)
{
    static const unsigned char glb[1256000];
    *m = (proto_message){.type = PROTO_FRAME, .request = 4};
    struct proto_frame *f = &m->as.frame;
    f->forest = UINT64_C(0x0000000100000001);
    f->time_us = 40000;
    f->sequence = 2;
    f->age_us = 9100;
    f->active_nodes = 512;
    f->splits = 3;
    f->steps = 4;
    f->kinetic_energy_j = 0.125f;
    f->step_us = 1500;
    f->encode_us = 9000;
    f->last_write_us = 700;
    f->glb = (proto_blob){glb, sizeof glb};
}

static const struct {
    const char *title; /* what stands before the bytes */
    void (*make)(proto_message *m);
} examples[] = {
    {"client: HELLO", example_hello},
    {"daemon: WELCOME", example_welcome},
    {"client: AUTH", example_auth},
    {"daemon: AUTH_REPLY", example_auth_reply},
    {"client: CREATE", example_create},
    {"daemon: CREATE_REPLY", example_create_reply},
    {"client: MOTION", example_motion},
    {"client: QUERY", example_query},
    {"daemon: FRAME, up to the GLB's own bytes", example_frame},
};

/* "title, N bytes\n0000  xx xx ...\n": sixteen bytes a line. */
static void example_text(size_t index, char *text, size_t size)
{
    static proto_message message;
    unsigned char bytes[1024];
    examples[index].make(&message);
    size_t count = proto_encode_head(&message, bytes, sizeof bytes);
    size_t used = (size_t)snprintf(text, size, "%s, %zu bytes\n", examples[index].title, count);
    for (size_t i = 0; i < count && used + 16 < size; i++) {
        if (i % 16 == 0) {
            used += (size_t)snprintf(text + used, size - used, "%04zx ", i);
        }
        const char *end = i % 16 == 15 || i + 1 == count ? "\n" : "";
        used += (size_t)snprintf(text + used, size - used, " %02x%s", bytes[i], end);
    }
}

TEST(document_shows_an_exchange_as_the_encoder_writes_it)
{
    char *document = document_read();
    for (size_t i = 0; document && i < sizeof examples / sizeof examples[0]; i++) {
        char text[4096];
        example_text(i, text, sizeof text);
        check_holds(document, text);
    }
    free(document);
}

/* The daemon would take what the document shows. */
TEST(document_exchange_decodes)
{
    static proto_message sent, got;
    for (size_t i = 0; i < sizeof examples / sizeof examples[0]; i++) {
        proto_header header;
        examples[i].make(&sent);
        unsigned char *payload = proto_payload(&sent, SIZE_MAX, &header);
        CHECK_INT(proto_decode(&header, payload, &got, NULL), 0);
        free(payload);
    }
}
