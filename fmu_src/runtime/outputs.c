/* Reading the table of variables: outputs belong to the present state and the present inputs. */
#include "method.h"

/* Compute outputs after an input was set. They stay stale if they are not finite, so that the next reading reports it
 * again. */
static kernel_status renew_outputs(kernel *self) {
    (void)kernel_prepare(self, "its outputs");
    const double *state = algebraic_place(self);
    if (!state) {
        char when[TIME_TEXT];
        return kernel_fail(self, KERNEL_ERROR,
                           "The equations have no solution at t = %s s with these inputs; set others, or restore a state.",
                           time_text(self->run.now->time, 9, when));
    }
    kernel_compute_outputs(self, 0.0, state);
    const char *bad = kernel_output_not_finite(self);
    if (bad) return kernel_fail(self, KERNEL_ERROR, "The output %s is not a finite number at these inputs.", bad);
    self->run.now->outputs_stale = false;
    return KERNEL_OK;
}

kernel_status kernel_get(kernel *self, int variable, double *value) {
    kernel_status status = kernel_check_reference(self, variable);
    if (status != KERNEL_OK) return status;
    const variable_description *description = &MODEL.variable[variable];
    if (description->kind == KIND_STRING)
        return kernel_fail(self, KERNEL_ERROR, "%s must be set and read as a text; got a call for a number.",
                           description->name);
    const bool follows = description->causality >= CAUSALITY_OUTPUT;
    if (follows && !self->system)
        return kernel_fail(self, KERNEL_ERROR, "%s has a value from the initialisation on; initialise %s first.",
                           description->name, MODEL.name);
    if (follows && self->run.now->outputs_stale) status = renew_outputs(self);
    if (status == KERNEL_OK) *value = self->run.value[variable];
    return status;
}
