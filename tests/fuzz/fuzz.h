/* fuzz.h: what is fuzzed: everything that reads bytes from outside, each under a name. */
#ifndef FUZZ_H
#define FUZZ_H

#include <stddef.h>
#include <stdint.h>

typedef struct fuzz_target {
    const char *name;
    /* Takes any bytes at all. What it accepts it also uses: strands become a groom, a snapshot goes on. */
    void (*run)(const uint8_t *bytes, size_t size);
    /* Hands to `give` some inputs that are right, for the fuzzer to begin from. */
    void (*seed)(void (*give)(const void *bytes, size_t size));
} fuzz_target;

enum { FUZZ_TARGETS = 9 };
extern const fuzz_target fuzz_targets[FUZZ_TARGETS];

void fuzz_seed_strands(void (*give)(const void *bytes, size_t size));
void fuzz_seed_hierarchy(void (*give)(const void *bytes, size_t size));
void fuzz_seed_motion(void (*give)(const void *bytes, size_t size));
void fuzz_seed_message(void (*give)(const void *bytes, size_t size));
void fuzz_seed_snapshot(void (*give)(const void *bytes, size_t size));
void fuzz_seed_frame(void (*give)(const void *bytes, size_t size));
void fuzz_seed_json(void (*give)(const void *bytes, size_t size));

/* delta.c has both. */
void fuzz_run_delta(const uint8_t *bytes, size_t size);
void fuzz_seed_delta(void (*give)(const void *bytes, size_t size));

/* session.c likewise. */
void fuzz_run_session(const uint8_t *bytes, size_t size);
void fuzz_seed_session(void (*give)(const void *bytes, size_t size));

#endif
