/* Steps with a Jacobian that is kept: ROS34PW2, whose order does not depend on how old its matrix is.
 *
 * A saved state holds the place where the Jacobian was taken. The factors are always made from that place, at once or after a
 * saved state was restored, so that both runs continue bit-identically. */
#include <math.h>
#include <string.h>

#include "method.h"

enum { OLDEST = 10 }; /* accepted steps with one Jacobian if this is the chosen method */

static void remember_place(kernel *self, double offset) {
    const system_description *system = self->system;
    for (int i = 0; i < system->inputs; ++i) self->run.kept_input[i] = self->given.input[i] + offset * self->given.rate[i];
    memcpy(self->run.kept_state, self->run.state, (size_t)system->states * sizeof(double));
    memcpy(self->run.kept_mode, self->run.mode, (size_t)system->frictions * sizeof(double));
    self->run.now->kept_time = self->given.step_origin + offset;
    self->run.now->kept_steps = 0;
}

static void linearise_at_kept_place(kernel *self) {
    const double origin = self->given.step_origin;
    double *mode = self->run.mode;
    self->given.step_origin = self->run.now->kept_time;
    self->run.mode = self->run.kept_mode;
    memcpy(self->given.stage_input, self->run.kept_input, (size_t)self->system->inputs * sizeof(double));
    kernel_look_up(self, 0.0, self->run.kept_state);
    rosenbrock_evaluate_jacobian(self, 0.0, self->run.kept_state, self->kept.jacobian);
    self->given.step_origin = origin;
    self->run.mode = mode;
}

/* The Jacobian stays as it is, the factors belong to one step size. Returns 0 for singular ones. */
static bool make_factors(kernel *self, double size) {
    if (self->kept.ready == KEPT_FACTORS && size == self->run.now->kept_size && linear_has_factors(self, &self->kept.factors))
        return true;
    if (self->kept.ready == KEPT_NOTHING) linearise_at_kept_place(self);
    self->kept.ready = KEPT_JACOBIAN;
    self->run.now->kept_size = size;
    if (!linear_factorise_algebraic(self, &self->kept.algebraic, self->kept.jacobian) ||
        !rosenbrock_factorise(self, &ROS34PW2, &self->kept.factors, self->kept.jacobian, size))
        return false;
    self->kept.ready = KEPT_FACTORS;
    return true;
}

static double step(kernel *self, double offset, double size) {
    if (!make_factors(self, size) ||
        !algebraic_follow(self, &self->kept.algebraic, offset, self->run.state, self->run.value[MODEL.tolerance]))
        return NAN;
    return rosenbrock_step(self, &ROS34PW2, &self->kept.factors, offset, size);
}

static bool modes_are_the_kept_ones(const kernel *self) {
    for (int i = 0; i < self->system->frictions; ++i)
        if (self->run.mode[i] != self->run.kept_mode[i]) return false;
    return true;
}

void reuse_remember(kernel *self, double offset, double until) {
    remember_place(self, offset);
    self->kept.ready = self->known[1] ? KEPT_NOTHING : KEPT_JACOBIAN; /* of steps in lanes it is not in work.jacobian */
    if (!self->known[1]) memcpy(self->kept.jacobian, self->work.jacobian, (size_t)self->system->nonzeros * sizeof(double));
    self->run.now->kept_until = until;
}

bool reuse_serves(const kernel *self, double offset) {
    return self->run.now->kept_steps >= 0 && self->given.step_origin + offset < self->run.now->kept_until &&
           modes_are_the_kept_ones(self);
}

double reuse_short_step(kernel *self, double offset, double size) {
    const double error = step(self, offset, size);
    if (!(error <= 1.0)) self->run.now->kept_steps = -1;
    return error;
}

double reuse_try(kernel *self, double offset, double size) {
    const int steps = self->run.now->kept_steps;
    if (steps >= 0 && steps < OLDEST && modes_are_the_kept_ones(self)) {
        const double error = step(self, offset, size);
        if (error <= 1.0 || steps == 0) return error;
    }
    remember_place(self, offset);
    self->kept.ready = KEPT_NOTHING;
    return step(self, offset, size);
}
