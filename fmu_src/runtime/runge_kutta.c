/* The explicit Runge-Kutta method of order 4, with the algebraic states solved for in each stage. It has no error control, and
 * above its stability limit the saturation of creep keeps it from blowing up: the guard reports the instability instead. */
#include <math.h>
#include <string.h>

#include "method.h"

enum { STAGES = 4, CHECK_EVERY = 32, POWER_STEPS = 24, STEPS_SHOWN = 4 };
static const double NODE[STAGES] = {0.0, 0.5, 0.5, 1.0}, WEIGHT[STAGES] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
/* End of the method's stability region on the negative real axis; Hairer and Wanner 1996, section IV.2. */
static const double STABILITY_LIMIT = 2.785293563405282;
/* Scaled change of algebraic states, well below the error of the method. */
static const double SOLVED = 1e-10;

double runge_kutta_try(kernel *self, double offset, double size) {
    const int n = self->system->states;
    memcpy(self->work.trial, self->run.state, (size_t)n * sizeof(double));
    memcpy(self->work.point, self->run.state, (size_t)n * sizeof(double));
    for (int stage = 0; stage < STAGES; ++stage) {
        double *slope = self->work.stage[stage];
        if (stage > 0)
            for (int i = 0; i < n; ++i)
                if (self->work.differential[i] != 0.0)
                    self->work.point[i] = self->run.state[i] + size * NODE[stage] * self->work.stage[stage - 1][i];
        if (!algebraic_find(self, offset + NODE[stage] * size, self->work.point, SOLVED)) return NAN;
        memcpy(slope, self->work.slope, (size_t)n * sizeof(double));
        for (int i = 0; i < n; ++i) self->work.trial[i] += size * WEIGHT[stage] * self->work.differential[i] * slope[i];
    }
    for (int i = 0; i < n; ++i)
        if (self->work.differential[i] == 0.0) self->work.trial[i] = self->work.point[i];
    if (!algebraic_find(self, offset + size, self->work.trial, SOLVED)) return NAN;
    for (int i = 0; i < n; ++i)
        if (!isfinite(self->work.trial[i])) return NAN;
    return 0.0;
}

/* Change of the slopes of the differential states with a change of these, the algebraic ones following: J times a vector
 * without algebraic states, which hold what they follow by. */
static void apply_jacobian(kernel *self, double *vector, double *image) {
    const system_description *system = self->system;
    double *follow = self->work.follow;
    for (int i = 0; i < system->algebraics; ++i) vector[system->algebraic[i]] = 0.0;
    memset(image, 0, (size_t)system->states * sizeof(double));
    linear_add_product(self, vector, image);
    if (system->algebraics == 0) return;
    for (int i = 0; i < system->algebraics; ++i) follow[i] = image[system->algebraic[i]];
    linear_solve_algebraic(&self->work.algebraic, follow);
    for (int i = 0; i < system->algebraics; ++i) vector[system->algebraic[i]] = -follow[i];
    memset(image, 0, (size_t)system->states * sizeof(double));
    linear_add_product(self, vector, image);
}

/* Magnitude of the fastest eigenvalue [1/s], by the power method on the exact Jacobian without algebraic states; each
 * state counts in its nominal value. */
static double fastest_eigenvalue(kernel *self, double offset) {
    const system_description *system = self->system;
    const int n = system->states;
    double *vector = self->work.direction, *image = self->work.image, growth = 1.0;
    rosenbrock_linearise(self, offset, self->run.state);
    if (!linear_factorise_algebraic(self, &self->work.algebraic, self->work.jacobian)) return NAN;
    for (int i = 0; i < n; ++i) vector[i] = system->nominal[i];
    for (int step = 0; step < POWER_STEPS; ++step) {
        double largest = 0.0;
        apply_jacobian(self, vector, image);
        for (int i = 0; i < n; ++i) largest = fmax(largest, self->work.differential[i] * fabs(image[i]) / system->nominal[i]);
        if (!(largest > 0.0)) return largest;
        for (int i = 0; i < n; ++i) vector[i] = image[i] / largest;
        if (step >= POWER_STEPS - STEPS_SHOWN) growth *= largest;
    }
    return pow(growth, 1.0 / (double)STEPS_SHOWN);
}

kernel_status runge_kutta_guard(kernel *self, double offset, double size) {
    if (self->run.now->guard_warned > 0.0 || self->run.now->guard_wait-- > 0) return KERNEL_OK;
    self->run.now->guard_wait = CHECK_EVERY - 1;
    const double eigenvalue = fastest_eigenvalue(self, offset);
    if (!(size * eigenvalue > STABILITY_LIMIT)) return KERNEL_OK;
    self->run.now->guard_warned = size * eigenvalue;
    char when[TIME_TEXT];
    return kernel_fail(self, KERNEL_WARNING,
                       "The explicit method is above its stability limit at t = %s s: the fastest eigenvalue, %.4g 1/s, "
                       "allows steps up to %.3g s and the step is %.3g s; do not trust the motion from here on, shorten "
                       "integration_step or choose integration_method 1.",
                       time_text(self->given.step_origin + offset, 6, when), eigenvalue, STABILITY_LIMIT / eigenvalue, size);
}
