/* Driver's valves: the pressure of each, its history, and the effect on a second valve or a pipe without flow. */
#include <math.h>

#include "train_inside.h"

double *valves_run(train *self, long long int valve) { return self->run + RUN_VALVES + valve * OF_VALVE; }

/* State of a valve at a time: pressure (0), position (1) or step (2); linear between the multiples of HISTORY_STEP. */
static double delayed(train *self, long long int valve, int what, double time) {
    const double *row = valves_run(self, valve) + 1 + what * HISTORY, newest = self->run[RUN_TOLD];
    const double at = fmin(fmax(time / HISTORY_STEP, newest - HISTORY + 2.0), newest), before = floor(at);
    const long long int place = (long long int)fmod(before, HISTORY), own = place < 0 ? place + HISTORY : place;
    if (what) return row[own]; /* positions have no intermediate values */
    return row[own] + (at - before) * (row[(own + 1) % HISTORY] - row[own]);
}

double valves_penalty(const train *self, long long int valve) {
    return fmax(self->input[IN_PENALTY][valve], cab_penalty(self, valve));
}

/* Position and step of a valve by its own driver, or by a penalty that brakes more. */
static double ordered(const train *self, long long int valve, double *step) {
    const double penalty = valves_penalty(self, valve), position = self->input[IN_DRIVER_POSITION][valve];
    *step = self->input[IN_DRIVER_STEP][valve];
    if (penalty == PENALTY_EMERGENCY) return DRIVER_POSITION_EMERGENCY;
    if (penalty == PENALTY_NONE || position == DRIVER_POSITION_EMERGENCY) return position;
    if (position == DRIVER_POSITION_CONTINUOUS_SERVICE) return position;
    *step = 1.0;
    return DRIVER_POSITION_SERVICE;
}

static double position_of(train *self, long long int valve, double *step) {
    const double delay = self->valve[valve * VALVE_ROWS + VALVE_DELAY], time = self->run[RUN_TIME] - delay;
    const double own = ordered(self, valve, step);
    if (delay < 0.0 || own != DRIVER_POSITION_SHUT_OFF) return own;
    *step = delayed(self, 0, 2, time);
    return delayed(self, 0, 1, time);
}

/* True if the pipe is charged below the surroundings: its exhauster takes air out, and braking lets air in. */
static int holds_vacuum(const double *given) { return given[VALVE_RUNNING] < given[VALVE_AROUND]; }

/* Demanded pressure of a valve. */
static double wanted(const double *given, double position, double step) {
    if (position == DRIVER_POSITION_CONTINUOUS_SERVICE) return given[VALVE_AROUND];
    if (position == DRIVER_POSITION_SERVICE && holds_vacuum(given))
        return given[VALVE_RUNNING] + given[VALVE_FIRST] + step * (given[VALVE_FULL] - given[VALVE_FIRST]);
    if (position == DRIVER_POSITION_OVERCHARGE) return given[VALVE_OVERCHARGE];
    if (position == DRIVER_POSITION_SERVICE && given[VALVE_WIRED] == 0.0)
        return given[VALVE_RUNNING] - given[VALVE_FIRST] - step * (given[VALVE_FULL] - given[VALVE_FIRST]);
    return position == DRIVER_POSITION_EMERGENCY ? given[VALVE_AROUND] : given[VALVE_RUNNING];
}

/* Share of full service by which the pressure that a valve holds has fallen, or risen of a vacuum. */
static double fallen(const double *given, double held) {
    const double by = holds_vacuum(given) ? held - given[VALVE_RUNNING] : given[VALVE_RUNNING] - held;
    return given[VALVE_FULL] > 0.0 ? fmin(fmax(by, 0.0) / given[VALVE_FULL], 1.0) : 1.0;
}

double valves_demand(train *self, double step, double dead_time) {
    const double time = self->run[RUN_TIME] + step / 2.0 - dead_time + HISTORY_STEP; /* the end of its step is stored */
    double most = 0.0;
    for (long long int v = 0; v < self->valves; ++v) {
        const double *given = self->valve + v * VALVE_ROWS;
        double now;
        const double own = ordered(self, v, &now), position = dead_time > 0.0 ? delayed(self, v, 1, time) : own;
        const double service = dead_time > 0.0 ? delayed(self, v, 2, time) : now;
        const double least = given[VALVE_FULL] > 0.0 ? fmin(given[VALVE_FIRST] / given[VALVE_FULL], 1.0) : 1.0;
        if (position == DRIVER_POSITION_SERVICE) most = fmax(most, least + service * (1.0 - least));
        if (position == DRIVER_POSITION_HOLD || position == DRIVER_POSITION_CONTINUOUS_SERVICE)
            most = fmax(most, fallen(given, dead_time > 0.0 ? delayed(self, v, 0, time) : *valves_run(self, v)));
        if (position == DRIVER_POSITION_EMERGENCY) most = 1.0;
    }
    return most;
}

static double moved(const double *given, double held, double position, double step, double time) {
    const double target = wanted(given, position, step);
    if (position == DRIVER_POSITION_SHUT_OFF || position == DRIVER_POSITION_HOLD) return held;
    const int quickly = position == DRIVER_POSITION_EMERGENCY && holds_vacuum(given);
    if (held < target) return fmin(target, held + given[quickly ? VALVE_QUICKLY : VALVE_UP] * time);
    const int slowly = position == DRIVER_POSITION_RUNNING;
    return fmax(target, held - given[position == DRIVER_POSITION_EMERGENCY ? VALVE_QUICKLY
                                     : slowly                              ? VALVE_SLOWLY
                                                                           : VALVE_DOWN] *
                                   time);
}

/* Openings of a valve of a vacuum: exhauster and, in release, ejector; air is let in through the service or the emergency port. The
 * supply of such a valve is the lowest pressure that its exhauster reaches: a choke to it displaces a constant volume. */
static void open_vacuum(const double *given, double position, double regulates, double numbers[VALVE_NUMBERS]) {
    const double releases = position == DRIVER_POSITION_OVERCHARGE;
    numbers[TAP_SUPPLY_PRESSURE] = given[VALVE_AROUND];
    if (position == DRIVER_POSITION_EMERGENCY) { /* open to the surroundings, both ways */
        numbers[TAP_FEEDING] = given[VALVE_EMERGENCY];
        numbers[TAP_HELD] = given[VALVE_AROUND] + given[VALVE_BAND];
        return;
    }
    numbers[TAP_EXHAUST] = regulates * (given[VALVE_EXHAUST] + releases * given[VALVE_EJECTOR]);
    numbers[TAP_AMBIENT_PRESSURE] = given[VALVE_SUPPLY];
}

/* State of a valve in the middle of a step. */
void valves_command(train *self, double time) {
    for (long long int v = 0; v < self->valves; ++v) {
        const double *given = self->valve + v * VALVE_ROWS;
        double *held = valves_run(self, v), step;
        const double position = position_of(self, v, &step), before = *held;
        *held = moved(given, before, position, step, time);
        if (self->brake_model == BRAKE_MODEL_DELAY) continue;
        const double regulates = position != DRIVER_POSITION_SHUT_OFF && position != DRIVER_POSITION_EMERGENCY;
        double volume;
        const double supply = cab_supply(self, v, &volume);
        double numbers[VALVE_NUMBERS] = {regulates * given[VALVE_FEEDING],
                                         regulates * given[VALVE_EXHAUST],
                                         (position == DRIVER_POSITION_EMERGENCY) * given[VALVE_EMERGENCY],
                                         (before + *held) / 2.0,
                                         given[VALVE_BAND],
                                         supply,
                                         given[VALVE_SUPPLY_TEMPERATURE],
                                         given[VALVE_AROUND]};
        if (holds_vacuum(given)) open_vacuum(given, position, regulates, numbers);
        pipe_valve(self->air, (int)v, (long long int)given[VALVE_FACE], numbers);
        pipe_supply(self->air, (int)v, volume);
    }
}

/* Without air flow: pressures in all vehicles' cells are those of the nearest open valve, with its delay. */
static void give_pressures(train *self, double time) {
    for (long long int i = 0; i < self->vehicles; ++i) {
        double nearest = INFINITY, pressure = NAN, step;
        for (long long int v = 0; v < self->valves; ++v) {
            const double distance = fabs(self->centre[i] - self->valve[v * VALVE_ROWS + VALVE_PLACE]);
            if (distance >= nearest || position_of(self, v, &step) == DRIVER_POSITION_SHUT_OFF) continue;
            nearest = distance;
            pressure = delayed(self, v, 0, time - distance / self->head[HEAD_PROPAGATION]);
        }
        if (isfinite(pressure)) pipe_give(self->air, self->cell[i], pressure);
    }
}

/* Writes the states of valves in a step into their history. */
void valves_tell(train *self, double step) {
    const double end = self->run[RUN_TIME] + step, newest = floor(end / HISTORY_STEP);
    for (double k = self->run[RUN_TOLD] + 1.0; k <= newest; ++k) {
        const long long int place = (long long int)fmod(fmod(k, HISTORY) + HISTORY, HISTORY);
        for (long long int v = 0; v < self->valves; ++v) {
            double *row = valves_run(self, v);
            row[1 + place] = row[0];
            row[1 + HISTORY + place] = ordered(self, v, &row[1 + 2 * HISTORY + place]);
        }
    }
    self->run[RUN_TOLD] = newest;
    if (self->brake_model == BRAKE_MODEL_DELAY) give_pressures(self, end);
}
