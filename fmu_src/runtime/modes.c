/* Dry friction that slides or sticks, and the conditions that end a run.
 *
 * A mode is a function of the present state alone: a moving velocity slides in its own direction, a velocity of exactly
 * zero sticks while the drive stays within the capacity, and a friction without capacity is no friction. Every switch is
 * located on the step length, so that the equations are smooth within a step. */
#include <math.h>

#include "internal.h"

static double direction_of(double velocity, double drive, double capacity) {
    if (capacity <= 0.0) return 1.0; /* no friction: the direction multiplies zero */
    if (velocity > 0.0) return 1.0;
    if (velocity < 0.0) return -1.0;
    if (fabs(drive) <= capacity) return 0.0;
    return drive > 0.0 ? 1.0 : -1.0;
}

/* The drive is asked for only where something is stuck or stands: it may cost as much as the whole right-hand side. */
static void find_drive_and_capacity(kernel *self, double offset, const double *state) {
    const system_description *system = self->system;
    kernel_evaluate_again(self, system->capacity, offset, state, self->capacity);
    for (int i = 0; i < system->frictions; ++i)
        if (self->mode[i] == 0.0 || state[system->friction[i].velocity] == 0.0) {
            kernel_evaluate_again(self, system->drive, offset, state, self->drive);
            return;
        }
}

void modes_refresh(kernel *self, double offset) {
    const system_description *system = self->system;
    if (system->frictions == 0) return;
    kernel_locate(self, offset, self->state);
    find_drive_and_capacity(self, offset, self->state);
    for (int i = 0; i < system->frictions; ++i) {
        const friction_description *friction = &system->friction[i];
        const double old = self->mode[i];
        self->mode[i] = direction_of(self->state[friction->velocity], self->drive[i], self->capacity[i]);
        if ((old == 0.0) != (self->mode[i] == 0.0)) {
            const char *word = self->mode[i] == 0.0 ? friction->stuck_word : friction->sliding_word;
            char when[CLOCK_SIZE];
            kernel_note(self, KERNEL_OK, "%s %s at %s s.", friction->label, word,
                        kernel_clock(self->step_origin + offset, 6, when));
        }
    }
}

/* Smallest of all margins; negative or NaN when a mode must switch or the run must end within the step.
 * The single margins stay in self->margin: of frictions, of what ends the run, and of what only warns. */
double modes_margin(kernel *self, double offset, const double *state) {
    const system_description *system = self->system;
    double smallest = INFINITY;
    kernel_locate(self, offset, state);
    if (system->frictions) find_drive_and_capacity(self, offset, state);
    for (int i = 0; i < system->frictions; ++i) {
        const int velocity = system->friction[i].velocity;
        if (self->capacity[i] <= 0.0)
            self->margin[i] = INFINITY;
        else if (self->mode[i] == 0.0)
            self->margin[i] = (self->capacity[i] - fabs(self->drive[i])) / self->capacity[i];
        else
            self->margin[i] = self->mode[i] * state[velocity] / system->nominal[velocity];
    }
    if (system->conditions)
        kernel_evaluate_again(self, system->condition_margin, offset, state, self->margin + system->frictions);
    for (int i = 0; i < system->frictions + system->ends; ++i)
        if (!(self->margin[i] >= smallest)) smallest = self->margin[i];
    return smallest;
}

/* After a located step: switches what crossed, that is what has a margin below 0 or as small as `least`, which another
 * method may find on this side of 0. Returns 1 + index of an end condition that was reached, else 0. */
int modes_switch(kernel *self, double offset, double least) {
    const system_description *system = self->system;
    (void)modes_margin(self, offset, self->state);
    for (int i = 0; i < system->ends; ++i)
        if (!(self->margin[system->frictions + i] >= 0.0)) return 1 + i;
    for (int i = 0; i < system->frictions; ++i)
        if ((self->margin[i] < 0.0 || self->margin[i] == least) && self->mode[i] != 0.0)
            self->state[system->friction[i].velocity] = 0.0;
    /* A stuck friction whose drive exceeds the capacity starts to slide in modes_refresh. */
    self->counters.events++;
    modes_refresh(self, offset);
    return 0;
}

/* Whether there is a warning to be said, by the margins as they stand. */
static int is_to_warn(const kernel *self, int i) {
    return self->said[i] == 0.0 && !(self->margin[self->system->frictions + i] >= 0.0);
}

/* Says once what only warns, from the margins of the state just reached. Returns the number of new warnings. */
int modes_warn(kernel *self, double offset) {
    const system_description *system = self->system;
    int count = 0, candidates = 0;
    for (int i = system->ends; i < system->conditions; ++i) candidates += is_to_warn(self, i);
    if (candidates && system->warning_margin)
        kernel_evaluate(self, system->warning_margin, offset, self->state,
                        self->margin + system->frictions + system->ends);
    for (int i = system->ends; i < system->conditions && candidates; ++i) {
        if (!is_to_warn(self, i)) continue;
        char when[CLOCK_SIZE];
        (void)kernel_fail(self, KERNEL_WARNING, system->sentence[i], kernel_clock(self->step_origin + offset, 6, when));
        self->said[i] = 1.0;
        ++count;
    }
    return count;
}
