/* draco_format.h: the constant parts of our meshes in Draco's bitstream, for those who write and read them. */
#ifndef GEOM_DRACO_FORMAT_H
#define GEOM_DRACO_FORMAT_H

#include <stdint.h>

/* What the vertices of a mesh have. */
typedef enum draco_form {
    DRACO_POSITIONS,      /* a position, quantised, predicted by difference */
    DRACO_POSITIONS_TURNS /* the same, and three 16-bit numbers, predicted by difference */
} draco_form;

typedef struct draco_attributes {
    draco_form form;
    int turn_bits; /* of DRACO_POSITIONS_TURNS: the numbers lie in -2^(turn_bits-1) .. 2^(turn_bits-1) - 1 */
} draco_attributes;

enum { DRACO_MAX_TURN_BITS = 15 };

/* "DRACO", bitstream 2.2, triangular mesh, sequential, no flags: what libdraco 1.3 to 1.5 write. */
static const unsigned char DRACO_HEADER[11] = {'D', 'R', 'A', 'C', 'O', 2, 2, 1, 0, 0, 0};
/* One attributes decoder, one attribute: position, float32, 3 components, not normalised, unique id 0, quantised. */
static const unsigned char DRACO_POSITION[8] = {1, 1, 0, 9, 3, 0, 0, 2};
/* The same with a second attribute: generic, int16, 3 components, not normalised, unique id 1, whole numbers. */
static const unsigned char DRACO_POSITION_TURN[14] = {1, 2, 0, 9, 3, 0, 0, 4, 3, 3, 0, 1, 2, 1};
/* Prediction by difference, wrapped; then: symbols, not plain numbers. */
static const unsigned char DRACO_DIFFERENCES[3] = {0, 1, 1};

enum {
    DRACO_INDICES_COMPRESSED = 0,
    DRACO_BOUNDS_BYTES = 8,    /* i32 least, i32 greatest, after symbols that are differences */
    DRACO_BOX_BYTES = 17,      /* f32 origin[3], f32 range, u8 bits: the end */
    DRACO_AROUND_BYTES = 64,   /* more than all constant parts and counts together */
    DRACO_BYTES_A_TRIANGLE = 3 /* decoders refuse a mesh that has fewer after its counts */
};

#endif
