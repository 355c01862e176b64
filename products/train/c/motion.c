/* motion.h: memory and steps. */
#include "motion.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "motion_inside.h"
#include "rows.h"

/* A request for a coupling of one that has broken: neither coupled nor apart. */
#define BROKEN (-1.0)
enum { EXTREMES = 4 };

/* Return 1 if the slope of a curve changes after its first FEW_POINTS points. */
static int bends_often(const double *coupler, long long int couplers) {
    for (int curve = 0; curve < CURVES; ++curve) {
        const double *changes = coupler + (COUPLER_TENSION_LOADING_SLOPE_1 + 2 * POINTS * curve + FEW_POINTS) * couplers;
        for (long long int n = 0; n < (POINTS - FEW_POINTS) * couplers; ++n)
            if (changes[n] != 0.0) return 1;
    }
    return 0;
}

motion *motion_create(long long int vehicles, const double *given, const double *coupler) {
    motion *self = (motion *)calloc(1, sizeof *self);
    if (!self) return NULL;
    const long long int stride = self->stride = rows_stride(vehicles);
    self->vehicles = vehicles;
    self->lanes = lanes_of_processor();
    self->bends_often = bends_often(coupler, vehicles - 1);
    const rows_part parts[] = {{&self->state, MOTION_STATES, 0.0},
                               {&self->acting, ACTING_ROWS, 0.0},
                               {&self->given, MOTION_ROWS, 1.0},
                               {&self->coupler, COUPLER_ROWS, 1.0},
                               {&self->found, MOTION_FOUND, 0.0},
                               {&self->force, 1, 0.0},
                               {&self->step, 1, 1.0},
                               {&self->wish, 1, 1.0},
                               {&self->lead, 1, NAN},
                               {&self->sum, 1, 0.0}};
    self->memory = ROWS_LAY(parts, stride);
    if (!self->memory) {
        free(self);
        return NULL;
    }
    self->speed = self->state + stride;
    self->wheel = self->speed + stride;
    self->rest = self->wheel + stride;
    rows_put(self->given, stride, given, MOTION_ROWS, vehicles);
    rows_put(self->coupler, stride, coupler, COUPLER_ROWS, vehicles - 1);
    return self;
}

void motion_free(motion *self) {
    if (!self) return;
    free(self->memory);
    free(self->strength);
    free(self);
}

int motion_strength(motion *self, const double *strength) {
    const long long int couplers = self->vehicles - 1;
    int breaks = 0;
    for (long long int i = 0; i < couplers; ++i) breaks |= strength[i] < UNBREAKABLE;
    if (!breaks) return 1;
    self->strength = (double *)malloc((size_t)couplers * sizeof(double));
    if (self->strength) rows_copy(self->strength, strength, couplers);
    return self->strength != NULL;
}

/* A coupler that waits to be coupled, or was uncoupled, is not broken: `wish` is that of the last call of motion_couple. */
int motion_is_broken(const motion *self, long long int coupler) { return self->wish[coupler] == BROKEN; }

int motion_broken(motion *self) {
    const int broken = self->broken;
    self->broken = 0;
    return broken;
}

void motion_put(motion *self, const double *state) {
    rows_put(self->state, self->stride, state, MOTION_STATES, self->vehicles);
}

void motion_get(const motion *self, double *state) {
    rows_get(state, self->state, self->stride, MOTION_STATES, self->vehicles);
}

double *motion_acting(motion *self, int row) { return self->acting + row * self->stride; }
const double *motion_place(const motion *self) { return self->state; }
const double *motion_speed(const motion *self) { return self->speed; }
const double *motion_wheel(const motion *self) { return self->wheel; }
double *motion_force(motion *self) { return self->force; }
const double *motion_rail(const motion *self) { return self->found + 2 * self->stride; }

int motion_is_coupled(const motion *self, long long int coupler) {
    return self->coupler[coupler + COUPLER_COUPLING_CLOSED * self->stride] > 0.0;
}

static void count_waiting(motion *self) {
    self->waiting = 0;
    for (long long int i = 0; i + 1 < self->vehicles; ++i) self->waiting += self->wish[i] > 0.0 && !motion_is_coupled(self, i);
}

static void count_led(motion *self) {
    self->led = 0;
    for (long long int i = 0; i < self->vehicles; ++i) self->led |= isfinite(self->lead[i]) != 0;
}

void motion_couple(motion *self, long long int coupler, int coupled) {
    self->wish[coupler] = coupled;
    if (!coupled) self->coupler[coupler + COUPLER_COUPLING_CLOSED * self->stride] = 0.0;
    count_waiting(self);
}

void motion_lead(motion *self, long long int vehicle, double speed) {
    self->lead[vehicle] = speed;
    count_led(self);
    if (isfinite(speed)) self->speed[vehicle] = self->wheel[vehicle] = speed;
}

void motion_correct(motion *self, long long int vehicle, double speed, double step) {
    self->state[vehicle] += (speed - self->speed[vehicle]) * step / 2.0;
    self->speed[vehicle] = self->wheel[vehicle] = speed;
}

double motion_frequency(const motion *self, long long int i) {
    const double *stiffness = self->coupler + COUPLER_STICKING_STIFFNESS * self->stride, *given = self->given + i;
    const double both = (i > 0 ? stiffness[i - 1] : 0.0) + (i + 1 < self->vehicles ? stiffness[i] : 0.0);
    return sqrt(both / (given[MOTION_MASS * self->stride] + given[MOTION_ROTATING_MASS * self->stride]));
}

void motion_begin_mean(motion *self) {
    rows_fill(self->sum, self->stride, 0.0);
    self->summed = 0;
}

void motion_mean(const motion *self, double *force) {
    for (long long int i = 0; i + 1 < self->vehicles; ++i)
        force[i] = self->summed ? self->sum[i] / (double)self->summed : self->force[i];
}

void motion_extremes(const motion *self, double found[4]) { memcpy(found, self->extremes, sizeof self->extremes); }
void motion_forget(motion *self) { memset(self->extremes, 0, sizeof self->extremes); }

/* After the states: present and requested couplings, forces, prescribed speeds, sums of forces; extremes; summed steps. */
enum { KEPT_ROWS = 5 };

long long int motion_numbers(const motion *self) { return (MOTION_STATES + KEPT_ROWS) * self->vehicles + EXTREMES + 1; }

static double *kept_rows(const motion *self, int row) {
    double *rows[] = {self->coupler + COUPLER_COUPLING_CLOSED * self->stride, self->wish, self->force, self->lead, self->sum};
    return rows[row];
}

void motion_save(const motion *self, double *numbers) {
    motion_get(self, numbers);
    numbers += MOTION_STATES * self->vehicles;
    for (int row = 0; row < KEPT_ROWS; ++row, numbers += self->vehicles)
        rows_copy(numbers, kept_rows(self, row), self->vehicles);
    memcpy(numbers, self->extremes, sizeof self->extremes);
    numbers[EXTREMES] = (double)self->summed;
}

void motion_load(motion *self, const double *numbers) {
    motion_put(self, numbers);
    numbers += MOTION_STATES * self->vehicles;
    for (int row = 0; row < KEPT_ROWS; ++row, numbers += self->vehicles)
        rows_copy(kept_rows(self, row), numbers, self->vehicles);
    memcpy(self->extremes, numbers, sizeof self->extremes);
    self->summed = (long long int)numbers[EXTREMES];
    count_waiting(self);
    count_led(self);
}

/* Couples waiting couplers of vehicles that touch. */
static void couple_what_touches(motion *self) {
    for (long long int i = 0; i + 1 < self->vehicles; ++i)
        if (self->wish[i] > 0.0 && !motion_is_coupled(self, i) && self->state[i] <= self->state[i + 1]) {
            self->coupler[i + COUPLER_COUPLING_CLOSED * self->stride] = 1.0;
            --self->waiting;
        }
}

/* Updates the largest forces so far. */
static void find_extremes(motion *self) {
    double most = 0.0, least = 0.0;
    const double *force = self->force;
    for (long long int i = 0; i + 1 < self->vehicles; ++i) {
        most = force[i] > most ? force[i] : most;
        least = force[i] < least ? force[i] : least;
    }
    if (most <= self->extremes[0] && -least <= self->extremes[2]) return;
    for (long long int i = 0; i + 1 < self->vehicles; ++i)
        for (int n = 0; n < EXTREMES; n += 2) {
            const double size = n ? -force[i] : force[i];
            if (size <= self->extremes[n]) continue;
            self->extremes[n] = size;
            self->extremes[n + 1] = (double)(i + 1);
        }
}

/* Uncouples the couplers whose tension exceeds their strength. */
static void break_couplers(motion *self) {
    for (long long int i = 0; i + 1 < self->vehicles; ++i)
        if (self->force[i] > self->strength[i] && motion_is_coupled(self, i)) {
            self->coupler[i + COUPLER_COUPLING_CLOSED * self->stride] = 0.0;
            self->wish[i] = BROKEN;
            ++self->broken;
        }
}

static void go_ways(motion *self, double time) {
    for (long long int i = 0; i < self->vehicles; ++i) self->state[i] += time * self->speed[i];
}

static void find_forces(motion *self) {
    const double *force = self->found, *rest = force + self->stride;
    const long long int couplers = self->vehicles - 1;
    if (self->waiting) couple_what_touches(self);
    IN_LANES(motion_force);
    rows_copy(self->force, force, couplers);
    rows_copy(self->rest, rest, couplers);
    for (long long int i = 0; i < couplers; ++i) self->sum[i] += force[i];
    ++self->summed;
    find_extremes(self);
    if (self->strength) break_couplers(self);
}

void motion_force_now(motion *self, double *force) {
    IN_LANES(motion_force);
    rows_copy(force, self->found, (self->vehicles - 1));
}

/* Speeds after a step; sliding wheels have their own law. */
static void find_speeds(motion *self) {
    double *speed = self->found, *over = speed + self->stride;
    IN_LANES(motion_speed);
    for (long long int i = 0; i < self->vehicles; ++i) {
        double wheel = speed[i];
        if (over[i] > 0.0) {
            motion_slide_1(self, i, self->found + i); /* speed, speed of the wheels, rail force */
            wheel = over[i];
        }
        self->wheel[i] = wheel;
    }
    for (long long int i = 0; i < self->vehicles && self->led; ++i)
        if (isfinite(self->lead[i])) speed[i] = self->wheel[i] = self->lead[i];
    rows_copy(self->speed, speed, self->vehicles);
}

void motion_follow(motion *self, void (*follow)(void *owner, double step), void *owner) {
    self->follow = follow;
    self->owner = owner;
}

void motion_move(motion *self, long long int vehicle, double place, double speed, double wheel) {
    self->state[vehicle] = place;
    self->speed[vehicle] = speed;
    self->wheel[vehicle] = wheel;
}

void motion_go(motion *self, long long int steps, double step) {
    for (long long int i = 0; i < self->vehicles; ++i) self->step[i] = step;
    for (long long int n = 0; n < steps; ++n) {
        go_ways(self, n ? step : step / 2.0); /* the second half of the previous step, and the first of this one */
        find_forces(self);
        find_speeds(self);
        if (self->follow) self->follow(self->owner, step);
    }
    go_ways(self, step / 2.0);
}

int motion_sound(const motion *self) {
    for (int n = 0; n < MOTION_STATES; ++n)
        for (long long int i = 0; i < self->vehicles; ++i)
            if (!isfinite(self->state[i + n * self->stride])) return 0;
    return 1;
}
