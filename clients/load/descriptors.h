/* descriptors.h: how many descriptors this process may have. */
#ifndef LOAD_DESCRIPTORS_H
#define LOAD_DESCRIPTORS_H

#include <stdint.h>

/* Raises the soft limit as far as the hard one lets it; how many there may be then. */
uint32_t descriptors_raise(void);

#endif
