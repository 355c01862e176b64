/* The equations for other methods: slopes, margins of switches, and arrival where such a method has gone. */
#include <string.h>

#include "method.h"
#include "studies.h"

/* Scaled change of algebraic states below which another method sees no noise. */
static const double SOLVED = 1e-13;

/* Takes the state to a place; *offset is its time since the kernel's own, from where ramps of inputs go on. */
static kernel_status move_to(kernel *self, double time, const double *place, double *offset) {
    const kernel_status status = kernel_prepare(self, "its equations");
    if (status != KERNEL_OK) return status;
    for (int i = 0, k = 0; i < self->system->states; ++i)
        if (self->work.differential[i] != 0.0) self->run.state[i] = place[k++];
    *offset = time - self->run.now->time;
    self->run.now->outputs_stale = true;
    memcpy(self->work.trial, self->run.state, (size_t)self->system->states * sizeof(double));
    if (algebraic_find(self, *offset, self->run.state, SOLVED)) return KERNEL_OK;
    memcpy(self->run.state, self->work.trial, (size_t)self->system->states * sizeof(double));
    char when[TIME_TEXT];
    return kernel_fail(self, KERNEL_ERROR, "The algebraic equations have no solution near t = %s s.", time_text(time, 9, when));
}

static void copy_differential(const kernel *self, const double *all, double *some) {
    for (int i = 0, k = 0; i < self->system->states; ++i)
        if (self->work.differential[i] != 0.0) some[k++] = all[i];
}

kernel_status kernel_slopes_at(kernel *self, double time, const double *place, double *slope, double *jacobian) {
    double offset;
    char when[TIME_TEXT];
    const kernel_status status = move_to(self, time, place, &offset);
    if (status != KERNEL_OK) return status;
    copy_differential(self, self->work.slope, slope);
    if (jacobian && !algebraic_reduce(self, offset, jacobian))
        return kernel_fail(self, KERNEL_ERROR, "The equations have no Jacobian at t = %s s.", time_text(time, 9, when));
    return KERNEL_OK;
}

kernel_status kernel_equations_at(kernel *self, double time, const double *state, double *slope, double *jacobian) {
    const kernel_status status = kernel_prepare(self, "its equations");
    if (status != KERNEL_OK) return status;
    const double offset = time - self->run.now->time;
    kernel_evaluate(self, self->system->ode, offset, state, slope);
    self->counters.right_hand_sides++;
    if (!jacobian) return KERNEL_OK;
    rosenbrock_linearise(self, offset, state);
    linear_write_by_rows(self, jacobian);
    return KERNEL_OK;
}

kernel_status kernel_margin_at(kernel *self, double time, const double *place, double *margin) {
    double offset;
    const kernel_status status = move_to(self, time, place, &offset);
    if (status == KERNEL_OK) *margin = modes_margin(self, offset, self->run.state);
    return status;
}

kernel_status kernel_arrive(kernel *self, double time, double *place, bool crossed) {
    double offset;
    const kernel_status status = move_to(self, time, place, &offset);
    if (status != KERNEL_OK) return status;
    const double margin = modes_margin(self, offset, self->run.state);
    if (margin < 0.0 || crossed) self->run.now->ended = modes_switch(self, offset, margin);
    for (int i = 0; i < self->system->inputs; ++i) {
        const int variable = self->system->input_variable[i];
        self->run.value[variable] += offset * self->run.input_rate[variable];
    }
    self->run.now->time = time;
    copy_differential(self, self->run.state, place);
    return KERNEL_OK;
}
