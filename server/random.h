/* random.h: bytes that nobody can guess, for nonces and tokens. */
#ifndef SERVER_RANDOM_H
#define SERVER_RANDOM_H

#include <stdbool.h>
#include <stddef.h>

/* Fills from /dev/urandom. False: it cannot be read (no descriptor left, or no such device). */
bool random_fill(void *bytes, size_t size);

#endif
