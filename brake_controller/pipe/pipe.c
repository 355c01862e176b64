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
enum { OWN_ROWS = 4 * VEHICLE_STATES + VEHICLE_CONSTANTS + PIPE_STATES + VEHICLE_RATES };
/* How often a step is halved at most. */
enum { MOST_HALVED = 12 };
enum { ROWS = 4 * PIPE_STATES + PIPE_CONSTANTS + PIPE_SIDES + 2 * PIPE_STATES + PIPE_LEAKS + 1 };

static void fill(double *row, long long int stride, double value)
{
    for (long long int i = -PIPE_EDGE; i < stride - PIPE_EDGE; ++i) row[i] = value;
}

static long long int stride_of(long long int count)
{
    return (count + 7) / 8 * 8 + 3 * PIPE_EDGE;
}

pipe *pipe_create(long long int cells, const double *state, const double *constants)
{
    pipe *self = (pipe *)calloc(1, sizeof *self);
    if (!self) return NULL;
    self->cells = cells;
    self->stride = stride_of(cells);
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
        fill(self->state + n * self->stride, self->stride, AIR[n]);
        memcpy(self->state + n * self->stride, state + n * cells, (size_t)cells * sizeof(double));
    }
    for (int n = 0; n < PIPE_CONSTANTS; ++n) {
        fill(self->given + n * self->stride, self->stride, 1.0);
        memcpy(self->given + n * self->stride, constants + n * cells, (size_t)cells * sizeof(double));
    }
    for (long long int i = 0; i < cells; ++i) self->leaks |= self->given[i + 5 * self->stride] > 0.0;
    for (int n = 0; n < PIPE_SIDES; ++n) fill(self->side + n * self->stride, self->stride, 1.0);
    for (int end = 0; end < 2; ++end) self->outside[end] = (pipe_outside){0.0, 1.0, 1e5, 293.15};
    return self;
}

void pipe_free(pipe *self)
{
    if (!self) return;
    free(self->memory);
    free(self->own_memory);
    free(self->cell);
    free(self);
}

int pipe_vehicles(pipe *self, long long int count, const long long int *cell, const double *state, const double *given, double pace)
{
    const long long int stride = self->vehicle_stride = stride_of(count);
    free(self->own_memory);
    free(self->cell);
    self->vehicles = 0;
    self->cell = (long long int *)malloc((size_t)count * sizeof *cell);
    self->own_memory = (double *)calloc((size_t)(OWN_ROWS * stride), sizeof(double));
    if (!self->cell || !self->own_memory) return 0;
    memcpy(self->cell, cell, (size_t)count * sizeof *cell);
    double *row = self->own_memory + PIPE_EDGE;
    const struct {
        double **first;
        int rows;
    } parts[] = {{&self->own, VEHICLE_STATES},       {&self->own_before, VEHICLE_STATES}, {&self->own_kept, VEHICLE_STATES},
                 {&self->own_first, VEHICLE_STATES}, {&self->own_given, VEHICLE_CONSTANTS}, {&self->own_pipe, PIPE_STATES},
                 {&self->own_rate, VEHICLE_RATES}};
    for (size_t part = 0; part < sizeof parts / sizeof *parts; ++part) {
        *parts[part].first = row;
        row += parts[part].rows * stride;
    }
    for (int n = 0; n < VEHICLE_STATES; ++n) {
        fill(self->own + n * stride, stride, 1e5);
        memcpy(self->own + n * stride, state + n * count, (size_t)count * sizeof(double));
    }
    for (int n = 0; n < VEHICLE_CONSTANTS; ++n) {
        fill(self->own_given + n * stride, stride, 1.0);
        memcpy(self->own_given + n * stride, given + n * count, (size_t)count * sizeof(double));
    }
    for (int n = 0; n < PIPE_STATES; ++n) fill(self->own_pipe + n * stride, stride, AIR[n]);
    self->vehicles = count;
    self->pace = pace;
    return 1;
}

void pipe_vehicle_states(const pipe *self, double *state)
{
    for (int n = 0; n < VEHICLE_STATES; ++n)
        memcpy(state + n * self->vehicles, self->own + n * self->vehicle_stride, (size_t)self->vehicles * sizeof(double));
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

/* What passes an end outwards, per square metre, and how fast. */
static void pass_end(pipe *self, int end, double *out)
{
    const long long int place = end ? self->cells - 1 : 0;
    const double outwards = end ? 1.0 : -1.0, *side = self->side + (end ? PIPE_STATES : 0) * self->stride + place;
    const pipe_outside *o = &self->outside[end];
    const double air[PIPE_STATES] = {side[0], outwards * side[self->stride], side[2 * self->stride]};
    const double outside[] = {o->opening, o->area, o->pressure, o->temperature};
    pipe_ending_1(air, outside, out);
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

/* Takes from the rates what goes to vehicles, and finds theirs. */
static void distribute(pipe *self, pipe_passed *passed)
{
    const long long int stride = self->stride, own = self->vehicle_stride;
    for (long long int v = 0; v < self->vehicles; ++v)
        for (int n = 0; n < PIPE_STATES; ++n) self->own_pipe[v + n * own] = self->state[self->cell[v] + n * stride];
    IN_LANES(pipe_distribute);
    const double *mass = self->own_rate + VEHICLE_STATES * own, *energy = mass + own, *filled = energy + own;
    for (long long int v = 0; v < self->vehicles; ++v) {
        const long long int i = self->cell[v];
        self->rate[i] -= mass[v] / volume(self, i);
        self->rate[i + 2 * stride] -= energy[v] / volume(self, i);
        passed->vehicle_mass += mass[v];
        passed->vehicle_energy += energy[v];
        passed->cylinder_mass += filled[v];
    }
}

/* Looks at the sides of cells and at the ends; how fast waves and vehicles change at most [1/s]. passed: through the ends. */
static double look(pipe *self, pipe_passed *passed)
{
    double through[2];
    mirror(self);
    IN_LANES(pipe_sides);
    for (int end = 0; end < 2; ++end) {
        double out[PIPE_STATES + 1];
        pass_end(self, end, out);
        through[end] = out[PIPE_STATES];
        passed->end_mass[end] = out[0] * self->outside[end].area;
        passed->end_energy[end] = out[2] * self->outside[end].area;
        for (int n = 0; n < PIPE_STATES; ++n) self->end_flux[end][n] = (n == 1 || end ? 1.0 : -1.0) * out[n];
    }
    const double *wave = self->side + 6 * self->stride, *length = self->given;
    double fastest = self->vehicles ? self->pace / 2.0 : 0.0; /* Heun's method is stable up to 2 over a pace */
    for (long long int i = 0; i < self->cells; ++i)
        fastest = wave[i] > fastest * length[i] ? wave[i] / length[i] : fastest;
    const long long int last = self->cells - 1;
    return fmax(fastest, fmax((wave[0] + through[0]) / length[0], (wave[last] + through[1]) / length[last]));
}

/* Rates of all cells and vehicles. passed: what leaves in a second. */
static void rates(pipe *self, pipe_passed *passed)
{
    memset(passed, 0, sizeof *passed);
    look(self, passed);
    IN_LANES(pipe_faces);
    for (int end = 0; end < 2; ++end)
        for (int n = 0; n < PIPE_STATES; ++n) self->flux[(end ? self->cells : 0) + n * self->stride] = self->end_flux[end][n];
    IN_LANES(pipe_rates);
    if (self->leaks) leak(self, passed);
    distribute(self, passed);
}

static void add(pipe_passed *to, const pipe_passed *more, double time)
{
    for (int end = 0; end < 2; ++end) {
        to->end_mass[end] += time * more->end_mass[end];
        to->end_energy[end] += time * more->end_energy[end];
    }
    to->leak_mass += time * more->leak_mass;
    to->leak_energy += time * more->leak_energy;
    to->vehicle_mass += time * more->vehicle_mass;
    to->vehicle_energy += time * more->vehicle_energy;
    to->cylinder_mass += time * more->cylinder_mass;
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

static void mix(double *u, const double *first, const double *rate, long long int count, double share, double step)
{
    for (long long int i = 0; i < count; ++i) u[i] = share * first[i] + (1.0 - share) * (u[i] + step * rate[i]);
}

/* state = share of what was before, and the rest of what the rates make of it in a step. */
static void go_on(pipe *self, double share, double step)
{
    for (int row = 0; row < PIPE_STATES; ++row)
        mix(self->state + row * self->stride, self->before + row * self->stride, self->rate + row * self->stride, self->cells, share,
            step);
    for (int row = 0; row < VEHICLE_STATES && self->vehicles; ++row) {
        const long long int at = row * self->vehicle_stride;
        mix(self->own + at, self->own_before + at, self->own_rate + at, self->vehicles, share, step);
    }
}

static void copy(const pipe *self, double *to, const double *from, double *own, const double *own_from)
{
    memcpy(to - PIPE_EDGE, from - PIPE_EDGE, (size_t)(PIPE_STATES * self->stride) * sizeof(double));
    if (!self->vehicles) return;
    memcpy(own - PIPE_EDGE, own_from - PIPE_EDGE, (size_t)(VEHICLE_STATES * self->vehicle_stride) * sizeof(double));
}

static bool sound(const pipe *self)
{
    const double *density = self->state, *momentum = density + self->stride, *energy = momentum + self->stride;
    for (long long int i = 0; i < self->cells; ++i)
        if (!(density[i] > 0.0 && isfinite(energy[i]) && energy[i] * density[i] > momentum[i] * momentum[i] / 2.0)) return false;
    for (int row = 0; row < VEHICLE_STATES; ++row)
        for (long long int v = 0; v < self->vehicles; ++v)
            if (!(self->own[v + row * self->vehicle_stride] > 0.0 && isfinite(self->own[v + row * self->vehicle_stride]))) return false;
    return true;
}

/* One step: Heun's between two halves of heat exchange. */
static void step_on(pipe *self, double step)
{
    pipe_passed first, second;
    warm(self, step / 2.0);
    copy(self, self->before, self->state, self->own_before, self->own);
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
    const double fastest = look(self, &unused);
    copy(self, self->kept, self->state, self->own_kept, self->own);
    for (int halved = 0; halved < MOST_HALVED; ++halved) {
        const double count = ceil(ldexp(left * fastest / courant, halved));
        if (!(count < 1e9)) return 0.0;
        const double step = left / fmax(count, 1.0);
        step_on(self, step);
        if (sound(self)) return step;
        copy(self, self->state, self->kept, self->own, self->own_kept);
        self->passed = passed;
    }
    return 0.0;
}

long long int pipe_advance(pipe *self, double time, double courant)
{
    const pipe_passed passed = self->passed;
    copy(self, self->first, self->state, self->own_first, self->own);
    long long int steps = 0;
    for (double left = time; left > 0.0; ++steps) {
        const double step = step_of(self, left, courant);
        if (step == 0.0) {
            copy(self, self->state, self->first, self->own, self->own_first);
            self->passed = passed;
            return -1;
        }
        left -= step;
    }
    return steps;
}
