/* Reports of frictions that stick and slide.
 *
 * A friction may have a condition for its sticking, or its sliding, to count: a wheel is locked if it does not turn while its
 * axle moves. Frictions that hold a vehicle as a whole are reported as one: when the last of them sticks that could, and when
 * they slide so that it counts. Repeated sticking is reported the 1st, 2nd, 4th, 8th time, and so on, until the vehicle as a
 * whole stands. Sliding is reported if the sticking before it was. Hence the number of reports does not grow with a run's
 * length. */
#include <math.h>

#include "method.h"

/* Return whether a friction sticks; for a vehicle as a whole, whether one sticks, and so do all others whose sticking
 * counts. */
static bool sticks(const kernel *self, int i) {
    const friction_description *friction = self->system->friction;
    if (friction[i].whole < 0) return self->run.mode[i] == 0.0;
    bool some = false;
    for (int k = i; k < self->system->frictions; ++k) {
        if (friction[k].whole != i) continue;
        if (self->run.mode[k] == 0.0) some = true;
        else if (!friction[k].counts || self->modes.reported[k] > 0.0) return false;
    }
    return some;
}

static bool is_power_of_two(double count) {
    int exponent;
    return frexp(count, &exponent) == 0.5;
}

static void tell_mode(kernel *self, int i, const char *word, double offset, bool counted) {
    const double times = fabs(self->run.reported[i]);
    if (!kernel_is_heard(self, KERNEL_OK) || !is_power_of_two(times)) return;
    char when[TIME_TEXT];
    const char *label = self->system->friction[i].label;
    (void)time_text(self->given.step_origin + offset, 6, when);
    if (counted && times > 1.0) kernel_note(self, KERNEL_OK, "%s %s at %s s; %g times so far.", label, word, when, times);
    else kernel_note(self, KERNEL_OK, "%s %s at %s s.", label, word, when);
}

/* Reset the counts of all other frictions when the vehicle as a whole stands. */
static void begin_anew(kernel *self) {
    for (int i = 0; i < self->system->frictions; ++i)
        if (self->system->friction[i].whole < 0) self->run.reported[i] = self->run.reported[i] < 0.0 ? -1.0 : 0.0;
}

/* Return whether the counted mode of a friction, or of the group reported with it, has changed; reports the change. */
static bool follow(kernel *self, int i, double offset) {
    const friction_description *friction = &self->system->friction[i];
    double *reported = &self->run.reported[i];
    const double *margin = self->modes.reported;
    const bool stuck = sticks(self, i), counted = *reported < 0.0;
    const bool counts = !friction->counts || friction->whole >= 0 || margin[i] > 0.0;
    const bool slides = !stuck && (!friction->counts || margin[self->system->frictions + i] > 0.0);
    self->run.now->watched |= friction->counts && (stuck || (counted && !slides));
    if (stuck && counts && !counted) {
        if (friction->whole >= 0) *reported = 0.0;
        *reported = -(*reported + 1.0);
        tell_mode(self, i, friction->stuck_word, offset, true);
        if (friction->whole >= 0) begin_anew(self);
        return true;
    }
    if (!counted || (stuck ? counts : !slides)) return false;
    *reported = -*reported;
    if (slides) tell_mode(self, i, friction->sliding_word, offset, false);
    return true;
}

bool reported_follow(kernel *self, double offset) {
    const system_description *system = self->system;
    bool changed = false;
    self->run.now->watched = false;
    if (system->reported) kernel_evaluate(self, system->reported, offset, self->run.state, self->modes.reported);
    for (int i = 0; i < system->frictions; ++i)
        if (system->friction[i].whole < 0) changed |= follow(self, i, offset);
    for (int i = 0; i < system->frictions; ++i)
        if (system->friction[i].whole == i) changed |= follow(self, i, offset);
    return changed;
}
