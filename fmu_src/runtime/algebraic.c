/* Algebraic states: solved for where a step starts, and eliminated for methods and studies without them. */
#include <math.h>
#include <string.h>

#include "method.h"

enum { MAXIMUM_NEWTON_STEPS = 20 };
/* Scaled corrections of Newton's method below which no further progress is round-off and not divergence. */
static const double ROUND_OFF = 1e-9;
/* The same with factors that are not exact, which converge by less at a time. */
static const double ROUND_OFF_FOLLOWING = 1e-11;
/* A correction that shrinks less than this from one step to the next requires a new Jacobian. */
static const double SLOW = 0.1;

/* Solves for the correction of the algebraic states with the factors at hand; its largest entry in nominal values. */
static double find_correction(kernel *self, const dense_factors *of, double *correction) {
    const int m = self->system->algebraics;
    const int *algebraic = self->system->algebraic;
    for (int i = 0; i < m; ++i) correction[i] = -self->work.slope[algebraic[i]];
    linear_solve_algebraic(of, correction);
    double largest = 0.0;
    for (int i = 0; i < m; ++i) {
        const double scaled = fabs(correction[i]) / self->system->nominal[algebraic[i]];
        if (!isfinite(scaled)) return NAN;
        if (scaled > largest) largest = scaled;
    }
    return largest;
}

static void correct(const kernel *self, double *state, const double *correction) {
    for (int i = 0; i < self->system->algebraics; ++i) state[self->system->algebraic[i]] += correction[i];
}

bool algebraic_solve(kernel *self, double offset, double *state, double tolerance) {
    double *correction = self->work.correction, before = INFINITY;
    if (self->system->algebraics == 0) return true;
    for (int count = 0; count < MAXIMUM_NEWTON_STEPS; ++count) {
        if (!linear_factorise_algebraic(self, &self->work.algebraic, self->work.jacobian)) return false;
        const double largest = find_correction(self, &self->work.algebraic, correction);
        if (!isfinite(largest)) return false;
        if (largest <= tolerance) return true;
        if (largest < ROUND_OFF && largest > 0.5 * before) return true;
        before = largest;
        correct(self, state, correction);
        rosenbrock_linearise(self, offset, state);
    }
    return false;
}

bool algebraic_begin(kernel *self, double offset, double tolerance) {
    rosenbrock_linearise(self, offset, self->run.state);
    if (algebraic_solve(self, offset, self->run.state, tolerance)) return true;
    char when[TIME_TEXT];
    kernel_fail(self, KERNEL_ERROR, "The algebraic equations have no solution near t = %s s; check inputs and parameters.",
                time_text(self->given.step_origin + offset, 9, when));
    return false;
}

bool algebraic_correct(kernel *self, double *state, double tolerance) {
    const system_description *system = self->system;
    double *correction = self->work.correction;
    if (system->algebraics == 0) return true;
    if (!linear_factorise_algebraic(self, &self->work.algebraic, self->work.jacobian)) return false;
    if (find_correction(self, &self->work.algebraic, correction) <= tolerance) return true;
    correct(self, state, correction);
    for (int k = 0; k < system->algebraics; ++k)
        for (int i = system->column_start[system->algebraic[k]]; i < system->column_start[system->algebraic[k] + 1]; ++i)
            self->work.slope[system->row[i]] += self->work.jacobian[i] * correction[k];
    return true;
}

bool algebraic_follow(kernel *self, const dense_factors *of, double offset, double *state, double tolerance) {
    const int m = self->system->algebraics;
    double *correction = self->work.correction, *guess = self->work.guess, before = INFINITY;
    for (int i = 0; i < m; ++i) guess[i] = state[self->system->algebraic[i]];
    for (int count = 0; count < MAXIMUM_NEWTON_STEPS; ++count) {
        kernel_evaluate(self, self->system->ode, offset, state, self->work.slope);
        self->counters.right_hand_sides++;
        if (m == 0) return true;
        const double largest = find_correction(self, of, correction);
        if (largest <= tolerance) return true;
        if (!(largest < SLOW * before)) {
            if (largest < ROUND_OFF_FOLLOWING) return true;
            break;
        }
        before = largest;
        correct(self, state, correction);
    }
    for (int i = 0; i < m; ++i) state[self->system->algebraic[i]] = guess[i];
    return false;
}

bool algebraic_find(kernel *self, double offset, double *state, double tolerance) {
    if (self->work.algebraic_serve && algebraic_follow(self, &self->work.algebraic, offset, state, tolerance)) return true;
    rosenbrock_linearise(self, offset, state);
    self->work.algebraic_serve = algebraic_solve(self, offset, state, tolerance);
    return self->work.algebraic_serve;
}

const double *algebraic_place(kernel *self) {
    if (self->system->algebraics == 0) return self->run.state;
    memcpy(self->reading.place, self->run.state, (size_t)self->system->states * sizeof(double));
    rosenbrock_linearise(self, 0.0, self->reading.place);
    return algebraic_solve(self, 0.0, self->reading.place, 0.0) ? self->reading.place : NULL;
}

/* J_dd - J_da J_aa^-1 J_ad, column by column. */
bool algebraic_reduce(kernel *self, double offset, double *jacobian) {
    const system_description *system = self->system;
    const int n = system->states, m = n - system->algebraics, *start = system->column_start;
    double *follow = self->work.follow, *reduced = self->work.image;
    rosenbrock_linearise(self, offset, self->run.state);
    if (!linear_factorise_algebraic(self, &self->work.algebraic, self->work.jacobian)) return false;
    for (int j = 0, column = 0; j < n; ++j) {
        if (self->work.differential[j] == 0.0) continue;
        memset(reduced, 0, (size_t)n * sizeof(double));
        for (int i = start[j]; i < start[j + 1]; ++i) reduced[system->row[i]] = self->work.jacobian[i];
        for (int i = 0; i < system->algebraics; ++i) follow[i] = reduced[system->algebraic[i]];
        linear_solve_algebraic(&self->work.algebraic, follow);
        for (int k = 0; k < system->algebraics; ++k)
            for (int i = start[system->algebraic[k]]; i < start[system->algebraic[k] + 1]; ++i)
                reduced[system->row[i]] -= self->work.jacobian[i] * follow[k];
        for (int i = 0, row = 0; i < n; ++i)
            if (self->work.differential[i] != 0.0) jacobian[row++ * m + column] = reduced[i];
        ++column;
    }
    return true;
}
