/* timeunit.c: see timeunit.h. */
#include "motion/timeunit.h"

#include <math.h>
#include <string.h>

static const struct {
    double unit_s;
    const char *name;
} TIMEUNITS[] = {{1, "s"}, {1e-3, "ms"}, {1e-6, "us"}, {1e-7, "100ns"}, {1e-9, "ns"}};

enum { TIMEUNIT_COUNT = sizeof TIMEUNITS / sizeof TIMEUNITS[0] };

/* Where the clocks that logs use begin: seconds from there to the year 2000. */
static const double TIMEUNIT_EPOCHS_S[] = {
    946684800.0,   /* 1970: Unix */
    12591158400.0, /* 1601: Windows file time */
    63082281600.0  /* year 1: .NET ticks */
};

#define TIMEUNIT_CENTURY_S 3155760000.0

static double timeunit_of_date(double first, double median_spacing)
{
    for (int u = 0; u < TIMEUNIT_COUNT; u++) {
        double spacing_s = median_spacing * TIMEUNITS[u].unit_s;
        for (size_t e = 0; e < sizeof TIMEUNIT_EPOCHS_S / sizeof TIMEUNIT_EPOCHS_S[0]; e++) {
            double since_2000_s = first * TIMEUNITS[u].unit_s - TIMEUNIT_EPOCHS_S[e];
            if (since_2000_s >= 0 && since_2000_s <= TIMEUNIT_CENTURY_S && spacing_s >= 5e-4 && spacing_s <= 5) {
                return TIMEUNITS[u].unit_s;
            }
        }
    }
    return 0;
}

double timeunit_guess(double first, double median_spacing)
{
    double best_s = timeunit_of_date(first, median_spacing), least = HUGE_VAL;
    if (best_s > 0 || median_spacing <= 0) {
        return best_s;
    }
    for (int u = 0; u < TIMEUNIT_COUNT; u++) {
        double off = fabs(log(median_spacing * TIMEUNITS[u].unit_s * 60));
        if (off < least) {
            least = off;
            best_s = TIMEUNITS[u].unit_s;
        }
    }
    return best_s;
}

const char *timeunit_name(double unit_s)
{
    for (int u = 0; u < TIMEUNIT_COUNT; u++) {
        if (fabs(unit_s / TIMEUNITS[u].unit_s - 1) < 1e-9) {
            return TIMEUNITS[u].name;
        }
    }
    return "the caller's unit";
}

double timeunit_find(const char *name)
{
    for (int u = 0; u < TIMEUNIT_COUNT; u++) {
        if (strcmp(TIMEUNITS[u].name, name) == 0) {
            return TIMEUNITS[u].unit_s;
        }
    }
    return 0;
}
