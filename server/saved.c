/* saved.c: see saved.h. */
#include "saved.h"
#include "base/assert.h"
#include "base/codec.h"
#include "base/crc32c.h"
#include "base/error.h"
#include "load.h"

#include <string.h>

enum { SAVED_VERSION = 2, SAVED_HEADER = 12 };
static const char magic[4] = "AWTF";

/* Everything between the header and the snapshot. */
static void walk(codec *c, saved *s)
{
    codec_u64(c, &s->handle);
    codec_bytes(c, s->drive_token, sizeof s->drive_token);
    codec_bytes(c, s->view_token, sizeof s->view_token);
    codec_bytes(c, s->name, sizeof s->name);
    codec_bytes(c, s->account, sizeof s->account);
    codec_u32(c, &s->mode);
    codec_f64(c, &s->rate);
    codec_f32(c, &s->importance);
    codec_u64(c, &s->sequence);
    codec_u64(c, &s->hash);
}

static size_t fields_size(void)
{
    saved nothing = {0};
    codec counting = codec_writing(NULL, 0);
    walk(&counting, &nothing);
    return counting.at;
}

size_t saved_size(const saved *s)
{
    return SAVED_HEADER + fields_size() + s->state_size;
}

unsigned char *saved_state(const saved *s, void *bytes)
{
    return (unsigned char *)bytes + saved_size(s) - s->state_size;
}

void saved_write(const saved *s, void *bytes)
{
    unsigned char *at = bytes;
    const size_t behind = fields_size() + s->state_size;
    saved fields = *s;
    codec writing = codec_writing(at + SAVED_HEADER, behind);
    walk(&writing, &fields);
    ASSERT(!writing.spent);
    memcpy(at, magic, sizeof magic);
    store_u32(at + 4, SAVED_VERSION);
    store_u32(at + 8, crc32c(at + SAVED_HEADER, behind));
}

static bool is_possible(const saved *s)
{
    const bool rated = s->mode != CLOCK_FREE || (s->rate >= CLOCK_RATE_LEAST && s->rate <= CLOCK_RATE_GREATEST);
    return s->handle != 0 && memchr(s->name, '\0', sizeof s->name) && memchr(s->account, '\0', sizeof s->account) &&
           s->mode <= CLOCK_PAUSED && rated && s->importance >= IMPORTANCE_LEAST &&
           s->importance <= IMPORTANCE_GREATEST;
}

awt_status saved_read(const void *bytes, size_t size, saved *out, awt_error *error)
{
    const unsigned char *at = bytes;
    *out = (saved){0};
    if (size < SAVED_HEADER + fields_size()) {
        return error_set(error, AWT_TRUNCATED, "a saved forest has more than %zu bytes", size);
    }
    if (memcmp(at, magic, sizeof magic) != 0 || load_u32(at + 4) != SAVED_VERSION) {
        return error_set(error, AWT_BAD_FORMAT, "no saved forest of version %d", SAVED_VERSION);
    }
    if (load_u32(at + 8) != crc32c(at + SAVED_HEADER, size - SAVED_HEADER)) {
        return error_set(error, AWT_BAD_VALUE, "the saved forest is damaged: its checksum is wrong");
    }
    codec reading = codec_reading(at + SAVED_HEADER, size - SAVED_HEADER);
    walk(&reading, out);
    if (reading.spent || !is_possible(out)) {
        return error_set(error, AWT_BAD_VALUE, "the saved forest has a field that cannot be");
    }
    out->state = at + SAVED_HEADER + reading.at;
    out->state_size = size - SAVED_HEADER - reading.at;
    return AWT_OK;
}
