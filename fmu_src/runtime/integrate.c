/* The steps of a kernel_step: those whose error is controlled, or of the explicit method, up to switches that are located.
 * Implicit steps of a fixed size are in fixed.c. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "own_functions.h"
#include "stepper.h"

static const int MAXIMUM_SWITCHES = 1000;            /* beyond the steps that end without one; more is chatter */
/* If the host cuts a step below this share of the size that the accuracy allows, it is taken with a kept Jacobian. That
 * Jacobian is used for as long as the error of its own step would have allowed. */
static const double SHORT = 0.25;
/* Its error, in units of the tolerance: of the stiff creep at walking pace a whole tolerance is some per cent. */
static const double SHORT_ERROR = 0.3;
/* Short steps that go to the default method after one with a kept Jacobian failed. */
enum { PAUSE = 16 };

/* ---- one step --------------------------------------------------------------------------------------------------- */

static void fail(stepper *run) {
    run->status = KERNEL_ERROR;
    run->phase = STEPPER_DONE;
}

static bool is_short(const kernel *self, const stepper *run) {
    return !self->recorder && run->remaining <= SHORT * self->run.now->proposed_step;
}

/* Try a step to the end of the interval with the kept Jacobian; return whether it succeeded. */
static bool short_step(kernel *self, stepper *run) {
    if (!is_short(self, run) || !reuse_serves(self, run->offset)) return false;
    const double error = reuse_short_step(self, run->offset, run->remaining);
    if (!(error <= SHORT_ERROR)) {
        self->run.now->pause = PAUSE;
        return false;
    }
    run->size = run->remaining;
    run->margin = modes_margin(self, run->offset + run->remaining, self->work.trial);
    return run->margin >= 0.0;
}

/* Keep the Jacobian of a short step for those that follow within the time `served`. */
static void keep_jacobian(kernel *self, const stepper *run, double served) {
    if (!is_short(self, run)) return;
    if (self->run.now->pause > 0) self->run.now->pause--;
    else reuse_remember(self, run->offset, self->given.step_origin + run->offset + served);
}

/* Time until something limited has changed as much as a step may change it. */
static double longest_step(kernel *self, double offset) {
    const system_description *system = self->system;
    if (system->limits == 0) return INFINITY;
    if (self->work.method != METHOD_EXACT) kernel_evaluate(self, system->ode, offset, self->run.state, self->work.slope);
    kernel_evaluate(self, system->largest_change, offset, self->run.state, self->work.largest_change);
    double shares = 0.0; /* largest share of an allowed change per second */
    for (int i = 0; i < system->limits; ++i) {
        const limited_change *of = &system->limited[i];
        const double rate = self->work.slope[of->state] + (of->other < 0 ? 0.0 : self->work.slope[of->other]);
        shares = fmax(shares, fabs(rate) / self->work.largest_change[i]);
    }
    return shares > 0.0 ? 1.0 / shares : INFINITY;
}

/* Return the size at which the error of two rejected trials falls to the tolerance, at least a tenth of the last size. After a
 * jump the error falls with a lower power of the size than in theory. Infinite if the two give no such power. */
static double size_by_trials(rejected_trial before, rejected_trial last) {
    if (!(before.size > last.size && before.error > last.error)) return INFINITY;
    const double power = own_log(before.error / last.error) / own_log(before.size / last.size);
    return last.size * fmax(0.9 * own_pow(last.error, -1.0 / power), 0.1);
}

/* Begin a step with error control: request its first trial. */
static void ask_adaptive(kernel *self, stepper *run) {
    run->phase = STEPPER_TRIES;
    run->proposed = self->run.now->proposed_step;
    if (self->work.method == METHOD_EXACT && !algebraic_begin(self, run->offset, self->run.value[MODEL.tolerance])) {
        fail(run);
        return;
    }
    run->longest = longest_step(self, run->offset);
    double wanted = fmin(run->proposed, run->longest);
    if (wanted > 0.5 * run->remaining) wanted = wanted < run->remaining ? 0.5 * run->remaining : run->remaining;
    run->size = run->wanted = wanted;
    run->before.size = run->before.error = 0.0;
}

/* Return whether the trial is accepted; set the size that is proposed next. */
static bool is_accepted(kernel *self, stepper *run, double error, double next) {
    if (!(error <= 1.0)) return false;
    /* A step cut short by the end of the interval is no reason to shorten the size proposed before. */
    const bool cut = run->size == run->wanted && run->wanted < run->proposed && next < run->proposed;
    self->run.now->proposed_step = cut ? run->proposed : next;
    if (self->work.method == METHOD_EXACT)
        keep_jacobian(self, run, fmin(rosenbrock_allowed_size(rosenbrock_method(self), run->size, error), run->longest));
    return true;
}

/* Return whether the run has used up its trials; then it fails. */
static bool is_stuck(kernel *self, stepper *run) {
    if (++run->tried <= MOST_TRIALS) return false;
    char when[TIME_TEXT];
    kernel_fail(self, KERNEL_ERROR, "No progress after %d steps at t = %s s; enlarge the tolerance %g.", MOST_TRIALS,
                time_text(self->given.step_origin + run->offset, 9, when), self->run.value[MODEL.tolerance]);
    fail(run);
    return true;
}

/* Request a shorter trial, or fail. */
static void shorten(kernel *self, stepper *run, double error, double next) {
    char when[TIME_TEXT];
    const double time = self->given.step_origin + run->offset;
    const rejected_trial last = {run->size, error};
    self->counters.rejected++;
    run->size = fmin(next, size_by_trials(run->before, last));
    run->before = last;
    if (run->size < 1e-15 + 4.0 * DBL_EPSILON * run->offset) {
        kernel_fail(self, KERNEL_ERROR,
                    "The step size vanished at t = %s s: the equations have no finite solution there, or the "
                    "tolerance %g is below round-off; check inputs and parameters, or enlarge the tolerance.",
                    time_text(time, 9, when), self->run.value[MODEL.tolerance]);
        fail(run);
    }
}

/* Make a step of integration_step seconds with the explicit method; return whether its end is finite. */
static bool explicit_step(kernel *self, stepper *run) {
    run->size = fixed_size(self, run->remaining);
    if (runge_kutta_guard(self, run->offset, run->size) != KERNEL_OK) run->status = KERNEL_WARNING;
    const double error = runge_kutta_try(self, run->offset, run->size);
    run->margin = isfinite(error) ? modes_margin(self, run->offset + run->size, self->work.trial) : NAN;
    if (!isnan(run->margin)) return true;
    fixed_failed(self, run);
    return false;
}

static void accept(kernel *self) {
    memcpy(self->run.state, self->work.trial, (size_t)self->system->states * sizeof(double));
    modes_hold(self, self->run.state);
    if (self->run.now->kept_steps >= 0) self->run.now->kept_steps++;
    self->counters.steps++;
}

/* ---- the loop --------------------------------------------------------------------------------------------------- */

/* Return whether steps end in a switch so often that the motion no longer advances. The count is kept between kernel_steps: at
 * rest an explicit method switches thousands of times within each communication step, and never comes to an end. */
static bool chatters(kernel *self, bool crossing) {
    if (crossing) self->run.now->switches++;
    else if (self->run.now->switches > 0) self->run.now->switches--;
    return self->run.now->switches > MAXIMUM_SWITCHES;
}

static const char *remedy_of_chatter(const kernel *self) {
    return self->work.method == METHOD_EXPLICIT ? "above its stability limit an explicit method cannot come to rest, choose "
                                                  "integration_method 1"
                                                : "check inputs and parameters";
}

/* End a step of `size`, at a switch or before one. */
static void arrive(kernel *self, stepper *run, bool crossing) {
    if (self->recorder) record_until(self, run->offset, run->size, run->offset + run->size);
    stepper_go_on(run);
    accept(self);
    if (chatters(self, crossing)) {
        char when[TIME_TEXT];
        kernel_fail(self, KERNEL_ERROR,
                    "More than %d switches between sliding and sticking with hardly a step between them up to "
                    "t = %s s: a friction chatters; %s.",
                    MAXIMUM_SWITCHES, time_text(self->given.step_origin + run->offset, 9, when), remedy_of_chatter(self));
        fail(run);
        return;
    }
    if (crossing) {
        self->run.now->ended = modes_switch(self, run->offset, -INFINITY);
        if (self->run.now->ended || self->requested.stops_at_events) {
            run->phase = STEPPER_DONE;
            return;
        }
    }
    if (modes_warn(self, run->offset)) run->status = KERNEL_WARNING;
}

/* A step that was found, with the margin at its end. */
static void take_found(kernel *self, stepper *run) {
    if (run->margin < 0.0) locate_begin(self, run);
    else arrive(self, run, false);
}

void stepper_begin(kernel *self, stepper *run, double size) {
    memset(run, 0, sizeof *run);
    run->phase = STEPPER_BEGINS;
    run->whole = size;
    run->fixed = self->run.value[MODEL.integration_step] > 0.0 && self->work.method != METHOD_EXPLICIT;
    self->work.algebraic_serve = false;
    if (run->fixed) {
        fixed_begin(self, run);
        return;
    }
    modes_refresh(self, 0.0);
    if (self->recorder) record_until(self, 0.0, 0.0, 0.0);
}

void stepper_ask(kernel *self, stepper *run) {
    if (run->phase != STEPPER_BEGINS) return;
    run->remaining = run->whole - run->offset;
    if (run->fixed) fixed_ask(self, run);
    else if (self->work.method == METHOD_EXPLICIT ? explicit_step(self, run)
                                                  : self->work.method == METHOD_EXACT && short_step(self, run))
        take_found(self, run);
    else if (run->phase == STEPPER_BEGINS) ask_adaptive(self, run);
}

double stepper_try(kernel *self, const stepper *run) {
    if (run->fixed) return rosenbrock_try(self, rosenbrock_method(self), run->offset, run->size);
    switch (self->work.method) {
    case METHOD_REUSED: return reuse_try(self, run->offset, run->size);
    case METHOD_EXPLICIT: return runge_kutta_try(self, run->offset, run->size);
    default: return rosenbrock_try(self, &RODAS5P, run->offset, run->size);
    }
}

void stepper_take(kernel *self, stepper *run, double error) {
    if (run->fixed) {
        fixed_take(self, run, error);
    } else if (run->phase == STEPPER_ARRIVES) {
        arrive(self, run, true);
    } else if (run->phase == STEPPER_LOCATES) {
        locate_take(self, run);
    } else if (!is_stuck(self, run)) {
        run->margin = INFINITY;
        if (error <= 1.0) run->margin = modes_margin(self, run->offset + run->size, self->work.trial);
        if (isnan(run->margin)) error = NAN;
        const double next = rosenbrock_next_size(rosenbrock_method(self), run->size, error);
        if (is_accepted(self, run, error, next)) take_found(self, run);
        else shorten(self, run, error, next);
    }
}

kernel_status integrate(kernel *self, double size, double *reached) {
    stepper run;
    stepper_begin(self, &run, size);
    for (;;) {
        stepper_ask(self, &run);
        if (run.phase == STEPPER_DONE) break;
        if (run.phase != STEPPER_BEGINS) stepper_take(self, &run, stepper_try(self, &run));
    }
    *reached = run.offset;
    return run.status;
}
