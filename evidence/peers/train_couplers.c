/* A train as a differential equation for third-party methods, and in linearly implicit steps; the product's own steps
 * are those of motion.h. The law of a coupler is implemented here independently, as a rate.
 *
 * A state: place of the head [m], strokes of the couplers [m], speeds [m/s], rest positions of the couplers [m]. */
#include <math.h>
#include <string.h>

#include "motion.h"
#include "train.h" /* TRAIN_SHOWN */

enum { MOST_VEHICLES = 256 };
/* Bounds this close are equal, and a force this close to a bound is on it [N]; below this speed brakes are viscous
   [m/s]. */
static const double NEAR = 1e-6, REST = 0.01;

typedef struct {
    long long int vehicles;
    const double *mass;       /* including rotation [kg] */
    const double *resistance; /* rows of constant, linear and square [N], [N.s/m], [N.s2/m2] */
    const double *coupler;    /* constants of every coupler, as in motion.h */
    const double *brake;      /* rows of capacities [N], `interval` s apart */
    long long int rows;
    double interval;
    long long int evaluations, solves; /* of all couplers and vehicles; of their tridiagonal equations */
    double compression;                /* the largest so far [N] */
} train_equations;

typedef struct {
    double force, slope; /* [N]; its slope over the stroke in the present direction [N/m] */
    double yields;       /* rate of the rest position over that of the stroke [1] */
    double along;        /* the slope at a fixed rest position [N/m] */
} law;

static double curve(const double *bends, double way, double *slope) {
    double force = 0.0;
    *slope = 0.0;
    for (int n = 0; n < FEW_POINTS; ++n)
        if (way > bends[n]) {
            force += bends[n + POINTS] * (way - bends[n]);
            *slope += bends[n + POINTS];
        }
    return force;
}

/* F = min(max(K (s - z), lower), upper); z' = s' - (slope of the bound) s' / K where it presses on one, else 0. */
static law coupler_law(const double *given, double way, double rest, double rate) {
    const double stiffness = given[0], *bends = given + 2;
    double slope[4];
    const double upper = curve(bends, way, slope) - curve(bends + 6 * POINTS, -way, slope + 3);
    const double lower = curve(bends + 2 * POINTS, way, slope + 1) - curve(bends + 4 * POINTS, -way, slope + 2);
    const double tried = stiffness * (way - rest), rises = slope[0] + slope[3], falls = slope[1] + slope[2];
    const int above = tried >= upper - NEAR, below = tried <= lower + NEAR, one = upper - lower <= NEAR;
    law found = {fmin(fmax(tried, lower), upper), stiffness, 0.0, tried > upper ? rises : tried < lower ? falls : stiffness};
    if (one || (above && rate > 0.0) || (below && rate < 0.0)) {
        found.slope = one || above ? rises : falls;
        found.yields = 1.0 - found.slope / stiffness;
    }
    return found;
}

/* Laws of many couplers at once: forces [N], and rates of their rest positions over those of the strokes. */
TRAIN_SHOWN void equations_laws(const double *given, long long int count, const double *way, const double *rest,
                                const double *rate, double *force, double *yields) {
    for (long long int i = 0; i < count; ++i) {
        const law found = coupler_law(given, way[i], rest[i], rate[i]);
        force[i] = found.force;
        yields[i] = found.yields;
    }
}

static double brake_at(const train_equations *self, double time, long long int vehicle) {
    const double row = fmin(fmax(time / self->interval, 0.0), (double)(self->rows - 1));
    const long long int first = row < (double)(self->rows - 1) ? (long long int)row : self->rows - 2;
    const double *at = self->brake + first * self->vehicles + vehicle, part = row - (double)first;
    return (1.0 - part) * at[0] + part * at[self->vehicles];
}

/* Returns the force of brakes and resistance [N]; slope: over the speed. */
static double held(const train_equations *self, double time, long long int i, double speed, double *slope) {
    const double *resistance = self->resistance + i, fast = fabs(speed), sense = fmin(fmax(speed / REST, -1.0), 1.0);
    const double linear = resistance[self->vehicles], square = resistance[2 * self->vehicles];
    const double most = brake_at(self, time, i) + resistance[0] + fast * (linear + fast * square);
    *slope = fast < REST ? most / REST : linear + 2.0 * square * fast;
    return sense * most;
}

/* Row and columns of one coupler in the Jacobian. */
static void put_coupler(const train_equations *self, double *jacobian, long long int i, const law *at) {
    const long long int n = self->vehicles, size = 3 * n - 1, way = 1 + i, rest = 2 * n + i;
    for (long long int side = 0; side < 2; ++side) {
        const long long int speed = n + i + side;
        const double sense = side ? -1.0 : 1.0, taken = -sense / self->mass[i + side];
        jacobian[way * size + speed] = sense;
        jacobian[rest * size + speed] = sense * at->yields;
        jacobian[speed * size + way] = taken * at->along;
        jacobian[speed * size + rest] = at->along == self->coupler[0] ? -taken * at->along : 0.0;
    }
}

/* Derivatives of a state, and the Jacobian row by row unless null. Returns 0. */
TRAIN_SHOWN int equations_slopes(train_equations *self, double time, const double *state, double *slopes, double *jacobian) {
    const long long int n = self->vehicles, size = 3 * n - 1;
    const double *way = state + 1, *speed = state + n, *rest = state + 2 * n;
    if (jacobian) memset(jacobian, 0, (size_t)(size * size) * sizeof(double));
    slopes[0] = speed[0];
    for (long long int i = 0; i < n; ++i) {
        double slope;
        slopes[n + i] = -held(self, time, i, speed[i], &slope) / self->mass[i];
        if (jacobian) jacobian[(n + i) * size + n + i] = -slope / self->mass[i];
    }
    for (long long int i = 0; i + 1 < n; ++i) {
        const double rate = speed[i] - speed[i + 1];
        const law at = coupler_law(self->coupler, way[i], rest[i], rate);
        slopes[1 + i] = rate;
        slopes[2 * n + i] = at.yields * rate;
        slopes[n + i] -= at.force / self->mass[i];
        slopes[n + i + 1] += at.force / self->mass[i + 1];
        if (jacobian) put_coupler(self, jacobian, i, &at);
    }
    if (jacobian) jacobian[n] = 1.0;
    self->evaluations++;
    return 0;
}

/* Solves a symmetric tridiagonal matrix; right side in, solution out (Thomas). */
static void solve(long long int n, double *diagonal, const double *beside, double *right) {
    for (long long int i = 1; i < n; ++i) {
        const double factor = beside[i - 1] / diagonal[i - 1];
        diagonal[i] -= factor * beside[i - 1];
        right[i] -= factor * right[i - 1];
    }
    right[n - 1] /= diagonal[n - 1];
    for (long long int i = n - 1; i-- > 0;) right[i] = (right[i] - beside[i] * right[i + 1]) / diagonal[i];
}

/* Runs `count` solutions for timing; the result prevents their elimination by the compiler. */
TRAIN_SHOWN double equations_solutions(long long int n, long long int count) {
    double diagonal[MOST_VEHICLES], beside[MOST_VEHICLES], right[MOST_VEHICLES] = {1.0};
    for (long long int k = 0; k < count; ++k) {
        for (long long int i = 0; i < n; ++i) {
            diagonal[i] = 4.0;
            beside[i] = -1.0;
            right[i] += 1.0;
        }
        solve(n, diagonal, beside, right);
    }
    return right[0];
}

/* Applies the play operator at new strokes, and updates the largest compression. */
static void settle(train_equations *self, double *state) {
    const long long int n = self->vehicles;
    for (long long int i = 0; i + 1 < n; ++i) {
        const double force = coupler_law(self->coupler, state[1 + i], state[2 * n + i], 0.0).force;
        state[2 * n + i] = state[1 + i] - force / self->coupler[0];
        self->compression = fmax(self->compression, -force);
    }
}

/* One step; forces hold at a share of it, 1 (Euler) or 1/2 (midpoint), and are linear from the present state. */
static void implicit_step(train_equations *self, double *state, double braked, double step, double share) {
    const long long int n = self->vehicles;
    double diagonal[MOST_VEHICLES], beside[MOST_VEHICLES] = {0}, gained[MOST_VEHICLES], slope, *speed = state + n;
    for (long long int i = 0; i < n; ++i) {
        diagonal[i] = self->mass[i];
        gained[i] = -step * held(self, braked, i, speed[i], &slope);
    }
    for (long long int i = 0; i + 1 < n; ++i) {
        const double rate = speed[i] - speed[i + 1], part = share * step;
        const law at = coupler_law(self->coupler, state[1 + i], state[2 * n + i], rate);
        const double force = at.force + part * at.slope * rate, stiff = part * part * at.slope;
        gained[i] -= step * force;
        gained[i + 1] += step * force;
        diagonal[i] += stiff;
        diagonal[i + 1] += stiff;
        beside[i] = -stiff;
    }
    solve(n, diagonal, beside, gained);
    state[0] += step * (speed[0] + share * gained[0]);
    for (long long int i = 0; i + 1 < n; ++i)
        state[1 + i] += step * (speed[i] - speed[i + 1] + share * (gained[i] - gained[i + 1]));
    for (long long int i = 0; i < n; ++i) speed[i] += gained[i];
    settle(self, state);
    self->evaluations++;
    self->solves++;
}

/* held_for: number of steps with constant brakes, those in the middle of these steps, as in a step of the pipe; 1:
   each. */
TRAIN_SHOWN void equations_implicit(train_equations *self, double *state, long long int steps, double step, double share,
                                    long long int held_for) {
    for (long long int k = 0; k < steps; ++k) {
        const double begin = (double)(k - k % held_for) * step;
        implicit_step(self, state, begin + (held_for > 1 ? (double)held_for / 2.0 : share) * step, step, share);
    }
}

/* The product's steps, with brakes as in the middle of each; no wheel slides. given: constants of the motion, and those
 * of all couplers; moving: a state of motion.h. Returns 0, or 1 if out of memory. */
TRAIN_SHOWN int equations_explicit(train_equations *self, const double *given, const double *couplers, double *moving,
                                   long long int steps, double step) {
    motion *moves = motion_create(self->vehicles, given, couplers);
    if (!moves) return 1;
    double *brake = motion_acting(moves, ACTING_BRAKE), *friction = motion_acting(moves, ACTING_FRICTION), extremes[4];
    for (long long int i = 0; i < self->vehicles; ++i) friction[i] = INFINITY;
    motion_put(moves, moving);
    for (long long int k = 0; k < steps; ++k) {
        for (long long int i = 0; i < self->vehicles; ++i) brake[i] = brake_at(self, ((double)k + 0.5) * step, i);
        motion_go(moves, 1, step);
        self->evaluations++;
    }
    motion_get(moves, moving);
    motion_extremes(moves, extremes);
    self->compression = extremes[2];
    motion_free(moves);
    return 0;
}
