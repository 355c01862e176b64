/* Hoses of the pipe between vehicles that are apart: one parts as they separate by more than its reach. */
#include <math.h>

#include "train_inside.h"

/* Gap beyond that between touching vehicles at which a hose parts [m]. Assumed: two hoses of 0.62 m hang in an arc, and couplers
 * have free travel. */
static const double REACH = 1.0;
/* Of each vehicle: state of the hose behind it, and the time when it was first torn [s]. A loose hose waits for the vehicles to
 * touch; a torn one is loose only after its state was changed. */
enum { JOINED, TORN, LOOSE };

static double *state_of(const train *self) { return hose_run(self); }
static double *time_of(const train *self) { return hose_run(self) + self->vehicles; }

void hoses_begin(train *self) {
    for (long long int i = 0; i < self->vehicles; ++i) time_of(self)[i] = TRAIN_NEVER;
}

const double *train_parted_at(const train *self) { return time_of(self); }

void hose_changed(train *self, long long int i) {
    if (state_of(self)[i] != JOINED) state_of(self)[i] = LOOSE;
}

int hose_joint(const train *self, long long int i) {
    const double input = self->given_before[self->input[IN_HOSE_STATE] - self->input[0] + i];
    const int apart = state_of(self)[i] != JOINED && input == HOSE_STATE_WHOLE;
    return motion_is_broken(self->moves, i) || apart ? HOSE_STATE_PARTED : (int)input;
}

/* The state of a hose at a gap between its vehicles. */
static double hose_at(const train *self, long long int i, double gap) {
    const double state = state_of(self)[i];
    if (motion_is_coupled(self->moves, i) || gap <= 0.0) return state == LOOSE ? JOINED : state;
    if (state != JOINED || gap <= REACH) return state;
    return hose_joint(self, i) == HOSE_STATE_WHOLE ? TORN : LOOSE;
}

int hoses_look(train *self, double step) {
    const double *place = motion_place(self->moves);
    int changed = 0;
    for (long long int i = 0; i + 1 < self->vehicles; ++i) {
        if (self->face[i] <= 0) continue; /* a cell spans the vehicles, or no air flows */
        if (motion_is_coupled(self->moves, i) && state_of(self)[i] == JOINED) continue;
        const double state = hose_at(self, i, place[i] - place[i + 1]);
        if (state == state_of(self)[i]) continue;
        state_of(self)[i] = state;
        changed = 1;
        if (state == TORN) time_of(self)[i] = fmin(time_of(self)[i], self->run[RUN_TIME] + step);
    }
    return changed;
}
