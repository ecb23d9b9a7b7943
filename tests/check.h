/* check.h: the tests' few words. TEST(name) { ... } in any file of tests/unit is found by the build and run by
 * build/CONFIG/tests; a check that fails prints where and both values, and the test goes on. */
#ifndef CHECK_H
#define CHECK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define TEST(name)          \
    void test_##name(void); \
    void test_##name(void)

void check_true(const char *file, int line, const char *text, bool holds);
void check_int(const char *file, int line, const char *text, long long got, long long expected);
void check_u64(const char *file, int line, const char *text, uint64_t got, uint64_t expected);
void check_near(const char *file, int line, const char *text, double got, double expected, double tolerance);
void check_text(const char *file, int line, const char *text, const char *got, const char *expected);
void check_bytes(const char *file, int line, const char *text, const void *got, const void *expected, size_t size);

#define CHECK(condition) check_true(__FILE__, __LINE__, #condition, (condition))
#define CHECK_INT(got, expected) check_int(__FILE__, __LINE__, #got, (long long)(got), (long long)(expected))
#define CHECK_U64(got, expected) check_u64(__FILE__, __LINE__, #got, (got), (expected))
#define CHECK_NEAR(got, expected, tolerance) check_near(__FILE__, __LINE__, #got, (got), (expected), (tolerance))
#define CHECK_TEXT(got, expected) check_text(__FILE__, __LINE__, #got, (got), (expected))
#define CHECK_BYTES(got, expected, size) check_bytes(__FILE__, __LINE__, #got, (got), (expected), (size))

/* Ends the test as skipped, visibly: `return` after it. */
void check_skip(const char *why);

/* Path of a file under the real data (AWT_DATA, or ../shared/data beside the checkout), or NULL where it is absent:
 * then the caller says check_skip and returns. Static storage, until the next call. */
const char *check_data(const char *relative);

/* The folder of the running tests, where the same build's programs are. */
const char *check_build_directory(void);

/* How many of `all` rounds of the same to go: all of them, but a third, and one at least, under a sanitizer, where each
 * takes five times as long and is there for its memory, not for its numbers. */
int check_rounds(int all);

/* A whole file in heap memory, or NULL. */
unsigned char *check_read_file(const char *path, size_t *size);
/* Writes the file FOLDER/NAMEENDING, which other programs' checks read; that it is whole is checked. */
void check_write_file(const char *folder, const char *name, const char *ending, const void *bytes, size_t size);

#endif
