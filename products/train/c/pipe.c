/* pipe.h: memory, steps, ends and balances. */
#include "pipe.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "pipe_inside.h"
#include "rows.h"

/* Air at rest, for cells outside the pipe. */
static const double AIR[PIPE_STATES] = {1.2, 0.0, 2.5e5};
/* A step that is shorter than this share of the limit by waves in the previous step is not checked again: air flow at the speed
 * of sound doubles the speed of waves. */
static const double WELL_BELOW = 0.4;
/* Largest number of halvings of a step. */
enum { MOST_HALVED = 12 };
/* Rate of friction over speed and diameter at Re of 2e5, 7/8 f of Blasius [1] (`dragging`). Waves limit the step more than friction
 * where k L |u| < c + |u|, k = DRAG / D: below a speed of waves, with the speed c of sound between these [m/s]. */
static const double DRAG = 0.0131, SLOW_SOUND = 320.0, SOUND = 343.0;
/* Opening of a parted hose, as a share of the pipe's area. Assumed. */
static const double HOSE = 0.9;

static double volume(const pipe *self, long long int i) {
    const double *length = self->given, *diameter = length + self->stride, *branch = length + CELL_BRANCH * self->stride;
    return 0.78539816339744831 * diameter[i] * diameter[i] * (length[i] + branch[i]);
}

pipe *pipe_create(long long int cells, const double *state, const double *constants) {
    pipe *self = (pipe *)calloc(1, sizeof *self);
    if (!self) return NULL;
    self->cells = cells;
    self->stride = rows_stride(cells);
    self->lanes = lanes_of_processor();
    const rows_part parts[] = {{&self->state, PIPE_STATES, 0.0},
                               {&self->before, PIPE_STATES, 0.0},
                               {&self->kept, PIPE_STATES, 0.0},
                               {&self->first, PIPE_STATES, 0.0},
                               {&self->given, CELL_ROWS, 1.0},
                               {&self->side, PIPE_SIDES, 1.0},
                               {&self->flux, PIPE_STATES, 0.0},
                               {&self->rate, PIPE_STATES, 0.0},
                               {&self->leak, PIPE_LEAKS, 0.0},
                               {&self->time, 1, 0.0},
                               {&self->jump, PIPE_STATES, 0.0},
                               {&self->over_volume, 1, 0.0},
                               {&self->drag, 1, 0.0},
                               {&self->dragged_from, 1, 0.0}};
    self->memory = ROWS_LAY(parts, self->stride);
    self->joint = (unsigned char *)calloc((size_t)(cells + 1), 1);
    if (!self->memory || !self->joint) {
        pipe_free(self);
        return NULL;
    }
    for (int n = 0; n < PIPE_STATES; ++n) rows_fill(self->state + n * self->stride, self->stride, AIR[n]);
    rows_put(self->state, self->stride, state, PIPE_STATES, cells);
    rows_put(self->given, self->stride, constants, CELL_ROWS, cells);
    for (long long int i = 0; i < cells; ++i) self->over_volume[i] = 1.0 / volume(self, i);
    self->leaks = rows_any(self->given + CELL_LEAK_AREA * self->stride, cells);
    for (long long int i = 0; i < cells; ++i) {
        const double *own = self->given + i,
                     drag = DRAG * own[CELL_FRICTION * self->stride] / own[CELL_DIAMETER * self->stride];
        self->dragged_from[i] = drag * own[0] > 1.0 ? SLOW_SOUND + SOUND / (drag * own[0] - 1.0) : INFINITY;
    }
    for (int end = 0; end < 2; ++end) self->outside[end] = (pipe_outside){0.0, 1.0, 1e5, 293.15};
    return self;
}

void pipe_free(pipe *self) {
    if (!self) return;
    free(self->memory);
    free(self->joint);
    distributors_free(self);
    free(self);
}

void pipe_give(pipe *self, long long int cell, double pressure) {
    self->state[cell + 2 * self->stride] = 2.5 * pressure; /* p / (kappa - 1), at rest */
    self->state[cell + self->stride] = 0.0;
}

void pipe_fill(pipe *self, double density, double pressure) {
    for (long long int i = 0; i < self->cells; ++i) {
        self->state[i] = density;
        pipe_give(self, i, pressure);
    }
    for (int valve = 0; valve < MOST_VALVES; ++valve) self->valve[valve].at = 0.0;
    memset(&self->passed, 0, sizeof self->passed);
    self->fastest = self->found_since = 0.0;
}

void pipe_end(pipe *self, int end, const pipe_outside *outside) {
    self->outside[end] = *outside;
    self->found_since = 0.0;
}

void pipe_join(pipe *self, long long int face, int how) {
    self->found_since = 0.0;
    self->joints += (how != HOSE_STATE_WHOLE) - (self->joint[face] != HOSE_STATE_WHOLE);
    self->joint[face] = (unsigned char)how;
}

long long int pipe_numbers(const pipe *self) {
    const long long int passed = (long long int)(sizeof self->passed / sizeof(double));
    return PIPE_STATES * self->cells + distributors_numbers(self) + passed + MOST_VALVES;
}

void pipe_save(const pipe *self, double *numbers) {
    pipe_state(self, numbers);
    distributors_save(self, numbers += PIPE_STATES * self->cells);
    numbers += distributors_numbers(self);
    memcpy(numbers, &self->passed, sizeof self->passed);
    for (int valve = 0; valve < MOST_VALVES; ++valve)
        numbers[sizeof self->passed / sizeof(double) + valve] = self->valve[valve].at;
}

void pipe_load(pipe *self, const double *numbers) {
    rows_put(self->state, self->stride, numbers, PIPE_STATES, self->cells);
    distributors_load(self, numbers += PIPE_STATES * self->cells);
    numbers += distributors_numbers(self);
    memcpy(&self->passed, numbers, sizeof self->passed);
    self->fastest = self->found_since = 0.0; /* it belonged to another state and is searched again */
    for (int valve = 0; valve < MOST_VALVES; ++valve)
        self->valve[valve].at = numbers[sizeof self->passed / sizeof(double) + valve];
}

void pipe_state(const pipe *self, double *state) { rows_get(state, self->state, self->stride, PIPE_STATES, self->cells); }

const pipe_passed *pipe_has_passed(const pipe *self) { return &self->passed; }

/* Cells beyond a closed end mirror those inside; beyond an open end they are equal to those. */
static void mirror(pipe *self) {
    const long long int n = self->cells;
    for (int row = 0; row < PIPE_STATES; ++row) {
        double *u = self->state + row * self->stride;
        u[-1] = row == 1 && self->outside[0].opening == 0.0 ? -u[0] : u[0];
        u[n] = row == 1 && self->outside[1].opening == 0.0 ? -u[n - 1] : u[n - 1];
    }
}

/* Flux per square metre out of the first (0) or the last end of a cell, and its speed. */
static void pass_end(const pipe *self, long long int place, int end, const pipe_outside *o, double *out) {
    const double outwards = end ? 1.0 : -1.0, *side = self->side + (end ? PIPE_STATES : 0) * self->stride + place;
    const double air[PIPE_STATES] = {side[0], outwards * side[self->stride], side[2 * self->stride]};
    const double outside[] = {o->opening, o->area, o->pressure, o->temperature};
    if (o->opening == 0.0) pipe_walled_1(air, out);
    else pipe_ending_1(air, outside, out);
}

/* Subtracts leakage from the rates. */
static void leak(pipe *self, pipe_passed *passed) {
    IN_LANES(pipe_leaks);
    double *mass = self->leak, *energy = mass + self->stride;
    for (long long int i = 0; i < self->cells; ++i) {
        self->rate[i] -= mass[i];
        self->rate[i + 2 * self->stride] -= energy[i];
        passed->leak_mass += volume(self, i) * mass[i];
        passed->leak_energy += volume(self, i) * energy[i];
    }
}

static double area_of(const pipe *self, long long int cell) {
    const double diameter = self->given[cell + CELL_DIAMETER * self->stride];
    return 0.78539816339744831 * diameter * diameter;
}

void pipe_valve(pipe *self, int valve, long long int face, const double numbers[VALVE_NUMBERS]) {
    valve_at *own = &self->valve[valve];
    own->face = face;
    memcpy(own->numbers, numbers, VALVE_NUMBERS * sizeof(double));
    own->numbers[TAP_AREA_BEHIND] = face > 0 && !self->joint[face] ? area_of(self, face - 1) : 0.0;
    own->numbers[TAP_AREA_AHEAD] = face < self->cells ? area_of(self, face) : 0.0;
    if (valve >= self->valves) self->valves = valve + 1;
    pipe_supply(self, valve, 0.0);
}

void pipe_supply(pipe *self, int valve, double volume) {
    valve_at *own = &self->valve[valve];
    own->supply = own->numbers[TAP_SUPPLY_PRESSURE];
    own->per_mass = volume > 0.0 ? GAS_CONSTANT * own->numbers[TAP_SUPPLY_TEMPERATURE] / volume : 0.0;
    self->drawn[STATE][valve] = 0.0;
}

double pipe_drawn(const pipe *self, int valve) { return self->drawn[STATE][valve]; }

/* Cells at separated faces have the same state beyond them. */
static void look_at_joints(pipe *self) {
    for (long long int face = 1; face < self->cells; ++face)
        for (int ahead = 0; ahead < 2 && self->joint[face]; ++ahead) {
            const long long int own = face - 1 + ahead;
            double cells[3][PIPE_STATES], found[PIPE_SIDES];
            for (int n = 0; n < PIPE_STATES; ++n)
                for (int k = 0; k < 3; ++k) {
                    const double *u = self->state + n * self->stride;
                    const int beyond = (ahead && k == 0) || (!ahead && k == 2);
                    const double mirrored = n == 1 && self->joint[face] == HOSE_STATE_SHUT ? -1.0 : 1.0;
                    cells[k][n] = beyond ? mirrored * u[own] : u[own + k - 1];
                }
            pipe_side_1(cells[0], cells[1], cells[2], found);
            for (int n = 0; n < PIPE_SIDES; ++n) self->side[own + n * self->stride] = found[n];
        }
}

/* The pressure at a driver's valve at which the waves match its flow: Newton's method within a bracket. */
static double meet(valve_at *own, const double *behind, const double *ahead) {
    enum { MOST = 60 };
    double low = 0.02 * fmin(behind[2], ahead[2]),
           high = 4.0 * fmax(fmax(behind[2], ahead[2]), own->numbers[TAP_SUPPLY_PRESSURE]), found[TAP_FOUND];
    double at = own->at > low && own->at < high ? own->at : behind[2];
    for (int turn = 0; turn < MOST; ++turn) {
        pipe_tapping_1(&at, behind, ahead, own->numbers, found);
        if (found[0] > 0.0) low = at;
        else high = at;
        const double better = at - found[0] / found[1], near = 1e-11 * at;
        if (fabs(better - at) < near || high - low < near) break;
        at = better > low && better < high ? better : (low + high) / 2.0;
    }
    return own->at = at;
}

/* Sets the fluxes on both sides of a face of a joint or a valve; stores the excess of the cell before it over the shared
 * flux. */
static void split_flux(pipe *self, long long int face, const double *behind, const double *ahead) {
    for (int n = 0; n < PIPE_STATES; ++n) {
        self->flux[face + n * self->stride] = face > 0 ? behind[n] : ahead[n];
        if (face > 0 && face < self->cells) self->jump[face + n * self->stride] = ahead[n] - behind[n];
    }
}

/* A valve is behind the cock of its joint: shut, it keeps the valve from the cell before it. An open hose lets the air of a valve
 * out at once. */
static void pass_valves(pipe *self, pipe_passed *passed) {
    for (int valve = 0; valve < self->valves; ++valve) {
        valve_at *own = &self->valve[valve];
        const long long int stride = self->stride, face = own->face, last = self->cells - 1;
        double air[2][PIPE_STATES], found[TAPPED];
        self->drawing[valve] = 0.0;
        if (self->joint[face] == HOSE_STATE_PARTED) continue;
        for (int n = 0; n < PIPE_STATES; ++n) {
            air[1][n] = face <= last ? self->side[face + n * stride] : self->side[last + (PIPE_STATES + n) * stride];
            air[0][n] = own->numbers[TAP_AREA_BEHIND] > 0.0 ? self->side[face - 1 + (PIPE_STATES + n) * stride] : air[1][n];
        }
        own->numbers[TAP_SUPPLY_PRESSURE] = own->supply - self->drawn[STATE][valve];
        const double at = meet(own, air[0], air[1]);
        pipe_tapped_1(&at, air[0], air[1], own->numbers, found);
        for (int n = 0; n < PIPE_STATES && self->joint[face]; ++n) found[n] = self->flux[face + n * stride];
        split_flux(self, face, found, found + PIPE_STATES);
        passed->valve_mass += found[VALVE_OUT];
        passed->valve_energy += found[ENERGY_OUT];
        passed->let_in += found[LET_IN];
        self->drawing[valve] = own->per_mass * found[LET_IN];
    }
}

/* Between separated cells: no flow, or all air leaves the pipe. */
static void pass_joints(pipe *self, pipe_passed *passed) {
    for (long long int face = 1; face < self->cells; ++face) {
        if (!self->joint[face]) continue;
        double out[2][PIPE_STATES + 1];
        for (int ahead = 0; ahead < 2; ++ahead) {
            const long long int own = face - 1 + ahead;
            const double area = area_of(self, own), *given = self->given + own;
            const double opening = self->joint[face] == HOSE_STATE_PARTED ? HOSE * area : 0.0;
            const pipe_outside o = {opening, area, given[CELL_AMBIENT_PRESSURE * self->stride],
                                    given[CELL_WALL_TEMPERATURE * self->stride]};
            pass_end(self, own, !ahead, &o, out[ahead]);
            passed->leak_mass += out[ahead][0] * area;
            passed->leak_energy += out[ahead][2] * area;
        }
        out[1][0] = -out[1][0];
        out[1][2] = -out[1][2];
        split_flux(self, face, out[0], out[1]);
    }
}

/* Adds the missing part of the rate of the cell before a face. */
static void add_jump(pipe *self, long long int face) {
    const double length = self->given[face], branch = self->given[face + CELL_BRANCH * self->stride];
    for (int n = 0; n < PIPE_STATES; ++n)
        self->rate[face + n * self->stride] += self->jump[face + n * self->stride] / (n == 1 ? length : length + branch);
}

static void add_jumps(pipe *self) {
    for (int valve = 0; valve < self->valves; ++valve) {
        const long long int face = self->valve[valve].face;
        if (face > 0 && face < self->cells && !self->joint[face]) add_jump(self, face);
    }
    for (long long int face = 1; face < self->cells && self->joints; ++face)
        if (self->joint[face]) add_jump(self, face);
}

/* Largest rate of change by waves and air in the cells next to valves [1/s]. */
static double fastest_at_valves(const pipe *self) {
    double fastest = 0.0;
    for (int valve = 0; valve < self->valves; ++valve)
        for (int ahead = 0; ahead < 2; ++ahead) {
            const valve_at *own = &self->valve[valve];
            const long long int cell = own->face - 1 + ahead, row = (ahead ? 0 : PIPE_STATES) * self->stride;
            if (cell < 0 || cell >= self->cells) continue;
            const double *side = self->side + row + cell, density = side[0], pressure = side[2 * self->stride];
            const double wave = self->side[cell + 6 * self->stride];
            const double through = own->at > 0.0 ? fabs(pressure - own->at) / (density * wave) : 0.0;
            fastest = fmax(fastest, (wave + through) / self->given[cell]);
        }
    return fastest;
}

/* Largest rate of friction [1/s]. At 0.8 over it, Heun's method damps. */
static double fastest_drag(pipe *self) {
    double fastest = 0.0;
    IN_LANES(pipe_drag);
    for (long long int i = 0; i < self->cells; ++i) fastest = fmax(fastest, self->drag[i]);
    return fastest;
}

/* Updates the sides of cells and the ends; returns the largest rate of change by waves and vehicles [1/s]. passed: through the
 * ends. */
static double fastest_rate(pipe *self, pipe_passed *passed) {
    if (self->brake_model == BRAKE_MODEL_DELAY) return self->pace / 2.0;
    double through[2];
    mirror(self);
    IN_LANES(pipe_sides);
    if (self->joints) look_at_joints(self);
    for (int end = 0; end < 2; ++end) {
        double out[PIPE_STATES + 1];
        pass_end(self, end ? self->cells - 1 : 0, end, &self->outside[end], out);
        through[end] = out[PIPE_STATES];
        passed->end_mass[end] = out[0] * self->outside[end].area;
        passed->end_energy[end] = out[2] * self->outside[end].area;
        for (int n = 0; n < PIPE_STATES; ++n) self->end_flux[end][n] = (n == 1 || end ? 1.0 : -1.0) * out[n];
    }
    const double *wave = self->side + 6 * self->stride, *length = self->given;
    double fastest = self->pace / 2.0; /* Heun's method is stable up to 2 over a pace */
    int dragged = 0;
    for (long long int i = 0; i < self->cells; ++i) {
        fastest = wave[i] > fastest * length[i] ? wave[i] / length[i] : fastest;
        dragged |= wave[i] > self->dragged_from[i];
    }
    if (dragged) fastest = fmax(fastest, fastest_drag(self));
    const long long int last = self->cells - 1;
    fastest = fmax(fastest, fastest_at_valves(self));
    return fmax(fastest, fmax((wave[0] + through[0]) / length[0], (wave[last] + through[1]) / length[last]));
}

/* Rates of all cells and vehicles. passed: outflow per second. */
static void rates(pipe *self, pipe_passed *passed) {
    memset(passed, 0, sizeof *passed);
    if (self->brake_model == BRAKE_MODEL_DELAY) {
        distributors_act(self, passed);
        return;
    }
    self->fastest = fastest_rate(self, passed);
    IN_LANES(pipe_faces);
    for (int end = 0; end < 2; ++end)
        for (int n = 0; n < PIPE_STATES; ++n) self->flux[(end ? self->cells : 0) + n * self->stride] = self->end_flux[end][n];
    if (self->joints) pass_joints(self, passed);
    if (self->valves) pass_valves(self, passed);
    IN_LANES(pipe_rates);
    if (self->valves || self->joints) add_jumps(self);
    if (self->leaks) leak(self, passed);
    distributors_act(self, passed);
}

/* Adds what has passed in a time; all members are numbers. */
static void add(pipe_passed *to, const pipe_passed *more, double time) {
    double *sum = (double *)to;
    for (size_t n = 0; n < sizeof *to / sizeof *sum; ++n) sum[n] += time * ((const double *)more)[n];
}

/* Heat exchange with the walls over a time. */
static void warm(pipe *self, double time) {
    if (self->brake_model == BRAKE_MODEL_DELAY) return;
    for (long long int i = 0; i < self->cells; ++i) self->time[i] = time;
    IN_LANES(pipe_warm);
    double *energy = self->state + 2 * self->stride;
    for (long long int i = 0; i < self->cells; ++i) {
        self->passed.heat += volume(self, i) * (self->rate[i] - energy[i]);
        energy[i] = self->rate[i];
    }
}

void pipe_mix(double *u, const double *first, const double *rate, long long int count, double share, double step) {
    for (long long int i = 0; i < count; ++i) u[i] = share * first[i] + (1.0 - share) * (u[i] + step * rate[i]);
}

/* state = share of the previous state, and the rest of the state after a step with these rates. */
static void go_on(pipe *self, double share, double step) {
    for (int row = 0; row < PIPE_STATES; ++row)
        pipe_mix(self->state + row * self->stride, self->before + row * self->stride, self->rate + row * self->stride,
                 self->cells, share, step);
    pipe_mix(self->drawn[STATE], self->drawn[BEFORE], self->drawing, self->valves, share, step);
    distributors_go_on(self, share, step);
}

static void copy(pipe *self, int to, int from) {
    double *blocks[] = {self->state, self->before, self->kept, self->first};
    rows_copy(blocks[to] - ROWS_EDGE, blocks[from] - ROWS_EDGE, (PIPE_STATES * self->stride));
    memcpy(self->drawn[to], self->drawn[from], sizeof self->drawn[to]);
    distributors_copy(self, to, from);
}

static bool sound(const pipe *self) {
    const double *density = self->state, *momentum = density + self->stride, *energy = momentum + self->stride;
    for (long long int i = 0; i < self->cells; ++i)
        if (!(density[i] > 0.0 && isfinite(energy[i]) && energy[i] * density[i] > momentum[i] * momentum[i] / 2.0))
            return false;
    return distributors_sound(self);
}

double pipe_longest(pipe *self, double courant) {
    pipe_passed unused;
    self->found_since = fastest_rate(self, &unused);
    return courant / self->found_since;
}

/* One step: Heun's between two halves of heat exchange. */
static void step_on(pipe *self, double step) {
    pipe_passed first, second;
    warm(self, step / 2.0);
    copy(self, BEFORE, STATE);
    rates(self, &first);
    go_on(self, 0.0, step);
    rates(self, &second);
    go_on(self, 0.5, step);
    add(&self->passed, &first, step / 2.0);
    add(&self->passed, &second, step / 2.0);
    warm(self, step / 2.0);
}

/* Takes a step of the remaining time that waves allow, halved until its result is valid; returns its length, 0: failed. */
static double step_of(pipe *self, double left, double courant) {
    pipe_passed passed = self->passed, unused;
    const int slow = left * self->fastest < WELL_BELOW * courant && self->fastest > 0.0;
    const double fastest = self->found_since > 0.0 ? self->found_since : slow ? self->fastest : fastest_rate(self, &unused);
    self->found_since = 0.0;
    copy(self, KEPT, STATE);
    for (int halved = 0; halved < MOST_HALVED; ++halved) {
        const double count = ceil(ldexp(left * fastest / courant, halved));
        if (!(count < 1e9)) return 0.0;
        const double step = left / fmax(count, 1.0);
        step_on(self, step);
        if (sound(self)) return step;
        copy(self, STATE, KEPT);
        self->passed = passed;
    }
    return 0.0;
}

long long int pipe_advance(pipe *self, double time, double courant) {
    const pipe_passed passed = self->passed;
    copy(self, FIRST, STATE);
    long long int steps = 0;
    for (double left = time; left > 0.0; ++steps) {
        const double step = step_of(self, left, courant);
        if (step == 0.0) {
            copy(self, STATE, FIRST);
            self->passed = passed;
            return -1;
        }
        left -= step;
    }
    return steps;
}
