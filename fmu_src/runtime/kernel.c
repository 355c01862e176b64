/* Instances: the variable table, initialisation, and a step from outside; its loop is in integrate.c. */
#include "kernel.h"

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double FIRST_STEP = 1e-4; /* s; the error control takes over after one step */

/* ---- messages ------------------------------------------------------------------------------------------------ */

void kernel_note(kernel *self, int status, const char *format, ...) {
    char line[MESSAGE_SIZE];
    va_list arguments;
    va_start(arguments, format);
    int length = snprintf(line, sizeof line, "%d ", status);
    vsnprintf(line + length, sizeof line - (size_t)length, format, arguments);
    va_end(arguments);
    const size_t needed = strlen(line) + 1;
    if (self->journal_length + needed >= JOURNAL_SIZE) return; /* nobody drains it: the oldest lines are kept */
    memcpy(self->journal + self->journal_length, line, needed - 1);
    self->journal[self->journal_length + needed - 1] = '\n';
    self->journal_length += needed;
    self->journal[self->journal_length] = '\0';
}

int kernel_fail(kernel *self, int status, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(self->message, sizeof self->message, format, arguments);
    va_end(arguments);
    kernel_note(self, status, "%s", self->message);
    return status;
}

const char *kernel_message(const kernel *self) { return self->message; }

const char *kernel_journal(kernel *self) {
    if (self->journal_length == 0) return "";
    self->journal_length = 0; /* the text stays until the next note */
    return self->journal;
}

/* ---- life cycle ---------------------------------------------------------------------------------------------- */

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
    self->trial = carve(block, &used, n);
    self->slope = carve(block, &used, n);
    self->time_slope = carve(block, &used, n);
    self->nonzero = carve(block, &used, most.nonzeros);
    self->jacobian = carve(block, &used, n * n);
    self->kept_jacobian = carve(block, &used, n * n);
    factors *const four[] = {&self->whole, &self->algebraic, &self->kept, &self->kept_algebraic};
    for (int i = 0; i < 4; ++i) {
        const int size = i % 2 ? most.algebraics : n;
        four[i]->matrix = carve(block, &used, size * size);
        four[i]->packed = carve(block, &used, size * size);
    }
    for (int i = 0; i < 6; ++i) self->stage[i] = carve(block, &used, n);
    self->point = carve(block, &used, n);
    self->between = carve(block, &used, n);
    self->first_slope = carve(block, &used, n);
    self->last_slope = carve(block, &used, n);
    self->ordered = carve(block, &used, 2 * n);
    self->differential = carve(block, &used, n);
    self->drive = carve(block, &used, most.frictions);
    self->capacity = carve(block, &used, most.frictions);
    self->margin = carve(block, &used, most.frictions + most.conditions);
    self->output = carve(block, &used, most.outputs);
    self->seed = carve(block, &used, 1 + n + most.inputs);
    self->output_rate = carve(block, &used, most.outputs);
    self->largest_change = carve(block, &used, most.limits);
    return used;
}

kernel *kernel_create(void) {
    kernel *self = calloc(1, sizeof *self);
    if (!self) return NULL;
    const size_t doubles = lay_out(self, NULL);
    self->block = calloc(doubles, sizeof(double));
    const size_t n = (size_t)largest_dimensions().states;
    self->places = calloc(6 * n + 1, sizeof(int));
    self->warned = calloc((size_t)MODEL.variables, 1);
    if (!self->block || !self->places || !self->warned) {
        kernel_free(self);
        return NULL;
    }
    lay_out(self, self->block);
    self->place = self->places;
    self->every = self->places + n;
    self->whole.pivot = self->places + 2 * n;
    self->algebraic.pivot = self->places + 3 * n;
    self->kept.pivot = self->places + 4 * n;
    self->kept_algebraic.pivot = self->places + 5 * n;
    for (size_t i = 0; i < n; ++i) self->every[i] = (int)i;
    kernel_reset(self);
    return self;
}

void kernel_free(kernel *self) {
    if (!self) return;
    free(self->block);
    free(self->places);
    free(self->warned);
    free(self);
}

void kernel_reset(kernel *self) {
    memset(self->block, 0, self->restored * sizeof(double));
    memset(self->warned, 0, (size_t)MODEL.variables);
    memset(&self->now, 0, sizeof self->now);
    memset(&self->counters, 0, sizeof self->counters);
    for (int i = 0; i < MODEL.variables; ++i) self->value[i] = MODEL.variable[i].start;
    self->now.system = -1;
    self->stop_time = INFINITY;
    self->system = NULL;
    self->message[0] = self->journal[0] = '\0';
    self->journal_length = 0;
}

/* ---- generated functions ------------------------------------------------------------------------------------- */

/* Calls a generated function at `offset` seconds after the start of the step, with the inputs and table pieces that the
 * call before it used: for a second function at the same place. */
void kernel_call(kernel *self, generated_function function, double offset, const double *state, double **result) {
    const double time = self->step_origin + offset;
    const double *argument[ARG_COUNT] = {&time,         state,      self->stage_input, self->rate, self->parameter,
                                         self->derived, self->mode, self->coefficient, self->seed};
    function(argument, result, NULL, NULL, 0);
}

void kernel_look_up(kernel *self, double offset, const double *state) {
    const system_description *system = self->system;
    for (int rank = 0; rank < system->table_ranks; ++rank) {
        kernel_call(self, system->table_argument[rank], offset, state, &self->table_at);
        tables_look_up(system, rank, self->table_at, self->coefficient);
    }
}

void kernel_locate(kernel *self, double offset, const double *state) {
    for (int i = 0; i < self->system->inputs; ++i) self->stage_input[i] = self->input[i] + offset * self->rate[i];
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
        self->input[i] = self->value[variable];
        self->rate[i] = self->input_rate[variable];
    }
}

void kernel_compute_outputs(kernel *self, double offset, const double *state) {
    const system_description *system = self->system;
    kernel_evaluate(self, system->output, offset, state, self->output);
    for (int i = 0; i < system->outputs; ++i) self->value[system->output_variable[i]] = self->output[i];
    for (int i = 0; i < system->states; ++i)
        if (system->state_variable[i] >= 0) self->value[system->state_variable[i]] = state[i];
}

/* First output that is not a finite number, or null. */
static const char *output_not_finite(const kernel *self) {
    for (int i = 0; i < self->system->outputs; ++i)
        if (!isfinite(self->output[i])) return MODEL.variable[self->system->output_variable[i]].name;
    return NULL;
}

/* ---- variables ----------------------------------------------------------------------------------------------- */

static int check_reference(kernel *self, int variable) {
    if (variable >= 0 && variable < MODEL.variables) return KERNEL_OK;
    return kernel_fail(self, KERNEL_ERROR, "There is no variable number %d: %s has the numbers 0 to %d.", variable,
                       MODEL.name, MODEL.variables - 1);
}

/* Unit with a blank before it; nothing for pure numbers. */
static const char *after_number(const variable_description *variable, char text[32]) {
    const int pure = strcmp(variable->unit, "1") == 0;
    snprintf(text, 32, "%s%s", pure ? "" : " ", pure ? "" : variable->unit);
    return text;
}

static int check_value(kernel *self, const variable_description *variable, double value, double kept) {
    const char *name = variable->name;
    char text[32];
    const char *unit = after_number(variable, text);
    if (!isfinite(value))
        return kernel_fail(self, KERNEL_ERROR, "Set %s to a finite number: it was given %g, and %g%s stays in force.",
                           name, value, kept, unit);
    if (value < variable->minimum)
        return kernel_fail(self, KERNEL_ERROR,
                           "Set %s to at least %g%s: %g%s is below this limit, and %g%s stays in force.", name,
                           variable->minimum, unit, value, unit, kept, unit);
    if (value > variable->maximum)
        return kernel_fail(self, KERNEL_ERROR,
                           "Set %s to at most %g%s: %g%s is above this limit, and %g%s stays in force.", name,
                           variable->maximum, unit, value, unit, kept, unit);
    if (variable->kind == KIND_INTEGER && value != floor(value))
        return kernel_fail(self, KERNEL_ERROR, "Set %s to a whole number: it was given %g, and %g stays in force.", name,
                           value, kept);
    return KERNEL_OK;
}

/* Says once that an input does nothing in the chosen system, so that it is not ignored in silence. */
static int warn_without_effect(kernel *self, int variable) {
    if (!self->system || self->warned[variable] || self->value[variable] == MODEL.variable[variable].start)
        return KERNEL_OK;
    for (int i = 0; i < self->system->inputs; ++i)
        if (self->system->input_variable[i] == variable) return KERNEL_OK;
    self->warned[variable] = 1;
    return kernel_fail(self, KERNEL_WARNING, "%s has no effect in the system \"%s\"; choose a level that contains it.",
                       MODEL.variable[variable].name, self->system->name);
}

int kernel_set(kernel *self, int variable, double value) {
    int status = check_reference(self, variable);
    if (status != KERNEL_OK) return status;
    const variable_description *description = &MODEL.variable[variable];
    if (description->causality >= CAUSALITY_OUTPUT)
        return kernel_fail(self, KERNEL_ERROR, "%s is %s and cannot be set; read it instead.", description->name,
                           description->causality == CAUSALITY_OUTPUT ? "an output" : "a state");
    if (description->causality == CAUSALITY_PARAMETER && self->system)
        return kernel_fail(self, KERNEL_ERROR, "%s is a parameter and fixed once the run has begun; reset first.",
                           description->name);
    const int lost = isnan(value) && !isnan(description->when_lost);
    if (lost) {
        value = description->when_lost;
    } else {
        status = check_value(self, description, value, self->value[variable]);
        if (status != KERNEL_OK) return status;
    }
    self->value[variable] = value;
    self->input_rate[variable] = 0.0;
    self->now.outputs_stale = 1;
    if (lost)
        return kernel_fail(self, KERNEL_WARNING, "The signal %s is lost (NaN): it counts as %g %s, the safe side.",
                           description->name, value, description->unit);
    return warn_without_effect(self, variable);
}

int kernel_set_rate(kernel *self, int variable, double rate) {
    int status = check_reference(self, variable);
    if (status != KERNEL_OK) return status;
    const variable_description *description = &MODEL.variable[variable];
    if (description->causality != CAUSALITY_INPUT || description->kind != KIND_REAL)
        return kernel_fail(self, KERNEL_ERROR, "Only real inputs have a rate of change; %s is none.", description->name);
    if (!isfinite(rate))
        return kernel_fail(self, KERNEL_ERROR, "Set the rate of %s to a finite number: it was given %g.",
                           description->name, rate);
    self->input_rate[variable] = rate;
    self->now.outputs_stale = 1;
    return KERNEL_OK;
}

int kernel_get(kernel *self, int variable, double *value) {
    int status = check_reference(self, variable);
    if (status != KERNEL_OK) return status;
    if (self->now.outputs_stale && self->system && MODEL.variable[variable].causality >= CAUSALITY_OUTPUT) {
        kernel_gather_inputs(self);
        self->step_origin = self->now.time;
        kernel_compute_outputs(self, 0.0, self->state);
        self->now.outputs_stale = 0;
        const char *bad = output_not_finite(self);
        if (bad) return kernel_fail(self, KERNEL_ERROR, "The output %s is not a finite number at these inputs.", bad);
    }
    *value = self->value[variable];
    return KERNEL_OK;
}

/* ---- derivatives of outputs ---------------------------------------------------------------------------------- */

/* Derivatives of all outputs along the seed (time, states, inputs), whose algebraic states follow from the residuals. */
static int differentiate_outputs(kernel *self) {
    const system_description *system = self->system;
    double *follow = self->stage[0];
    if (system->residual_along) {
        for (int i = 0; i < system->algebraics; ++i) self->seed[1 + system->algebraic[i]] = 0.0;
        kernel_evaluate(self, system->residual_along, 0.0, self->state, follow);
        if (!linear_factorise_algebraic(self, &self->algebraic, self->jacobian))
            return kernel_fail(self, KERNEL_ERROR, "The outputs have no derivatives at t = %.9g s.", self->now.time);
        linear_solve_algebraic(self, &self->algebraic, follow);
        for (int i = 0; i < system->algebraics; ++i) self->seed[1 + system->algebraic[i]] = -follow[i];
    }
    kernel_evaluate(self, system->output_along, 0.0, self->state, self->output_rate);
    for (int i = 0; i < system->outputs; ++i)
        if (!isfinite(self->output_rate[i]))
            return kernel_fail(self, KERNEL_ERROR, "The output %s has no finite derivative at t = %.9g s.",
                               MODEL.variable[system->output_variable[i]].name, self->now.time);
    return KERNEL_OK;
}

/* Where the derivatives are taken, with an empty seed. */
static int prepare_derivatives(kernel *self) {
    if (!self->system)
        return kernel_fail(self, KERNEL_ERROR, "Initialise %s before asking for derivatives.", MODEL.name);
    kernel_gather_inputs(self);
    self->step_origin = self->now.time;
    rosenbrock_linearise(self, 0.0, self->state);
    memset(self->seed, 0, (size_t)(1 + self->system->states + self->system->inputs) * sizeof(double));
    return KERNEL_OK;
}

/* Copies the derivatives of some outputs; those that the system does not have are constant. */
static int pick_derivatives(kernel *self, int count, const int *variable, double *result) {
    for (int i = 0; i < count; ++i) {
        const int status = check_reference(self, variable[i]);
        if (status != KERNEL_OK) return status;
        const variable_description *description = &MODEL.variable[variable[i]];
        if (description->causality < CAUSALITY_OUTPUT || description->kind != KIND_REAL)
            return kernel_fail(self, KERNEL_ERROR, "Only real outputs have derivatives; %s is none.", description->name);
        result[i] = 0.0;
        for (int j = 0; j < self->system->states; ++j)
            if (self->system->state_variable[j] == variable[i]) result[i] = self->seed[1 + j];
        for (int j = 0; j < self->system->outputs; ++j)
            if (self->system->output_variable[j] == variable[i]) result[i] = self->output_rate[j];
    }
    return KERNEL_OK;
}

int kernel_get_rates(kernel *self, int count, const int *variable, double *rate) {
    int status = prepare_derivatives(self);
    if (status != KERNEL_OK) return status;
    const system_description *system = self->system;
    self->seed[0] = 1.0;
    memcpy(self->seed + 1, self->slope, (size_t)system->states * sizeof(double));
    for (int i = 0; i < system->inputs; ++i)
        self->seed[1 + system->states + i] = self->last_rate[system->input_variable[i]];
    status = differentiate_outputs(self);
    return status == KERNEL_OK ? pick_derivatives(self, count, variable, rate) : status;
}

int kernel_get_directional(kernel *self, int unknowns, const int *unknown, int knowns, const int *known,
                           const double *change, double *result) {
    int status = prepare_derivatives(self);
    if (status != KERNEL_OK) return status;
    const system_description *system = self->system;
    for (int i = 0; i < knowns; ++i) {
        status = check_reference(self, known[i]);
        if (status != KERNEL_OK) return status;
        const variable_description *description = &MODEL.variable[known[i]];
        const int taken = description->causality == CAUSALITY_INPUT || description->causality == CAUSALITY_LOCAL;
        if (!taken || description->kind != KIND_REAL)
            return kernel_fail(self, KERNEL_ERROR, "Derivatives are taken by real inputs and states; %s is none.",
                               description->name);
        for (int j = 0; j < system->states; ++j)
            if (system->state_variable[j] == known[i]) self->seed[1 + j] += change[i];
        for (int j = 0; j < system->inputs; ++j)
            if (system->input_variable[j] == known[i]) self->seed[1 + system->states + j] += change[i];
    }
    status = differentiate_outputs(self);
    return status == KERNEL_OK ? pick_derivatives(self, unknowns, unknown, result) : status;
}

/* ---- initialisation ------------------------------------------------------------------------------------------ */

/* Sets what follows from the chosen system and the parameters and is not restored with them. */
static void enter_system(kernel *self) {
    const system_description *system = self->system = self->now.system < 0 ? NULL : &MODEL.system[self->now.system];
    if (!system) return;
    for (int i = 0; i < system->parameters; ++i) self->parameter[i] = self->value[system->parameter_variable[i]];
    self->method = (int)self->value[MODEL.integration_method];
    self->factors_serve = self->kept_ready = 0;
    memset(self->jacobian, 0, (size_t)(system->states * system->states) * sizeof(double));
    memset(self->kept_jacobian, 0, (size_t)(system->states * system->states) * sizeof(double));
    for (int i = 0; i < system->states; ++i) {
        self->differential[i] = 1.0;
        self->place[system->order[i]] = i;
    }
    for (int i = 0; i < system->algebraics; ++i) self->differential[system->algebraic[i]] = 0.0;
}

int kernel_initialise(kernel *self, double time) {
    if (!isfinite(time)) return kernel_fail(self, KERNEL_ERROR, "Start at a finite time: %g was given.", time);
    if (self->value[MODEL.integration_method] == METHOD_EXPLICIT && self->value[MODEL.integration_step] == 0.0)
        return kernel_fail(self, KERNEL_ERROR,
                           "Set integration_step above 0 s: integration_method %d, explicit, has no error control that "
                           "could choose its steps.",
                           METHOD_EXPLICIT);
    const int chosen = MODEL.selector < 0 ? 0 : (int)self->value[MODEL.selector] - 1;
    self->now.system = chosen;
    enter_system(self);
    const system_description *system = self->system;
    self->now.time = self->step_origin = time;
    self->now.proposed_step = FIRST_STEP;
    self->now.kept_steps = -1;
    self->now.pause = self->now.guard_wait = 0;
    self->now.guard_said = 0.0;
    kernel_gather_inputs(self);
    if (system->derive) kernel_call(self, system->derive, 0.0, self->state, &self->derived);
    kernel_evaluate(self, system->start, 0.0, self->state, self->trial);
    memcpy(self->state, self->trial, (size_t)system->states * sizeof(double));
    for (int i = 0; i < system->frictions; ++i) self->mode[i] = 1.0;
    for (int i = 0; i < system->conditions; ++i) self->said[i] = 0.0;
    rosenbrock_linearise(self, 0.0, self->state);
    const int solved = algebraic_solve(self, 0.0, self->state, self->value[MODEL.tolerance]);
    modes_refresh(self, 0.0);
    kernel_compute_outputs(self, 0.0, self->state);
    const char *bad = output_not_finite(self);
    if (bad || !solved) {
        kernel_reopen(self);
        return bad ? kernel_fail(self, KERNEL_ERROR,
                                 "The output %s is not a finite number at the start; check the parameters it depends on.",
                                 bad)
                   : kernel_fail(self, KERNEL_ERROR,
                                 "The equations have no consistent start at t = %.9g s; check inputs and parameters.",
                                 time);
    }
    self->now.outputs_stale = 0;
    for (int i = 0; i < MODEL.variables; ++i)
        if (MODEL.variable[i].causality == CAUSALITY_INPUT) (void)warn_without_effect(self, i);
    return KERNEL_OK;
}

/* Opens the parameters again, all values kept; initialise afterwards. */
void kernel_reopen(kernel *self) {
    self->system = NULL;
    self->now.system = -1;
}

/* ---- the step ------------------------------------------------------------------------------------------------ */

void kernel_stop_at_events(kernel *self, int stops) {
    self->stops_at_events = stops;
    self->whole_steps = !stops;
}

static int check_step(kernel *self, double time, double size) {
    if (!self->system)
        return kernel_fail(self, KERNEL_ERROR, "Initialise %s before the first step.", MODEL.name);
    if (!(size > 0.0) || !isfinite(size))
        return kernel_fail(self, KERNEL_ERROR, "Give a step size above 0 s: it was %g s; nothing was advanced.", size);
    int status = kernel_check_times(self, time, size);
    if (status != KERNEL_OK) return status;
    char when[CLOCK_SIZE];
    if (self->now.ended)
        return kernel_fail(self, KERNEL_DISCARD, "The run ended at t = %s s; reset it to start again.",
                           kernel_clock(self->now.time, 9, when));
    for (int i = 0; i < self->system->inputs; ++i) {
        const int variable = self->system->input_variable[i];
        if (self->input_rate[variable] == 0.0) continue;
        const double last = self->value[variable] + size * self->input_rate[variable];
        status = check_value(self, &MODEL.variable[variable], last, self->value[variable]);
        if (status != KERNEL_OK) return status;
    }
    return KERNEL_OK;
}

int kernel_step(kernel *self, double time, double size) {
    int status = check_step(self, time, size);
    if (status != KERNEL_OK) return status;
    const kernel_snapshot before = self->now;
    const size_t heard = self->journal_length;
    memcpy(self->backup, self->block, self->restored * sizeof(double));

    self->step_origin = time;
    kernel_gather_inputs(self);
    double reached = size;
    status = integrate(self, size, &reached);
    if (status <= KERNEL_WARNING && self->now.ended && self->whole_steps && reached < size)
        status = kernel_discard(self, heard, reached);
    if (status <= KERNEL_WARNING) {
        kernel_compute_outputs(self, reached, self->state);
        const char *bad = output_not_finite(self);
        if (bad)
            status = kernel_fail(self, KERNEL_ERROR, "The output %s is not a finite number at t = %.9g s.", bad,
                                 time + reached);
    }
    if (status > KERNEL_WARNING) { /* the last good state stays */
        self->now = before;
        self->kept_ready = 0;
        memcpy(self->block, self->backup, self->restored * sizeof(double));
        return status;
    }
    for (int i = 0; i < self->system->inputs; ++i) {
        const int variable = self->system->input_variable[i];
        self->value[variable] += reached * self->input_rate[variable];
        self->last_rate[variable] = self->input_rate[variable];
        self->input_rate[variable] = 0.0;
    }
    self->now.outputs_stale = 0;
    self->now.time = time + reached;
    if (!self->now.ended) return status;
    char when[CLOCK_SIZE];
    return kernel_fail(self, KERNEL_DISCARD, self->system->sentence[self->now.ended - 1],
                       kernel_clock(self->now.time, 6, when));
}

int kernel_record(kernel *self, double time, double size, double interval, int columns, const int *variable,
                  double *buffer, long long int rows) {
    kernel_recorder recorder = {rows, 0, interval, columns, variable, buffer};
    self->recorder = &recorder;
    const int status = kernel_step(self, time, size);
    self->recorder = NULL;
    for (long long int i = recorder.written * columns; i < rows * columns; ++i) buffer[i] = NAN;
    return status;
}

/* ---- saved states -------------------------------------------------------------------------------------------- */

size_t kernel_state_size(const kernel *self) { return sizeof self->now + self->restored * sizeof(double); }

void kernel_save(const kernel *self, void *bytes) {
    memcpy(bytes, &self->now, sizeof self->now);
    memcpy((char *)bytes + sizeof self->now, self->block, self->restored * sizeof(double));
}

int kernel_restore(kernel *self, const void *bytes) {
    kernel_snapshot saved;
    memcpy(&saved, bytes, sizeof saved);
    if (saved.system < -1 || saved.system >= MODEL.systems)
        return kernel_fail(self, KERNEL_ERROR, "The saved state is not one of %s; nothing was restored.", MODEL.name);
    self->now = saved;
    memcpy(self->block, (const char *)bytes + sizeof saved, self->restored * sizeof(double));
    enter_system(self);
    return KERNEL_OK;
}

/* ---- small questions ----------------------------------------------------------------------------------------- */

double kernel_time(const kernel *self) { return self->now.time; }
int kernel_ended(const kernel *self) { return self->now.ended; }
int kernel_variable_count(void) { return MODEL.variables; }
int kernel_state_count(const kernel *self) { return self->system ? self->system->states : 0; }

const char *kernel_variable_name(int variable) {
    return variable >= 0 && variable < MODEL.variables ? MODEL.variable[variable].name : "";
}

void kernel_counts(const kernel *self, long long int counts[6]) {
    counts[0] = self->counters.right_hand_sides;
    counts[1] = self->counters.jacobians;
    counts[2] = self->counters.factorisations;
    counts[3] = self->counters.steps;
    counts[4] = self->counters.rejected;
    counts[5] = self->counters.events;
}

int kernel_linearise(kernel *self, double *state, double *slope, double *jacobian) {
    if (!self->system) return kernel_fail(self, KERNEL_ERROR, "Initialise %s before its linearisation.", MODEL.name);
    const int n = self->system->states;
    kernel_gather_inputs(self);
    self->step_origin = self->now.time;
    rosenbrock_linearise(self, 0.0, self->state);
    if (!algebraic_solve(self, 0.0, self->state, 0.0))
        return kernel_fail(self, KERNEL_ERROR,
                           "The algebraic equations have no solution near t = %.9g s; check inputs and parameters.",
                           self->now.time);
    for (int i = 0; i < n; ++i) {
        state[i] = self->state[i];
        slope[i] = self->slope[i];
        for (int j = 0; j < n; ++j) jacobian[i * n + j] = self->jacobian[self->place[j] * n + self->place[i]];
    }
    return KERNEL_OK;
}

int kernel_repeat_right_hand_side(kernel *self, long long int repeat) {
    if (!self->system) return KERNEL_ERROR;
    kernel_gather_inputs(self);
    for (long long int i = 0; i < repeat; ++i)
        kernel_evaluate(self, self->system->ode, 0.0, self->state, self->slope);
    return KERNEL_OK;
}

int kernel_repeat_jacobian(kernel *self, long long int repeat) {
    if (!self->system) return KERNEL_ERROR;
    kernel_gather_inputs(self);
    for (long long int i = 0; i < repeat; ++i)
        rosenbrock_linearise(self, 0.0, self->state);
    return KERNEL_OK;
}

int kernel_repeat_step(kernel *self, double time, double size, long long int repeat) {
    for (long long int i = 0; i < repeat; ++i) {
        const int status = kernel_step(self, time + (double)i * size, size);
        if (status > KERNEL_WARNING) return status;
    }
    return KERNEL_OK;
}
