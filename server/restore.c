/* restore.c: see restore.h. */
#include "restore.h"
#include "completions.h"
#include "log.h"

#include <errno.h>
#include <inttypes.h>
#include <string.h>
#include <time.h>

enum { WAIT_NS = 2000000 };

typedef struct restoring {
    service *shared;
    const vault *from;
} restoring;

static void refuse(const vault *from, uint64_t handle, const char *why)
{
    log_write(LOG_ERROR, "forest not restored", "forest=%016" PRIx64 " folder=%s why=\"%s\"", handle, from->folder,
              why);
    vault_set_aside(from, handle);
}

/* Begins to make one again. */
static bool begin(void *context, uint64_t handle)
{
    const restoring *all = context;
    size_t size = 0;
    saved s;
    awt_error error = {0};
    unsigned char *bytes = vault_read(all->from, handle, &size);
    upload *file = bytes ? upload_of(bytes, size) : NULL;
    if (!file) {
        refuse(all->from, handle, strerror(errno));
        return true;
    }
    awt_status status = saved_read(bytes, size, &s, &error);
    if (status == AWT_OK && s.handle != handle) {
        refuse(all->from, handle, "the file is of another forest than its name says");
    } else if (status == AWT_OK) {
        service_lock(all->shared);
        status = registry_restore(&all->shared->forests, &s, file, all->shared->options.clock_us(), &error);
        service_unlock(all->shared);
    }
    if (status != AWT_OK) {
        refuse(all->from, handle, error.text);
    }
    service_lock(all->shared);
    upload_release(file);
    service_unlock(all->shared);
    return true;
}

/* Brings home what is done; forests that are still being made. */
static uint32_t take_done(service *shared)
{
    service_lock(shared);
    completions_take(shared);
    const uint32_t left = shared->forests.restoring;
    service_unlock(shared);
    return left;
}

bool restore_all(service *shared, const vault *from)
{
    restoring all = {shared, from};
    if (!vault_list(from, begin, &all)) {
        return false;
    }
    while (take_done(shared) > 0) {
        if (!worker_pool_run_one(
                shared->pool)) { /* this thread helps, and is the only one where there are no workers */
            nanosleep(&(struct timespec){.tv_nsec = WAIT_NS}, NULL);
        }
    }
    return true;
}
