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

/* The first margin that turns negative between two lengths of a step, which one is kept at each end: the Illinois variant
 * of the secant rule. */
typedef struct {
    double left, right, at_left, at_right, left_weight, right_weight;
} bracket;

static bool is_wide(const bracket *of, double size) {
    return of->at_right < -LOCATED && of->right - of->left > 1e-12 * size;
}

static double middle_of(const bracket *of) {
    const double down = of->right_weight * of->at_right, up = of->left_weight * of->at_left;
    const double middle = of->right - down * (of->right - of->left) / (down - up);
    return middle > of->left && middle < of->right ? middle : 0.5 * (of->left + of->right);
}

static void divide(bracket *of, double middle, double margin) {
    if (margin >= 0.0) {
        of->left = middle;
        of->at_left = margin;
        of->left_weight = 1.0;
        of->right_weight *= 0.5;
    } else {
        of->right = middle;
        of->at_right = margin;
        of->right_weight = 1.0;
        of->left_weight *= 0.5;
    }
}

/* Where the step as it stands crosses, by its continuous extension: steps of two lengths beside that are all that is left
 * to try. */
static void narrow_by_extension(kernel *self, double offset, double size, bracket *of) {
    bracket within = *of;
    for (int count = 0; count < MAXIMUM_LOCATION_STEPS && is_wide(&within, size); ++count) {
        const double middle = middle_of(&within);
        rosenbrock_interpolate(self, middle / size, self->reading.shown);
        divide(&within, middle, modes_margin(self, offset + middle, self->reading.shown));
    }
    /* A step that ends there has another error than the extension has; its margin falls as steeply. */
    const double steepness = (within.at_left - within.at_right) / (within.right - within.left);
    double length = within.right;
    for (int count = 0; count < 2 && length > of->left && length < of->right && is_wide(of, size); ++count) {
        (void)integrate_try(self, offset, length);
        const double margin = modes_margin(self, offset + length, self->work.trial);
        divide(of, length, margin);
        length += (margin + 0.5 * LOCATED) / steepness;
    }
}

/* Shortens a step that crosses a switch: returns the length at which the first margin has just turned negative. The step
 * itself is repeated, so the state is that of the method, not of an interpolation. */
double modes_locate(kernel *self, double offset, double size) {
    bracket of = {0.0, size, modes_margin(self, offset, self->run.state), 0.0, 1.0, 1.0};
    of.at_right = modes_margin(self, offset + size, self->work.trial);
    if (!(of.at_left > 0.0)) of.at_left = 0.0;
    if (self->work.method == METHOD_EXACT) narrow_by_extension(self, offset, size, &of);
    for (int count = 0; count < MAXIMUM_LOCATION_STEPS && is_wide(&of, size); ++count) {
        const double middle = middle_of(&of);
        (void)integrate_try(self, offset, middle);
        divide(&of, middle, modes_margin(self, offset + middle, self->work.trial));
    }
    (void)integrate_try(self, offset, of.right);
    return of.right;
}
