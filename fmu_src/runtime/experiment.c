/* What the host says about a run: its tolerance, its end, and the times of its steps. */
#include <float.h>
#include <math.h>

#include "instance.h"

/* Two times are the same that differ by this share of a step. Round-off of start + n * step is below it until numbers at
 * that time are spaced as coarsely as the step; from there on it is two spacings, but never half a step. */
static const double SHARE_OF_STEP = 1e-3;

static double round_off(double time, double size) {
    return fmax(SHARE_OF_STEP * size, fmin(0.5 * size, 2.0 * DBL_EPSILON * fabs(time)));
}

static kernel_status suggest_tolerance(kernel *self, double tolerance) {
    const variable_description *own = &MODEL.variable[MODEL.tolerance];
    if (tolerance >= own->minimum && tolerance <= own->maximum) return kernel_set(self, MODEL.tolerance, tolerance);
    return kernel_fail(self, KERNEL_WARNING,
                       "Give a tolerance from %g to %g, or none: %g was given, and %g stays in force.", own->minimum,
                       own->maximum, tolerance, self->run.value[MODEL.tolerance]);
}

kernel_status kernel_plan(kernel *self, const double *tolerance, double start, const double *stop) {
    char begin[CLOCK_SIZE], end[CLOCK_SIZE];
    if (!isfinite(start)) return kernel_fail(self, KERNEL_ERROR, "Set the start time to a finite time: %g s was given.", start);
    if (stop && !(*stop >= start))
        return kernel_fail(self, KERNEL_ERROR,
                           "Set the stop time to the start time of %s s or later: %s s was given; nothing was changed.",
                           kernel_clock(start, 9, begin), kernel_clock(*stop, 9, end));
    self->asked.stop_time = stop ? *stop : INFINITY;
    return tolerance ? suggest_tolerance(self, *tolerance) : KERNEL_OK;
}

kernel_status kernel_check_times(kernel *self, double time, double size) {
    char here[CLOCK_SIZE], there[CLOCK_SIZE];
    const double slack = round_off(self->run.now->time, size);
    if (!(fabs(time - self->run.now->time) <= slack))
        return kernel_fail(self, KERNEL_ERROR,
                           "Step from t = %s s, where the last step ended: %s s was given; nothing was advanced.",
                           kernel_clock(self->run.now->time, 9, here), kernel_clock(time, 9, there));
    if (!(time + size > time))
        return kernel_fail(self, KERNEL_ERROR,
                           "Give a longer step at t = %s s: %g s is lost in the round-off of the time; nothing was advanced.",
                           kernel_clock(time, 9, here), size);
    if (time + size > self->asked.stop_time + slack)
        return kernel_fail(self, KERNEL_ERROR,
                           "End the last step at the stop time of %s s: this one would end at %s s; nothing was advanced.",
                           kernel_clock(self->asked.stop_time, 9, here), kernel_clock(time + size, 9, there));
    return KERNEL_OK;
}

kernel_status kernel_discard(kernel *self, unsigned long long noted, double reached) {
    char begin[CLOCK_SIZE], end[CLOCK_SIZE];
    kernel_clock(self->given.step_origin, 6, begin), kernel_clock(self->given.step_origin + reached, 6, end);
    kernel_take_back(self, noted); /* what was to be told of this step did not happen */
    (void)kernel_say_when(self, KERNEL_DISCARD, self->system->sentence[self->run.now->ended - 1], end);
    return kernel_fail(self, KERNEL_DISCARD,
                       "The step from t = %s s was discarded, for the run ends within it and no early return is allowed; "
                       "take steps that end before %s s.",
                       begin, end);
}
