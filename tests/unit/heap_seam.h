/* heap_seam.h: the heap before the eyes of the tests, and in their hands. The build has the linker lead every call of
 * the heap that our code makes through here (Makefile: WRAP), and the C++ libraries' `new` ends here too, whatever heap
 * is behind it, the sanitizers' own included.
 *
 * Everything is of the calling thread alone: what other threads take is neither counted nor refused. */
#ifndef HEAP_SEAM_H
#define HEAP_SEAM_H

#include <stdbool.h>
#include <stdint.h>

/* What this thread did since heap_watch. */
typedef struct heap_seen {
    unsigned calls;       /* of any kind, free among them */
    int64_t blocks;       /* taken and not given back */
    int64_t bytes;        /* in them, as the heap rounds; 0 where it does not say */
    int64_t most_bytes;   /* at any time */
    uint32_t allocations; /* while they were numbered: heap_number */
    bool failed;          /* heap_fail had its way */
} heap_seen;

/* Everything begins at 0; nothing is numbered, nothing fails. */
void heap_watch(void);
/* So far. */
heap_seen heap_look(void);
/* The watch ends; what it saw. */
heap_seen heap_watch_end(void);

/* From now on allocations are numbered, from 1 on; or they are not, and none fails: what a test needs for itself. */
void heap_number(bool numbered);
/* That one of those numbered finds no memory, once. 0: none. */
void heap_fail(uint32_t number);

#endif
