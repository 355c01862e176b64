/* A step as the host sees it: all of it or nothing. Its loop is in integrate.c. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "internal.h"

void kernel_stop_at_events(kernel *self, int stops) { self->stops_at_events = stops; }
int kernel_stops_at_events(const kernel *self) { return self->stops_at_events; }

static int check_step(kernel *self, double time, double size) {
    if (!self->system)
        return kernel_fail(self, KERNEL_ERROR, "Initialise %s before the first step.", MODEL.name);
    if (!(size > 0.0) || !isfinite(size))
        return kernel_fail(self, KERNEL_ERROR, "Give a step size above 0 s: it was %g s; nothing was advanced.", size);
    if (!(fabs(time - self->now.time) <= 1e-3 * size + 1e-12 * fabs(time)))
        return kernel_fail(self, KERNEL_ERROR,
                           "Step from t = %.9g s, where the last step ended: %.9g s was given; nothing was advanced.",
                           self->now.time, time);
    if (self->now.ended)
        return kernel_fail(self, KERNEL_DISCARD, "The run ended at t = %.9g s; reset it to start again.", self->now.time);
    for (int i = 0; i < self->system->inputs; ++i) {
        const int variable = self->system->input_variable[i];
        if (self->input_rate[variable] == 0.0) continue;
        const double last = self->value[variable] + size * self->input_rate[variable];
        int status = kernel_check_value(self, &MODEL.variable[variable], last, self->value[variable]);
        if (status != KERNEL_OK) return status;
    }
    return KERNEL_OK;
}

int kernel_step(kernel *self, double time, double size) {
    int status = check_step(self, time, size);
    if (status != KERNEL_OK) return status;
    const kernel_snapshot before = self->now;
    memcpy(self->backup, self->block, self->restored * sizeof(double));

    self->step_origin = time;
    kernel_gather_inputs(self);
    double reached = size;
    status = integrate(self, size, &reached);
    if (status <= KERNEL_WARNING) {
        kernel_compute_outputs(self, reached, self->state);
        const char *bad = kernel_output_not_finite(self);
        if (bad)
            status = kernel_fail(self, KERNEL_ERROR, "The output %s is not a finite number at t = %.9g s.", bad,
                                 time + reached);
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
    char when[32];
    snprintf(when, sizeof when, "%.6g", self->now.time);
    return kernel_fail(self, KERNEL_DISCARD, self->system->sentence[self->now.ended - 1], when);
}
