/* published.h: the pictures that a resident keeps: the latest, those before it to be drawn into again, and what they
 * said of the sizes of frames. */
#ifndef PUBLISHED_H
#define PUBLISHED_H

#include "registry.h"

/* The picture that a job drew becomes the latest, or stands on it where it is of the same step. Takes the reference.
 * False: it shows nothing of that step that was not there before, and the latest stays. */
bool published_take(resident *r, picture *drawn);

/* A picture that only the resident still has; NULL: none. */
picture *published_take_spare(resident *r);

#endif
