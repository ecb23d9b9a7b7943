/* main.c: libFuzzer's way in. AWT_FUZZ names the target; with AWT_FUZZ_SEEDS=FOLDER the program writes the target's
 * first inputs there and ends. */
#include "fuzz/fuzz.h"

#include "files.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerInitialize(int *argc, char ***argv);
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

static const fuzz_target *target;
static const char *folder;
static int given;

static void give(const void *bytes, size_t size)
{
    char path[1024], error[512];
    snprintf(path, sizeof path, "%s/seed%d", folder, given++);
    if (!files_write(path, bytes, size, error, sizeof error)) {
        fprintf(stderr, "fuzz: %s\n", error);
        exit(1);
    }
}

int LLVMFuzzerInitialize(int *argc, char ***argv)
{
    const char *name = getenv("AWT_FUZZ");
    (void)argc;
    (void)argv;
    for (size_t i = 0; name && i < FUZZ_TARGETS; i++) {
        target = strcmp(fuzz_targets[i].name, name) == 0 ? &fuzz_targets[i] : target;
    }
    if (!target) {
        fputs("fuzz: AWT_FUZZ names one of", stderr);
        for (size_t i = 0; i < FUZZ_TARGETS; i++) {
            fprintf(stderr, " %s", fuzz_targets[i].name);
        }
        fputc('\n', stderr);
        exit(2);
    }
    folder = getenv("AWT_FUZZ_SEEDS");
    if (folder) {
        target->seed(give);
        exit(0);
    }
    return 0;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    target->run(bytes, size);
    return 0;
}
