/* The cab: main reservoirs with compressors, direct brakes, bail-off and its interlock with the electric brake, vigilance. */
#include <math.h>
#include <stdlib.h>

#include "rows.h"
#include "train_inside.h"

/* Longest part of a step over the time in which a direct brake comes to rest. Assumed: Heun's method is stable up to 2. */
static const double PART = 1.0;
/* Variables of a run. For each vehicle: pressures of reservoir and direct brake [Pa], whether the compressor runs, its air [kg].
 * For each valve: the time since an acknowledgement [s], the penalty, and whether it was acknowledged. */
enum { RUN_RESERVOIR, RUN_DIRECT, RUN_COMPRESSOR, RUN_AIR, OF_VEHICLE };
enum { RUN_SINCE, RUN_PENALTY, RUN_ACKNOWLEDGED, OF_DESK };

long long int cab_numbers(const train *self) {
    return self->has_cab ? OF_VEHICLE * self->vehicles + OF_DESK * self->valves : 0;
}
static double *vehicle_run(const train *self, int row) { return cab_run(self) + row * self->vehicles; }
static double *desk_run(const train *self, int row) { return vehicle_run(self, OF_VEHICLE) + row * self->valves; }

/* True if a vehicle's distributor can be bailed off by the electric brake. */
static int has_interlock(const double *electric, long long int i, long long int stride) {
    return electric[ELECTRIC_BLENDING * stride + i] == INTERLOCK;
}

/* True if a vehicle has a direct brake or a main reservoir. */
static int has_air(const double *const at[LAYOUT_GROUPS], long long int i, long long int count) {
    return at[GROUP_DIRECT][DIRECT_DIRECT_PRESSURE * count + i] > 0.0 ||
           at[GROUP_MAIN][MAIN_RESERVOIR_VOLUME * count + i] > 0.0;
}

int cab_is_stated(const long long int counts[LAYOUT_OWNERS], const double *const at[LAYOUT_GROUPS]) {
    const long long int count = counts[OF_VEHICLES], valves = counts[OF_VALVES];
    int found = rows_any(at[GROUP_VIGILANCE] + VIGILANCE_VIGILANCE_TIME * valves, valves);
    for (long long int i = 0; i < count; ++i) found |= has_air(at, i, count) || has_interlock(at[GROUP_ELECTRIC], i, count);
    return found;
}

/* Copies the numbers of vehicles that have air of their own. */
static void put_air(const train *self, const double *const at[LAYOUT_GROUPS]) {
    cab *own = self->cab;
    const long long int count = self->vehicles;
    for (long long int i = 0; i < count; ++i) {
        if (!has_air(at, i, count)) continue;
        const long long int k = own->count++;
        own->vehicle[k] = i;
        for (int n = 0; n < DIRECT_ROWS; ++n) own->direct[n * own->stride + k] = at[GROUP_DIRECT][n * count + i];
        for (int n = 0; n < MAIN_ROWS; ++n) own->main[n * own->stride + k] = at[GROUP_MAIN][n * count + i];
        const double cylinder = at[GROUP_DIRECT][DIRECT_DIRECT_VOLUME * count + i];
        const double reservoir = at[GROUP_MAIN][MAIN_RESERVOIR_VOLUME * count + i];
        const double share = reservoir > 0.0 ? cylinder / reservoir : 0.0; /* of a change, as a small reservoir falls too */
        own->pace = fmax(own->pace, (1.0 + share) * at[GROUP_DIRECT][DIRECT_DIRECT_PACE * count + i]);
    }
}

int cab_create(train *self, const double *const at[LAYOUT_GROUPS]) {
    if (!self->has_cab) return 1;
    cab *own = self->cab = (cab *)calloc(1, sizeof *own);
    if (!own) return 0;
    own->stride = self->stride;
    own->lanes = self->lanes;
    const rows_part parts[] = {{&own->direct, DIRECT_ROWS, 1.0},
                               {&own->main, MAIN_ROWS, 1.0},
                               {&own->pressure, PRESSED_ROWS, AMBIENT},
                               {&own->before, PRESSED_ROWS, AMBIENT},
                               {&own->order, DIRECTLY_ROWS, 0.0},
                               {&own->rate, PRESSED_ROWS, 0.0},
                               {&own->pumped, PUMPED_ROWS, 1.0},
                               {&own->pumps, 2, 0.0},
                               {&own->held, 1, 0.0},
                               {&own->vented, 1, 0.0},
                               {&own->full, 1, 0.0}};
    own->memory = ROWS_LAY(parts, own->stride);
    own->vehicle = (long long int *)calloc((size_t)self->vehicles, sizeof(long long int));
    own->desk = (double *)calloc((size_t)(VIGILANCE_ROWS * self->valves), sizeof(double));
    if (!own->memory || !own->vehicle || !own->desk) return 0;
    put_air(self, at);
    rows_copy(own->full, at[GROUP_DIRECT] + DIRECT_DIRECT_PRESSURE * self->vehicles, self->vehicles);
    rows_copy(own->desk, at[GROUP_VIGILANCE], VIGILANCE_ROWS * self->valves);
    for (long long int i = 0; i < self->vehicles; ++i)
        own->bails |= own->full[i] > 0.0 || has_interlock(self->electric, i, self->stride);
    return 1;
}

void cab_free(cab *self) {
    if (!self) return;
    free(self->memory);
    free(self->vehicle);
    free(self->desk);
    free(self);
}

void cab_begin(train *self) {
    const cab *own = self->cab;
    for (long long int i = 0; i < self->vehicles; ++i) self->output[OUT_MAIN_RESERVOIR_PRESSURE][i] = AMBIENT;
    if (!own) return;
    for (long long int i = 0; i < 2 * self->vehicles; ++i) cab_run(self)[i] = AMBIENT;
    for (long long int k = 0; k < own->count; ++k)
        vehicle_run(self, RUN_RESERVOIR)[own->vehicle[k]] = own->main[MAIN_START_PRESSURE * own->stride + k] + AMBIENT;
}

void cab_acknowledge(train *self, const double *before) {
    if (!self->cab) return;
    for (long long int v = 0; v < self->valves; ++v) {
        if (self->input[IN_VIGILANCE][v] == before[v]) continue;
        desk_run(self, RUN_SINCE)[v] = 0.0;
        desk_run(self, RUN_ACKNOWLEDGED)[v] = 1.0;
    }
}

/* A time that is reached, within the rounding of its sum. */
static int reached(double time, double limit) { return time >= limit * (1.0 - 1e-12); }

void cab_watch(train *self, double step) {
    const cab *own = self->cab;
    if (!own) return;
    for (long long int v = 0; v < self->valves; ++v) {
        const double *given = own->desk + v, time = given[VIGILANCE_VIGILANCE_TIME * self->valves];
        double *since = desk_run(self, RUN_SINCE) + v, *penalty = desk_run(self, RUN_PENALTY) + v;
        double *acknowledged = desk_run(self, RUN_ACKNOWLEDGED) + v;
        const long long int vehicle = (long long int)given[VIGILANCE_VEHICLE * self->valves];
        if (time == 0.0) continue;
        if (fabs(motion_speed(self->moves)[vehicle]) < STANDS) {
            *since = 0.0;
            if (*acknowledged > 0.0) *penalty = PENALTY_NONE;
            continue;
        }
        *since += step;
        if (*penalty == PENALTY_NONE && reached(*since, time + given[VIGILANCE_WARNING_TIME * self->valves])) {
            *penalty = given[VIGILANCE_VIGILANCE_PENALTY * self->valves];
            *acknowledged = 0.0;
        }
    }
}

double cab_penalty(const train *self, long long int valve) { return self->cab ? desk_run(self, RUN_PENALTY)[valve] : 0.0; }

double cab_supply(const train *self, long long int valve, double *volume) {
    const cab *own = self->cab;
    *volume = 0.0;
    const double *given = self->valve + valve * VALVE_ROWS;
    if (!own || given[VALVE_RUNNING] < given[VALVE_AROUND]) return given[VALVE_SUPPLY]; /* a vacuum has an exhauster */
    const long long int vehicle = (long long int)own->desk[VIGILANCE_VEHICLE * self->valves + valve];
    for (long long int k = 0; k < own->count; ++k)
        if (own->vehicle[k] == vehicle) *volume = own->main[MAIN_RESERVOIR_VOLUME * own->stride + k];
    return *volume > 0.0 ? vehicle_run(self, RUN_RESERVOIR)[vehicle] : given[VALVE_SUPPLY];
}

/* True if the electric brake of a vehicle with the interlock is demanded and acts, above the speed at which it fades. */
static int acts(const train *self, long long int i) {
    const double *electric = self->electric + i;
    return has_interlock(self->electric, i, self->stride) && self->input[IN_DYNAMIC_BRAKE][i] > 0.0 && self->blended[i] > 0.0 &&
           fabs(motion_wheel(self->moves)[i]) >= electric[ELECTRIC_DYNAMIC_FADE * self->stride];
}

void cab_bail_off(train *self) {
    cab *own = self->cab;
    if (!own || !own->bails) return;
    for (long long int i = 0; i < self->vehicles; ++i) {
        const int has = own->full[i] > 0.0 || has_interlock(self->electric, i, self->stride);
        const int bailed = has && (self->input[IN_BAIL_OFF][i] == BAIL_OFF_ON || acts(self, i));
        protection_shares(self, i, &own->held[i], &own->vented[i]);
        if (!bailed) continue;
        own->held[i] = own->vented[i] = 1.0;
        pipe_vent_parts(self->air, i);
    }
    pipe_dump(self->air, own->held, own->vented);
}

static void find_rates(cab *self) { IN_LANES(cab_rate); }
static void find_pumps(cab *self) { IN_LANES(cab_pump); }

/* Direct brakes in a step, by Heun's method in parts of it. */
static void fill_cylinders(train *self, double step) {
    cab *own = self->cab;
    const double count = ceil(fmax(1.0, step * own->pace / PART)), part = step / count;
    for (double n = 0.0; n < count; ++n)
        for (int second = 0; second < 2; ++second) {
            if (!second) rows_copy(own->before, own->pressure, (PRESSED_ROWS - 1) * own->stride + own->count);
            find_rates(own);
            for (int row = 0; row < PRESSED_ROWS; ++row)
                pipe_mix(own->pressure + row * own->stride, own->before + row * own->stride, own->rate + row * own->stride,
                         own->count, second ? 0.5 : 0.0, part);
        }
}

/* Compressors in a step. */
static void pump(train *self, double step) {
    cab *own = self->cab;
    double *runs = vehicle_run(self, RUN_COMPRESSOR), *air = vehicle_run(self, RUN_AIR);
    rows_copy(own->pumped + PUMPED_PRESSURE * own->stride, own->pressure + PRESSED_RESERVOIR * own->stride, own->count);
    for (long long int k = 0; k < own->count; ++k) {
        own->pumped[PUMPED_RUNS * own->stride + k] = runs[own->vehicle[k]];
        own->pumped[PUMPED_STEP * own->stride + k] = step;
    }
    find_pumps(own);
    for (long long int k = 0; k < own->count; ++k) {
        double *pressure = own->pressure + PRESSED_RESERVOIR * own->stride + k;
        const double volume = own->main[MAIN_RESERVOIR_VOLUME * own->stride + k];
        air[own->vehicle[k]] += (own->pumps[k] - *pressure) * volume / (GAS_CONSTANT * WALL);
        *pressure = own->pumps[k];
        runs[own->vehicle[k]] = own->pumps[own->stride + k];
    }
}

int cab_advance(train *self, double step) {
    cab *own = self->cab;
    if (!own || !own->count) return 1;
    double *reservoir = vehicle_run(self, RUN_RESERVOIR), *direct = vehicle_run(self, RUN_DIRECT);
    for (long long int v = 0; v < self->valves; ++v) {
        const long long int vehicle = (long long int)own->desk[VIGILANCE_VEHICLE * self->valves + v];
        reservoir[vehicle] -= pipe_drawn(self->air, (int)v); /* 0 of a constant supply */
    }
    for (long long int k = 0; k < own->count; ++k) {
        const long long int i = own->vehicle[k];
        own->pressure[PRESSED_RESERVOIR * own->stride + k] = reservoir[i];
        own->pressure[PRESSED_CYLINDER * own->stride + k] = direct[i];
        own->order[DIRECTLY_WANTED * own->stride + k] = self->input[IN_DIRECT_BRAKE][i];
        protection_shares(self, i, &own->order[DIRECTLY_HELD * own->stride + k],
                          &own->order[DIRECTLY_VENTED * own->stride + k]);
    }
    fill_cylinders(self, step);
    pump(self, step);
    int sound = 1;
    for (long long int k = 0; k < own->count; ++k) {
        const long long int i = own->vehicle[k];
        reservoir[i] = own->pressure[PRESSED_RESERVOIR * own->stride + k];
        direct[i] = own->pressure[PRESSED_CYLINDER * own->stride + k];
        sound &= reservoir[i] > 0.0 && direct[i] > 0.0 && isfinite(reservoir[i] + direct[i]);
    }
    return sound;
}

void cab_press(const train *self, double *cylinder) {
    if (!self->cab) return;
    const double *direct = vehicle_run(self, RUN_DIRECT);
    for (long long int i = 0; i < self->vehicles; ++i) cylinder[i] = fmax(cylinder[i], direct[i]);
}

void cab_outputs(train *self) {
    for (long long int v = 0; v < self->valves; ++v) self->output[OUT_PENALTY_APPLIED][v] = valves_penalty(self, v);
    const cab *own = self->cab;
    if (!own) return;
    for (long long int k = 0; k < own->count; ++k) {
        const long long int i = own->vehicle[k];
        if (!(own->main[MAIN_RESERVOIR_VOLUME * own->stride + k] > 0.0)) continue;
        self->output[OUT_MAIN_RESERVOIR_PRESSURE][i] = vehicle_run(self, RUN_RESERVOIR)[i];
        self->output[OUT_COMPRESSOR_ON][i] = vehicle_run(self, RUN_COMPRESSOR)[i];
        self->output[OUT_COMPRESSOR_AIR][i] = vehicle_run(self, RUN_AIR)[i];
    }
    for (long long int v = 0; v < self->valves; ++v) {
        const double time = own->desk[VIGILANCE_VIGILANCE_TIME * self->valves + v];
        self->output[OUT_VIGILANCE_WARNING][v] = time > 0.0 && reached(desk_run(self, RUN_SINCE)[v], time);
    }
}
