/* form.h: the forms that frames are made in: which kinds at which levels there are. A form is known by its number in
 * the table; everything that is kept for each form is an array of FORM_COUNT. */
#ifndef FORM_H
#define FORM_H

#include <stdbool.h>
#include <stdint.h>

enum { FORM_COUNT = 15, FORM_NONE = -1 };

/* Numbers of QUERY's `kind` and `level`. */
enum { FORM_KIND_GREATEST = 3 /* ribbon, strands, guides, nodes */, FORM_LEVEL_GREATEST = 2 /* full, fifth, guides */ };

typedef struct frame_form {
    uint8_t kind; /* a geom_kind */
    uint8_t level;
    bool has_deltas;
    bool bare; /* whole frames are written as deltas are, against nothing: numbers for who has the binding, no mesh */
    bool attributed; /* vertices have attributes beside their position; whole frames only */
    int poorer; /* the coarser level of this kind, which takes its place within a budget; FORM_NONE: there is none */
} frame_form;

const frame_form *form_at(int number);
/* "ribbon/full", of those with attributes "ribbon+/full", for the log. */
const char *form_name(int number);
/* What somebody may want beside kind and level: bits. */
enum { FORM_DELTAS = 1 /* takes deltas, too */, FORM_ATTRIBUTES = 2 };

/* The form that somebody gets who asks for that kind and level. FORM_NONE: there are no such frames. */
int form_find(uint8_t kind, uint8_t level, unsigned wants);

#endif
