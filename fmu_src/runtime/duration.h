/* When and by how much a host may advance an instance: the same rules and messages for all objects. */
#ifndef DURATION_H
#define DURATION_H

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>

#include "print_text.h"

/* A day [s]: beyond it a step is a slip of the pen, or patience is lost. */
#define LONGEST_STEP 86400.0
/* Farthest time from 0 [s], 300 years: Unix time lies within it, and it counts any period in 64 bits. */
#define FARTHEST_TIME 1e10

enum { TIME_TEXT = 48, DURATION_PROBLEM = 320 };

/* Write a time [s] for a message with `digits` digits. Times with more than three digits before the point get more: Unix time
 * has ten there, and three (of 6) or six (of 9) remain after the point. */
static inline const char *time_text(double time, int digits, char text[TIME_TEXT]) {
    const int before = fabs(time) >= 1e3 && fabs(time) < 1e18 ? 1 + (int)log10(fabs(time)) : 3;
    const int all = before + digits - 3;
    print_text(text, TIME_TEXT, "%.*g", all < 24 ? all : 24, time);
    return text;
}

/* Two times are the same that differ by a thousandth of a step. Round-off of start + n * step is below it until numbers at
 * that time are spaced as coarsely as the step; from there on it is two spacings, but never half a step. */
static inline double time_slack(double time, double size, double epsilon) {
    return fmax(1e-3 * size, fmin(0.5 * size, 2.0 * epsilon * fabs(time)));
}

/* Return whether a run cannot have this start and stop; `problem` then holds a message. stop: NULL if the host gave none. */
static inline bool plan_is_wrong(double start, const double *stop, char problem[DURATION_PROBLEM]) {
    char begin[TIME_TEXT], end[TIME_TEXT];
    if (!isfinite(start)) {
        print_text(problem, DURATION_PROBLEM, "The start time must be a finite number; got %g.", start);
        return true;
    }
    if (!stop || *stop >= start) return false;
    print_text(problem, DURATION_PROBLEM,
               "The stop time must be at least the start time of %s s; got %s s. Nothing was changed.",
               time_text(start, 9, begin), time_text(*stop, 9, end));
    return true;
}

/* Return whether a step cannot have this size. */
static inline bool size_is_wrong(double size, char problem[DURATION_PROBLEM]) {
    if (size > 0.0 && size <= LONGEST_STEP) return false;
    if (size > 0.0 && isfinite(size))
        print_text(problem, DURATION_PROBLEM, "The step must be at most %g s, a day; got %g s. Nothing was advanced.",
                   LONGEST_STEP, size);
    else print_text(problem, DURATION_PROBLEM, "The step must be above 0 s; got %g s. Nothing was advanced.", size);
    return true;
}

/* Return whether a step cannot begin at `time`, if the one before ended at `now` and the run is to stop at `stop`. */
static inline bool time_is_wrong(double time, double size, double now, double stop, char problem[DURATION_PROBLEM]) {
    const double end = time + size, surely = 1e-3 * size; /* evaluated at every step of a host */
    if (fabs(time - now) <= surely && end > time && end <= stop + surely) return false;
    char here[TIME_TEXT], there[TIME_TEXT];
    const double slack = time_slack(now, size, DBL_EPSILON), of_clock = time_slack(now, size, FLT_EPSILON);
    if (!(fabs(time - now) <= of_clock)) /* game engines have clocks in single precision */
        print_text(
            problem, DURATION_PROBLEM,
            "The step must begin at t = %s s, where the last step ended; got %s s. Nothing was advanced. After a pause, pass "
            "the time that the FMU has reached, not that of a clock which runs on.",
            time_text(now, 9, here), time_text(time, 9, there));
    else if (!(end > time))
        print_text(problem, DURATION_PROBLEM,
                   "The step must be above the round-off of the time t = %s s; got %g s. Nothing was advanced.",
                   time_text(time, 9, here), size);
    else if (end > stop + slack)
        print_text(problem, DURATION_PROBLEM,
                   "The step must end at most at the stop time of %s s; got an end at %s s. Nothing was advanced.",
                   time_text(stop, 9, here), time_text(end, 9, there));
    else return false;
    return true;
}

#endif
