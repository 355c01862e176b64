/* Model exchange: the equations for an integrator of the host, which sets time, states and inputs and reads slopes and event
 * indicators. At a zero crossing of an indicator, modes are found as within a co-simulation step.
 *
 * A host knows the number of states beforehand: it is that of the system which the start values choose, and systems with other
 * states are refused. None of them has algebraic states. */
#include <math.h>
#include <string.h>

#include "method.h"

/* An event indicator is the scaled margin of a switch plus this constant. At its zero crossing the margin is negative by more
 * than the host's round-off in locating it. After an event no indicator is zero. */
static const double HYSTERESIS = 1e-9;

int kernel_exchange_states(void) { return MODEL.exchanged < 0 ? 0 : MODEL.system[MODEL.exchanged].states; }

int kernel_exchange_indicators(void) {
    if (MODEL.exchanged < 0) return 0;
    return MODEL.system[MODEL.exchanged].frictions + MODEL.system[MODEL.exchanged].ends;
}

/* Return the name of the first selector that is not at its start value, or that of the table file. */
static const char *name_of_choice(const kernel *self) {
    for (int i = 0; i < MODEL.selectors; ++i) {
        const variable_description *selector = &MODEL.variable[MODEL.selector[i]];
        if (self->run.value[MODEL.selector[i]] != selector->start) return selector->name;
    }
    return kernel_name_of_table_file();
}

kernel_status kernel_check_exchange(kernel *self) {
    const system_description *system = self->system;
    if (system->exchanged || MODEL.exchanged < 0) return KERNEL_OK; /* without model exchange there is no instance of it */
    kernel_reopen(self);
    return kernel_fail(self, KERNEL_ERROR,
                       "Leave %s at its start value in model exchange, which has the %d states of the system \"%s\": the "
                       "system \"%s\" has others and runs in co-simulation.",
                       name_of_choice(self), kernel_exchange_states(), MODEL.system[MODEL.exchanged].name, system->name);
}

/* Return the index of the first number that is not finite; -1 if all are. */
static int first_not_finite(const double *number, int count) {
    for (int i = 0; i < count; ++i)
        if (!isfinite(number[i])) return i;
    return -1;
}

/* An integrator may try a state without a finite motion: return a discard, which requests a shorter step. */
static kernel_status discard(kernel *self, const char *what) {
    char when[TIME_TEXT];
    return kernel_fail(self, KERNEL_DISCARD, "%s at t = %s s is not a finite number; shorten the step.", what,
                       time_text(self->run.now->time, 9, when));
}

static const char *name_of_state(const kernel *self, int state) {
    return MODEL.variable[self->system->state_variable[state]].name;
}

kernel_status kernel_set_time(kernel *self, double time) {
    if (!isfinite(time))
        return kernel_fail(self, KERNEL_ERROR, "The time must be a finite number; got %g. %g s stays in force.", time,
                           self->run.now->time);
    self->run.now->time = time;
    self->run.now->outputs_stale = true;
    return KERNEL_OK;
}

kernel_status kernel_set_states(kernel *self, const double *state) {
    const kernel_status status = kernel_prepare(self, "its equations");
    if (status != KERNEL_OK) return status;
    const int bad = first_not_finite(state, self->system->states);
    if (bad >= 0) return discard(self, name_of_state(self, bad));
    memcpy(self->run.state, state, (size_t)self->system->states * sizeof(double));
    self->run.now->outputs_stale = true;
    return KERNEL_OK;
}

kernel_status kernel_get_states(kernel *self, double *state) {
    const kernel_status status = kernel_prepare(self, "its equations");
    if (status == KERNEL_OK) memcpy(state, self->run.state, (size_t)self->system->states * sizeof(double));
    return status;
}

void kernel_get_nominals(double *nominal) {
    memcpy(nominal, MODEL.system[MODEL.exchanged].nominal, (size_t)kernel_exchange_states() * sizeof(double));
}

/* All slopes, in work.slope; of algebraic states residuals. */
static kernel_status find_slopes(kernel *self) {
    const kernel_status status = kernel_prepare(self, "its equations");
    if (status != KERNEL_OK) return status;
    const double *place = algebraic_place(self);
    if (place) kernel_evaluate(self, self->system->ode, 0.0, place, self->work.slope);
    self->counters.right_hand_sides++;
    const bool finite = place && first_not_finite(self->work.slope, self->system->states) < 0;
    return finite ? KERNEL_OK : discard(self, "A derivative of the states");
}

kernel_status kernel_get_slopes(kernel *self, double *slope) {
    const kernel_status status = find_slopes(self);
    if (status != KERNEL_OK) return status;
    memcpy(slope, self->work.slope, (size_t)self->system->states * sizeof(double));
    explicit_host_read(self);
    return KERNEL_OK;
}

/* Margins, in modes.margin. A friction without capacity has its direction watched, for when there is some; one whose
 * capacity is below 0 never gets any. */
static kernel_status find_margins(kernel *self) {
    const kernel_status status = kernel_prepare(self, "its equations");
    if (status != KERNEL_OK) return status;
    const system_description *system = self->system;
    (void)modes_margin(self, 0.0, self->run.state);
    for (int i = 0; i < system->frictions; ++i)
        if (isinf(self->modes.margin[i]))
            self->modes.margin[i] = self->modes.capacity[i] < 0.0 ? 1.0 : modes_direction_margin(self, i, self->run.state);
    const int bad = first_not_finite(self->modes.margin, system->frictions + system->ends);
    return bad < 0 ? KERNEL_OK : discard(self, "An event indicator");
}

kernel_status kernel_get_indicators(kernel *self, double *indicator) {
    const kernel_status status = find_margins(self);
    if (status != KERNEL_OK) return status;
    for (int i = 0; i < kernel_exchange_indicators(); ++i) indicator[i] = self->modes.margin[i] + HYSTERESIS;
    return KERNEL_OK;
}

int exchange_state(const kernel *self, int number) {
    const int variable = MODEL.system[MODEL.exchanged].state_variable[number];
    for (int i = 0; i < self->system->states; ++i)
        if (self->system->state_variable[i] == variable) return i;
    return -1;
}

int kernel_exchanged_number(int variable) {
    if (variable <= MODEL.variables) return -1; /* also where a reference above 2^31 came as a number below 0 */
    const int number = variable - MODEL.variables - 1;
    return number < kernel_exchange_states() + kernel_exchange_indicators() ? number : -1;
}

kernel_status kernel_get_exchanged(kernel *self, int number, double *value) {
    const int states = kernel_exchange_states();
    kernel_status status = kernel_prepare(self, "its equations");
    *value = 0.0;
    if (status != KERNEL_OK) return status;
    if (number < states) {
        const int state = exchange_state(self, number);
        status = find_slopes(self);
        if (state >= 0) *value = self->work.slope[state];
    } else if (self->system->exchanged) {
        status = find_margins(self);
        *value = self->modes.margin[number - states] + HYSTERESIS;
    }
    return status;
}

/* Return whether part of a state that a rollback restores differs from the backup. */
static bool differs(const kernel *self, const double *vector, int count) {
    return memcmp(self->backup + (vector - self->run.block), vector, (size_t)count * sizeof(double)) != 0;
}

kernel_status kernel_find_modes(kernel *self, bool *jumped) {
    const kernel_status status = find_margins(self);
    if (status != KERNEL_OK) return status;
    const system_description *system = self->system;
    memcpy(self->backup, self->run.block, self->run.doubles * sizeof(double));
    kernel_evaluate(self, system->ode, 0.0, self->run.state, self->host.slope_before);
    self->run.now->ended = modes_switch(self, 0.0, -INFINITY);
    kernel_evaluate(self, system->ode, 0.0, self->run.state, self->work.slope);
    const bool moved = differs(self, self->run.state, system->states);
    if (moved || differs(self, self->run.mode, system->frictions)) modes_grow_reluctant(self);
    *jumped = moved || self->run.now->inputs_jumped ||
              memcmp(self->host.slope_before, self->work.slope, (size_t)system->states * sizeof(double)) != 0;
    explicit_host_begin(self);
    self->run.now->inputs_jumped = false;
    self->run.now->outputs_stale = true;
    if (self->run.now->ended) (void)kernel_say_end(self, self->run.now->time);
    return KERNEL_OK;
}

kernel_status kernel_complete_step(kernel *self, bool *crossed) {
    const kernel_status status = find_margins(self);
    if (status != KERNEL_OK) return status;
    *crossed = false;
    for (int i = 0; i < kernel_exchange_indicators(); ++i) *crossed |= self->modes.margin[i] < 0.0;
    /* An output that depends on a friction's reports is discrete: it changes only at events. */
    if (self->run.now->watched) *crossed |= reported_follow(self, 0.0);
    const bool warned = modes_warn(self, 0.0);
    return explicit_host_guard(self) != KERNEL_OK || warned ? KERNEL_WARNING : KERNEL_OK;
}
