/* wake.c: see wake.h. */
#include "wake.h"
#include "net.h"

#include <errno.h>
#include <signal.h>
#include <stdatomic.h>
#include <stddef.h>
#include <unistd.h>

/* Signal handlers have no argument: what they touch is here. Other threads look at it than the one that is interrupted:
 * atomic, and without a lock, which a handler must not take. */
static wake *signal_wake;
static wake *hangup_wake;
static atomic_int stop_asked; /* how often */
static atomic_bool save_asked, hangup_asked;
_Static_assert(ATOMIC_INT_LOCK_FREE == 2 && ATOMIC_BOOL_LOCK_FREE == 2, "signal handlers write these");

bool wake_init(wake *w)
{
    return net_pipe(w->ends);
}

void wake_fini(wake *w)
{
    close(w->ends[0]);
    close(w->ends[1]);
}

void wake_ring(void *context)
{
    const wake *w = context;
    int kept = errno; /* the handler must not disturb what it interrupts */
    if (write(w->ends[1], "", 1) < 0) {
        /* full: it has been rung already */
    }
    errno = kept;
}

void wake_clear(wake *w)
{
    char rung[256];
    if (read(w->ends[0], rung, sizeof rung) < 0) {
        /* nothing was there; more than fits ends the next sleep too, which does no harm */
    }
}

static void on_signal(int number)
{
    if (number == SIGUSR1) {
        atomic_store(&save_asked, true);
    } else if (atomic_load(&stop_asked) < 2) {
        atomic_fetch_add(&stop_asked, 1);
    }
    wake_ring(signal_wake);
}

void wake_on_signals(wake *w)
{
    struct sigaction asked = {.sa_handler = on_signal}, ignore = {.sa_handler = SIG_IGN};
    signal_wake = w;
    sigaction(SIGTERM, &asked, NULL);
    sigaction(SIGINT, &asked, NULL);
    sigaction(SIGUSR1, &asked, NULL);
    sigaction(SIGPIPE, &ignore, NULL);
#ifdef SIGXFSZ
    sigaction(SIGXFSZ, &ignore, NULL); /* a file that may not grow: write says so, and the keeper */
#endif
}

static void on_hangup(int number)
{
    (void)number;
    atomic_store(&hangup_asked, true);
    wake_ring(hangup_wake);
}

void wake_on_hangup(wake *w)
{
    struct sigaction hangup = {.sa_handler = on_hangup, .sa_flags = SA_RESTART};
    hangup_wake = w;
    sigaction(SIGHUP, &hangup, NULL);
}

bool wake_take_hangup(void)
{
    return atomic_exchange(&hangup_asked, false);
}

bool wake_stop_asked(void)
{
    return atomic_load(&stop_asked) != 0;
}

bool wake_hurry_asked(void)
{
    return atomic_load(&stop_asked) > 1;
}

bool wake_save_asked(void)
{
    return atomic_exchange(&save_asked, false);
}
