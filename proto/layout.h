/* layout.h: messages.def as tables that can be walked: which fields a message has, of what kind, and where they stand
 * in its struct. Encoder and decoder walk them; so do the tests and the check of PROTOCOL.md's tables. */
#ifndef PROTO_LAYOUT_H
#define PROTO_LAYOUT_H

#include "proto.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Kinds of a fixed width first: proto_kind_fixed. */
typedef enum proto_kind {
    PROTO_KIND_u8,
    PROTO_KIND_u16,
    PROTO_KIND_u32,
    PROTO_KIND_u64,
    PROTO_KIND_i64,
    PROTO_KIND_f32,
    PROTO_KIND_f64,
    PROTO_KIND_raw,
    PROTO_KIND_pose,
    PROTO_KIND_str,
    PROTO_KIND_blob,
    PROTO_KIND_list
} proto_kind;

typedef struct proto_layout proto_layout;

typedef struct proto_field {
    const char *name, *text; /* name NULL: behind the last field */
    proto_kind kind;
    size_t offset;                       /* of the member in the struct, bytes */
    uint32_t limit;                      /* raw: its size; str, blob: the greatest length; list: the greatest count */
    size_t items;                        /* list: offset of its first record in the struct, bytes */
    const proto_layout *(*record)(void); /* list: what it holds */
} proto_field;

struct proto_layout {
    const char *name, *text; /* "MOTION", or "collider" of a record */
    const char *sender;      /* "C", "S" or "B" as in messages.def; "" of a record */
    uint16_t type;           /* 0 of a record */
    size_t size;             /* of the struct, bytes */
    const proto_field *fields;
};

/* The layout of a message type; NULL if it is not in the list. Static storage, as are all below. */
const proto_layout *proto_layout_of(uint16_t type);
/* Message `index` in the list's order; NULL behind the last. */
const proto_layout *proto_layout_at(size_t index);
/* Record `index` in the list's order; NULL behind the last. */
const proto_layout *proto_record_at(size_t index);

static inline bool proto_kind_fixed(proto_kind kind)
{
    return kind < PROTO_KIND_str;
}

/* Bytes that a field takes on the wire: exactly, if its kind is fixed; else at least. */
size_t proto_field_width(const proto_field *field);

/* The blob that ends a message (what proto_encode_head leaves out); NULL if the message does not end with one. */
const proto_blob *proto_tail(const proto_message *message);

#ifdef __cplusplus
}
#endif

#endif
