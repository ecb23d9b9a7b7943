/* random.h: bytes that nobody can guess, for nonces and tokens. */
#ifndef SERVER_RANDOM_H
#define SERVER_RANDOM_H

#include <stdbool.h>
#include <stddef.h>

/* Opens /dev/urandom for good, so that a process which runs out of descriptors later still has it; random_fill does so
 * otherwise. Any thread. False: errno says why. */
bool random_open(void);

/* Fills from /dev/urandom. Any thread. False: it cannot be read (no descriptor left, or no such device). */
bool random_fill(void *bytes, size_t size);

#endif
