/* Steps with a Jacobian that is kept: ROS34PW2, whose order does not depend on how old its matrix is.
 *
 * What a saved state holds is the place where the Jacobian was taken. The factors are always made from that place, at
 * once or after a saved state came back, so that both go on with the same bits. */
#include <math.h>
#include <string.h>

#include "internal.h"

enum { OLDEST = 10 }; /* accepted steps that one Jacobian serves where this is the chosen method */

static void remember_place(kernel *self, double offset) {
    const system_description *system = self->system;
    for (int i = 0; i < system->inputs; ++i) self->kept_input[i] = self->input[i] + offset * self->rate[i];
    memcpy(self->kept_state, self->state, (size_t)system->states * sizeof(double));
    memcpy(self->kept_mode, self->mode, (size_t)system->frictions * sizeof(double));
    self->now.kept_time = self->step_origin + offset;
    self->now.kept_steps = 0;
}

static void linearise_at_kept_place(kernel *self) {
    const double origin = self->step_origin;
    double *mode = self->mode;
    self->step_origin = self->now.kept_time;
    self->mode = self->kept_mode;
    memcpy(self->stage_input, self->kept_input, (size_t)self->system->inputs * sizeof(double));
    kernel_look_up(self, 0.0, self->kept_state);
    rosenbrock_evaluate_jacobian(self, 0.0, self->kept_state, self->kept_jacobian);
    self->step_origin = origin;
    self->mode = mode;
}

/* The Jacobian stays as it is, the factors belong to one step size. Returns 0 for singular ones. */
static int make_factors(kernel *self, double size) {
    if (self->kept_ready == KEPT_FACTORS && size == self->now.kept_size && linear_has_factors(self, &self->kept)) return 1;
    if (self->kept_ready == KEPT_NOTHING) linearise_at_kept_place(self);
    self->kept_ready = KEPT_JACOBIAN;
    self->now.kept_size = size;
    if (!linear_factorise_algebraic(self, &self->kept_algebraic, self->kept_jacobian) ||
        !rosenbrock_factorise(self, &ROS34PW2, &self->kept, self->kept_jacobian, size))
        return 0;
    self->kept_ready = KEPT_FACTORS;
    return 1;
}

static double step(kernel *self, double offset, double size) {
    if (!make_factors(self, size) ||
        !algebraic_follow(self, &self->kept_algebraic, offset, self->state, self->value[MODEL.tolerance]))
        return NAN;
    return rosenbrock_step(self, &ROS34PW2, &self->kept, offset, size);
}

static int modes_are_the_kept_ones(const kernel *self) {
    for (int i = 0; i < self->system->frictions; ++i)
        if (self->mode[i] != self->kept_mode[i]) return 0;
    return 1;
}

void reuse_remember(kernel *self, double offset, double until) {
    remember_place(self, offset);
    memcpy(self->kept_jacobian, self->jacobian, (size_t)self->system->nonzeros * sizeof(double));
    self->kept_ready = KEPT_JACOBIAN;
    self->now.kept_until = until;
}

int reuse_serves(const kernel *self, double offset) {
    return self->now.kept_steps >= 0 && self->step_origin + offset < self->now.kept_until && modes_are_the_kept_ones(self);
}

double reuse_short_step(kernel *self, double offset, double size) {
    const double error = step(self, offset, size);
    if (!(error <= 1.0)) self->now.kept_steps = -1;
    return error;
}

double reuse_try(kernel *self, double offset, double size) {
    const int steps = self->now.kept_steps;
    if (steps >= 0 && steps < OLDEST && modes_are_the_kept_ones(self)) {
        const double error = step(self, offset, size);
        if (error <= 1.0 || steps == 0) return error;
    }
    remember_place(self, offset);
    self->kept_ready = KEPT_NOTHING;
    return step(self, offset, size);
}
