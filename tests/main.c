/* main.c: runs the unit tests, all or those whose name contains an argument. */
#include "check.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TEST_ENTRY(name) void test_##name(void);
#include "test_list.h"
#undef TEST_ENTRY

static const struct {
    const char *name;
    void (*run)(void);
} test_table[] = {
#define TEST_ENTRY(name) {#name, test_##name},
#include "test_list.h"
#undef TEST_ENTRY
};

static char build_directory[512] = ".";
static int failures_in_test;
static bool skipped;

void check_true(const char *file, int line, const char *text, bool holds)
{
    if (!holds) {
        failures_in_test++;
        printf("%s:%d: %s does not hold\n", file, line, text);
    }
}

void check_int(const char *file, int line, const char *text, long long got, long long expected)
{
    if (got != expected) {
        failures_in_test++;
        printf("%s:%d: %s is %lld, not %lld\n", file, line, text, got, expected);
    }
}

void check_u64(const char *file, int line, const char *text, uint64_t got, uint64_t expected)
{
    if (got != expected) {
        failures_in_test++;
        printf("%s:%d: %s is 0x%016" PRIx64 ", not 0x%016" PRIx64 "\n", file, line, text, got, expected);
    }
}

void check_near(const char *file, int line, const char *text, double got, double expected, double tolerance)
{
    if (!(fabs(got - expected) <= tolerance)) {
        failures_in_test++;
        printf("%s:%d: %s is %.17g, not within %g of %.17g\n", file, line, text, got, tolerance, expected);
    }
}

void check_text(const char *file, int line, const char *text, const char *got, const char *expected)
{
    if (!got || strcmp(got, expected) != 0) {
        failures_in_test++;
        printf("%s:%d: %s is \"%s\", not \"%s\"\n", file, line, text, got ? got : "(none)", expected);
    }
}

void check_bytes(const char *file, int line, const char *text, const void *got, const void *expected, size_t size)
{
    const unsigned char *a = got, *b = expected;
    for (size_t i = 0; i < size; i++) {
        if (a[i] != b[i]) {
            failures_in_test++;
            printf("%s:%d: %s differs at byte %zu of %zu: %02x, not %02x\n", file, line, text, i, size, a[i], b[i]);
            return;
        }
    }
}

void check_skip(const char *why)
{
    skipped = true;
    printf("     because: %s\n", why);
}

const char *check_data(const char *relative)
{
    static char path[1024];
    const char *root = getenv("AWT_DATA");
    snprintf(path, sizeof path, "%s/%s", root ? root : "../shared/data", relative);
    FILE *file = fopen(path, "rb");
    if (!file) {
        return NULL;
    }
    fclose(file);
    return path;
}

unsigned char *check_read_file(const char *path, size_t *size)
{
    FILE *file = fopen(path, "rb");
    if (!file) {
        return NULL;
    }
    size_t capacity = 1 << 16, used = 0;
    unsigned char *bytes = malloc(capacity);
    for (size_t got; bytes && (got = fread(bytes + used, 1, capacity - used, file)) > 0;) {
        used += got;
        if (used == capacity) {
            capacity *= 2;
            unsigned char *larger = realloc(bytes, capacity);
            if (!larger) {
                free(bytes);
            }
            bytes = larger;
        }
    }
    fclose(file);
    *size = used;
    return bytes;
}

void check_write_file(const char *folder, const char *name, const char *ending, const void *bytes, size_t size)
{
    char path[1024];
    snprintf(path, sizeof path, "%s/%s%s", folder, name, ending);
    FILE *file = fopen(path, "wb");
    CHECK(file && fwrite(bytes, 1, size, file) == size);
    CHECK(file && fclose(file) == 0);
}

#if defined(__has_feature)
#define HAS_FEATURE(name) __has_feature(name)
#else
#define HAS_FEATURE(name) 0
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || HAS_FEATURE(address_sanitizer) || \
    HAS_FEATURE(thread_sanitizer)
enum { SHARE_OF_ROUNDS = 3 };
#else
enum { SHARE_OF_ROUNDS = 1 };
#endif

int check_rounds(int all)
{
    return (all + SHARE_OF_ROUNDS - 1) / SHARE_OF_ROUNDS;
}

const char *check_build_directory(void)
{
    return build_directory;
}

/* AWT_SHARE=K/N: of N processes that share the tests, this is number K, from 0. */
static bool is_mine(size_t test)
{
    const char *share = getenv("AWT_SHARE"), *of = share ? strchr(share, '/') : NULL;
    const unsigned long count = of ? strtoul(of + 1, NULL, 10) : 1;
    return count < 2 || test % count == strtoul(share, NULL, 10);
}

int main(int argc, char **argv)
{
    int passed = 0, failed = 0, skips = 0;
    const char *slash = strrchr(argv[0], '/');
    if (slash) {
        snprintf(build_directory, sizeof build_directory, "%.*s", (int)(slash - argv[0]), argv[0]);
    }
    for (size_t i = 0; i < sizeof test_table / sizeof test_table[0]; i++) {
        bool wanted = argc < 2 && is_mine(i);
        for (int a = 1; a < argc; a++) {
            wanted = wanted || strstr(test_table[i].name, argv[a]) != NULL;
        }
        if (!wanted) {
            continue;
        }
        failures_in_test = 0;
        skipped = false;
        test_table[i].run();
        if (failures_in_test > 0) {
            failed++;
        } else if (skipped) {
            skips++;
        } else {
            passed++;
        }
        printf("%s %s\n", failures_in_test > 0 ? "FAIL" : skipped ? "skip" : "ok  ", test_table[i].name);
        fflush(stdout);
    }
    printf("%d passed, %d failed, %d skipped\n", passed, failed, skips);
    return failed > 0 || passed + skips == 0;
}
