/* Initialisation: computes a consistent start from the parameters. */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "method.h"

static const double FIRST_STEP = 1e-4; /* s; the error control takes over after one step */

void kernel_enter_system(kernel *self) {
    const system_description *system = self->system = self->run.now->system < 0 ? NULL : &MODEL.system[self->run.now->system];
    if (!system) return;
    for (int i = 0; i < system->parameters; ++i) self->given.parameter[i] = self->run.value[system->parameter_variable[i]];
    self->work.method = (int)self->run.value[MODEL.integration_method];
    self->work.algebraic_serve = false;
    self->kept.ready = KEPT_NOTHING;
    for (int i = 0; i < system->states; ++i) self->work.differential[i] = 1.0;
    for (int i = 0; i < system->algebraics; ++i) self->work.differential[system->algebraic[i]] = 0.0;
    for (int i = 0; i < 2 * system->tables; ++i) self->given.held[i] = NAN; /* no range is valid yet */
    double *value = self->given.coefficient + system->table_coefficients - system->records;
    for (int i = 0; i < system->records; ++i) value[i] = records_value(&system->record[i], self->records);
}

/* Return the index of the chosen system in the model, with another value of one selector (-1: none); below 0 if it does not
 * exist. */
static int chosen_system(const kernel *self, int selector, int value, bool on_table) {
    int combination = 0, combinations = 1;
    for (int i = 0; i < MODEL.selectors; ++i) {
        const int own = i == selector ? value : (int)self->run.value[MODEL.selector[i]];
        combination = combination * MODEL.selectable[i] + own - 1;
        combinations *= MODEL.selectable[i];
    }
    return MODEL.choice[on_table ? combination + combinations : combination];
}

static void add_text(char text[MESSAGE_SIZE], const char *format, ...) LIKE_PRINTF(2);
static void add_text(char text[MESSAGE_SIZE], const char *format, ...) {
    const size_t used = strlen(text);
    va_list arguments;
    va_start(arguments, format);
    print_list(text + used, MESSAGE_SIZE - used, format, arguments);
    va_end(arguments);
}

/* Add the values that one selector could have, with the others unchanged. */
static void add_remedy(const kernel *self, int selector, char remedies[MESSAGE_SIZE]) {
    const variable_description *variable = &MODEL.variable[MODEL.selector[selector]];
    bool named = false;
    for (int value = (int)variable->minimum; value <= (int)variable->maximum; ++value) {
        if (chosen_system(self, selector, value, self->table != NULL) < 0) continue;
        if (named) add_text(remedies, " or %d", value);
        else add_text(remedies, "%s %s to %d", *remedies ? ", or" : "Set", variable->name, value);
        named = true;
    }
}

/* Report that the model has no system for these choices, and list choices that have one. */
static kernel_status refuse_choice(kernel *self) {
    const table_file_description *file = MODEL.table_file;
    char chosen[MESSAGE_SIZE] = "", remedies[MESSAGE_SIZE] = "";
    for (int i = 0; i < MODEL.selectors; ++i) {
        const int variable = MODEL.selector[i];
        add_text(chosen, "%s%s %d", i ? ", " : " for ", MODEL.variable[variable].name, (int)self->run.value[variable]);
        add_remedy(self, i, remedies);
    }
    if (file) add_text(chosen, " %s a %s", self->table ? file->in_use : "without", file->noun);
    if (file && chosen_system(self, -1, 0, !self->table) >= 0) {
        if (self->own_table)
            add_text(remedies, "%s%s", *remedies ? ", or remove resources" : "Remove resources", file->resource);
        else
            add_text(remedies, "%s %s to %s", *remedies ? ", or" : "Set", kernel_name_of_table_file(),
                     self->table ? "no text" : "the path of a file");
    }
    return kernel_fail(self, KERNEL_ERROR, "%s has no system%s. %s.", MODEL.name, chosen,
                       *remedies ? remedies : "Change more than one of these");
}

/* Return an error with a message if parameters break a relation between them. */
static kernel_status check_relations(kernel *self) {
    for (int i = 0; i < MODEL.relations; ++i) {
        const relation_description *relation = &MODEL.relation[i];
        double sum = relation->constant;
        for (int term = 0; term < relation->terms; ++term)
            sum += relation->factor[term] * self->run.value[relation->variable[term]];
        if (sum > 0.0) continue;
        char lacks[TIME_TEXT];
        print_text(lacks, sizeof lacks, "%.4g", -sum);
        return kernel_say_when(self, KERNEL_ERROR, relation->sentence, lacks);
    }
    return KERNEL_OK;
}

/* Check that the chosen system can run with its records. A file without effect is a warning, unless the system refuses it. */
static kernel_status check_records(kernel *self, const system_description *system) {
    bool exact = self->records || !system->records || records_are_exact(system->record[0].own);
    for (int i = 0; self->records && i < self->records->roots; ++i) exact = exact && records_are_exact(self->records->root[i]);
    if (!exact)
        return kernel_fail(self, KERNEL_ERROR, "This computer's addresses of memory are too large for a %s.",
                           MODEL.record_file->noun);
    if (!self->records || system->records) return KERNEL_OK;
    const int variable = MODEL.record_file->variable;
    if (system->refuses_records) return kernel_fail(self, KERNEL_ERROR, "%s", system->refuses_records);
    if (self->warned[variable]) return KERNEL_OK;
    return kernel_fail(self, KERNEL_WARNING, "Nothing in the system \"%s\" depends on %s, so that setting this has no effect.",
                       system->name, MODEL.variable[variable].name);
}

/* Reports inputs and parameters without an effect, and pressures in a likely other unit. */
static kernel_status warn_at_start(kernel *self) {
    kernel_status status = KERNEL_OK;
    for (int i = 0; i < MODEL.variables; ++i) {
        const int causality = MODEL.variable[i].causality;
        if (causality != CAUSALITY_INPUT && causality != CAUSALITY_PARAMETER) continue;
        if (causality == CAUSALITY_INPUT && kernel_warn_without_effect(self, i) != KERNEL_OK) status = KERNEL_WARNING;
        if (kernel_warn_of_small_pressure(self, i) != KERNEL_OK) status = KERNEL_WARNING;
    }
    return kernel_warn_of_idle_parameters(self) != KERNEL_OK ? KERNEL_WARNING : status;
}

kernel_status kernel_initialise(kernel *self, double time) {
    if (!isfinite(time)) return kernel_fail(self, KERNEL_ERROR, "The start time must be a finite number; got %g.", time);
    if (self->run.value[MODEL.integration_method] == (double)METHOD_EXPLICIT && self->run.value[MODEL.integration_step] == 0.0)
        return kernel_fail(self, KERNEL_ERROR,
                           "integration_step must be above 0 s with integration_method %d, explicit, which has no error "
                           "control; got 0 s. Set a fixed step.",
                           METHOD_EXPLICIT);
    if (check_relations(self) != KERNEL_OK) return KERNEL_ERROR;
    const int chosen = chosen_system(self, -1, 0, self->table != NULL);
    if (chosen < 0) return refuse_choice(self);
    if (!self->table && MODEL.system[chosen].tables > 0)
        return kernel_fail(self, KERNEL_ERROR, "%s must be the path of a file with a %s; got no path. This model has no other.",
                           kernel_name_of_table_file(), MODEL.table_file->noun);
    const kernel_status of_records = check_records(self, &MODEL.system[chosen]);
    if (of_records == KERNEL_ERROR) return of_records;
    self->run.now->system = chosen;
    kernel_enter_system(self);
    const system_description *system = self->system;
    self->run.now->time = self->given.step_origin = time;
    self->run.now->proposed_step = FIRST_STEP;
    self->run.now->kept_steps = -1;
    self->run.now->pause = self->run.now->guard_wait = self->run.now->switches = 0;
    self->run.now->guard_warned = self->run.now->reluctance = 0.0;
    self->run.now->switched = -INFINITY;
    kernel_gather_inputs(self);
    if (system->derive) kernel_call(self, system->derive, 0.0, self->run.state, &self->run.derived);
    kernel_evaluate(self, system->start, 0.0, self->run.state, self->work.trial);
    memcpy(self->run.state, self->work.trial, (size_t)system->states * sizeof(double));
    for (int i = 0; i < system->frictions; ++i) {
        self->run.mode[i] = 1.0;
        self->run.reported[i] = 0.0;
    }
    self->run.now->watched = false;
    for (int i = 0; i < system->conditions; ++i) self->run.warned[i] = 0.0;
    if (!steady_find(self)) {
        char when[TIME_TEXT];
        kernel_reopen(self);
        return kernel_say_when(self, KERNEL_ERROR, system->steady->sentence, time_text(time, 9, when));
    }
    rosenbrock_linearise(self, 0.0, self->run.state);
    const bool solved = algebraic_solve(self, 0.0, self->run.state, self->run.value[MODEL.tolerance]);
    modes_refresh(self, 0.0);
    kernel_compute_outputs(self, 0.0, self->run.state);
    const char *bad = kernel_output_not_finite(self);
    if (bad || !solved) {
        char when[TIME_TEXT];
        kernel_reopen(self);
        return bad ? kernel_fail(self, KERNEL_ERROR,
                                 "The output %s is not a finite number at the start; check the parameters it depends on.", bad)
                   : kernel_fail(self, KERNEL_ERROR,
                                 "The equations have no consistent start at t = %s s; check inputs and parameters.",
                                 time_text(time, 9, when));
    }
    self->run.now->outputs_stale = self->run.now->inputs_jumped = false;
    return warn_at_start(self) != KERNEL_OK ? KERNEL_WARNING : of_records;
}

/* Open the parameters again, all values kept; initialise afterwards. */
void kernel_reopen(kernel *self) {
    self->system = NULL;
    self->run.now->system = -1;
}
