/* pipe.h: memory, steps, ends and balances. */
#include "pipe.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "lanes_widest.h"
#include "pipe_inside.h"

/* Air that rests, for cells that are none. */
static const double AIR[PIPE_STATES] = {1.2, 0.0, 2.5e5};
/* How often a step is halved at most. */
enum { MOST_HALVED = 12 };
enum { ROWS = 4 * PIPE_STATES + PIPE_CONSTANTS + PIPE_SIDES + 2 * PIPE_STATES + PIPE_LEAKS + 1 };

static void fill(pipe *self, double *row, double value)
{
    for (long long int i = -PIPE_EDGE; i < self->stride - PIPE_EDGE; ++i) row[i] = value;
}

pipe *pipe_create(long long int cells, const double *state, const double *constants)
{
    pipe *self = (pipe *)calloc(1, sizeof *self);
    if (!self) return NULL;
    self->cells = cells;
    self->stride = (cells + 7) / 8 * 8 + 3 * PIPE_EDGE;
    self->lanes = lanes_of_processor();
    self->memory = (double *)calloc((size_t)(ROWS * self->stride), sizeof(double));
    if (!self->memory) {
        free(self);
        return NULL;
    }
    double *row = self->memory + PIPE_EDGE;
    const struct {
        double **first;
        int rows;
    } parts[] = {{&self->state, PIPE_STATES}, {&self->before, PIPE_STATES}, {&self->kept, PIPE_STATES}, {&self->first, PIPE_STATES}, {&self->given, PIPE_CONSTANTS}, {&self->side, PIPE_SIDES},
                 {&self->flux, PIPE_STATES},  {&self->rate, PIPE_STATES},   {&self->leak, PIPE_LEAKS},     {&self->time, 1}};
    for (size_t part = 0; part < sizeof parts / sizeof *parts; ++part) {
        *parts[part].first = row;
        row += parts[part].rows * self->stride;
    }
    for (int n = 0; n < PIPE_STATES; ++n) {
        fill(self, self->state + n * self->stride, AIR[n]);
        memcpy(self->state + n * self->stride, state + n * cells, (size_t)cells * sizeof(double));
    }
    for (int n = 0; n < PIPE_CONSTANTS; ++n) {
        fill(self, self->given + n * self->stride, 1.0);
        memcpy(self->given + n * self->stride, constants + n * cells, (size_t)cells * sizeof(double));
    }
    for (long long int i = 0; i < cells; ++i) self->leaks |= self->given[i + 5 * self->stride] > 0.0;
    for (int n = 0; n < PIPE_SIDES; ++n) fill(self, self->side + n * self->stride, 1.0);
    for (int end = 0; end < 2; ++end) self->outside[end] = (pipe_outside){0.0, 1.0, 1e5, 293.15};
    return self;
}

void pipe_free(pipe *self)
{
    if (!self) return;
    free(self->memory);
    free(self);
}

void pipe_end(pipe *self, int end, const pipe_outside *outside)
{
    self->outside[end] = *outside;
}

void pipe_state(const pipe *self, double *state)
{
    for (int n = 0; n < PIPE_STATES; ++n)
        memcpy(state + n * self->cells, self->state + n * self->stride, (size_t)self->cells * sizeof(double));
}

const pipe_passed *pipe_has_passed(const pipe *self)
{
    return &self->passed;
}

static void in_lanes(pipe *self, void (*one)(pipe *), void (*two)(pipe *), void (*four)(pipe *), void (*eight)(pipe *))
{
    (self->lanes >= 8 ? eight : self->lanes >= 4 ? four : self->lanes >= 2 ? two : one)(self);
}
#if LANES_WIDEST >= 8
#define IN_LANES(what) in_lanes(self, what##_1, what##_2, what##_4, what##_8)
#elif LANES_WIDEST >= 2
#define IN_LANES(what) in_lanes(self, what##_1, what##_2, what##_2, what##_2)
#else
#define IN_LANES(what) in_lanes(self, what##_1, what##_1, what##_1, what##_1)
#endif

/* Cells beyond a closed end are the mirror of those inside, beyond an open one the same as those. */
static void mirror(pipe *self)
{
    const long long int n = self->cells;
    for (int row = 0; row < PIPE_STATES; ++row) {
        double *u = self->state + row * self->stride;
        u[-1] = row == 1 && self->outside[0].opening == 0.0 ? -u[0] : u[0];
        u[n] = row == 1 && self->outside[1].opening == 0.0 ? -u[n - 1] : u[n - 1];
    }
}

/* What passes an end, per square metre, outwards; and what that is along the pipe. */
static void pass_end(pipe *self, int end, double *out)
{
    const long long int place = end ? self->cells - 1 : 0;
    const double outwards = end ? 1.0 : -1.0, *side = self->side + (end ? PIPE_STATES : 0) * self->stride + place;
    const pipe_outside *o = &self->outside[end];
    const double air[PIPE_STATES] = {side[0], outwards * side[self->stride], side[2 * self->stride]};
    const double outside[] = {o->opening, o->area, o->pressure, o->temperature};
    pipe_ending_1(air, outside, out);
    double *flux = self->flux + (end ? self->cells : 0);
    flux[0] = outwards * out[0];
    flux[self->stride] = out[1];
    flux[2 * self->stride] = outwards * out[2];
}

static double volume(const pipe *self, long long int i)
{
    const double *length = self->given, *diameter = length + self->stride;
    return 0.78539816339744831 * diameter[i] * diameter[i] * length[i];
}

/* Takes from the rates what leaks. */
static void leak(pipe *self, pipe_passed *passed)
{
    IN_LANES(pipe_leaks);
    double *mass = self->leak, *energy = mass + self->stride;
    for (long long int i = 0; i < self->cells; ++i) {
        self->rate[i] -= mass[i];
        self->rate[i + 2 * self->stride] -= energy[i];
        passed->leak_mass += volume(self, i) * mass[i];
        passed->leak_energy += volume(self, i) * energy[i];
    }
}

/* Rates of all cells; the fastest wave over the length of its cell [1/s]. passed: what leaves in a second. */
static double rates(pipe *self, pipe_passed *passed)
{
    double through[2];
    mirror(self);
    IN_LANES(pipe_sides);
    IN_LANES(pipe_faces);
    for (int end = 0; end < 2; ++end) {
        double out[PIPE_STATES + 1];
        pass_end(self, end, out);
        through[end] = out[PIPE_STATES];
        passed->end_mass[end] = out[0] * self->outside[end].area;
        passed->end_energy[end] = out[2] * self->outside[end].area;
    }
    IN_LANES(pipe_rates);
    passed->leak_mass = passed->leak_energy = 0.0;
    if (self->leaks) leak(self, passed);
    const double *wave = self->side + 6 * self->stride, *length = self->given;
    double fastest = 0.0;
    for (long long int i = 0; i < self->cells; ++i)
        fastest = wave[i] > fastest * length[i] ? wave[i] / length[i] : fastest;
    const long long int last = self->cells - 1;
    return fmax(fastest, fmax((wave[0] + through[0]) / length[0], (wave[last] + through[1]) / length[last]));
}

static void add(pipe_passed *to, const pipe_passed *more, double time)
{
    for (int end = 0; end < 2; ++end) {
        to->end_mass[end] += time * more->end_mass[end];
        to->end_energy[end] += time * more->end_energy[end];
    }
    to->leak_mass += time * more->leak_mass;
    to->leak_energy += time * more->leak_energy;
}

/* Heat exchange with the walls for a time. */
static void warm(pipe *self, double time)
{
    for (long long int i = 0; i < self->cells; ++i) self->time[i] = time;
    IN_LANES(pipe_warm);
    double *energy = self->state + 2 * self->stride;
    for (long long int i = 0; i < self->cells; ++i) {
        self->passed.heat += volume(self, i) * (self->rate[i] - energy[i]);
        energy[i] = self->rate[i];
    }
}

/* state = share of what was before, and the rest of what the rates make of it in a step. */
static void go_on(pipe *self, double share, double step)
{
    for (int row = 0; row < PIPE_STATES; ++row) {
        double *u = self->state + row * self->stride;
        const double *first = self->before + row * self->stride, *rate = self->rate + row * self->stride;
        for (long long int i = 0; i < self->cells; ++i) u[i] = share * first[i] + (1.0 - share) * (u[i] + step * rate[i]);
    }
}

static void copy(pipe *self, double *to, const double *from)
{
    memcpy(to - PIPE_EDGE, from - PIPE_EDGE, (size_t)(PIPE_STATES * self->stride) * sizeof(double));
}

static bool sound(const pipe *self)
{
    const double *density = self->state, *momentum = density + self->stride, *energy = momentum + self->stride;
    for (long long int i = 0; i < self->cells; ++i)
        if (!(density[i] > 0.0 && isfinite(energy[i]) && energy[i] * density[i] > momentum[i] * momentum[i] / 2.0)) return false;
    return true;
}

/* One step: Heun's between two halves of heat exchange. */
static void step_on(pipe *self, double step)
{
    pipe_passed first, second;
    warm(self, step / 2.0);
    copy(self, self->before, self->state);
    rates(self, &first);
    go_on(self, 0.0, step);
    rates(self, &second);
    go_on(self, 0.5, step);
    add(&self->passed, &first, step / 2.0);
    add(&self->passed, &second, step / 2.0);
    warm(self, step / 2.0);
}

/* Of what is left, a step that waves allow, or half of it as often as that leads nowhere; how long it was, 0: there is none. */
static double step_of(pipe *self, double left, double courant)
{
    pipe_passed passed = self->passed, unused;
    const double fastest = rates(self, &unused);
    copy(self, self->kept, self->state);
    for (int halved = 0; halved < MOST_HALVED; ++halved) {
        const double count = ceil(ldexp(left * fastest / courant, halved));
        if (!(count < 1e9)) return 0.0;
        const double step = left / fmax(count, 1.0);
        step_on(self, step);
        if (sound(self)) return step;
        copy(self, self->state, self->kept);
        self->passed = passed;
    }
    return 0.0;
}

long long int pipe_advance(pipe *self, double time, double courant)
{
    const pipe_passed passed = self->passed;
    copy(self, self->first, self->state);
    long long int steps = 0;
    for (double left = time; left > 0.0; ++steps) {
        const double step = step_of(self, left, courant);
        if (step == 0.0) {
            copy(self, self->state, self->first);
            self->passed = passed;
            return -1;
        }
        left -= step;
    }
    return steps;
}
