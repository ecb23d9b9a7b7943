/* folder_fixture.h: a folder of a test's own. */
#ifndef FOLDER_FIXTURE_H
#define FOLDER_FIXTURE_H

enum { FOLDER_PATH = 64 };

/* A new, empty one; its path. */
void folder_make(char path[FOLDER_PATH]);
/* With all that is in it. */
void folder_remove(const char *path);

#endif
