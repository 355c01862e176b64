/* Locate the crossing of a switch within a step. If the method has a continuous extension, it is used first. Then steps of
 * other lengths follow, so that the state is that of the method and not of an interpolation. */
#include "stepper.h"

enum { MAXIMUM_LOCATION_STEPS = 60, STEPS_BY_EXTENSION = 2 };
static const double LOCATED = 1e-10; /* scaled margin at which a switch is treated as located */

static bool is_wide(const bracket *of, double size) { return of->at_right < -LOCATED && of->right - of->left > 1e-12 * size; }

/* The Illinois variant of the secant rule. */
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

/* Find the crossing of the present step on its extension. A step that ends there has another error than the extension; its
 * margin falls as steeply. */
static void look_along_extension(kernel *self, stepper *run) {
    bracket within = run->within;
    for (int count = 0; count < MAXIMUM_LOCATION_STEPS && is_wide(&within, run->crossing); ++count) {
        const double middle = middle_of(&within);
        rosenbrock_interpolate(self, middle / run->crossing, self->reading.state);
        divide(&within, middle, modes_margin(self, run->offset + middle, self->reading.state));
    }
    run->steepness = (within.at_left - within.at_right) / (within.right - within.left);
    run->by_extension = STEPS_BY_EXTENSION;
    run->size = within.right;
}

/* Request the next length. */
static void ask(stepper *run, double by_extension) {
    const bracket *of = &run->within;
    run->phase = STEPPER_LOCATES;
    if (run->located < MAXIMUM_LOCATION_STEPS && is_wide(of, run->crossing)) {
        const bool serves = run->by_extension-- > 0 && by_extension > of->left && by_extension < of->right;
        run->size = serves ? by_extension : middle_of(of);
        return;
    }
    run->phase = STEPPER_ARRIVES;
    run->size = of->right;
}

void locate_begin(kernel *self, stepper *run) {
    const bracket whole = {0.0, run->size, modes_margin(self, run->offset, self->run.state), run->margin, 1.0, 1.0};
    run->within = whole;
    if (!(run->within.at_left > 0.0)) run->within.at_left = 0.0;
    run->by_extension = 0;
    run->located = 0;
    run->crossing = run->size;
    if (self->work.method == METHOD_EXACT) look_along_extension(self, run);
    ask(run, run->size);
}

void locate_take(kernel *self, stepper *run) {
    const double margin = modes_margin(self, run->offset + run->size, self->work.trial);
    divide(&run->within, run->size, margin);
    run->located++;
    ask(run, run->size + (margin + 0.5 * LOCATED) / run->steepness);
}
