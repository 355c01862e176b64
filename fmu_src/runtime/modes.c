/* Dry friction that slides or sticks, and the conditions that end a run.
 *
 * A mode is a function of the present state alone. A moving velocity slides in its own direction. A still one sticks while the
 * drive is within the capacity. A friction without capacity does not act. A velocity is still if it is exactly zero, or not
 * above a speed that a friction may have; the rest of the velocity is then set to zero. A friction that moves below that speed
 * sticks again only if some capacity is spare. Every switch is located on the step length, so that the equations are smooth
 * within a step; steps of a fixed size are an exception, see modes_settle. */
#include <math.h>
#include <string.h>

#include "method.h"
#include "own_functions.h"

enum { ROUNDS = 4 };             /* of modes that wait for one another */
/* Share of the capacity up to which a slow friction sticks. With 0.99, a load that grows through the capacity within 1000 s
 * releases once or a few times; with 0.999 it did so hundreds of times. */
static const double SPARE = 0.99;
/* Events within AGAIN [s] repeat each other; how fast reluctance fades [s], and its least and largest as a share of the
 * capacity. */
static const double AGAIN = 1e-3, FADING = 1e-4, LEAST_RELUCTANCE = 1e-7, MOST_RELUCTANCE = 1e3;

double modes_velocity(const friction_description *friction, const double *state) {
    return state[friction->velocity] + (friction->other < 0 ? 0.0 : state[friction->other]);
}

/* Exactly zero, also where it is a sum. */
void modes_stop(const friction_description *friction, double *state) {
    state[friction->velocity] = friction->other < 0 ? 0.0 : -state[friction->other];
}

/* The share of the capacity up to which a drive sticks, or stays stuck. */
static double share_of(double mode, double velocity, double still, double reluctant) {
    return mode != 0.0 && velocity != 0.0 && still > 0.0 ? SPARE : 1.0 + reluctant;
}

/* An integrator of the host leaves errors in the state. Near rest, 1e-5 of the running speed is more than the slip that carries
 * a brake's whole force. A wheel that comes to a stop is then driven on, or back, stops again, and so on without end. Creep
 * reduces such a force within microseconds once the wheel is held. Hence each event that follows on another makes frictions
 * more reluctant to slide, for a moment. In co-simulation steps, which locate on the state itself, this is 0. */
static double reluctance(const kernel *self, double offset) {
    if (self->run.now->reluctance == 0.0) return 0.0;
    return self->run.now->reluctance * own_exp(-(self->given.step_origin + offset - self->run.now->switched) / FADING);
}

void modes_grow_reluctant(kernel *self) {
    const bool again = self->run.now->time - self->run.now->switched < AGAIN;
    self->run.now->reluctance = again ? fmin(fmax(100.0 * self->run.now->reluctance, LEAST_RELUCTANCE), MOST_RELUCTANCE) : 0.0;
    self->run.now->switched = self->run.now->time;
}

static double direction_of(double velocity, double drive, double capacity, double still) {
    if (capacity <= 0.0) return velocity < 0.0 ? -1.0 : 1.0; /* for when there is some: now it multiplies zero */
    if (fabs(velocity) <= still && fabs(drive) <= capacity) return 0.0;
    if (velocity != 0.0) return velocity > 0.0 ? 1.0 : -1.0;
    return drive > 0.0 ? 1.0 : -1.0;
}

static void find_capacity(kernel *self, double offset, const double *state) {
    kernel_evaluate_again(self, self->system->capacity, offset, state, self->modes.capacity);
    self->modes.still = self->modes.capacity + self->system->frictions;
}

/* The drive is evaluated only if something is stuck or still: it may cost as much as the whole right-hand side. */
static void find_drive_and_capacity(kernel *self, double offset, const double *state) {
    const system_description *system = self->system;
    find_capacity(self, offset, state);
    for (int i = 0; i < system->frictions; ++i)
        if (self->run.mode[i] == 0.0 || fabs(modes_velocity(&system->friction[i], state)) <= self->modes.still[i]) {
            kernel_evaluate_again(self, system->drive, offset, state, self->modes.drive);
            return;
        }
}

/* Return whether something began or ceased to be stuck since the modes `before`. */
static bool has_switched(const kernel *self) {
    for (int i = 0; i < self->system->frictions; ++i)
        if ((self->modes.before[i] == 0.0) != (self->run.mode[i] == 0.0)) return true;
    return false;
}

/* Mode of a friction by the drive and capacity that were found, by its velocity and the mode `before`. */
static void renew_mode(kernel *self, int i, double offset) {
    const friction_description *friction = &self->system->friction[i];
    const double velocity = modes_velocity(friction, self->run.state), still = self->modes.still[i];
    const double reached = self->modes.overshoot[i] != 0.0 ? self->modes.overshoot[i] : velocity;
    const double share = share_of(self->modes.before[i], reached, still, reluctance(self, offset));
    self->run.mode[i] = direction_of(velocity, self->modes.drive[i], share * self->modes.capacity[i], still);
    if (self->run.mode[i] == 0.0) modes_stop(friction, self->run.state);
}

/* Keep the present modes; nothing has passed zero. */
static void begin_round(kernel *self) {
    const int n = self->system->frictions;
    memcpy(self->modes.before, self->run.mode, (size_t)n * sizeof(double));
    memset(self->modes.overshoot, 0, (size_t)n * sizeof(double));
}

/* Set the modes by the present state and the modes before; return whether one became or ceased to be stuck. */
static bool refresh_once(kernel *self, double offset) {
    kernel_locate(self, offset, self->run.state);
    find_drive_and_capacity(self, offset, self->run.state);
    begin_round(self);
    for (int i = 0; i < self->system->frictions; ++i) renew_mode(self, i, offset);
    return has_switched(self);
}

/* A friction may depend on another that holds already: a wheelset stands on its rails if it does not turn. */
void modes_refresh(kernel *self, double offset) {
    if (self->system->frictions == 0) return;
    bool switched = false;
    for (int i = 0; refresh_once(self, offset) && i < ROUNDS; ++i) switched = true;
    if (switched) (void)reported_follow(self, offset);
}

/* Return whether a friction has taken a velocity through zero within a step. */
static inline bool has_crossed(const kernel *self, int i) {
    if (self->run.mode[i] == 0.0 || !(self->modes.capacity[i] > 0.0)) return false;
    return self->run.mode[i] * modes_velocity(&self->system->friction[i], self->run.state) < 0.0;
}

/* Hold, for a trial, the frictions that have crossed: a drive is that of a friction at rest. The first of them begins a round.
 * Returns whether there is a round. */
static bool hold_what_crossed(kernel *self, bool begun) {
    for (int i = 0; i < self->system->frictions; ++i) {
        const friction_description *friction = &self->system->friction[i];
        if (!has_crossed(self, i)) continue;
        if (!begun) begin_round(self);
        begun = true;
        self->modes.overshoot[i] = modes_velocity(friction, self->run.state);
        modes_stop(friction, self->run.state);
        self->run.mode[i] = 0.0;
    }
    return begun;
}

/* Return whether all slide on in their directions: then drives do not matter. */
static bool all_slide(const kernel *self) {
    for (int i = 0; i < self->system->frictions; ++i) {
        const double velocity = modes_velocity(&self->system->friction[i], self->run.state);
        if (!(self->run.mode[i] * velocity > self->modes.still[i])) return false;
    }
    return true;
}

/* Return whether a mode stays unchanged, by a quick test: sticks up to a share of the capacity, or slides on. */
static inline bool stays(const kernel *self, int i, double share) {
    const double mode = self->run.mode[i], capacity = self->modes.capacity[i];
    if (mode == 0.0) return capacity > 0.0 && fabs(self->modes.drive[i]) <= share * capacity;
    const double velocity = modes_velocity(&self->system->friction[i], self->run.state);
    return mode * velocity > self->modes.still[i] || (capacity <= 0.0 && velocity == 0.0 && mode == 1.0);
}

static bool all_stay(const kernel *self) {
    for (int i = 0; i < self->system->frictions; ++i)
        if (!stays(self, i, 1.0)) return false;
    return true;
}

static void give_back(kernel *self, int i) {
    self->run.state[self->system->friction[i].velocity] += self->modes.overshoot[i];
    self->modes.overshoot[i] = 0.0;
}

/* A friction that could not be held continues in the other direction. So does a friction that has lost its capacity to another
 * one's sliding. */
static void let_go(kernel *self, double offset) {
    const mode_workspace *modes = &self->modes;
    bool slides = false;
    for (int i = 0; i < self->system->frictions; ++i) {
        const bool held = modes->overshoot[i] != 0.0 || modes->before[i] == 0.0;
        slides |= held && self->run.mode[i] != 0.0;
        if (self->run.mode[i] * modes->overshoot[i] > 0.0) give_back(self, i);
    }
    if (!slides) return;
    find_capacity(self, offset, self->run.state);
    for (int i = 0; i < self->system->frictions; ++i) {
        if (self->run.mode[i] != 0.0 || modes->capacity[i] > 0.0) continue;
        give_back(self, i);
        self->run.mode[i] = modes_velocity(&self->system->friction[i], self->run.state) < 0.0 ? -1.0 : 1.0;
    }
}

bool modes_settle(kernel *self, double offset) {
    const system_description *system = self->system;
    kernel_locate(self, offset, self->run.state);
    if (system->frictions == 0) return false;
    find_capacity(self, offset, self->run.state);
    if (all_slide(self)) return false;
    const bool crossed = hold_what_crossed(self, false);
    if (crossed) { /* a wheelset may stand on its rails because it no longer turns */
        find_capacity(self, offset, self->run.state);
        (void)hold_what_crossed(self, true);
    }
    kernel_evaluate_again(self, system->drive, offset, self->run.state, self->modes.drive);
    if (!crossed) {
        if (all_stay(self)) return false;
        begin_round(self);
    }
    for (int i = 0; i < system->frictions; ++i)
        if (!stays(self, i, self->modes.overshoot[i] != 0.0 ? SPARE : 1.0)) renew_mode(self, i, offset);
    let_go(self, offset);
    if (!has_switched(self)) return false;
    (void)reported_follow(self, offset);
    self->counters.events++;
    return true;
}

/* Keep a stuck friction exactly at rest: its slope is zero, but row exchanges in the factorisation leave round-off. */
void modes_hold(const kernel *self, double *state) {
    for (int i = 0; i < self->system->frictions; ++i)
        if (self->run.mode[i] == 0.0) modes_stop(&self->system->friction[i], state);
}

/* Return the margin of a sliding friction: positive while it slides in its direction. */
double modes_direction_margin(const kernel *self, int i, const double *state) {
    const friction_description *friction = &self->system->friction[i];
    return self->run.mode[i] * modes_velocity(friction, state) / self->system->nominal[friction->velocity];
}

/* Smallest of all margins; negative or NaN when a mode must switch or the run must end within the step. The single margins stay
 * in self->modes.margin: of frictions, of end conditions and of warnings. */
double modes_margin(kernel *self, double offset, const double *state) {
    const system_description *system = self->system;
    double smallest = INFINITY;
    kernel_locate(self, offset, state);
    if (system->frictions) find_drive_and_capacity(self, offset, state);
    const double reluctant = reluctance(self, offset);
    for (int i = 0; i < system->frictions; ++i) {
        const friction_description *friction = &system->friction[i];
        const double velocity = modes_velocity(friction, state), capacity = self->modes.capacity[i],
                     still = self->modes.still[i];
        if (capacity <= 0.0) self->modes.margin[i] = self->run.mode[i] == 0.0 ? -1.0 : INFINITY;
        else if (self->run.mode[i] == 0.0)
            self->modes.margin[i] = (capacity - fabs(self->modes.drive[i])) / capacity + reluctant;
        else if (still > 0.0)
            self->modes.margin[i] = fmax(fabs(velocity) / still, fabs(self->modes.drive[i]) / (SPARE * capacity)) - 1.0;
        else self->modes.margin[i] = modes_direction_margin(self, i, state);
    }
    if (system->conditions)
        kernel_evaluate_again(self, system->condition_margin, offset, state, self->modes.margin + system->frictions);
    for (int i = 0; i < system->frictions + system->ends; ++i)
        if (!(self->modes.margin[i] >= smallest)) smallest = self->modes.margin[i];
    return smallest;
}

/* After a located step: switches each friction with a margin below 0, or as small as `least`, which another method may find on
 * this side of 0. Returns 1 + index of an end condition that was reached, else 0. */
int modes_switch(kernel *self, double offset, double least) {
    const system_description *system = self->system;
    (void)modes_margin(self, offset, self->run.state);
    for (int i = 0; i < system->ends; ++i)
        if (!(self->modes.margin[system->frictions + i] >= 0.0)) return 1 + i;
    for (int i = 0; i < system->frictions; ++i) /* with a speed `still`, it stops once it is found to stick */
        if ((self->modes.margin[i] < 0.0 || self->modes.margin[i] == least) && self->run.mode[i] != 0.0 &&
            self->modes.still[i] == 0.0)
            modes_stop(&system->friction[i], self->run.state);
    /* A stuck friction whose drive exceeds the capacity starts to slide in modes_refresh. */
    self->counters.events++;
    modes_refresh(self, offset);
    return 0;
}

/* Return whether a warning is due, by the present margins. */
static bool is_to_warn(const kernel *self, int i) {
    return self->run.warned[i] == 0.0 && !(self->modes.margin[self->system->frictions + i] >= 0.0);
}

/* Give each warning once, from the margins of the state just reached; return whether there was one. Reports frictions before,
 * if their reports may change without a switch. */
bool modes_warn(kernel *self, double offset) {
    const system_description *system = self->system;
    int candidates = 0;
    bool warned = false;
    if (self->run.now->watched) (void)reported_follow(self, offset);
    for (int i = system->ends; i < system->conditions; ++i) candidates += is_to_warn(self, i);
    if (candidates && system->warning_margin)
        kernel_evaluate(self, system->warning_margin, offset, self->run.state,
                        self->modes.margin + system->frictions + system->ends);
    for (int i = system->ends; i < system->conditions && candidates; ++i) {
        if (!is_to_warn(self, i)) continue;
        char when[TIME_TEXT];
        if (kernel_is_heard(self, KERNEL_WARNING))
            (void)kernel_say_when(self, KERNEL_WARNING, system->sentence[i],
                                  time_text(self->given.step_origin + offset, 6, when));
        self->run.warned[i] = 1.0;
        warned = true;
    }
    return warned;
}
