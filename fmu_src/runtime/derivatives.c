/* Derivatives of outputs, and the linearisation, at the present state. */
#include <math.h>
#include <string.h>

#include "method.h"

/* Derivatives of all outputs along the seed (time, states, inputs), whose algebraic states follow from the residuals. */
static kernel_status differentiate_outputs(kernel *self, const double *place) {
    const system_description *system = self->system;
    double *follow = self->work.follow;
    char when[TIME_TEXT];
    if (system->residual_along) {
        for (int i = 0; i < system->algebraics; ++i) self->given.seed[1 + system->algebraic[i]] = 0.0;
        kernel_evaluate(self, system->residual_along, 0.0, place, follow);
        if (!linear_factorise_algebraic(self, &self->work.algebraic, self->work.jacobian))
            return kernel_fail(self, KERNEL_ERROR, "The outputs have no derivatives at t = %s s.",
                               time_text(self->run.now->time, 9, when));
        linear_solve_algebraic(&self->work.algebraic, follow);
        for (int i = 0; i < system->algebraics; ++i) self->given.seed[1 + system->algebraic[i]] = -follow[i];
    }
    kernel_evaluate(self, system->output_along, 0.0, place, self->reading.output_rate);
    for (int i = 0; i < system->outputs; ++i)
        if (!isfinite(self->reading.output_rate[i]))
            return kernel_fail(self, KERNEL_ERROR, "The output %s has no finite derivative at t = %s s.",
                               MODEL.variable[system->output_variable[i]].name, time_text(self->run.now->time, 9, when));
    return KERNEL_OK;
}

/* Return the place of the derivatives, linearised, with an empty seed; NULL, with an error, if that fails. */
static const double *prepare_derivatives(kernel *self) {
    char when[TIME_TEXT];
    if (kernel_prepare(self, "its derivatives") != KERNEL_OK) return NULL;
    const double *place = algebraic_place(self);
    if (!place) {
        (void)kernel_fail(self, KERNEL_ERROR, "The equations have no solution at t = %s s; check inputs and parameters.",
                          time_text(self->run.now->time, 9, when));
        return NULL;
    }
    rosenbrock_linearise(self, 0.0, place);
    memset(self->given.seed, 0, (size_t)(1 + self->system->states + self->system->inputs) * sizeof(double));
    return place;
}

/* Compute derivatives of all slopes along the seed, in reading.slope_change: by states from the Jacobian, by inputs from the
 * change of the time derivative when their rates change by the seed. */
static void differentiate_slopes(kernel *self, const double *place) {
    const int n = self->system->states;
    for (int i = 0; i < n; ++i) self->reading.slope_change[i] = -self->work.time_slope[i];
    for (int i = 0; i < self->system->inputs; ++i) self->given.rate[i] += self->given.seed[1 + n + i];
    rosenbrock_linearise(self, 0.0, place);
    for (int i = 0; i < n; ++i) self->reading.slope_change[i] += self->work.time_slope[i];
    linear_add_product(self, self->given.seed + 1, self->reading.slope_change);
}

/* Return the derivative of one slope of model exchange; 0 if the system does not have that state. */
static kernel_status pick_slope(kernel *self, int number, double *result) {
    const int state = exchange_state(self, number);
    char when[TIME_TEXT];
    *result = state < 0 ? 0.0 : self->reading.slope_change[state];
    if (isfinite(*result)) return KERNEL_OK;
    return kernel_fail(self, KERNEL_ERROR, "The slope of %s has no finite derivative at t = %s s.",
                       MODEL.variable[self->system->state_variable[state]].name, time_text(self->run.now->time, 9, when));
}

/* Copy the derivatives of some outputs; those that the system does not have are constant. */
static kernel_status pick_derivatives(kernel *self, int count, const int *variable, double *result) {
    for (int i = 0; i < count; ++i) {
        const kernel_status status = kernel_check_reference(self, variable[i]);
        if (status != KERNEL_OK) return status;
        const variable_description *description = &MODEL.variable[variable[i]];
        if (description->causality < CAUSALITY_OUTPUT || description->kind != KIND_REAL)
            return kernel_fail(self, KERNEL_ERROR, "A derivative must be of a real output; got %s.", description->name);
        result[i] = 0.0;
        for (int j = 0; j < self->system->states; ++j)
            if (self->system->state_variable[j] == variable[i]) result[i] = self->given.seed[1 + j];
        for (int j = 0; j < self->system->outputs; ++j)
            if (self->system->output_variable[j] == variable[i]) result[i] = self->reading.output_rate[j];
    }
    return KERNEL_OK;
}

kernel_status kernel_get_rates(kernel *self, int count, const int *variable, double *rate) {
    const double *place = prepare_derivatives(self);
    if (!place) return KERNEL_ERROR;
    const system_description *system = self->system;
    self->given.seed[0] = 1.0;
    memcpy(self->given.seed + 1, self->work.slope, (size_t)system->states * sizeof(double));
    for (int i = 0; i < system->inputs; ++i)
        self->given.seed[1 + system->states + i] = self->run.last_rate[system->input_variable[i]];
    const kernel_status status = differentiate_outputs(self, place);
    return status == KERNEL_OK ? pick_derivatives(self, count, variable, rate) : status;
}

static bool asks_for_slopes(int count, const int *variable) {
    for (int i = 0; i < count; ++i)
        if (kernel_exchanged_number(variable[i]) >= 0) return true;
    return false;
}

kernel_status kernel_get_directional(kernel *self, int unknowns, const int *unknown, int knowns, const int *known,
                                     const double *change, double *result) {
    const double *place = prepare_derivatives(self);
    if (!place) return KERNEL_ERROR;
    kernel_status status = KERNEL_OK;
    const system_description *system = self->system;
    for (int i = 0; i < knowns; ++i) {
        status = kernel_check_reference(self, known[i]);
        if (status != KERNEL_OK) return status;
        const variable_description *description = &MODEL.variable[known[i]];
        const bool taken = description->causality == CAUSALITY_INPUT || description->causality == CAUSALITY_LOCAL;
        if (!taken || description->kind != KIND_REAL)
            return kernel_fail(self, KERNEL_ERROR, "A derivative must be with respect to a real input or state; got %s.",
                               description->name);
        for (int j = 0; j < system->states; ++j)
            if (system->state_variable[j] == known[i]) self->given.seed[1 + j] += change[i];
        for (int j = 0; j < system->inputs; ++j)
            if (system->input_variable[j] == known[i]) self->given.seed[1 + system->states + j] += change[i];
    }
    status = differentiate_outputs(self, place);
    if (status == KERNEL_OK && asks_for_slopes(unknowns, unknown)) differentiate_slopes(self, place);
    for (int i = 0; i < unknowns && status == KERNEL_OK; ++i) {
        const int number = kernel_exchanged_number(unknown[i]);
        status = number >= 0 && number < kernel_exchange_states() ? pick_slope(self, number, &result[i])
                                                                  : pick_derivatives(self, 1, &unknown[i], &result[i]);
    }
    return status;
}
