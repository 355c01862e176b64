/* Steps of integration_step seconds with the implicit methods. Their error is not controlled; a warning reports a large one.
 *
 * Each step costs the same: a Jacobian, a correction of the algebraic states, the stages of the method and a round of modes. No
 * step is repeated, shortened or divided. A switch within a step takes effect at its end, so an event is up to a step late. */
#include <math.h>
#include <string.h>

#include "stepper.h"

/* Warn when the local error exceeds the tolerance, and again when it is ten times the one last reported. */
static kernel_status guard_error(kernel *self, double time, double size, double error) {
    if (!(error > 1.0) || error < 10.0 * self->run.now->guard_warned) return KERNEL_OK;
    self->run.now->guard_warned = error;
    if (!kernel_is_heard(self, KERNEL_WARNING)) return KERNEL_WARNING;
    char when[TIME_TEXT];
    return kernel_fail(self, KERNEL_WARNING,
                       "The local error of the fixed step of %.3g s is %.2g times the tolerance %g at t = %s s; "
                       "shorten integration_step, or set it to 0 for steps chosen by the error.",
                       size, error, self->run.value[MODEL.tolerance], time_text(time, 6, when));
}

/* Return 1 + index of an end condition that is reached at the state; 0: none, -1: it is not a number. */
static int find_end(kernel *self, double offset) {
    const system_description *system = self->system;
    double *margin = self->modes.margin + system->frictions;
    if (system->conditions) kernel_evaluate_again(self, system->condition_margin, offset, self->run.state, margin);
    for (int i = 0; i < system->ends; ++i)
        if (!(margin[i] >= 0.0)) return isnan(margin[i]) ? -1 : 1 + i;
    return 0;
}

void fixed_failed(kernel *self, stepper *run) {
    char when[TIME_TEXT];
    run->phase = STEPPER_DONE;
    run->status = kernel_fail(self, KERNEL_ERROR,
                              "The fixed step of %.3g s finds no finite motion at t = %s s; shorten integration_step, or set "
                              "it to 0 for steps chosen by the error.",
                              run->size, time_text(self->given.step_origin + run->offset, 9, when));
}

double fixed_size(const kernel *self, double remaining) {
    const double fixed = self->run.value[MODEL.integration_step];
    return remaining <= fixed * (1.0 + 1e-6) ? remaining : fixed;
}

void fixed_begin(kernel *self, stepper *run) {
    (void)modes_settle(self, run->offset); /* the inputs are new */
    if (self->recorder) record_until(self, 0.0, 0.0, 0.0);
}

void fixed_ask(kernel *self, stepper *run) {
    run->size = fixed_size(self, run->remaining);
    rosenbrock_linearise(self, run->offset, self->run.state);
    run->phase = STEPPER_TRIES;
    if (!algebraic_correct(self, self->run.state, self->run.value[MODEL.tolerance])) fixed_failed(self, run);
}

void fixed_take(kernel *self, stepper *run, double error) {
    const double offset = run->offset, step = run->size;
    if (!isfinite(error)) {
        fixed_failed(self, run);
        return;
    }
    if (guard_error(self, self->given.step_origin + offset, step, error) != KERNEL_OK) run->status = KERNEL_WARNING;
    if (self->recorder) record_until(self, offset, step, offset + step * (1.0 - 1e-9));
    memcpy(self->run.state, self->work.trial, (size_t)self->system->states * sizeof(double));
    modes_hold(self, self->run.state);
    self->counters.steps++;
    stepper_go_on(run);
    const bool switched = modes_settle(self, run->offset);
    const int end = find_end(self, run->offset);
    if (end < 0) {
        run->offset = offset;
        fixed_failed(self, run);
        return;
    }
    if (self->recorder) record_until(self, run->offset, 0.0, run->offset);
    self->run.now->ended = end;
    if (end || (switched && self->requested.stops_at_events)) run->phase = STEPPER_DONE;
    else if (modes_warn(self, run->offset)) run->status = KERNEL_WARNING;
}
