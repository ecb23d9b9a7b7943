/* vault.h: the folder of the state directory where forests are kept, a file each. A file comes into being whole: it is
 * written beside its place, brought to the disk (fsync), renamed, and the folder brought to the disk too; whoever is
 * killed in between leaves the old file or the new one. Files are named by the forest's handle. */
#ifndef VAULT_H
#define VAULT_H

#include "limits.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct vault {
    char folder[LIMIT_PATH];
} vault;

/* Makes the folder in the state directory where it is missing, tries whether it can be written, and removes what was
 * half written when a daemon died. False: `error` says why and what to do. */
bool vault_open(vault *v, const char *state_directory, char *error, size_t error_size);

/* Writes a forest's file whole, in place of an earlier one, into the folder, which is made again if it was removed
 * meanwhile. False: the earlier one stands, and errno says why. */
bool vault_write(const vault *v, uint64_t handle, const void *bytes, size_t size);
/* Nothing where there is none. False: errno says why. */
bool vault_remove(const vault *v, uint64_t handle);

/* Calls `found` with each file's handle, in no order, until it says false. False: the folder cannot be read. */
bool vault_list(const vault *v, bool (*found)(void *context, uint64_t handle), void *context);
/* The whole file in heap memory, the caller's; NULL: errno says why (EFBIG: more than LIMIT_SAVED_BYTES). */
unsigned char *vault_read(const vault *v, uint64_t handle, size_t *size);
/* Puts a file that is of no use out of the way, under a name that vault_list passes over; it is kept for people. */
void vault_set_aside(const vault *v, uint64_t handle);

#endif
