/* test_crc32c.c: checksums of bytes that come in pieces. (That they are Castagnoli's: test_snapshot.c.) */
#include "check.h"

#include "base/crc32c.h"
#include "base/rng.h"

TEST(crc32c_of_pieces_is_that_of_the_whole)
{
    unsigned char bytes[300];
    rng random = rng_seed(11);
    for (size_t i = 0; i < sizeof bytes; i++) {
        bytes[i] = (unsigned char)rng_u32(&random);
    }
    for (size_t size = 0; size <= sizeof bytes; size += 1 + size / 9) {
        const uint32_t whole = crc32c(bytes, size);
        for (size_t cut = 0; cut <= size; cut++) {
            CHECK_U64(crc32c_more(crc32c(bytes, cut), bytes + cut, size - cut), whole);
            CHECK_U64(crc32c_join(crc32c(bytes, cut), crc32c(bytes + cut, size - cut), size - cut), whole);
        }
    }
}
