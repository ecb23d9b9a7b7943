/* errors.c: what errors.def says of each error. */
#include "proto.h"

typedef struct error_entry {
    int code;
    bool retry, closes;
    const char *text;
} error_entry;

static const error_entry *error_find(int code)
{
    static const error_entry entries[] = {
#define ERROR_ENTRY(NAME, number, retry, closes, text) {number, retry, closes, text},
        PROTO_ERRORS(ERROR_ENTRY)
#undef ERROR_ENTRY
    };
    static const error_entry unknown = {0, false, false, "an error that this version does not know"};
    for (size_t i = 0; i < sizeof entries / sizeof entries[0]; i++) {
        if (entries[i].code == code) {
            return &entries[i];
        }
    }
    return &unknown;
}

const char *proto_error_text(int code)
{
    return error_find(code)->text;
}

bool proto_error_retry(int code)
{
    return error_find(code)->retry;
}

bool proto_error_closes(int code)
{
    return error_find(code)->closes;
}
