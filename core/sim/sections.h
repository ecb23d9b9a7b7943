/* sections.h: the vessel of a snapshot: named runs of bytes behind a table, each with its checksum.
 *
 * magic "AWTS", u32 format version, u32 physics version, u32 number of sections; then for each section its name (4
 * bytes), the CRC32C of its bytes, u64 offset and u64 size; then the CRC32C of everything so far; then the sections,
 * one after the other in the table's order and nothing behind the last. All numbers little-endian. */
#ifndef SIM_SECTIONS_H
#define SIM_SECTIONS_H

#include "awt.h"
#include "base/codec.h"

enum { SECTIONS_NAME = 4, SECTIONS_MAX = 64 };

typedef struct sections_writer {
    codec to;
    uint32_t count, next;
    size_t began; /* of the open section */
} sections_writer;

/* Leaves room for the table of `count` sections. Counts where `bytes` is NULL. */
sections_writer sections_begin(void *bytes, size_t capacity, uint32_t count);
/* Opens the next section; what is walked over the codec returned is in it, until sections_close. */
codec *sections_open(sections_writer *w, const char *name);
void sections_close(sections_writer *w);
/* After all of them. */
void sections_end(sections_writer *w, uint32_t physics_version);

typedef struct sections_reader {
    const unsigned char *bytes;
    uint32_t count, physics_version;
} sections_reader;

/* Checks table and checksums; nothing is allocated. AWT_BAD_FORMAT, AWT_TRUNCATED, AWT_BAD_VALUE, AWT_OTHER_VERSION. */
awt_status sections_check(const void *bytes, size_t size, sections_reader *out, awt_error *error);
/* A codec that reads the section; false: there is none of that name. */
bool sections_find(const sections_reader *r, const char *name, codec *out);

#endif
