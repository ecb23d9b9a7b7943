/* folder_fixture.c: see folder_fixture.h. */
#include "folder_fixture.h"
#include "check.h"

#include <stdio.h>
#include <stdlib.h>

void folder_make(char path[FOLDER_PATH])
{
    snprintf(path, FOLDER_PATH, "/tmp/awtd-test-XXXXXX");
    CHECK(mkdtemp(path) != NULL);
}

void folder_remove(const char *path)
{
    char command[FOLDER_PATH + 16];
    snprintf(command, sizeof command, "rm -rf '%s'", path);
    CHECK_INT(system(command), 0);
}
