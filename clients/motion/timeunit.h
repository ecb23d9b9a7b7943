/* timeunit.h: which unit a log's timestamps count. */
#ifndef MOTION_TIMEUNIT_H
#define MOTION_TIMEUNIT_H

/* Seconds per timestamp unit, from the first timestamp and the median distance of two; 0: that
 * distance is 0.
 * A first timestamp that is a date of the years 2000 to 2100 settles it. Otherwise the unit is taken that brings the
 * rate nearest to 60 a second. */
double timeunit_guess(double first, double median_spacing);

/* "s", "ms", "us", "100ns" or "ns"; for other units "the caller's unit". Static storage. */
const char *timeunit_name(double unit_s);
/* The unit of one of these names in seconds; 0: there is none. */
double timeunit_find(const char *name);

#endif
