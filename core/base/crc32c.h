/* crc32c.h: the Castagnoli checksum (RFC 3720, appendix B.4): finds damage, keeps nobody out. */
#ifndef BASE_CRC32C_H
#define BASE_CRC32C_H

#include <stddef.h>
#include <stdint.h>

uint32_t crc32c(const void *bytes, size_t size);

#endif
