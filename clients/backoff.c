/* backoff.c: see backoff.h. */
#include "backoff.h"

enum { FIRST_WAIT_MS = 100, GREATEST_WAIT_MS = 5000 };

int64_t backoff_failed(backoff *self, uint32_t least_ms)
{
    int64_t wait_ms = FIRST_WAIT_MS;
    for (unsigned i = 0; i < self->tries && wait_ms < GREATEST_WAIT_MS; i++) {
        wait_ms *= 2;
    }
    wait_ms = wait_ms < GREATEST_WAIT_MS ? wait_ms : GREATEST_WAIT_MS;
    self->tries++;
    self->random = self->random * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    const double chance = (double)(self->random >> 11) * 0x1p-53;
    const int64_t wait_us = wait_ms * 500 + (int64_t)(chance * 500 * (double)wait_ms);
    const int64_t least_us = (int64_t)least_ms * 1000;
    return wait_us > least_us ? wait_us : least_us;
}
