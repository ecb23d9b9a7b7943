/* level.h: the strands of a level (read.h has the levels), and these evaluated alone (for core/geom alone).
 *
 * Which strands they are follows from the groom and never changes. `guides`: of each finest wisp the strand that lies
 * nearest to its centre line. `fifth`: every fifth of the strands, which are ordered by wisp, so that each wisp has its
 * share; in a wisp that has one of these, the one nearest in number makes way for the wisp's own of `guides`, so that
 * what is seen at one level is seen at the finer one, too. */
#ifndef GEOM_LEVEL_H
#define GEOM_LEVEL_H

#include "geom/read.h"

/* The strands of one level of a groom. */
typedef struct level_strands {
    geom_level level;
    uint32_t strands;       /* of this level */
    uint32_t full_strands;  /* of the groom */
    uint32_t *number;       /* [strands], rising: which strand of the groom each one is; NULL: all are here */
    uint32_t *strand_first; /* [finest wisps + 1]: as the groom's, of the strands of this level; NULL: the groom's */
    float *offsets;         /* [strands][3][points], the groom's; NULL: the groom's own */
} level_strands;

/* Chooses them. AWT_NO_MEMORY. */
awt_status level_strands_make(const awt_groom *groom, geom_level level, level_strands *out, awt_error *error);
void level_strands_fini(level_strands *level);

/* The first strand of finest wisp `wisp`, numbered within the level; of the wisp after the last: how many there are. */
uint32_t level_first_strand(const level_strands *level, const awt_groom *groom, uint32_t wisp);

/* Evaluates them, points [strands][points_per_strand][3], to the bit as awt_groom_strands_of does; arguments as there.
 */
void level_evaluate(const level_strands *level, const awt_groom *groom, const bool *wisps, const float *centres,
                    const float *frames, float *scratch, float *points);

/* How much wider its strands are than those of the full hair: each stands for full_strands / strands of them, and has
 * the cross-section of all these together. So the volume of the hair is the same at every level. */
float level_growth(const level_strands *level);

#endif
