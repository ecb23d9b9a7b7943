/* look.h: how the hair of a built-in style grows; the table stands in style.c, beside the public one. */
#ifndef GROOM_LOOK_H
#define GROOM_LOOK_H

#include "awt.h"

typedef struct style_look {
    double length_m, edge_length_m; /* along the axis of a lock, on top of the head and at nape and temples */
    double parting_x;               /* share of the head's radius; hair is combed to both sides of it */
    bool parted;                    /* else combed around a whorl at the crown */
    double lift;                    /* how far hair stands off the scalp where it leaves it */
    double lift_reach_m;            /* and for how long */
    double comb, comb_reach_m;      /* strength of the combing direction, and for how long */
    double fall;                    /* strength of hanging */
    double bend_m;                  /* length over which hair gives way to those three */
    double layer_m;                 /* thickness of the hair over the scalp */
    double clump;                   /* share by which the strands of a lock come together at its tip */
    double length_spread;           /* strands are shorter than their lock by up to this share */
    double wave_m, wave_length_m;   /* sway of a lock, at its tip */
    double curl_m, curl_pitch_m;    /* radius of the helix and length of a turn; 0: no curl */
    double flyaway;                 /* share of strands that keep out of their lock */
} style_look;

/* NULL if there is no built-in style of that name. */
const style_look *style_look_find(const char *name);

#endif
