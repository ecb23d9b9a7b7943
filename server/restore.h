/* restore.h: at its start the daemon makes the forests again that its state directory holds. */
#ifndef RESTORE_H
#define RESTORE_H

#include "service.h"

/* Has every forest of the vault made again and waits until all are. What cannot be is logged, and its file set aside.
 * Before anyone else uses the service; without the lock. False: the folder cannot be read (errno). */
bool restore_all(service *shared, const vault *from);

#endif
