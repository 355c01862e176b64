/* A trial step with the chosen method, repeated to find where a step crosses a switch. */
#include "method.h"

enum { MAXIMUM_LOCATION_STEPS = 60 };
static const double LOCATED = 1e-10; /* scaled margin at which a switch counts as located */

double integrate_try(kernel *self, double offset, double size) {
    switch (self->work.method) {
        case METHOD_REUSED: return reuse_try(self, offset, size);
        case METHOD_EXPLICIT: return runge_kutta_try(self, offset, size);
        default: return rosenbrock_try(self, offset, size);
    }
}

/* Shortens a step that crosses a switch: returns the length at which the first margin has just turned negative.
 * Illinois variant of the secant rule; the step itself is repeated, so the state is that of the method, not of an
 * interpolation. It is the right end of the bracket that is kept. */
double modes_locate(kernel *self, double offset, double size) {
    double left = 0.0, right = size;
    double at_left = modes_margin(self, offset, self->run.state);
    double at_right = modes_margin(self, offset + size, self->work.trial);
    double left_weight = 1.0, right_weight = 1.0;
    if (!(at_left > 0.0)) at_left = 0.0;
    for (int count = 0; count < MAXIMUM_LOCATION_STEPS && at_right < -LOCATED && right - left > 1e-12 * size; ++count) {
        const double down = right_weight * at_right, up = left_weight * at_left;
        double middle = right - down * (right - left) / (down - up);
        if (!(middle > left && middle < right)) middle = 0.5 * (left + right);
        (void)integrate_try(self, offset, middle);
        const double at_middle = modes_margin(self, offset + middle, self->work.trial);
        if (at_middle >= 0.0) {
            left = middle;
            at_left = at_middle;
            left_weight = 1.0;
            right_weight *= 0.5;
        } else {
            right = middle;
            at_right = at_middle;
            right_weight = 1.0;
            left_weight *= 0.5;
        }
    }
    (void)integrate_try(self, offset, right);
    return right;
}
