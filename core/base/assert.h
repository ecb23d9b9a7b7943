/* assert.h: for our own bugs, kept in release. Input from outside is never asserted, it is refused. */
#ifndef BASE_ASSERT_H
#define BASE_ASSERT_H

#include <stdio.h>
#include <stdlib.h>

#define ASSERT(condition)                                                                                \
    do {                                                                                                 \
        if (!(condition)) {                                                                              \
            fprintf(stderr, "%s:%d: a bug of awtd: %s does not hold\n", __FILE__, __LINE__, #condition); \
            abort();                                                                                     \
        }                                                                                                \
    } while (0)

#endif
