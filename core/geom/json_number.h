/* json_number.h: a JSON number from its text, in standard C and whatever the host program's locale is. */
#ifndef GEOM_JSON_NUMBER_H
#define GEOM_JSON_NUMBER_H

#include <stdbool.h>

/* The finite number that fills the text from `begin` to `end`. False: it is none, or longer than 63 characters. */
bool json_number(const char *begin, const char *end, double *out);

#endif
