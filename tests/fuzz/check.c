/* check.c: the tests' fixtures say CHECK; under the fuzzer what does not hold ends the run, so that its input is kept.
 */
#include "check.h"

#include "base/assert.h"

#include <string.h>

void check_true(const char *file, int line, const char *text, bool holds)
{
    (void)file;
    (void)line;
    (void)text;
    ASSERT(holds);
}

void check_int(const char *file, int line, const char *text, long long got, long long expected)
{
    check_true(file, line, text, got == expected);
}

void check_u64(const char *file, int line, const char *text, uint64_t got, uint64_t expected)
{
    check_true(file, line, text, got == expected);
}

void check_text(const char *file, int line, const char *text, const char *got, const char *expected)
{
    check_true(file, line, text, strcmp(got, expected) == 0);
}
