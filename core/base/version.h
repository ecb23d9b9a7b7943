/* version.h: the version of everything in this repository. */
#ifndef BASE_VERSION_H
#define BASE_VERSION_H

#define AWTD_VERSION "0.1.0"

#endif
