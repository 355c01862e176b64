/* A complete step for the host: all of it or nothing. Its loop is in integrate.c. */
#include <math.h>
#include <string.h>

#include "method.h"

void kernel_stop_at_events(kernel *self, bool stops) {
    self->requested.stops_at_events = stops;
    self->requested.whole_steps = !stops;
}

static kernel_status check_step(kernel *self, double time, double size) {
    if (!self->system) return kernel_fail(self, KERNEL_ERROR, "Initialise %s before the first step.", MODEL.name);
    char problem[DURATION_PROBLEM];
    if (size_is_wrong(size, problem) || time_is_wrong(time, size, self->run.now->time, self->requested.stop_time, problem))
        return kernel_fail(self, KERNEL_ERROR, "%s", problem);
    char when[TIME_TEXT];
    if (self->run.now->ended)
        return kernel_fail(self, KERNEL_DISCARD, "The run ended at t = %s s; reset it to start again.",
                           time_text(self->run.now->time, 9, when));
    const double fixed = self->run.value[MODEL.integration_step];
    if (fixed > 0.0 && size / fixed > (double)MOST_TRIALS)
        return kernel_fail(self, KERNEL_ERROR,
                           "The step must be at most %g s; got %g s, more than %d integration steps of %g s. Give a longer "
                           "integration_step. Nothing was advanced.",
                           (double)MOST_TRIALS * fixed, size, MOST_TRIALS, fixed);
    for (int i = 0; i < self->system->inputs; ++i) {
        const int variable = self->system->input_variable[i];
        if (self->run.input_rate[variable] == 0.0) continue;
        const double last = self->run.value[variable] + size * self->run.input_rate[variable];
        const kernel_status status = kernel_check_value(self, &MODEL.variable[variable], last, self->run.value[variable]);
        if (status != KERNEL_OK) return status;
    }
    return KERNEL_OK;
}

/* Return the bytes of the run that a step changes. */
static size_t changing(const kernel *self) {
    return (self->reads_outputs_later ? self->run.unread : self->run.changing) * sizeof(double);
}

kernel_status step_begin(kernel *self, double time, double size) {
    kernel_status status = check_step(self, time, size);
    if (status != KERNEL_OK) return status;
    memcpy(self->backup, self->run.block, changing(self));

    self->given.step_origin = time;
    kernel_gather_inputs(self);
    return KERNEL_OK;
}

kernel_status kernel_step(kernel *self, double time, double size) {
    const unsigned long long noted = self->messages.noted;
    double reached = size;
    kernel_status status = step_begin(self, time, size);
    if (status != KERNEL_OK) return status;
    status = integrate(self, size, &reached);
    return step_end(self, noted, size, reached, status);
}

kernel_status step_end(kernel *self, unsigned long long noted, double size, double reached, kernel_status status) {
    const double time = self->given.step_origin;
    if (status <= KERNEL_WARNING && self->run.now->ended && self->requested.whole_steps && reached < size)
        status = kernel_discard(self, noted, reached);
    if (status <= KERNEL_WARNING && !self->reads_outputs_later) {
        kernel_compute_outputs(self, reached, self->run.state);
        const char *bad = kernel_output_not_finite(self);
        char when[TIME_TEXT];
        if (bad)
            status = kernel_fail(self, KERNEL_ERROR, "The output %s is not a finite number at t = %s s.", bad,
                                 time_text(time + reached, 9, when));
    }
    if (status > KERNEL_WARNING) { /* the last good state stays */
        self->kept.ready = KEPT_NOTHING;
        memcpy(self->run.block, self->backup, changing(self));
        return status;
    }
    for (int i = 0; i < self->system->inputs; ++i) {
        const int variable = self->system->input_variable[i];
        self->run.value[variable] += reached * self->run.input_rate[variable];
        self->run.last_rate[variable] = self->run.input_rate[variable];
        self->run.input_rate[variable] = 0.0;
    }
    self->run.now->outputs_stale = self->reads_outputs_later;
    self->run.now->time = time + reached;
    return self->run.now->ended ? kernel_say_end(self, self->run.now->time) : status;
}
