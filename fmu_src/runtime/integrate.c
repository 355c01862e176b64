/* The step loop: steps whose error is controlled, or of the explicit method, and located switches. Implicit steps of a
 * fixed size are in fixed.c. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "method.h"

static const int MAXIMUM_SWITCHES = 1000;            /* beyond the steps that end without one; more is chatter */
/* A step that the host cuts below this share of what the accuracy allows is taken with a kept Jacobian, which serves as
 * long as the error of the step that took it would have allowed. */
static const double SHORT = 0.25;
/* Its error, in units of the tolerance: of the stiff creep at walking pace a whole tolerance is some per cent. */
static const double SHORT_ERROR = 0.3;
/* Short steps that go to the default method after one with a kept Jacobian failed. */
enum { PAUSE = 16 };

/* ---- one step --------------------------------------------------------------------------------------------------- */

typedef struct {
    double offset, remaining; /* since the start of the kernel_step, and to its end [s] */
    double margin;            /* of the modes at the end of the step found; negative: a switch lies within it */
    int trials;
} progress;

static bool start_exact_step(kernel *self, double offset) {
    rosenbrock_linearise(self, offset, self->run.state);
    if (algebraic_solve(self, offset, self->run.state, self->run.value[MODEL.tolerance])) return true;
    char when[CLOCK_SIZE];
    kernel_fail(self, KERNEL_ERROR, "The algebraic equations have no solution near t = %s s; check inputs and parameters.",
                kernel_clock(self->given.step_origin + offset, 9, when));
    return false;
}

static bool is_short(const kernel *self, const progress *now) {
    return !self->recorder && now->remaining <= SHORT * self->run.now->proposed_step;
}

/* A step to the end of the interval with the kept Jacobian. Returns its length; 0: the default method must take it. */
static double short_step(kernel *self, progress *now) {
    if (!is_short(self, now) || !reuse_serves(self, now->offset)) return 0.0;
    const double error = reuse_short_step(self, now->offset, now->remaining);
    if (!(error <= SHORT_ERROR)) {
        self->run.now->pause = PAUSE;
        return 0.0;
    }
    now->margin = modes_margin(self, now->offset + now->remaining, self->work.trial);
    return now->margin >= 0.0 ? now->remaining : 0.0;
}

/* Keeps the Jacobian of a short step for those that follow within the time `served`. */
static void keep_jacobian(kernel *self, const progress *now, double served) {
    if (!is_short(self, now)) return;
    if (self->run.now->pause > 0)
        self->run.now->pause--;
    else
        reuse_remember(self, now->offset, self->given.step_origin + now->offset + served);
}

/* Time until something limited has changed as much as a step may change it. */
static double longest_step(kernel *self, double offset) {
    const system_description *system = self->system;
    if (system->limits == 0) return INFINITY;
    if (self->work.method != METHOD_EXACT) kernel_evaluate(self, system->ode, offset, self->run.state, self->work.slope);
    kernel_evaluate(self, system->largest_change, offset, self->run.state, self->work.largest_change);
    double shares = 0.0; /* of what may change, in a second */
    for (int i = 0; i < system->limits; ++i) {
        const limited_change *of = &system->limited[i];
        const double rate = self->work.slope[of->state] + (of->other < 0 ? 0.0 : self->work.slope[of->other]);
        shares = fmax(shares, fabs(rate) / self->work.largest_change[i]);
    }
    return shares > 0.0 ? 1.0 / shares : INFINITY;
}

typedef struct {
    double size, error;
} rejected_trial;

/* The size at which the error of two rejected trials comes down to the tolerance, not below a tenth of the last: behind a
 * jump it falls with a lower power of the size than theory has. Infinite where the two do not tell. */
static double size_by_trials(rejected_trial before, rejected_trial last) {
    if (!(before.size > last.size && before.error > last.error)) return INFINITY;
    const double power = log(before.error / last.error) / log(before.size / last.size);
    return last.size * fmax(0.9 * pow(last.error, -1.0 / power), 0.1);
}

/* A step that the error control accepts. Returns its length; 0 after a failure, with the sentence set. */
static double adaptive_step(kernel *self, progress *now) {
    const rosenbrock_tableau *method = self->work.method == METHOD_REUSED ? &ROS34PW2 : &RODAS5P;
    const double proposed = self->run.now->proposed_step, remaining = now->remaining;
    if (self->work.method == METHOD_EXACT && !start_exact_step(self, now->offset)) return 0.0;
    const double longest = longest_step(self, now->offset);
    double wanted = fmin(proposed, longest);
    if (wanted > 0.5 * remaining) wanted = wanted < remaining ? 0.5 * remaining : remaining;
    rejected_trial before = {0.0, 0.0};
    for (double size = wanted;;) {
        char when[CLOCK_SIZE];
        const double time = self->given.step_origin + now->offset;
        if (++now->trials > MOST_TRIALS) {
            kernel_fail(self, KERNEL_ERROR, "No progress after %d steps at t = %s s; enlarge the tolerance %g.",
                        MOST_TRIALS, kernel_clock(time, 9, when), self->run.value[MODEL.tolerance]);
            return 0.0;
        }
        double error = integrate_try(self, now->offset, size);
        if (error <= 1.0) {
            now->margin = modes_margin(self, now->offset + size, self->work.trial);
            if (isnan(now->margin)) error = NAN;
        }
        const double next = rosenbrock_next_size(method, size, error);
        if (error <= 1.0) {
            /* A step cut short by the end of the interval says nothing against the longer one proposed before. */
            const bool cut = size == wanted && wanted < proposed && next < proposed;
            self->run.now->proposed_step = cut ? proposed : next;
            if (self->work.method == METHOD_EXACT)
                keep_jacobian(self, now, fmin(rosenbrock_allowed_size(method, size, error), longest));
            return size;
        }
        self->counters.rejected++;
        const rejected_trial last = {size, error};
        size = fmin(next, size_by_trials(before, last));
        before = last;
        if (size < 1e-15 + 4.0 * DBL_EPSILON * now->offset) {
            kernel_fail(self, KERNEL_ERROR,
                        "The step size vanished at t = %s s: the equations have no finite solution there, or the "
                        "tolerance %g is below round-off; check inputs and parameters, or enlarge the tolerance.",
                        kernel_clock(time, 9, when), self->run.value[MODEL.tolerance]);
            return 0.0;
        }
    }
}

/* A step of integration_step seconds with the explicit method. Returns its length, 0 after a failure. */
static double explicit_step(kernel *self, progress *now, kernel_status *status) {
    const double size = integrate_fixed_size(self, now->remaining);
    if (runge_kutta_guard(self, now->offset, size) != KERNEL_OK) *status = KERNEL_WARNING;
    const double error = runge_kutta_try(self, now->offset, size);
    now->margin = isfinite(error) ? modes_margin(self, now->offset + size, self->work.trial) : NAN;
    if (!isnan(now->margin)) return size;
    (void)integrate_fixed_failed(self, now->offset, size);
    return 0.0;
}

static double next_step(kernel *self, progress *now, kernel_status *status) {
    if (self->work.method == METHOD_EXPLICIT) return explicit_step(self, now, status);
    const double cut = self->work.method == METHOD_EXACT ? short_step(self, now) : 0.0;
    return cut > 0.0 ? cut : adaptive_step(self, now);
}

static void accept(kernel *self) {
    memcpy(self->run.state, self->work.trial, (size_t)self->system->states * sizeof(double));
    modes_hold(self, self->run.state);
    if (self->run.now->kept_steps >= 0) self->run.now->kept_steps++;
    self->counters.steps++;
}

/* ---- the loop --------------------------------------------------------------------------------------------------- */

/* Whether steps end in a switch so often that the motion no longer goes on. The count outlives a kernel_step: at rest an
 * explicit method switches thousands of times within each of a host's steps, and never comes to an end. */
static bool chatters(kernel *self, bool crossing) {
    if (crossing)
        self->run.now->switches++;
    else if (self->run.now->switches > 0)
        self->run.now->switches--;
    return self->run.now->switches > MAXIMUM_SWITCHES;
}

static const char *remedy_of_chatter(const kernel *self) {
    return self->work.method == METHOD_EXPLICIT ? "above its stability limit an explicit method cannot come to rest, choose "
                                             "integration_method 1"
                                           : "check inputs and parameters";
}

kernel_status integrate(kernel *self, double size, double *reached) {
    if (self->run.value[MODEL.integration_step] > 0.0 && self->work.method != METHOD_EXPLICIT)
        return integrate_fixed(self, size, reached);
    kernel_status status = KERNEL_OK;
    progress now = {0.0, size, INFINITY, 0};
    self->work.algebraic_serve = 0;
    modes_refresh(self, 0.0);
    if (self->recorder) record_until(self, 0.0, 0.0, 0.0);
    while (now.offset < size) {
        now.remaining = size - now.offset;
        double step = next_step(self, &now, &status);
        if (step == 0.0) return KERNEL_ERROR;
        const bool crossing = now.margin < 0.0;
        if (crossing) step = modes_locate(self, now.offset, step);
        if (self->recorder) record_until(self, now.offset, step, now.offset + step);
        const double arrival = step == now.remaining ? size : now.offset + step;
        accept(self);
        now.offset = arrival;
        if (chatters(self, crossing)) {
            char when[CLOCK_SIZE];
            return kernel_fail(self, KERNEL_ERROR,
                               "More than %d switches between sliding and sticking with hardly a step between them up to "
                               "t = %s s: a friction chatters; %s.",
                               MAXIMUM_SWITCHES, kernel_clock(self->given.step_origin + now.offset, 9, when),
                               remedy_of_chatter(self));
        }
        if (crossing) {
            self->run.now->ended = modes_switch(self, now.offset, -INFINITY);
            if (self->run.now->ended || self->asked.stops_at_events) break;
        }
        if (modes_warn(self, now.offset)) status = KERNEL_WARNING;
    }
    *reached = now.offset;
    return status;
}
