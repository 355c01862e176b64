/* An integrator of the host that takes explicit steps above a stability limit lies: creep saturates, so that nothing blows
 * up at once. Which method a host has it does not say, but Euler's shows: each step is its length times the slope that was
 * read where it began. */
#include <math.h>
#include <string.h>

#include "method.h"

/* Steps in a row that identify Euler's method; steps between two checks; doublings of a step over which growth is computed;
 * refinement (power of 2) of the motion used for comparison. */
enum { STEPS_TO_TELL = 2, LOOK_EVERY = 64, DOUBLINGS = 10, FINER = 4 };
/* Growth of a disturbance, relative to that of the finer motion, above which the solution is unstable; growth above which
 * squaring ends. */
static const double UNSTABLE = 1e3, ENDLESS = 1e100;
/* Largest deviation from Euler's step, relative to its size. Smallest change of a slope within a step, relative to the nominal
 * value, at which no implicit method takes the same step. */
static const double MISSED = 1e-12, SEEN = 1e-9;

void explicit_host_begin(kernel *self) {
    memcpy(self->host.state, self->run.state, (size_t)self->system->states * sizeof(double));
    self->host.time = self->run.now->time;
    self->host.slope_known = false;
}

void explicit_host_read(kernel *self) {
    if (self->host.slope_known || self->run.now->time != self->host.time) return;
    const int n = self->system->states;
    for (int i = 0; i < n; ++i) {
        self->host.change[i] = self->work.slope[i] - self->host.slope[i];
        self->host.slope[i] = self->work.slope[i];
    }
    self->host.slope_known = true;
}

/* Return whether the step that ends here was one of Euler's method and not also one of an implicit method. */
static bool is_step_of_euler(const kernel *self, double size) {
    bool changed = false;
    if (!self->host.slope_known || !(size > 0.0)) return false;
    for (int i = 0; i < self->system->states; ++i) {
        const double way = size * self->host.slope[i], missed = self->run.state[i] - self->host.state[i] - way;
        if (fabs(missed) > MISSED * (fabs(self->run.state[i]) + fabs(way))) return false;
        changed |= size * fabs(self->host.change[i]) > SEEN * self->system->nominal[i];
    }
    return changed;
}

/* Largest growth of a disturbance, each state in its nominal value, over 2^DOUBLINGS steps of Euler's method, each in 2^finer
 * parts: (I + h J) squared as many times. */
static double growth_over_steps(kernel *self, double size, int finer) {
    const int n = self->system->states;
    double *matrix = self->host.growth, *square = self->host.square, largest = 1.0;
    linear_write_by_rows(self, matrix);
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const double scale = self->system->nominal[j] / self->system->nominal[i];
            matrix[i * n + j] = (i == j) + ldexp(size, -finer) * scale * matrix[i * n + j];
        }
    for (int doubling = 0; doubling < DOUBLINGS + finer && largest < ENDLESS; ++doubling) {
        largest = 0.0;
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) {
                double sum = 0.0;
                for (int k = 0; k < n; ++k) sum += matrix[i * n + k] * matrix[k * n + j];
                square[i * n + j] = sum;
                largest = fmax(largest, fabs(sum));
            }
        memcpy(matrix, square, (size_t)(n * n) * sizeof(double));
    }
    return largest;
}

kernel_status explicit_host_guard(kernel *self) {
    const double size = self->run.now->time - self->host.time;
    self->host.steps = is_step_of_euler(self, size) ? self->host.steps + 1 : 0;
    explicit_host_begin(self);
    if (self->run.now->guard_warned > 0.0 || self->host.steps % LOOK_EVERY != STEPS_TO_TELL) return KERNEL_OK;
    rosenbrock_linearise(self, 0.0, self->run.state);
    const double growth = growth_over_steps(self, size, 0);
    if (!(growth > UNSTABLE * growth_over_steps(self, size, FINER))) return KERNEL_OK;
    self->run.now->guard_warned = growth;
    char when[TIME_TEXT];
    return kernel_fail(self, KERNEL_WARNING,
                       "The host's steps of %.3g s by Euler's method are unstable at t = %s s: a disturbance grows %.1g-fold "
                       "within %d of them; do not trust the motion from here on, integrate with an implicit method such as "
                       "CVODE, or use co-simulation.",
                       size, time_text(self->run.now->time, 6, when), growth, 1 << DOUBLINGS);
}
