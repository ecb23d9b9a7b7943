/* layout.c: expands messages.def into the tables of layout.h.
 *
 * F(...) does not say to which struct a field belongs, so each table is made inside a function of its own where the
 * struct is called `self`. */
#include "layout.h"

#define FIELD(kind, name, argument, text) \
    {#name, text, PROTO_KIND_##kind, offsetof(self, name), FIELD_##kind(name, argument)},
#define FIELD_PLAIN 0, 0, NULL
#define FIELD_u8(name, argument) FIELD_PLAIN
#define FIELD_u16(name, argument) FIELD_PLAIN
#define FIELD_u32(name, argument) FIELD_PLAIN
#define FIELD_u64(name, argument) FIELD_PLAIN
#define FIELD_i64(name, argument) FIELD_PLAIN
#define FIELD_f32(name, argument) FIELD_PLAIN
#define FIELD_f64(name, argument) FIELD_PLAIN
#define FIELD_pose(name, argument) FIELD_PLAIN
#define FIELD_raw(name, size) size, 0, NULL
#define FIELD_str(name, greatest) greatest, 0, NULL
#define FIELD_blob(name, greatest) greatest, 0, NULL
#define FIELD_list(name, argument) PROTO_LIST_MAX argument, offsetof(self, name.items), FIELD_RECORD argument
#define FIELD_RECORD(record, greatest) record_##record

#define RECORD_LAYOUT(record, text)                                                              \
    static const proto_layout *record_##record(void)                                             \
    {                                                                                            \
        typedef struct proto_##record self;                                                      \
        static const proto_field fields[] = {PROTO_RECORD_FIELDS_##record(FIELD){.name = NULL}}; \
        static const proto_layout layout = {#record, text, "", 0, sizeof(self), fields};         \
        return &layout;                                                                          \
    }
PROTO_RECORDS(RECORD_LAYOUT)

#define MESSAGE_LAYOUT(NAME, message, id, who, text)                                       \
    static const proto_layout *message_##message(void)                                     \
    {                                                                                      \
        typedef struct proto_##message self;                                               \
        static const proto_field fields[] = {PROTO_FIELDS_##message(FIELD){.name = NULL}}; \
        static const proto_layout layout = {#NAME, text, #who, id, sizeof(self), fields};  \
        return &layout;                                                                    \
    }
PROTO_MESSAGES(MESSAGE_LAYOUT)

const proto_layout *proto_layout_of(uint16_t type)
{
    switch (type) {
#define MESSAGE_CASE(NAME, message, id, who, text) \
    case id:                                       \
        return message_##message();
        PROTO_MESSAGES(MESSAGE_CASE)
#undef MESSAGE_CASE
    }
    return NULL;
}

const proto_layout *proto_layout_at(size_t index)
{
    static const uint16_t types[] = {
#define MESSAGE_TYPE(NAME, message, id, who, text) id,
        PROTO_MESSAGES(MESSAGE_TYPE)
#undef MESSAGE_TYPE
    };
    return index < sizeof types / sizeof types[0] ? proto_layout_of(types[index]) : NULL;
}

const proto_layout *proto_record_at(size_t index)
{
    static const proto_layout *(*const records[])(void) = {
#define RECORD_FUNCTION(record, text) record_##record,
        PROTO_RECORDS(RECORD_FUNCTION)
#undef RECORD_FUNCTION
    };
    return index < sizeof records / sizeof records[0] ? records[index]() : NULL;
}

size_t proto_field_width(const proto_field *field)
{
    switch (field->kind) {
    case PROTO_KIND_u8:
        return 1;
    case PROTO_KIND_u16:
        return 2;
    case PROTO_KIND_u32:
    case PROTO_KIND_f32:
        return 4;
    case PROTO_KIND_u64:
    case PROTO_KIND_i64:
    case PROTO_KIND_f64:
        return 8;
    case PROTO_KIND_raw:
        return field->limit;
    case PROTO_KIND_pose:
        return 7 * 8;
    case PROTO_KIND_str: /* from here on what announces the length */
    case PROTO_KIND_list:
        return 2;
    case PROTO_KIND_blob:
        return 4;
    }
    return 0;
}

const proto_blob *proto_tail(const proto_message *message)
{
    const proto_layout *layout = proto_layout_of(message->type);
    const proto_blob *tail = NULL;
    for (const proto_field *field = layout ? layout->fields : NULL; field && field->name; field++) {
        const void *member = (const char *)&message->as + field->offset;
        tail = field->kind == PROTO_KIND_blob ? member : NULL;
    }
    return tail;
}

bool proto_type_known(uint16_t type)
{
    return proto_layout_of(type) != NULL;
}

const char *proto_type_name(uint16_t type)
{
    const proto_layout *layout = proto_layout_of(type);
    return layout ? layout->name : "unknown";
}
