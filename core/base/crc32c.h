/* crc32c.h: the Castagnoli checksum (RFC 3720, appendix B.4): finds damage, keeps nobody out. */
#ifndef BASE_CRC32C_H
#define BASE_CRC32C_H

#include <stddef.h>
#include <stdint.h>

uint32_t crc32c(const void *bytes, size_t size);

/* The checksum of what `crc` is of, with `bytes` behind it. Of nothing: 0. */
uint32_t crc32c_more(uint32_t crc, const void *bytes, size_t size);
/* The same where only the checksum `crc_behind` of the `size_behind` bytes behind it is known. */
uint32_t crc32c_join(uint32_t crc, uint32_t crc_behind, size_t size_behind);

#endif
