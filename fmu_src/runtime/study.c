/* Functions for studies alone: names, counts, records, the linearisation, and repeated calls for benchmarks. */
#include <math.h>

#include "lanes_widest.h"
#include "method.h"
#include "studies.h"

int kernel_variable_count(void) { return MODEL.variables; }
const char *kernel_message(const kernel *self) { return self->messages.message; }
void kernel_counts(const kernel *self, kernel_counters *counts) { *counts = self->counters; }

int kernel_use_lanes(kernel *self, int most) {
    const int widest = lanes_of_processor();
    self->lanes = widest;
    while (self->lanes > most && self->lanes > 1) self->lanes /= 2;
    return self->lanes;
}

const char *kernel_variable_name(int variable) {
    return variable >= 0 && variable < MODEL.variables ? MODEL.variable[variable].name : "";
}

kernel_status kernel_record(kernel *self, double time, double size, double interval, int columns, const int *variable,
                            double *buffer, long long int rows) {
    kernel_recorder recorder = {rows, 0, interval, columns, variable, buffer};
    self->recorder = &recorder;
    const kernel_status status = kernel_step(self, time, size);
    self->recorder = NULL;
    for (long long int i = recorder.written * columns; i < rows * columns; ++i) buffer[i] = NAN;
    return status;
}

kernel_status kernel_linearise(kernel *self, double *state, double *slope, double *jacobian) {
    if (kernel_prepare(self, "its linearisation") != KERNEL_OK) return KERNEL_ERROR;
    const int n = self->system->states;
    if (!algebraic_begin(self, 0.0, 0.0)) return KERNEL_ERROR;
    for (int i = 0; i < n; ++i) {
        state[i] = self->run.state[i];
        slope[i] = self->work.slope[i];
    }
    linear_write_by_rows(self, jacobian);
    return KERNEL_OK;
}

kernel_status kernel_repeat_right_hand_side(kernel *self, long long int repeat) {
    if (!self->system) return KERNEL_ERROR;
    kernel_gather_inputs(self);
    for (long long int i = 0; i < repeat; ++i) kernel_evaluate(self, self->system->ode, 0.0, self->run.state, self->work.slope);
    return KERNEL_OK;
}

kernel_status kernel_repeat_jacobian(kernel *self, long long int repeat) {
    if (!self->system) return KERNEL_ERROR;
    kernel_gather_inputs(self);
    for (long long int i = 0; i < repeat; ++i) rosenbrock_linearise(self, 0.0, self->run.state);
    return KERNEL_OK;
}

kernel_status kernel_repeat_step(kernel *self, double time, double size, long long int repeat) {
    for (long long int i = 0; i < repeat; ++i) {
        const kernel_status status = kernel_step(self, time + (double)i * size, size);
        if (status > KERNEL_WARNING) return status;
    }
    return KERNEL_OK;
}
