/* For benchmarks: one thing many times. */
#include "internal.h"

int kernel_repeat_right_hand_side(kernel *self, long long int repeat) {
    if (!self->system) return KERNEL_ERROR;
    kernel_gather_inputs(self);
    for (long long int i = 0; i < repeat; ++i)
        kernel_evaluate(self, self->system->ode, 0.0, self->state, self->slope);
    return KERNEL_OK;
}

int kernel_repeat_jacobian(kernel *self, long long int repeat) {
    if (!self->system) return KERNEL_ERROR;
    kernel_gather_inputs(self);
    for (long long int i = 0; i < repeat; ++i)
        rosenbrock_linearise(self, 0.0, self->state);
    return KERNEL_OK;
}

int kernel_repeat_step(kernel *self, double time, double size, long long int repeat) {
    for (long long int i = 0; i < repeat; ++i) {
        const int status = kernel_step(self, time + (double)i * size, size);
        if (status > KERNEL_WARNING) return status;
    }
    return KERNEL_OK;
}
