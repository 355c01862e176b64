/* The host's settings of a run: tolerance and stop time. */
#include <math.h>

#include "instance.h"

static kernel_status suggest_tolerance(kernel *self, double tolerance) {
    const variable_description *own = &MODEL.variable[MODEL.tolerance];
    if (tolerance >= own->minimum && tolerance <= own->maximum) return kernel_set(self, MODEL.tolerance, tolerance);
    return kernel_fail(self, KERNEL_WARNING, "The tolerance must be from %g to %g; got %g. %g stays in force.", own->minimum,
                       own->maximum, tolerance, self->run.value[MODEL.tolerance]);
}

kernel_status kernel_plan(kernel *self, const double *tolerance, double start, const double *stop) {
    char problem[DURATION_PROBLEM];
    if (plan_is_wrong(start, stop, problem)) return kernel_fail(self, KERNEL_ERROR, "%s", problem);
    self->requested.stop_time = stop ? *stop : INFINITY;
    return tolerance ? suggest_tolerance(self, *tolerance) : KERNEL_OK;
}

kernel_status kernel_say_end(kernel *self, double time) {
    char when[TIME_TEXT];
    return kernel_say_when(self, KERNEL_DISCARD, self->system->sentence[self->run.now->ended - 1], time_text(time, 6, when));
}

kernel_status kernel_discard(kernel *self, unsigned long long noted, double reached) {
    char begin[TIME_TEXT], end[TIME_TEXT];
    time_text(self->given.step_origin, 6, begin), time_text(self->given.step_origin + reached, 6, end);
    kernel_take_back(self, noted); /* messages of this step, which is taken back */
    (void)kernel_say_end(self, self->given.step_origin + reached);
    return kernel_fail(self, KERNEL_DISCARD,
                       "The step from t = %s s was discarded, for the run ends within it and no early return is allowed; "
                       "take steps that end before %s s.",
                       begin, end);
}
