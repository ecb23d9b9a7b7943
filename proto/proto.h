/* proto.h: bytes to messages and back. No I/O, no allocation, nothing but this folder.
 *
 * messages.def is the one list; here it becomes structs. A decoded message's texts and blobs point into the bytes it
 * was decoded from. Decoding checks everything that can be checked without knowing the daemon's state: lengths and
 * counts against the bytes that remain, UTF-8 without NUL, finite numbers, unit quaternions, nothing left over. */
#ifndef PROTO_PROTO_H
#define PROTO_PROTO_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "errors.def"
#include "messages.def"

#ifdef __cplusplus
extern "C" {
#endif

enum {
    PROTO_VERSION = 1,
    PROTO_HEADER_SIZE = 16,            /* u32 payload length, u16 type, u16 flags, u64 request id */
    PROTO_REPLY = 0x8000,              /* set in the type of a reply */
    PROTO_FLAG_REQUIRED = 1,           /* the receiver must understand it, or answer ERROR */
    PROTO_MAX_GREETING = 512,          /* payload bytes before the client is in */
    PROTO_MAX_REQUEST = 2 << 20,       /* payload bytes of any message from a client */
    PROTO_MAX_REPLY = (64 << 20) + 512 /* payload bytes of any message from a daemon */
};

#define PROTO_MAGIC "AWTD"

enum proto_type {
#define PROTO_TYPE(NAME, name, id, who, text) PROTO_##NAME = id,
    PROTO_MESSAGES(PROTO_TYPE)
#undef PROTO_TYPE
};

enum proto_error_code {
#define PROTO_ERROR_CODE(NAME, number, retry, closes, text) PROTO_ERROR_##NAME = number,
    PROTO_ERRORS(PROTO_ERROR_CODE)
#undef PROTO_ERROR_CODE
};

typedef struct proto_str {
    const char *text; /* not terminated */
    uint16_t length;
} proto_str;

typedef struct proto_blob {
    const unsigned char *bytes;
    uint32_t length;
} proto_blob;

typedef struct proto_pose {
    double position[3];
    double orientation[4];
} proto_pose;

/* Fields to struct members. */
#define PROTO_MEMBER(kind, name, argument, text) PROTO_MEMBER_##kind(name, argument)
#define PROTO_MEMBER_u8(name, argument) uint8_t name;
#define PROTO_MEMBER_u16(name, argument) uint16_t name;
#define PROTO_MEMBER_u32(name, argument) uint32_t name;
#define PROTO_MEMBER_u64(name, argument) uint64_t name;
#define PROTO_MEMBER_i64(name, argument) int64_t name;
#define PROTO_MEMBER_f32(name, argument) float name;
#define PROTO_MEMBER_f64(name, argument) double name;
#define PROTO_MEMBER_raw(name, size) uint8_t name[size];
#define PROTO_MEMBER_str(name, greatest) proto_str name;
#define PROTO_MEMBER_blob(name, greatest) proto_blob name;
#define PROTO_MEMBER_pose(name, argument) proto_pose name;
#define PROTO_MEMBER_list(name, argument)                          \
    struct {                                                       \
        uint16_t count;                                            \
        PROTO_LIST_RECORD argument items[PROTO_LIST_MAX argument]; \
    } name;
#define PROTO_LIST_RECORD(record, greatest) struct proto_##record
#define PROTO_LIST_MAX(record, greatest) greatest

#define PROTO_RECORD_STRUCT(record, text)          \
    struct proto_##record {                        \
        PROTO_RECORD_FIELDS_##record(PROTO_MEMBER) \
    };
PROTO_RECORDS(PROTO_RECORD_STRUCT)
#undef PROTO_RECORD_STRUCT

/* A message without fields keeps one unused byte: C has no empty structs. */
#define PROTO_MESSAGE_STRUCT(NAME, name, id, who, text)   \
    struct proto_##name {                                 \
        PROTO_FIELDS_##name(PROTO_MEMBER) uint8_t unused; \
    };
PROTO_MESSAGES(PROTO_MESSAGE_STRUCT)
#undef PROTO_MESSAGE_STRUCT

typedef struct proto_message {
    uint16_t type; /* which member of the union */
    uint16_t flags;
    uint64_t request;
    union {
#define PROTO_UNION(NAME, name, id, who, text) struct proto_##name name;
        PROTO_MESSAGES(PROTO_UNION)
#undef PROTO_UNION
    } as;
} proto_message;

typedef struct proto_header {
    uint32_t length; /* of the payload */
    uint16_t type, flags;
    uint64_t request;
} proto_header;

/* Reads the PROTO_HEADER_SIZE bytes at `bytes`. Nothing can be wrong with them; the caller checks length and type. */
proto_header proto_header_read(const unsigned char *bytes);

/* True if `type` is in the list. */
bool proto_type_known(uint16_t type);
/* "MOTION"; "unknown" if it is not in the list. */
const char *proto_type_name(uint16_t type);

/* Decodes one payload of header->length bytes into *out, whose texts and blobs point into `payload`.
 * 0, or a PROTO_ERROR_ code: UNKNOWN_MESSAGE, BAD_FRAME (does not fit, or bytes are left over), BAD_VALUE (a number is
 * not finite, a quaternion not of unit length, a text not UTF-8), LIMIT (a list or text longer than its limit). `where`
 * (may be NULL) then names the field. */
int proto_decode(const proto_header *header, const unsigned char *payload, proto_message *out, const char **where);

/* Begins a message of that type: all its own fields are 0. The room of longer messages (a list has 12 KB) is left as it
 * is, where an initialiser would fill it. */
void proto_begin(proto_message *message, uint16_t type);

/* Bytes that proto_encode writes for it, header included; 0 where it cannot be encoded (a text or list over its limit).
 */
size_t proto_encoded_size(const proto_message *message);
/* Writes header and payload into `bytes`, of which there are `capacity`. The bytes written; 0: they do not fit (and
 * what stands in `bytes` then is nothing). */
size_t proto_encode(const proto_message *message, unsigned char *bytes, size_t capacity);

/* As proto_encode, for a message whose last field is a blob, but without the blob's bytes: the caller sends these after
 * it. */
size_t proto_encode_head(const proto_message *message, unsigned char *bytes, size_t capacity);

/* The list's text of an error, and its properties. */
const char *proto_error_text(int code);
bool proto_error_retry(int code);
bool proto_error_closes(int code);

proto_str proto_str_of(const char *text);
/* Copies into a terminated buffer, cut to what fits. */
void proto_str_copy(proto_str from, char *to, size_t size);

#ifdef __cplusplus
}
#endif

#endif
