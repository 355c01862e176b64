/* train.h: memory, steps, saved states. */
#include "train.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "detail.h"
#include "rows.h"
#include "train_inside.h"

/* Brakes and line are constant during a step. It is as long as waves in the pipe allow, within these limits [s]; assumed. */
static const double SHORTEST = 0.01, LONGEST = 0.1;
/* Largest steps of hosts that couple a vehicle, times its frequency between its neighbours [1] (docs/train-couplers.md). They are
 * below the limits of stability of a coach: 1.53 to 1.81, and 0.55 to 1.76, at 50 to 1000 MN/m. */
static const double HELD = 1.0, CORRECTED = 0.5;
/* Rows of results: of electric brakes, of heat. */
enum { BLENDED_ROWS = 4, WARM_ROWS = 1 + 2 * HEATED_ROWS };

/* Length of a run's variables: behind those of the valves, of each vehicle the force of its electric brake [N] and the heat of
 * its friction brake (HEATED_ROWS), and the times when its wheels first locked and the coupler behind it first broke, then
 * those of drive.c, of extra_brakes.c, of cab.c and of hoses.c. */
enum { OWN_RUN = 3 + HEATED_ROWS };
static long long int runs(const train *self) {
    return RUN_VALVES + OF_VALVE * self->valves + (OWN_RUN + DRIVE_RUN + EXTRA_RUN + HOSE_RUN) * self->vehicles +
           cab_numbers(self);
}
static double *electric_run(train *self) { return self->run + RUN_VALVES + OF_VALVE * self->valves; }
static double *heat_run(train *self) { return electric_run(self) + self->vehicles; }
static double *break_run(const train *self) { return drive_run(self) - self->vehicles; }
static double *lock_run(const train *self) { return break_run(self) - self->vehicles; }
double *drive_run(const train *self) { return self->run + RUN_VALVES + OF_VALVE * self->valves + OWN_RUN * self->vehicles; }
double *extra_run(const train *self) { return drive_run(self) + DRIVE_RUN * self->vehicles; }
double *hose_run(const train *self) { return cab_run(self) + cab_numbers(self); }
double *cab_run(const train *self) { return extra_run(self) + EXTRA_RUN * self->vehicles; }

static double *take(double **from, long long int count) {
    double *place = *from;
    *from += count;
    return place;
}

static void lay_inputs(train *self, double *room) {
    self->given_before = room + self->inputs;
    for (int n = 0; n < TRAIN_INPUTS; ++n) self->input[n] = take(&room, layout_input(self->counts, n));
}

/* Integral of a column of the line from its first point on. */
static void put_integral(const train *self, double *integral, const double *column) {
    const double *distance = self->line[POINT_DISTANCE];
    integral[0] = 0.0;
    for (long long int i = 1; i < self->points; ++i)
        integral[i] = integral[i - 1] + (distance[i] - distance[i - 1]) * (column[i - 1] + column[i]) / 2.0;
}

static void put_integrals(train *self) {
    const double *gradient = self->line[POINT_GRADIENT], *friction = self->line[POINT_FRICTION];
    self->level = self->even = 1;
    for (long long int i = 0; i < self->points; ++i) {
        self->level &= gradient[i] == 0.0 && self->line[POINT_CURVATURE][i] == 0.0;
        self->even &= friction[i] == 1.0;
    }
    put_integral(self, self->height, gradient);
    put_integral(self, self->grip, friction);
}

/* Allocates memory for all numbers outside pipe and motion; returns 0 if out of memory. */
static int take_memory(train *self) {
    const long long int n = self->vehicles, run = runs(self);
    long long int outputs = TRAIN_SUMS;
    for (int row = 0; row < TRAIN_INPUTS; ++row) self->inputs += layout_input(self->counts, row);
    for (int row = 0; row < OUT_SUMS; ++row) outputs += layout_output(self->counts, row);
    const rows_part parts[] = {{&self->brake, BRAKE_ROWS, 1.0},
                               {&self->cylinder, 1, 1.0},
                               {&self->wheel, 1, 1.0},
                               {&self->held, 1, 1.0},
                               {&self->electric, ELECTRIC_ROWS, 1.0},
                               {&self->command, ELECTRICALLY_ROWS, 0.0},
                               {&self->blended, BLENDED_ROWS, 0.0},
                               {&self->heat, HEAT_ROWS, 1.0},
                               {&self->worked, WORKED_ROWS, 1.0},
                               {&self->warm, WARM_ROWS, 1.0}};
    self->rows = ROWS_LAY(parts, self->stride);
    const long long int given = 3 * n + VALVE_ROWS * self->valves + (POINT_ROWS + 2) * self->points;
    double *room = self->numbers = (double *)calloc((size_t)(given + 2 * self->inputs + outputs + run), sizeof(double));
    self->cell = (long long int *)calloc((size_t)(3 * n), sizeof(long long int));
    if (!self->rows || !self->numbers || !self->cell) return 0;
    self->hint = self->cell + n;
    self->face = self->hint + n;
    self->mass = take(&room, n);
    self->centre = take(&room, n);
    self->length = take(&room, n);
    self->valve = take(&room, VALVE_ROWS * self->valves);
    for (int row = 0; row < POINT_ROWS; ++row) self->line[row] = take(&room, self->points);
    self->height = take(&room, self->points);
    self->grip = take(&room, self->points);
    lay_inputs(self, take(&room, 2 * self->inputs));
    for (int row = 0; row <= OUT_SUMS; ++row) self->output[row] = take(&room, layout_output(self->counts, row));
    self->run = take(&room, run);
    return 1;
}

static void put(double *to, const double *group, int row, long long int count) { rows_copy(to, group + row * count, count); }

/* Numbers of vehicles, valves and the line. */
static void put_numbers(train *self, const double *const at[LAYOUT_GROUPS]) {
    const long long int count = self->vehicles;
    rows_put(self->brake, self->stride, at[GROUP_BRAKE], BRAKE_ROWS, count);
    rows_put(self->electric, self->stride, at[GROUP_ELECTRIC], ELECTRIC_ROWS, count);
    rows_put(self->heat, self->stride, at[GROUP_HEAT], HEAT_ROWS, count);
    self->blends = rows_any(at[GROUP_ELECTRIC] + ELECTRIC_BLENDED_PRESSURE * count, count) ||
                   rows_any(at[GROUP_ELECTRIC] + ELECTRIC_DYNAMIC_FORCE * count, count);
    self->heats = rows_any(at[GROUP_HEAT] + HEAT_HEAT_CAPACITY * count, count);
    put(self->mass, at[GROUP_MOTION], MOTION_MASS, self->vehicles);
    put(self->centre, at[GROUP_FRAME], FRAME_CENTRE, self->vehicles);
    put(self->length, at[GROUP_FRAME], FRAME_LENGTH, self->vehicles);
    for (long long int v = 0; v < self->valves; ++v)
        for (int n = 0; n < VALVE_ROWS; ++n) self->valve[v * VALVE_ROWS + n] = at[GROUP_VALVE][n * self->valves + v];
    for (int row = 0; row < POINT_ROWS; ++row) put(self->line[row], at[GROUP_POINT], row, self->points);
    put_integrals(self);
    for (long long int i = 0; i < self->vehicles; ++i) {
        self->cell[i] = (long long int)at[GROUP_PLACE][PLACE_CELL * self->vehicles + i];
        self->face[i] = (long long int)at[GROUP_PLACE][PLACE_FACE * self->vehicles + i];
    }
}

/* The pipe with its distributors; 0 if out of memory. */
static int make_pipe(train *self, const double *const at[LAYOUT_GROUPS]) {
    double *air = (double *)calloc((size_t)(PIPE_STATES * self->cells), sizeof(double));
    long long int *kind = (long long int *)calloc((size_t)self->vehicles, sizeof(long long int));
    self->air = air && kind ? pipe_create(self->cells, air, at[GROUP_CELL]) : NULL;
    int made = self->air != NULL;
    for (long long int i = 0; made && i < self->vehicles; ++i)
        kind[i] = (long long int)at[GROUP_PLACE][PLACE_DISTRIBUTOR * self->vehicles + i];
    const double *const *given = at + GROUP_FIRST_KIND; /* one group of each kind */
    const double *parts = at[GROUP_SLIDE] + SLIDE_WHEELSETS * self->vehicles;
    made = made &&
           pipe_vehicles(self->air, self->vehicles, kind, self->cell, parts, given, self->brake_model, self->head[HEAD_PACE]);
    if (made) self->blends |= pipe_is_assisted(self->air);
    free(air);
    free(kind);
    return made;
}

int train_lay_saved(train *self) {
    free(self->saved);
    self->saved = (double *)malloc((size_t)train_numbers(self) * sizeof(double));
    return self->saved != NULL;
}

static train *lay(train *self, const double *numbers) {
    const double *at[LAYOUT_GROUPS];
    layout_find(numbers, self->counts, at);
    self->has_cab = cab_is_stated(self->counts, at);
    if (!take_memory(self)) return NULL;
    put_numbers(self, at);
    self->moves = motion_create(self->vehicles, at[GROUP_MOTION], at[GROUP_COUPLER]);
    if (!self->moves || !motion_strength(self->moves, at[GROUP_STRENGTH]) || !make_pipe(self, at)) return NULL;
    if (!extra_create(self, at[GROUP_TRACK], at[GROUP_PARKING])) return NULL;
    if (!drive_create(self, at[GROUP_TRACTION], at[GROUP_ADHESION], at[GROUP_MOTION])) return NULL;
    if (!protection_create(self, at[GROUP_SLIDE])) return NULL;
    if (!cab_create(self, at)) return NULL;
    self->works = self->heats || self->blends || self->drive;
    return train_lay_saved(self) ? self : NULL;
}

train *train_create(const double *numbers, long long int count) {
    if (train_wrong(numbers, count)) return NULL;
    train *self = (train *)calloc(1, sizeof *self);
    if (!self) return NULL;
    memcpy(self->head, numbers, sizeof self->head);
    layout_count(numbers, self->counts);
    self->vehicles = self->counts[OF_VEHICLES];
    self->cells = self->counts[OF_CELLS];
    self->valves = self->counts[OF_VALVES];
    self->points = self->counts[OF_POINTS];
    self->brake_model = (int)numbers[HEAD_BRAKE_MODEL];
    self->stride = rows_stride(self->vehicles);
    self->lanes = lanes_of_processor();
    if (lay(self, numbers)) {
        train_begin(self, 0.0, 0.0, 0.0, self->valve[VALVE_RUNNING], self->valve[VALVE_AROUND]);
        return self;
    }
    train_free(self);
    return NULL;
}

void train_free(train *self) {
    if (!self) return;
    pipe_free(self->air);
    motion_free(self->moves);
    extra_free(self->extra);
    drive_free(self->drive);
    protection_free(self->slide);
    detail_free(self->detail);
    cab_free(self->cab);
    free(self->rows);
    free(self->numbers);
    free(self->cell);
    free(self->saved);
    free(self);
}

static void fill(double *values, long long int count, double value) {
    for (long long int i = 0; i < count; ++i) values[i] = value;
}

static void begin_inputs(train *self) {
    fill(self->input[0], self->inputs, 0.0);
    fill(self->input[IN_DRIVER_POSITION], self->valves, DRIVER_POSITION_SHUT_OFF);
    self->input[IN_DRIVER_POSITION][0] = DRIVER_POSITION_RUNNING;
    fill(self->input[IN_FRICTION], self->vehicles, START_FRICTION);
    fill(self->input[IN_COUPLING_CLOSED], self->vehicles - 1, 1.0);
    fill(self->input[IN_HOSE_STATE], self->vehicles - 1, HOSE_STATE_WHOLE);
    rows_copy(self->given_before, self->input[0], self->inputs);
}

static void begin_air(train *self, double pressure, double cylinder) {
    pipe_fill(self->air, pressure / (GAS_CONSTANT * self->valve[VALVE_SUPPLY_TEMPERATURE]), pressure);
    const double running = self->valve[VALVE_RUNNING], around = self->valve[VALVE_AROUND];
    pipe_charge(self->air, running < around ? fmin(pressure, running) : fmax(pressure, running), around, cylinder);
}

/* `saved` is only a buffer here. */
static void begin_motion(train *self, double speed, double distance) {
    double *at = self->saved;
    fill(at, MOTION_STATES * self->vehicles, 0.0);
    fill(at, self->vehicles, distance);
    fill(at + self->vehicles, 2 * self->vehicles, speed);
    motion_put(self->moves, at);
    motion_forget(self->moves);
    motion_begin_mean(self->moves);
    for (long long int i = 0; i + 1 < self->vehicles; ++i) {
        motion_couple(self->moves, i, 1);
        motion_force(self->moves)[i] = 0.0;
    }
    for (long long int i = 0; i < self->vehicles; ++i) motion_lead(self->moves, i, NAN);
}

/* Forces of electric brakes, and what their vehicles' cylinders are to give, in a step. */
static void demand_brakes(train *self, double step) {
    rows_copy(self->wheel, motion_wheel(self->moves), self->vehicles);
    for (long long int i = 0; i < self->vehicles; ++i) {
        const int released = protection_commands(self)[i] == PROTECTION_RELEASE;
        const double dead_time = self->electric[i + ELECTRIC_DEAD_TIME * self->stride];
        double *command = self->command + i;
        const double ordered = self->blended[i + 3 * self->stride] = valves_demand(self, step, dead_time);
        command[ELECTRICALLY_DEMANDED * self->stride] = released ? 0.0 : ordered;
        command[ELECTRICALLY_DYNAMIC * self->stride] = released ? 0.0 : self->input[IN_DYNAMIC_BRAKE][i];
        command[ELECTRICALLY_BEFORE * self->stride] = released ? 0.0 : electric_run(self)[i];
        command[ELECTRICALLY_STEP * self->stride] = step;
    }
    IN_LANES(train_blend);
    rows_copy(electric_run(self), self->blended + 2 * self->stride, self->vehicles);
    pipe_demand(self->air, self->blended + self->stride, self->blended + 3 * self->stride);
}

/* Copies the heat of a run to rows before a step. */
static void heat_rows(train *self) { rows_put(self->warm, self->stride, heat_run(self), HEATED_ROWS, self->vehicles); }

/* Changes brake forces by the share of friction of warm brakes. */
static void fade_brakes(train *self) {
    const double *left = self->warm + HEATED_ROWS * self->stride;
    heat_rows(self);
    IN_LANES(train_fade);
    for (long long int i = 0; i < self->vehicles; ++i) self->held[i] *= left[i];
}

/* Positions and slip before a step, for `warm_brakes`. */
static void note_motion(train *self) {
    const double *place = motion_place(self->moves), *speed = motion_speed(self->moves), *wheel = motion_wheel(self->moves);
    for (long long int i = 0; i < self->vehicles; ++i) {
        self->worked[WORKED_SPEED * self->stride + i] = place[i];
        self->worked[WORKED_WAY * self->stride + i] = wheel[i] - speed[i];
    }
}

/* Warms friction brakes by a step. Rolling wheels go as far as their vehicle, which motion_go finds by the trapezoidal
 * rule; to sliding ones the mean of their slip before and after the step is added. */
static void warm_brakes(train *self, double step) {
    const double *place = motion_place(self->moves), *speed = motion_speed(self->moves), *wheel = motion_wheel(self->moves);
    for (long long int i = 0; i < self->vehicles; ++i) {
        double *worked = self->worked + i;
        const double way = place[i] - worked[WORKED_SPEED * self->stride], slip = worked[WORKED_WAY * self->stride];
        worked[WORKED_FORCE * self->stride] = self->held[i] - (self->blends ? self->blended[i] : 0.0);
        worked[WORKED_WAY * self->stride] = way + (slip + wheel[i] - speed[i]) * step / 2.0;
        worked[WORKED_SPEED * self->stride] = way / step;
        worked[WORKED_STEP * self->stride] = step;
    }
    drive_brake(self, self->worked + WORKED_WAY * self->stride);
    heat_rows(self);
    IN_LANES(train_heat);
    rows_get(heat_run(self), self->warm + (1 + HEATED_ROWS) * self->stride, self->stride, HEATED_ROWS, self->vehicles);
}

void find_cylinders(const train *self, double *cylinder) {
    pipe_pressures(self->air, NULL, cylinder);
    cab_press(self, cylinder);
}

/* Brake forces at pressures of cylinders and speeds of wheels, with parking brakes applied for a time. */
static void find_brakes(train *self, double step) {
    rows_copy(self->wheel, motion_wheel(self->moves), self->vehicles);
    IN_LANES(train_brake);
    extra_park(self, step);
    protection_brake(self);
    if (self->heats) fade_brakes(self);
    for (long long int i = 0; i < self->vehicles && self->blends; ++i) self->held[i] += self->blended[i];
    protection_share(self);
}

/* Forces of the last step. */
static void find_forces(train *self) {
    rows_copy(self->output[OUT_BRAKE_FORCE], self->held, self->vehicles);
    rows_copy(self->output[OUT_RAIL_FORCE], motion_rail(self->moves), self->vehicles);
    detail_forces(self);
}

/* Temperatures of the surfaces that are rubbed. */
static void find_surfaces(train *self) {
    double *left = self->warm + HEATED_ROWS * self->stride;
    if (self->heats) {
        heat_rows(self);
        IN_LANES(train_surface);
    }
    rows_copy(self->output[OUT_SURFACE_TEMPERATURE], self->heats ? left : heat_run(self), self->vehicles);
}

/* Outputs that depend on the state alone. */
static void find_outputs(train *self) {
    double *sums = self->output[OUT_SUMS];
    const double *place = motion_place(self->moves), *speed = motion_speed(self->moves), *wheel = motion_wheel(self->moves);
    for (long long int i = 0; i < self->vehicles; ++i) {
        self->output[OUT_DISTANCE][i] = place[i] + self->centre[i];
        self->output[OUT_SPEED][i] = speed[i];
        self->output[OUT_WHEEL_SPEED][i] = wheel[i];
    }
    put(self->output[OUT_BRAKE_TEMPERATURE], heat_run(self), HEATED_TEMPERATURE, self->vehicles);
    find_surfaces(self);
    put(self->output[OUT_BLOCK_TEMPERATURE], heat_run(self), HEATED_BLOCK_TEMPERATURE, self->vehicles);
    put(self->output[OUT_BRAKE_HEAT], heat_run(self), HEATED_HEAT, self->vehicles);
    rows_copy(self->output[OUT_TRACK_BRAKE_FORCE], extra_run(self) + 3 * self->vehicles, self->vehicles);
    drive_outputs(self);
    protection_outputs(self);
    detail_outputs(self);
    motion_force_now(self->moves, self->output[OUT_COUPLER_FORCE]);
    motion_mean(self->moves, self->output[OUT_MEAN_COUPLER_FORCE]);
    pipe_pressures(self->air, self->output[OUT_PIPE_PRESSURE], self->output[OUT_CYLINDER_PRESSURE]);
    cab_press(self, self->output[OUT_CYLINDER_PRESSURE]);
    cab_outputs(self);
    memcpy(sums, self->run + RUN_SUMS, TRAIN_SUMS * sizeof(double));
    sums[SUM_TIME] = self->run[RUN_TIME];
    sums[SUM_AIR_USED] = pipe_has_passed(self->air)->let_in;
    motion_extremes(self->moves, sums + SUM_LARGEST_TENSION);
}

/* The joints of the last step's inputs, and of hoses that have parted. */
static void put_joints(train *self) {
    for (long long int i = 0; i + 1 < self->vehicles; ++i)
        if (self->face[i] > 0) pipe_join(self->air, self->face[i], hose_joint(self, i));
}

void train_begin(train *self, double time, double speed, double distance, double pressure, double cylinder) {
    begin_inputs(self);
    begin_air(self, pressure, cylinder);
    begin_motion(self, speed, distance);
    detail_forget(self);
    fill(self->run, runs(self), 0.0);
    fill(lock_run(self), 2 * self->vehicles, TRAIN_NEVER); /* and break_run */
    self->run[RUN_TIME] = time;
    self->run[RUN_TOLD] = floor(time / HISTORY_STEP);
    for (long long int v = 0; v < self->valves; ++v) {
        static const double closed[VALVE_NUMBERS] = {0.0}; /* until a step sets it; the longest step depends on it */
        double *own = valves_run(self, v);
        pipe_valve(self->air, (int)v, (long long int)self->valve[v * VALVE_ROWS + VALVE_FACE], closed);
        fill(own, 1 + HISTORY, pressure);
        fill(own + 1 + HISTORY, HISTORY, v ? DRIVER_POSITION_SHUT_OFF : DRIVER_POSITION_RUNNING);
    }
    hoses_begin(self);
    put_joints(self);
    cab_begin(self);
    fill(self->blended, self->vehicles, 0.0);
    fill(heat_run(self) + HEATED_TEMPERATURE * self->vehicles, self->vehicles, SURROUNDINGS);
    fill(heat_run(self) + HEATED_BLOCK_TEMPERATURE * self->vehicles, self->vehicles, SURROUNDINGS);
    self->steps[0] = self->steps[1] = 0;
    protection_begin(self);
    find_cylinders(self, self->cylinder);
    find_brakes(self, 0.0);
    find_forces(self);
    fill(self->output[OUT_RAIL_FORCE], self->vehicles, 0.0);
    find_outputs(self);
}

double train_longest(const train *self, long long int *vehicle) {
    double most = INFINITY;
    for (long long int i = 0; i < self->vehicles; ++i) {
        const double led = self->input[IN_EXTERNAL_VEHICLE][i];
        if (led == 0.0) continue;
        const double own = (led == EXTERNAL_VEHICLE_HELD ? HELD : CORRECTED) / motion_frequency(self->moves, i);
        if (own < most) *vehicle = i;
        most = fmin(most, own);
    }
    return most;
}

/* Vehicles that are simulated in detail elsewhere. */
static void lead(train *self) {
    const double *led = self->input[IN_EXTERNAL_VEHICLE], *speed = self->input[IN_EXTERNAL_VEHICLE_SPEED];
    const double *before = self->given_before + (led - self->input[0]);
    for (long long int i = 0; i < self->vehicles; ++i) {
        if (led[i] == EXTERNAL_VEHICLE_CORRECTED) motion_correct(self->moves, i, speed[i], self->run[RUN_STEP]);
        if (led[i] == EXTERNAL_VEHICLE_HELD || before[i] == EXTERNAL_VEHICLE_HELD)
            motion_lead(self->moves, i, led[i] == EXTERNAL_VEHICLE_HELD ? speed[i] : NAN);
    }
}

/* Couplings and joints that were changed from outside. */
static void take_inputs(train *self) {
    const long long int couplings = self->vehicles - 1;
    const double *coupled = self->input[IN_COUPLING_CLOSED], *joined = self->input[IN_HOSE_STATE];
    const double *coupled_before = self->given_before + (coupled - self->input[0]);
    const double *joined_before = self->given_before + (joined - self->input[0]);
    int changed = 0;
    for (long long int i = 0; i < couplings; ++i) {
        changed |= coupled[i] != coupled_before[i] || joined[i] != joined_before[i];
        if (joined[i] != joined_before[i]) hose_changed(self, i);
        if (coupled[i] != coupled_before[i]) motion_couple(self->moves, i, coupled[i] > 0.0);
    }
    lead(self);
    cab_acknowledge(self, self->given_before + (self->input[IN_VIGILANCE] - self->input[0]));
    rows_copy(self->given_before, self->input[0], self->inputs);
    if (changed) put_joints(self);
    if (!self->slide) pipe_protect(self->air, self->input[IN_PROTECTION]);
    motion_begin_mean(self->moves);
    double *force = motion_force(self->moves);
    force[-1] = self->input[IN_END_FORCE][0];
    force[couplings] = self->input[IN_END_FORCE][1];
    rows_copy(motion_acting(self->moves, ACTING_PULL), self->input[IN_PULL], self->vehicles);
    rows_copy(motion_acting(self->moves, ACTING_FRICTION), self->input[IN_FRICTION], self->vehicles);
}

const double *train_locked_at(const train *self) { return lock_run(self); }
const double *train_broken_at(const train *self) { return break_run(self); }

/* Stores the time when the wheels of a vehicle first lock. */
static void note_locks(train *self, double time) {
    const double *speed = motion_speed(self->moves), *wheel = motion_wheel(self->moves);
    for (long long int i = 0; i < self->vehicles; ++i)
        if (wheel[i] == 0.0 && speed[i] != 0.0) lock_run(self)[i] = fmin(lock_run(self)[i], time);
}

/* Parts the hoses of broken couplers, and stores the time when each first broke. */
static void note_breaks(train *self, double time) {
    put_joints(self);
    for (long long int i = 0; i + 1 < self->vehicles; ++i)
        if (motion_is_broken(self->moves, i)) break_run(self)[i] = fmin(break_run(self)[i], time);
}

/* One step with brakes and line of its middle; returns 0 if its result is not finite. */
static int step_on(train *self, double step) {
    if (hoses_look(self, step)) put_joints(self);
    cab_watch(self, step);
    valves_command(self, step);
    protection_open(self, step);
    if (self->blends) demand_brakes(self, step);
    cab_bail_off(self);
    find_cylinders(self, self->cylinder);
    rows_copy(self->held, self->cylinder, self->vehicles);
    const long long int taken = pipe_advance(self->air, step, self->head[HEAD_COURANT]);
    if (taken < 0) return 0;
    valves_tell(self, step);
    if (!cab_advance(self, step)) return 0;
    find_cylinders(self, self->cylinder);
    for (long long int i = 0; i < self->vehicles; ++i) self->cylinder[i] = (self->cylinder[i] + self->held[i]) / 2.0;
    find_brakes(self, step);
    rows_copy(motion_acting(self->moves, ACTING_BRAKE), self->held, self->vehicles);
    line_act(self, step);
    extra_track(self, step);
    const double count = fmax(1.0, ceil(step / (self->head[HEAD_SHARE] * self->head[HEAD_BOUND])));
    if (!(count < 1e9)) return 0;
    if (self->works) note_motion(self);
    self->steps[0] += taken;
    self->steps[1] += drive_go(self, (long long int)count, step);
    protection_turn(self, step);
    if (self->works) warm_brakes(self, step);
    note_locks(self, self->run[RUN_TIME] + step);
    if (motion_broken(self->moves)) note_breaks(self, self->run[RUN_TIME] + step);
    return motion_sound(self->moves);
}

/* True if all results of a step are finite. */
static int outputs_finite(const train *self) {
    const double *rail = motion_rail(self->moves), *found = self->output[0];
    int finite = 1;
    for (const double *end = self->output[OUT_SUMS] + TRAIN_SUMS; found < end; ++found) finite &= isfinite(*found) != 0;
    for (long long int i = 0; i < self->vehicles; ++i) finite &= isfinite(rail[i]) && isfinite(self->held[i]);
    return finite;
}

/* Return the next step of a time that is left; 0: too short. */
static double next_step(const train *self, double left) {
    const double most =
        left <= SHORTEST ? SHORTEST : fmin(fmax(pipe_longest(self->air, self->head[HEAD_COURANT]), SHORTEST), LONGEST);
    const double count = ceil(left / most * (1.0 - 1e-12));
    return !(count < 1e9) ? 0.0 : count > 1.0 ? left / count : left;
}

int train_go(train *self, double time) {
    const double begin = self->run[RUN_TIME];
    long long int wrong;
    if (train_input_wrong(self, &wrong) >= 0) return -2;
    train_save(self, self->saved);
    detail_try(self);
    take_inputs(self);
    for (double left = time; left > 0.0;) {
        const double span = fmin(left, protection_sample(self, self->run[RUN_TIME]));
        const double step = self->detail ? detail_step(self, span) : next_step(self, span);
        if (!(step > 0.0) || !step_on(self, step)) {
            const int refused = train_detail_failed(self) >= 0;
            train_load(self, self->saved);
            return refused ? -3 : -1;
        }
        left = step < left - detail_rounding(self) ? left - step : 0.0;
        self->run[RUN_TIME] = begin + (time - left);
    }
    if (time > 0.0) self->run[RUN_STEP] = time;
    find_outputs(self);
    if (!outputs_finite(self)) {
        train_load(self, self->saved);
        return -1;
    }
    find_forces(self);
    return 0;
}

double *train_input(train *self, int row, long long int *count) {
    if (count) *count = layout_input(self->counts, row);
    return self->input[row];
}

const double *train_output(const train *self, int row, long long int *count) {
    if (count) *count = layout_output(self->counts, row);
    return self->output[row];
}

long long int train_numbers(const train *self) {
    return pipe_numbers(self->air) + motion_numbers(self->moves) + 2 * self->inputs + runs(self) + 2 * self->vehicles +
           protection_numbers(self) + detail_numbers(self);
}

void train_save(const train *self, double *numbers) {
    pipe_save(self->air, numbers);
    motion_save(self->moves, numbers += pipe_numbers(self->air));
    rows_copy(numbers += motion_numbers(self->moves), self->input[0], 2 * self->inputs);
    rows_copy(numbers += 2 * self->inputs, self->run, runs(self));
    rows_copy(numbers += runs(self), self->output[OUT_BRAKE_FORCE], self->vehicles);
    rows_copy(numbers += self->vehicles, self->output[OUT_RAIL_FORCE], self->vehicles);
    protection_save(self, numbers += self->vehicles);
    detail_save(self, numbers + protection_numbers(self));
}

void train_load(train *self, const double *numbers) {
    pipe_load(self->air, numbers);
    motion_load(self->moves, numbers += pipe_numbers(self->air));
    rows_copy(self->input[0], numbers += motion_numbers(self->moves), 2 * self->inputs);
    rows_copy(self->run, numbers += 2 * self->inputs, runs(self));
    rows_copy(self->output[OUT_BRAKE_FORCE], numbers += runs(self), self->vehicles);
    rows_copy(self->output[OUT_RAIL_FORCE], numbers += self->vehicles, self->vehicles);
    protection_load(self, numbers += self->vehicles);
    detail_load(self, numbers + protection_numbers(self));
    put_joints(self);
    find_outputs(self);
}

double train_charged(const train *self) { return self->valve[VALVE_RUNNING]; }
pipe *train_air(train *self) { return self->air; }
void train_steps(const train *self, long long int *steps) { memcpy(steps, self->steps, sizeof self->steps); }
void train_motion(const train *self, double *state) { motion_get(self->moves, state); }

void train_set_motion(train *self, const double *state) {
    if (state) motion_put(self->moves, state);
    detail_settle(self);
    find_outputs(self);
}
