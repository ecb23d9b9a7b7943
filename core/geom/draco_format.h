/* draco_format.h: the constant parts of our meshes in Draco's bitstream, for those who write and read them. */
#ifndef GEOM_DRACO_FORMAT_H
#define GEOM_DRACO_FORMAT_H

/* "DRACO", bitstream 2.2, triangular mesh, sequential, no flags: what libdraco 1.3 to 1.5 write. */
static const unsigned char DRACO_HEADER[11] = {'D', 'R', 'A', 'C', 'O', 2, 2, 1, 0, 0, 0};
/* One attributes decoder, one attribute: position, float32, 3 components, not normalised, unique id 0, quantised. */
static const unsigned char DRACO_POSITION[8] = {1, 1, 0, 9, 3, 0, 0, 2};
/* Prediction by difference, wrapped; then: symbols, not plain numbers. */
static const unsigned char DRACO_DIFFERENCES[3] = {0, 1, 1};

enum {
    DRACO_INDICES_COMPRESSED = 0,
    DRACO_TAIL_BYTES = 25,     /* i32 bounds[2], f32 origin[3], f32 range, u8 bits */
    DRACO_AROUND_BYTES = 64,   /* more than all constant parts and counts together */
    DRACO_BYTES_A_TRIANGLE = 3 /* decoders refuse a mesh that has fewer after its counts */
};

#endif
