/* Rows of variables at equal times, from between the ends of steps. */
#include <float.h>

#include "method.h"

/* Cubic through both ends and slopes of a step of a method without an extension of its own; algebraic states are solved
 * for, from the straight line between their ends. */
static void interpolate_by_slopes(kernel *self, double offset, double size, double fraction, double *state) {
    const double other = 1.0 - fraction;
    for (int i = 0; i < self->system->states; ++i) {
        const double change = self->work.trial[i] - self->run.state[i];
        const double bend =
            other * (size * self->reading.first_slope[i] - change) - fraction * (size * self->reading.last_slope[i] - change);
        state[i] = self->run.state[i] + fraction * (change + self->work.differential[i] * other * bend);
    }
    (void)algebraic_find(self, offset + fraction * size, state, self->run.value[MODEL.tolerance]);
}

static void prepare_interpolation(kernel *self, double offset, double size) {
    kernel_evaluate(self, self->system->ode, offset, self->run.state, self->reading.first_slope);
    kernel_evaluate(self, self->system->ode, offset + size, self->work.trial, self->reading.last_slope);
}

void record_until(kernel *self, double offset, double size, double until) {
    kernel_recorder *recorder = self->recorder;
    const bool own_extension = self->work.method == METHOD_EXACT;
    bool prepared = false;
    while (recorder->written < recorder->capacity) {
        const double at = (double)recorder->written * recorder->interval;
        if (at > until * (1.0 + 4.0 * DBL_EPSILON)) return;
        const double share = size > 0.0 ? (at - offset) / size : 0.0, fraction = share < 1.0 ? share : 1.0;
        double *shown = size > 0.0 ? self->reading.state : self->run.state;
        if (size > 0.0 && own_extension) {
            rosenbrock_interpolate(self, fraction, shown);
        } else if (size > 0.0) {
            if (!prepared) prepare_interpolation(self, offset, size);
            prepared = true;
            interpolate_by_slopes(self, offset, size, fraction, shown);
        }
        kernel_compute_outputs(self, at, shown);
        double *row = recorder->buffer + recorder->written * recorder->columns;
        for (int i = 0; i < recorder->columns; ++i)
            row[i] = self->run.value[recorder->variable[i]] + at * self->run.input_rate[recorder->variable[i]];
        recorder->written++;
    }
}
