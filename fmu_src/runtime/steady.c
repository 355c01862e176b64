/* The start as a steady state, for systems that require it.
 *
 * A steady state has zero derivatives, except for those that grow with the speed as the vehicle rolls faster or slower. Steps
 * of the implicit Euler method follow the motion in time with artificial damping, which acts on all motions that are fast
 * relative to a step. They grow until they are steps of Newton's method. Hence states are found from afar, and those too about
 * which a motion would grow (Kelley and Keyes (1998), Convergence analysis of pseudo-transient continuation, SIAM Journal on
 * Numerical Analysis 35, 508-523). */
#include <math.h>
#include <string.h>

#include "method.h"

enum { MOST_STEPS = 300, MOST_CORRECTIONS = 8, QUICK = 4 };
/* Sizes of steps [s]: the first; the smallest, below which the search fails; the size from which on a change in a step is all
 * of the remaining change. */
static const double FIRST = 1e-3, LEAST = 1e-8, LONG = 1e6;
/* Scaled changes: corrections at which an implicit step is solved, and a long step without further change. */
static const double SOLVED_STEP = 1e-6, SETTLED = 1e-9;
/* Directions of a friction that has no velocity to oppose: it gives way with this share of its capacity. */
static const double GIVES_WAY = 1e-4;
/* Mass of a state that is held. */
static const double HELD = 1e200;

static bool is_held(const kernel *self, int i) { return self->work.differential[i] == HELD; }

static double largest_scaled(const kernel *self, const double *change) {
    double largest = 0.0;
    for (int i = 0; i < self->system->states; ++i) {
        const double scaled = fabs(change[i]) / self->system->nominal[i];
        if (isnan(scaled)) return NAN;
        if (scaled > largest) largest = scaled;
    }
    return largest;
}

/* A correction of self->work.trial by Newton's method, in a step of `size` from self->run.state. Returns its largest scaled
 * entry; NaN if it fails. How the acceleration follows from all states is a matrix of rank 1: Sherman and Morrison (1950). */
static double newton_correction(kernel *self, double size) {
    const system_description *system = self->system;
    const int n = system->states, speed = system->steady->speed;
    double *change = self->steady.change, *answer = self->steady.answer, *pace = self->steady.pace;
    rosenbrock_linearise(self, 0.0, self->work.trial);
    const double acceleration = self->work.slope[speed];
    for (int i = 0; i < n; ++i) {
        const bool held = is_held(self, i);
        const double moved = held ? 0.0 : self->work.differential[i] * (self->work.trial[i] - self->run.state[i]) / size;
        change[i] = held ? 0.0 : self->work.slope[i] - pace[i] * acceleration - moved;
        answer[i] = held ? 0.0 : pace[i];
    }
    if (!linear_factorise_step(self, &self->work.factors, self->work.jacobian, 1.0 / size)) return NAN;
    linear_solve_step(self, &self->work.factors, change);
    linear_solve_step(self, &self->work.factors, answer);
    double gained = 0.0, divisor = 1.0;
    for (int j = 0; j < n; ++j)
        for (int i = system->column_start[j]; i < system->column_start[j + 1]; ++i) {
            if (system->row[i] != speed) continue;
            gained += self->work.jacobian[i] * change[j];
            divisor += self->work.jacobian[i] * answer[j];
        }
    for (int i = 0; i < n; ++i) {
        change[i] = is_held(self, i) ? 0.0 : change[i] - answer[i] * gained / divisor;
        self->work.trial[i] += change[i];
    }
    return largest_scaled(self, change);
}

/* A step of the implicit Euler method to self->work.trial. Returns the corrections that it took; 0: it was not solved. */
static int implicit_step(kernel *self, double size) {
    double before = INFINITY;
    memcpy(self->work.trial, self->run.state, (size_t)self->system->states * sizeof(double));
    for (int count = 1; count <= MOST_CORRECTIONS; ++count) {
        const double largest = newton_correction(self, size);
        if (!(largest <= 2.0 * before)) return 0;
        if (largest <= SOLVED_STEP) return count;
        before = largest;
    }
    return 0;
}

/* Step until nothing changes any more; return whether that is reached. */
static bool find_rest(kernel *self) {
    double size = FIRST;
    for (int count = 0; count < MOST_STEPS && size > LEAST; ++count) {
        const int corrections = implicit_step(self, size);
        if (!corrections) {
            size /= 4.0;
            continue;
        }
        for (int i = 0; i < self->system->states; ++i) self->steady.change[i] = self->work.trial[i] - self->run.state[i];
        memcpy(self->run.state, self->work.trial, (size_t)self->system->states * sizeof(double));
        if (size >= LONG && largest_scaled(self, self->steady.change) <= SETTLED) return true;
        size *= corrections <= QUICK ? 4.0 : 1.5;
    }
    return false;
}

/* Frictions as in the steady state: against the velocity that there is, and without one not at all. */
static void release_frictions(kernel *self) {
    if (self->system->frictions == 0) return;
    kernel_evaluate(self, self->system->capacity, 0.0, self->run.state, self->modes.capacity);
    for (int i = 0; i < self->system->frictions; ++i) {
        const double velocity = modes_velocity(&self->system->friction[i], self->run.state);
        self->run.mode[i] = velocity < 0.0 ? -1.0 : velocity > 0.0 || self->modes.capacity[i] <= 0.0 ? 1.0 : GIVES_WAY;
    }
}

/* Set a velocity that was zero at the start to exactly zero, so that its friction holds it from then on. */
static void stop_frictions(kernel *self, const double *start) {
    for (int i = 0; i < self->system->frictions; ++i) {
        if (modes_velocity(&self->system->friction[i], start) == 0.0) modes_stop(&self->system->friction[i], self->run.state);
        self->run.mode[i] = 1.0;
    }
}

static void hold(kernel *self, const int *state, int count, double mass) {
    for (int i = 0; i < count; ++i)
        if (self->work.differential[state[i]] != 0.0) self->work.differential[state[i]] = mass; /* algebraic states have none */
}

/* Return whether a parameter sets the place of the states that come to rest last: then they stay there. */
static bool is_placed(const kernel *self) {
    const steady_start *steady = self->system->steady;
    for (int i = 0; i < steady->places; ++i)
        if (self->given.parameter[steady->place[i]] != 0.0) return true;
    return false;
}

/* Set drives and brakes to 0: they begin when the run does. */
static void leave_drives(kernel *self) {
    const steady_start *steady = self->system->steady;
    for (int i = 0; i < steady->drives; ++i) self->given.input[steady->drive[i]] = self->given.rate[steady->drive[i]] = 0.0;
}

/* Find the state from the start values, in self->run.state: first all states except those that come to rest last, then all. */
static bool find(kernel *self) {
    const steady_start *steady = self->system->steady;
    double *pace = self->steady.pace;
    hold(self, steady->kept, steady->kepts, HELD);
    hold(self, &steady->speed, 1, HELD);
    kernel_evaluate(self, steady->pace, 0.0, self->run.state, pace);
    if (self->run.state[steady->speed] == 0.0) memset(pace, 0, (size_t)self->system->states * sizeof(double));
    hold(self, steady->last, steady->lasts, HELD);
    bool found = steady->lasts == 0 || find_rest(self);
    hold(self, steady->last, steady->lasts, 1.0);
    if (found && !is_placed(self)) found = find_rest(self);
    hold(self, steady->kept, steady->kepts, 1.0);
    hold(self, &steady->speed, 1, 1.0);
    return found;
}

/* Return whether a condition that ends runs is met. */
static bool has_ended(kernel *self) {
    if (self->system->ends == 0) return false;
    kernel_evaluate(self, self->system->condition_margin, 0.0, self->run.state, self->modes.margin);
    for (int i = 0; i < self->system->ends; ++i)
        if (!(self->modes.margin[i] >= 0.0)) return true;
    return false;
}

bool steady_find(kernel *self) {
    const steady_start *steady = self->system->steady;
    double course = 0.0, *start = self->steady.start;
    if (!steady) return true;
    kernel_evaluate(self, steady->course, 0.0, self->run.state, &course);
    if (course <= 0.0) return true;
    memcpy(start, self->run.state, (size_t)self->system->states * sizeof(double));
    leave_drives(self);
    release_frictions(self);
    const bool found = find(self) && !has_ended(self);
    stop_frictions(self, start);
    kernel_gather_inputs(self);
    return found;
}
