/* admin_page.h: what each of the operator's pages says. */
#ifndef ADMIN_PAGE_H
#define ADMIN_PAGE_H

#include <stdbool.h>
#include <stddef.h>

/* A whole answer to the request whose head is in `bytes`, on the heap; NULL: no memory. *status is 0, and nothing is
 * made, while the head is incomplete; with `full` there is no room for more of it, and the answer says so. */
char *admin_page(const char *bytes, size_t size, bool full, int *status, size_t *answer_size);

#endif
