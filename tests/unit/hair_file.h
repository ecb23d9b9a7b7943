/* hair_file.h: a small strand file with a hierarchy of its own, as clients upload them. */
#ifndef HAIR_FILE_H
#define HAIR_FILE_H

#include "proto.h"

enum { HAIR_FILE_SIZE = 128 + 16 * 10 * 12 };

/* 16 strands of 10 points, on a head of 0.1 m, in metres. */
void hair_file_write(unsigned char bytes[HAIR_FILE_SIZE]);
/* Two trees, eight wisps. */
extern const char hair_file_hierarchy[];
/* CREATE from the uploads of these numbers. */
proto_message hair_file_create(uint32_t strands, uint32_t hierarchy);

#endif
