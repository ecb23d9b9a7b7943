/* disk.h: bytes to the disk. */
#ifndef DISK_H
#define DISK_H

#include <stdbool.h>
#include <stddef.h>

/* Writes all, and brings it to the disk (fsync). False: errno says why. */
bool disk_write(int fd, const void *bytes, size_t size);

#endif
