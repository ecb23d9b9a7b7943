/* sections.c: see sections.h. */
#include "sim/sections.h"

#include "base/assert.h"
#include "base/crc32c.h"
#include "base/error.h"

enum { SECTIONS_FORMAT = 2, HEADER_SIZE = 16, ENTRY_SIZE = 24, CRC_SIZE = 4 };
enum { ENTRY_CRC = 4, ENTRY_OFFSET = 8, ENTRY_BYTES = 16 };

static const unsigned char sections_magic[4] = {'A', 'W', 'T', 'S'};

/* Where the table ends and its checksum stands. */
static size_t table_end(uint32_t count)
{
    return HEADER_SIZE + ENTRY_SIZE * (size_t)count;
}

/* Without output, or where it is too small, nothing is written. */
static bool is_written(const codec *to)
{
    return to->out && !to->spent;
}

sections_writer sections_begin(void *bytes, size_t capacity, uint32_t count)
{
    ASSERT(count <= SECTIONS_MAX);
    sections_writer w = {.to = codec_writing(bytes, capacity), .count = count};
    size_t from;
    codec_pass(&w.to, table_end(count) + CRC_SIZE, &from);
    return w;
}

codec *sections_open(sections_writer *w, const char *name)
{
    ASSERT(w->next < w->count);
    w->began = w->to.at;
    if (is_written(&w->to)) {
        memcpy(w->to.out + table_end(w->next), name, SECTIONS_NAME);
    }
    return &w->to;
}

void sections_close(sections_writer *w)
{
    size_t size = w->to.at - w->began;
    if (is_written(&w->to)) {
        unsigned char *entry = w->to.out + table_end(w->next);
        store_u32(entry + ENTRY_CRC, crc32c(w->to.out + w->began, size));
        store_u64(entry + ENTRY_OFFSET, w->began);
        store_u64(entry + ENTRY_BYTES, size);
    }
    w->next++;
}

void sections_end(sections_writer *w, uint32_t physics_version)
{
    ASSERT(w->next == w->count);
    if (is_written(&w->to)) {
        unsigned char *header = w->to.out;
        memcpy(header, sections_magic, sizeof sections_magic);
        store_u32(header + 4, SECTIONS_FORMAT);
        store_u32(header + 8, physics_version);
        store_u32(header + 12, w->count);
        store_u32(header + table_end(w->count), crc32c(header, table_end(w->count)));
    }
}

static awt_status check_header(const unsigned char *bytes, size_t size, awt_error *error)
{
    if (size < sizeof sections_magic || memcmp(bytes, sections_magic, sizeof sections_magic) != 0) {
        return error_set(error, AWT_BAD_FORMAT, "this is not a snapshot");
    }
    if (size < HEADER_SIZE) {
        return error_set(error, AWT_TRUNCATED, "the snapshot ends within its header");
    }
    if (load_u32(bytes + 4) != SECTIONS_FORMAT) {
        return error_set(error, AWT_OTHER_VERSION, "a snapshot of format %lu; this program reads format %d",
                         (unsigned long)load_u32(bytes + 4), SECTIONS_FORMAT);
    }
    uint32_t count = load_u32(bytes + 12);
    if (count > SECTIONS_MAX) {
        return error_set(error, AWT_BAD_VALUE, "the snapshot's table is damaged");
    }
    if (size < table_end(count) + CRC_SIZE) {
        return error_set(error, AWT_TRUNCATED, "the snapshot ends within its table");
    }
    if (load_u32(bytes + table_end(count)) != crc32c(bytes, table_end(count))) {
        return error_set(error, AWT_BAD_VALUE, "the snapshot's table is damaged");
    }
    return AWT_OK;
}

/* Each section begins where the one before ends, and the last ends where the bytes end. */
static awt_status check_extents(const sections_reader *r, size_t size, awt_error *error)
{
    uint64_t at = table_end(r->count) + CRC_SIZE;
    for (uint32_t k = 0; k < r->count; k++) {
        const unsigned char *entry = r->bytes + table_end(k);
        if (load_u64(entry + ENTRY_OFFSET) != at) {
            return error_set(error, AWT_BAD_VALUE, "the snapshot's table is damaged");
        }
        if (load_u64(entry + ENTRY_BYTES) > size - at) {
            return error_set(error, AWT_TRUNCATED, "the snapshot ends before what its table announces");
        }
        at += load_u64(entry + ENTRY_BYTES);
    }
    if (at != size) {
        return error_set(error, AWT_BAD_VALUE, "the snapshot has bytes behind its last section");
    }
    return AWT_OK;
}

static awt_status check_sums(const sections_reader *r, awt_error *error)
{
    for (uint32_t k = 0; k < r->count; k++) {
        const unsigned char *entry = r->bytes + table_end(k);
        size_t offset = (size_t)load_u64(entry + ENTRY_OFFSET), bytes = (size_t)load_u64(entry + ENTRY_BYTES);
        if (load_u32(entry + ENTRY_CRC) != crc32c(r->bytes + offset, bytes)) {
            return error_set(error, AWT_BAD_VALUE, "the snapshot is damaged in its section %lu", (unsigned long)k);
        }
    }
    return AWT_OK;
}

awt_status sections_check(const void *bytes, size_t size, sections_reader *out, awt_error *error)
{
    awt_status status = check_header(bytes, size, error);
    if (status != AWT_OK) {
        return status;
    }
    sections_reader r = {.bytes = bytes};
    r.physics_version = load_u32(r.bytes + 8);
    r.count = load_u32(r.bytes + 12);
    status = check_extents(&r, size, error);
    if (status == AWT_OK) {
        status = check_sums(&r, error);
    }
    if (status == AWT_OK) {
        *out = r;
    }
    return status;
}

bool sections_find(const sections_reader *r, const char *name, codec *out)
{
    for (uint32_t k = 0; k < r->count; k++) {
        const unsigned char *entry = r->bytes + table_end(k);
        if (memcmp(entry, name, SECTIONS_NAME) == 0) {
            *out = codec_reading(r->bytes + load_u64(entry + ENTRY_OFFSET), (size_t)load_u64(entry + ENTRY_BYTES));
            return true;
        }
    }
    return false;
}
