/* Algebraic states: solved for where a step starts, and eliminated for methods and studies that know none. */
#include <math.h>
#include <string.h>

#include "internal.h"

enum { MAXIMUM_NEWTON_STEPS = 20 };
/* Scaled corrections of Newton's method below which no further progress is round-off and not divergence. */
static const double ROUND_OFF = 1e-9;
/* The same with factors that are not exact, which converge by less at a time. */
static const double ROUND_OFF_FOLLOWING = 1e-11;
/* A correction that shrinks less than this from one step to the next asks for a new Jacobian. */
static const double SLOW = 0.1;

/* Solves for the correction of the algebraic states with the factors at hand; its largest entry in nominal values. */
static double find_correction(kernel *self, const dense_factors *of, double *correction) {
    const int m = self->system->algebraics;
    const int *algebraic = self->system->algebraic;
    for (int i = 0; i < m; ++i) correction[i] = -self->slope[algebraic[i]];
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

int algebraic_solve(kernel *self, double offset, double *state, double tolerance) {
    double *correction = self->ordered, before = INFINITY;
    if (self->system->algebraics == 0) return 1;
    for (int count = 0; count < MAXIMUM_NEWTON_STEPS; ++count) {
        if (!linear_factorise_algebraic(self, &self->algebraic, self->jacobian)) return 0;
        const double largest = find_correction(self, &self->algebraic, correction);
        if (!isfinite(largest)) return 0;
        if (largest <= tolerance) return 1;
        if (largest < ROUND_OFF && largest > 0.5 * before) return 1;
        before = largest;
        correct(self, state, correction);
        rosenbrock_linearise(self, offset, state);
    }
    return 0;
}

int algebraic_follow(kernel *self, const dense_factors *of, double offset, double *state, double tolerance) {
    const int m = self->system->algebraics;
    double *correction = self->ordered, *guess = correction + m, before = INFINITY;
    for (int i = 0; i < m; ++i) guess[i] = state[self->system->algebraic[i]];
    for (int count = 0; count < MAXIMUM_NEWTON_STEPS; ++count) {
        kernel_evaluate(self, self->system->ode, offset, state, self->slope);
        self->counters.right_hand_sides++;
        if (m == 0) return 1;
        const double largest = find_correction(self, of, correction);
        if (largest <= tolerance) return 1;
        if (!(largest < SLOW * before)) {
            if (largest < ROUND_OFF_FOLLOWING) return 1;
            break;
        }
        before = largest;
        correct(self, state, correction);
    }
    for (int i = 0; i < m; ++i) state[self->system->algebraic[i]] = guess[i];
    return 0;
}

int algebraic_find(kernel *self, double offset, double *state, double tolerance) {
    if (self->factors_serve && algebraic_follow(self, &self->algebraic, offset, state, tolerance)) return 1;
    rosenbrock_linearise(self, offset, state);
    self->factors_serve = algebraic_solve(self, offset, state, tolerance);
    return self->factors_serve;
}

const double *algebraic_place(kernel *self) {
    if (self->system->algebraics == 0) return self->state;
    memcpy(self->place_read, self->state, (size_t)self->system->states * sizeof(double));
    rosenbrock_linearise(self, 0.0, self->place_read);
    return algebraic_solve(self, 0.0, self->place_read, 0.0) ? self->place_read : NULL;
}

/* J_dd - J_da J_aa^-1 J_ad, column by column. */
int algebraic_reduce(kernel *self, double offset, double *jacobian) {
    const system_description *system = self->system;
    const int n = system->states, m = n - system->algebraics, *start = system->column_start;
    double *follow = self->stage[0], *reduced = self->stage[1];
    rosenbrock_linearise(self, offset, self->state);
    if (!linear_factorise_algebraic(self, &self->algebraic, self->jacobian)) return 0;
    for (int j = 0, column = 0; j < n; ++j) {
        if (self->differential[j] == 0.0) continue;
        memset(reduced, 0, (size_t)n * sizeof(double));
        for (int i = start[j]; i < start[j + 1]; ++i) reduced[system->row[i]] = self->jacobian[i];
        for (int i = 0; i < system->algebraics; ++i) follow[i] = reduced[system->algebraic[i]];
        linear_solve_algebraic(&self->algebraic, follow);
        for (int k = 0; k < system->algebraics; ++k)
            for (int i = start[system->algebraic[k]]; i < start[system->algebraic[k] + 1]; ++i)
                reduced[system->row[i]] -= self->jacobian[i] * follow[k];
        for (int i = 0, row = 0; i < n; ++i)
            if (self->differential[i] != 0.0) jacobian[row++ * m + column] = reduced[i];
        ++column;
    }
    return 1;
}
