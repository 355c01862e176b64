/* An instance: its memory in one block, and small questions about it. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "internal.h"

/* The largest of each dimension over the systems, so that one block fits whichever is chosen. */
static system_description largest_dimensions(void) {
    system_description most = MODEL.system[0];
    for (int i = 1; i < MODEL.systems; ++i) {
        const system_description *one = &MODEL.system[i];
#define GROW(member) \
    if (one->member > most.member) most.member = one->member
        GROW(states);
        GROW(algebraics);
        GROW(nonzeros);
        GROW(factors);
        GROW(inputs);
        GROW(parameters);
        GROW(derived);
        GROW(frictions);
        GROW(tables);
        GROW(table_coefficients);
        GROW(outputs);
        GROW(conditions);
        GROW(limits);
#undef GROW
    }
    return most;
}

static double *carve(double *block, size_t *used, int count) {
    double *start = block ? block + *used : NULL;
    *used += (size_t)count;
    return start;
}

/* Lays the arrays out in one block, or only counts the doubles when `block` is null. */
static size_t lay_out(kernel *self, double *block) {
    const system_description most = largest_dimensions();
    const int n = most.states;
    size_t used = 0;
    self->value = carve(block, &used, MODEL.variables);
    self->input_rate = carve(block, &used, MODEL.variables);
    self->last_rate = carve(block, &used, MODEL.variables);
    self->state = carve(block, &used, n);
    self->mode = carve(block, &used, most.frictions);
    self->said = carve(block, &used, most.conditions);
    self->derived = carve(block, &used, most.derived);
    self->kept_state = carve(block, &used, n);
    self->kept_input = carve(block, &used, most.inputs);
    self->kept_mode = carve(block, &used, most.frictions);
    self->restored = used;
    self->backup = carve(block, &used, (int)self->restored);
    self->parameter = carve(block, &used, most.parameters);
    self->input = carve(block, &used, most.inputs);
    self->rate = carve(block, &used, most.inputs);
    self->stage_input = carve(block, &used, most.inputs);
    self->coefficient = carve(block, &used, most.table_coefficients);
    self->table_at = carve(block, &used, most.tables);
    self->held = carve(block, &used, 2 * most.tables);
    self->trial = carve(block, &used, n);
    self->slope = carve(block, &used, n);
    self->time_slope = carve(block, &used, n);
    self->jacobian = carve(block, &used, most.nonzeros);
    self->kept_jacobian = carve(block, &used, most.nonzeros);
    self->whole.packed = carve(block, &used, most.factors);
    self->kept.packed = carve(block, &used, most.factors);
    self->algebraic.matrix = carve(block, &used, most.algebraics * most.algebraics);
    self->kept_algebraic.matrix = carve(block, &used, most.algebraics * most.algebraics);
    self->dense.matrix = carve(block, &used, n * n);
    for (int i = 0; i < MOST_STAGES; ++i) self->stage[i] = carve(block, &used, n);
    self->point = carve(block, &used, n);
    self->between = carve(block, &used, n);
    self->place_read = carve(block, &used, n);
    self->host_state = carve(block, &used, n);
    self->host_slope = carve(block, &used, n);
    self->host_change = carve(block, &used, n);
    self->host_growth = carve(block, &used, 2 * kernel_exchange_states() * kernel_exchange_states());
    self->first_slope = carve(block, &used, n);
    self->last_slope = carve(block, &used, n);
    self->ordered = carve(block, &used, 2 * n);
    self->differential = carve(block, &used, n);
    self->drive = carve(block, &used, most.frictions);
    self->capacity = carve(block, &used, 2 * most.frictions);
    self->margin = carve(block, &used, most.frictions + most.conditions);
    self->output = carve(block, &used, most.outputs);
    self->seed = carve(block, &used, 1 + n + most.inputs);
    self->output_rate = carve(block, &used, most.outputs);
    self->largest_change = carve(block, &used, most.limits);
    return used;
}

kernel *kernel_create(void) {
    kernel *self = (kernel *)calloc(1, sizeof *self);
    if (!self) return NULL;
    const size_t doubles = lay_out(self, NULL);
    self->block = (double *)calloc(doubles, sizeof(double));
    const size_t n = (size_t)largest_dimensions().states;
    self->places = (int *)calloc(3 * n + (size_t)largest_dimensions().tables + 1, sizeof(int));
    self->warned = (char *)calloc((size_t)MODEL.variables, 1);
    if (!self->block || !self->places || !self->warned) {
        kernel_free(self);
        return NULL;
    }
    lay_out(self, self->block);
    self->dense.pivot = self->places;
    self->algebraic.pivot = self->places + n;
    self->kept_algebraic.pivot = self->places + 2 * n;
    self->row = self->places + 3 * n;
    kernel_reset(self);
    return self;
}

void kernel_free(kernel *self) {
    if (!self) return;
    free(self->block);
    free(self->places);
    free(self->warned);
    kernel_leave_table(self);
    free(self);
}

void kernel_reset(kernel *self) {
    kernel_leave_table(self);
    memset(self->block, 0, self->restored * sizeof(double));
    memset(self->warned, 0, (size_t)MODEL.variables);
    memset(&self->now, 0, sizeof self->now);
    memset(&self->counters, 0, sizeof self->counters);
    for (int i = 0; i < MODEL.variables; ++i) self->value[i] = MODEL.variable[i].start;
    self->now.system = -1;
    self->host_steps = self->host_slope_known = 0;
    self->stop_time = INFINITY;
    self->system = NULL;
    self->message[0] = '\0';
    self->journal_length = self->heard = 0;
    self->noted = self->lost = 0;
}

double kernel_time(const kernel *self) { return self->now.time; }
int kernel_ended(const kernel *self) { return self->now.ended; }
int kernel_state_count(const kernel *self) { return self->system ? self->system->states : 0; }
