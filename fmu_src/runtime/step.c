/* A step as the host sees it: all of it or nothing. Its loop is in integrate.c. */
#include <math.h>
#include <string.h>

#include "internal.h"

void kernel_stop_at_events(kernel *self, int stops) {
    self->stops_at_events = stops;
    self->whole_steps = !stops;
}

static int check_step(kernel *self, double time, double size) {
    if (!self->system)
        return kernel_fail(self, KERNEL_ERROR, "Initialise %s before the first step.", MODEL.name);
    if (!(size > 0.0) || !isfinite(size))
        return kernel_fail(self, KERNEL_ERROR, "Give a step size above 0 s: it was %g s; nothing was advanced.", size);
    int status = kernel_check_times(self, time, size);
    if (status != KERNEL_OK) return status;
    char when[CLOCK_SIZE];
    if (self->now.ended)
        return kernel_fail(self, KERNEL_DISCARD, "The run ended at t = %s s; reset it to start again.",
                           kernel_clock(self->now.time, 9, when));
    const double fixed = self->value[MODEL.integration_step];
    if (fixed > 0.0 && size / fixed > (double)MOST_TRIALS)
        return kernel_fail(self, KERNEL_ERROR,
                           "Give a step of at most %g s, or a longer integration_step: %g s are more than %d steps of %g s; "
                           "nothing was advanced.",
                           (double)MOST_TRIALS * fixed, size, MOST_TRIALS, fixed);
    for (int i = 0; i < self->system->inputs; ++i) {
        const int variable = self->system->input_variable[i];
        if (self->input_rate[variable] == 0.0) continue;
        const double last = self->value[variable] + size * self->input_rate[variable];
        status = kernel_check_value(self, &MODEL.variable[variable], last, self->value[variable]);
        if (status != KERNEL_OK) return status;
    }
    return KERNEL_OK;
}

int kernel_step(kernel *self, double time, double size) {
    int status = check_step(self, time, size);
    if (status != KERNEL_OK) return status;
    const kernel_snapshot before = self->now;
    const unsigned long long noted = self->noted;
    memcpy(self->backup, self->block, self->restored * sizeof(double));

    self->step_origin = time;
    kernel_gather_inputs(self);
    double reached = size;
    status = integrate(self, size, &reached);
    if (status <= KERNEL_WARNING && self->now.ended && self->whole_steps && reached < size)
        status = kernel_discard(self, noted, reached);
    if (status <= KERNEL_WARNING) {
        kernel_compute_outputs(self, reached, self->state);
        const char *bad = kernel_output_not_finite(self);
        char when[CLOCK_SIZE];
        if (bad)
            status = kernel_fail(self, KERNEL_ERROR, "The output %s is not a finite number at t = %s s.", bad,
                                 kernel_clock(time + reached, 9, when));
    }
    if (status > KERNEL_WARNING) { /* the last good state stays */
        self->now = before;
        self->kept_ready = 0;
        memcpy(self->block, self->backup, self->restored * sizeof(double));
        return status;
    }
    for (int i = 0; i < self->system->inputs; ++i) {
        const int variable = self->system->input_variable[i];
        self->value[variable] += reached * self->input_rate[variable];
        self->last_rate[variable] = self->input_rate[variable];
        self->input_rate[variable] = 0.0;
    }
    self->now.outputs_stale = 0;
    self->now.time = time + reached;
    if (!self->now.ended) return status;
    char when[CLOCK_SIZE];
    return kernel_say_when(self, KERNEL_DISCARD, self->system->sentence[self->now.ended - 1],
                           kernel_clock(self->now.time, 6, when));
}
