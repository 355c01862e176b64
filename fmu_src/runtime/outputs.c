/* What is read of the table of variables: outputs are those of the present state and of the inputs as they are now. */
#include "internal.h"

/* Outputs after an input was set. They stay stale where they are no numbers, so that the next reading says so again. */
static int renew_outputs(kernel *self) {
    kernel_gather_inputs(self);
    self->step_origin = self->now.time;
    const double *state = algebraic_place(self);
    if (!state) {
        char when[CLOCK_SIZE];
        return kernel_fail(self, KERNEL_ERROR,
                           "The equations have no solution at t = %s s with these inputs; set others, or restore a state.",
                           kernel_clock(self->now.time, 9, when));
    }
    kernel_compute_outputs(self, 0.0, state);
    const char *bad = kernel_output_not_finite(self);
    if (bad) return kernel_fail(self, KERNEL_ERROR, "The output %s is not a finite number at these inputs.", bad);
    self->now.outputs_stale = 0;
    return KERNEL_OK;
}

int kernel_get(kernel *self, int variable, double *value) {
    int status = kernel_check_reference(self, variable);
    if (status != KERNEL_OK) return status;
    const variable_description *description = &MODEL.variable[variable];
    if (description->kind == KIND_STRING)
        return kernel_fail(self, KERNEL_ERROR, "%s is a text, no number.", description->name);
    const int follows = description->causality >= CAUSALITY_OUTPUT;
    if (follows && !self->system)
        return kernel_fail(self, KERNEL_ERROR, "%s has a value from the initialisation on; initialise %s first.",
                           description->name, MODEL.name);
    if (follows && self->now.outputs_stale) status = renew_outputs(self);
    if (status == KERNEL_OK) *value = self->value[variable];
    return status;
}
