/* Generated functions at a place: with inputs, table pieces and modes as they are there. */
#include <math.h>

#include "instance.h"

static bool is_same(const double *numbers, const double *known, int lanes, int count) {
    for (int i = 0; i < count; ++i)
        if (numbers[i] != known[i * lanes]) return false;
    return true;
}

/* Return whether a function's results are known there; then copies them to `result`. */
static bool is_known(const kernel *self, const known_place *at, generated_function function, double offset, const double *state,
                     double **result) {
    const known_function *found = NULL;
    for (int i = 0; i < at->functions; ++i)
        if (at->function[i].function == function) found = &at->function[i];
    if (!found || at->offset != offset || !is_same(self->run.mode, at->mode + at->lane, at->lanes, self->system->frictions) ||
        !is_same(state, at->state + at->lane, at->lanes, self->system->states))
        return false;
    for (int n = 0; n < MOST_RESULTS && found->result[n]; ++n)
        for (int i = 0; i < found->size[n]; ++i) result[n][i] = found->result[n][i * at->lanes + at->lane];
    return true;
}

/* Calls a generated function at `offset` seconds after the start of the step, with the inputs and table pieces that the
 * call before it used: for a second function at the same place. */
void kernel_call(kernel *self, generated_function function, double offset, const double *state, double **result) {
    for (int n = 0; n < 2; ++n)
        if (self->known[n] && is_known(self, self->known[n], function, offset, state, result)) return;
    const double time = self->given.step_origin + offset;
    const double *argument[ARG_COUNT] = {&time,
                                         state,
                                         self->given.stage_input,
                                         self->given.rate,
                                         self->given.parameter,
                                         self->run.derived,
                                         self->run.mode,
                                         self->given.coefficient,
                                         self->given.seed};
    function(argument, result, NULL, NULL, self->lanes);
}

/* Look up the pieces of the table file of one rank, from `first` on, at the places in table_at. Most places are between the
 * same rows as before. Returns the index of the first of the next rank. */
static int look_up_rank(kernel *self, int first) {
    const system_description *system = self->system;
    int i = first;
    for (; i < system->tables && system->table[i].rank == system->table[first].rank; ++i) {
        const double at = self->given.table_at[i - first];
        double *held = self->given.held + 2 * i;
        if (!(at >= held[0] && at < held[1]))
            table_look_up(self->table, &system->table[i], at, &self->given.row[i], held,
                          self->given.coefficient + system->table[i].place);
    }
    return i;
}

void kernel_look_up(kernel *self, double offset, const double *state) {
    const system_description *system = self->system;
    for (int rank = 0, next = 0; rank < system->table_ranks; ++rank) {
        kernel_call(self, system->table_argument[rank], offset, state, &self->given.table_at);
        next = look_up_rank(self, next);
    }
}

void kernel_locate(kernel *self, double offset, const double *state) {
    for (int i = 0; i < self->system->inputs; ++i)
        self->given.stage_input[i] = self->given.input[i] + offset * self->given.rate[i];
    kernel_look_up(self, offset, state);
}

void kernel_evaluate_again(kernel *self, generated_function function, double offset, const double *state, double *result) {
    kernel_call(self, function, offset, state, &result);
}

void kernel_evaluate(kernel *self, generated_function function, double offset, const double *state, double *result) {
    kernel_locate(self, offset, state);
    kernel_call(self, function, offset, state, &result);
}

void kernel_gather_inputs(kernel *self) {
    for (int i = 0; i < self->system->inputs; ++i) {
        const int variable = self->system->input_variable[i];
        self->given.input[i] = self->run.value[variable];
        self->given.rate[i] = self->run.input_rate[variable];
    }
}

kernel_status kernel_prepare(kernel *self, const char *what) {
    if (!self->system) return kernel_fail(self, KERNEL_ERROR, "Initialise %s before %s.", MODEL.name, what);
    kernel_gather_inputs(self);
    self->given.step_origin = self->run.now->time;
    return KERNEL_OK;
}

void kernel_compute_outputs(kernel *self, double offset, const double *state) {
    const system_description *system = self->system;
    kernel_evaluate(self, system->output, offset, state, self->reading.output);
    for (int i = 0; i < system->outputs; ++i) self->run.value[system->output_variable[i]] = self->reading.output[i];
    for (int i = 0; i < system->states; ++i)
        if (system->state_variable[i] >= 0) self->run.value[system->state_variable[i]] = state[i];
}

const char *kernel_output_not_finite(const kernel *self) {
    for (int i = 0; i < self->system->outputs; ++i)
        if (!isfinite(self->reading.output[i])) return MODEL.variable[self->system->output_variable[i]].name;
    return NULL;
}
