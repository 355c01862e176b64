/* Wheel-slide protection of a train's vehicles: protection.h. Sensors and controllers are those of the test rig (encoder.h,
 * wheel_slide.h). A valve's open area follows its command by a first-order lag, as in brake_controller/magnet_valves.py. */
#include "protection.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "detail.h"
#include "encoder.h"
#include "own_controllers.h"
#include "rows.h"
#include "train_inside.h"
#include "wheel_slide.h"

enum { ALIGNED = 16 };
/* Share of an open area that has no effect. */
static const double SETTLED = 1e-9;

/* Controllers of this binary, by their number from 1: the built-in one, and those of users. */
static const struct {
    size_t (*size)(int wheelsets);
    void (*start)(void *memory, int wheelsets, double period);
    void (*step)(void *memory, double time, const double *wheel_speed, int *valve);
} CONTROLLERS[] = {{wheel_slide_size, wheel_slide_start, wheel_slide_step}, OWN_CONTROLLERS};

/* One wheel speed in, one valve out. */
typedef struct {
    encoder sensor;
    double rotation, speed;  /* before a step [rad], [m/s] */
    double fills, vents;     /* open areas of the valves that fill and vent the cylinder [1] */
    double pressure, before; /* at the last step of the controller, before a step of the train [Pa] */
    double force;            /* of the vehicle if all wheelsets had this pressure [N] */
    int command;
} wheelset;

/* State of a vehicle. The memory of its controller follows its wheelsets. `steps` of the controller; -1 as `failed_at` until it
 * failed [s]; the air that filled its cylinders [kg]. */
typedef struct {
    double steps, failed_at, air;
} state;

typedef struct {
    long long int vehicle;
    int wheelsets;
    double radius, period, valve_pace, air_per_pressure; /* valve_pace: 0: its valves follow at once */
    encoder_settings sensor;
    rig_controller controller; /* step is NULL: it is not here yet */
    size_t at, bytes;          /* of its state, in all states */
} protected_vehicle;

struct protections {
    long long int count;
    double start; /* of the run [s] */
    protected_vehicle *each;
    char *states;
    size_t bytes;
    double *command, *held, *vented; /* of all vehicles */
};

static size_t aligned(size_t size) { return (size + ALIGNED - 1) / ALIGNED * ALIGNED; }
static state *state_of(const protections *self, const protected_vehicle *one) {
    return (state *)(void *)(self->states + one->at);
}
static wheelset *wheelsets_of(const protections *self, const protected_vehicle *one) {
    return (wheelset *)(void *)(self->states + one->at + aligned(sizeof(state)));
}
static void *memory_of(const protections *self, const protected_vehicle *one) {
    return self->states + one->at + aligned(sizeof(state)) + aligned((size_t)one->wheelsets * sizeof(wheelset));
}

/* The protected vehicles. */
#define EACH(self, one) for (protected_vehicle *one = (self)->each; one < (self)->each + (self)->count; ++one)

/* Places the states of all vehicles, for the sizes of their controllers' memory; returns 0 if out of memory. */
static int lay_states(protections *self) {
    self->bytes = 0;
    EACH(self, one) {
        const size_t wheels = aligned((size_t)one->wheelsets * sizeof(wheelset));
        one->at = self->bytes;
        one->bytes = aligned(sizeof(state)) + wheels + aligned(guarded_bytes(&one->controller));
        self->bytes += one->bytes;
    }
    free(self->states);
    self->states = (char *)calloc(self->bytes, 1);
    return self->states != NULL;
}

static void put_numbers(protected_vehicle *self, const double *given, long long int count) {
    const double time = given[SLIDE_VALVE_TIME * count];
    self->wheelsets = (int)given[SLIDE_WHEELSETS * count];
    self->radius = given[SLIDE_WHEEL_RADIUS * count];
    self->period = given[SLIDE_PERIOD * count];
    self->valve_pace = time > 0.0 ? TIME_CONSTANTS_TO_95_PERCENT / time : 0.0;
    self->air_per_pressure = given[SLIDE_CYLINDERS * count] / (GAS_CONSTANT * SURROUNDINGS);
    self->sensor.pulses = (int)given[SLIDE_TEETH * count];
    self->sensor.gate = ENCODER_GATE;
    self->sensor.timer = ENCODER_TIMER;
    self->sensor.lowest_frequency = ENCODER_LOWEST_FREQUENCY;
}

/* Sets the functions of a controller by its number; returns 0 for too much memory. */
static int put_controller(protected_vehicle *self, double number) {
    const size_t place = (size_t)number - 1;
    if (place >= sizeof CONTROLLERS / sizeof *CONTROLLERS) return 1;
    self->controller.start = CONTROLLERS[place].start;
    self->controller.step = CONTROLLERS[place].step;
    self->controller.size = CONTROLLERS[place].size(self->wheelsets);
    return self->controller.size <= LARGEST_MEMORY;
}

int protection_create(train *self, const double *given) {
    const long long int vehicles = self->vehicles;
    if (!rows_any(given + SLIDE_CONTROLLER * vehicles, vehicles)) return 1;
    protections *all = self->slide = (protections *)calloc(1, sizeof *all);
    if (!all) return 0;
    all->each = (protected_vehicle *)calloc((size_t)vehicles, sizeof *all->each);
    all->command = (double *)calloc((size_t)(3 * vehicles), sizeof(double));
    if (!all->each || !all->command) return 0;
    all->held = all->command + vehicles;
    all->vented = all->held + vehicles;
    for (long long int i = 0; i < vehicles; ++i) {
        const double number = given[SLIDE_CONTROLLER * vehicles + i];
        if (!(number > 0.0)) continue;
        protected_vehicle *one = &all->each[all->count++];
        one->vehicle = i;
        put_numbers(one, given + i, vehicles);
        if (!put_controller(one, number)) return 0;
    }
    return lay_states(all);
}

void protection_free(protections *self) {
    if (!self) return;
    free(self->each);
    free(self->command);
    free(self->states);
    free(self);
}

int protection_wheelsets(const train *self, long long int vehicle) {
    for (long long int n = 0; self->slide && n < self->slide->count; ++n)
        if (self->slide->each[n].vehicle == vehicle) return self->slide->each[n].wheelsets;
    return 0;
}

int train_control(train *self, long long int vehicle, void (*start)(void *, int, double),
                  void (*step)(void *, double, const double *, int *), size_t size) {
    if (!protection_wheelsets(self, vehicle) || size > LARGEST_MEMORY) return 0;
    EACH(self->slide, one)
    if (one->vehicle == vehicle) {
        one->controller.start = start;
        one->controller.step = step;
        one->controller.size = size;
    }
    return lay_states(self->slide) && train_lay_saved(self);
}

long long int train_lacks_controller(const train *self) {
    for (long long int n = 0; self->slide && n < self->slide->count; ++n)
        if (!self->slide->each[n].controller.step) return self->slide->each[n].vehicle;
    return -1;
}

static void give_up(const protections *self, const protected_vehicle *one) {
    state *own = state_of(self, one);
    own->failed_at = own->steps * one->period;
    for (int n = 0; n < one->wheelsets; ++n) wheelsets_of(self, one)[n].command = WHEEL_SLIDE_APPLY;
}

/* Pressures of a vehicle's cylinders [Pa], by wheelset; `self->cylinder` has those of all vehicles. */
static void find_pressures(const train *self, const protected_vehicle *one, double *pressure) {
    if (one->wheelsets == 1) *pressure = self->cylinder[one->vehicle];
    else pipe_part_pressures(self->air, one->vehicle, pressure);
}

void protection_begin(train *self) {
    protections *all = self->slide;
    if (!all) return;
    memset(all->states, 0, all->bytes);
    all->start = self->run[RUN_TIME];
    find_cylinders(self, self->cylinder);
    EACH(all, one) {
        double pressure[RIG_MOST];
        find_pressures(self, one, pressure);
        state_of(all, one)->failed_at = -1.0;
        for (int n = 0; n < one->wheelsets; ++n) {
            wheelset *of = wheelsets_of(all, one) + n;
            encoder_begin(&of->sensor, NULL, 0.0);
            of->fills = 1.0;
            of->pressure = of->before = pressure[n];
        }
        if (one->controller.step && !guarded_start(&one->controller, memory_of(all, one), one->wheelsets, one->period))
            give_up(all, one);
    }
}

/* Speed of the wheels of a wheelset at the rim [m/s]. */
static double speed_of(const train *self, const protected_vehicle *one, int number) {
    return one->wheelsets == 1 ? motion_wheel(self->moves)[one->vehicle] : detail_rim(self, one->vehicle, number);
}

const double *protection_commands(const train *self) { return self->slide ? self->slide->command : self->input[IN_PROTECTION]; }

/* Reads the sensors of a vehicle and lets its controller step; one that fails or gives an invalid command is given up. */
static void control(const protections *self, const protected_vehicle *one) {
    state *own = state_of(self, one);
    wheelset *of = wheelsets_of(self, one);
    const double time = own->steps * one->period;
    double speed[RIG_MOST];
    int valve[RIG_MOST], valid = 1;
    for (int n = 0; n < one->wheelsets; ++n) {
        speed[n] = one->radius * encoder_read(&of[n].sensor, &one->sensor, time, of[n].rotation);
        valve[n] = of[n].command;
    }
    if (one->controller.step && own->failed_at < 0.0) {
        valid = guarded_step(&one->controller, memory_of(self, one), one->wheelsets, time, speed, valve);
        for (int n = 0; n < one->wheelsets; ++n) valid &= valve[n] >= WHEEL_SLIDE_APPLY && valve[n] <= WHEEL_SLIDE_VENT;
        for (int n = 0; n < one->wheelsets && valid; ++n) of[n].command = valve[n];
        if (!valid) give_up(self, one);
    }
    own->steps += 1.0;
}

/* Least or largest command of a vehicle's wheelsets. */
static double least_command(const protections *self, const protected_vehicle *one) {
    int least = WHEEL_SLIDE_VENT;
    for (int n = 0; n < one->wheelsets; ++n)
        if (wheelsets_of(self, one)[n].command < least) least = wheelsets_of(self, one)[n].command;
    return least;
}
static double largest_command(const protections *self, const protected_vehicle *one) {
    int most = WHEEL_SLIDE_APPLY;
    for (int n = 0; n < one->wheelsets; ++n)
        if (wheelsets_of(self, one)[n].command > most) most = wheelsets_of(self, one)[n].command;
    return most;
}

/* Adds the air that has filled a vehicle's cylinders since the last step of its controller. */
static void count_air(const train *self, const protected_vehicle *one) {
    wheelset *of = wheelsets_of(self->slide, one);
    double pressure[RIG_MOST];
    find_pressures(self, one, pressure);
    for (int n = 0; n < one->wheelsets; ++n) {
        state_of(self->slide, one)->air += one->air_per_pressure * fmax(pressure[n] - of[n].pressure, 0.0) / one->wheelsets;
        of[n].pressure = pressure[n];
    }
}

double protection_sample(train *self, double time) {
    protections *all = self->slide;
    if (!all) return INFINITY;
    double next = INFINITY;
    find_cylinders(self, self->cylinder);
    rows_copy(all->command, self->input[IN_PROTECTION], self->vehicles);
    EACH(all, one) {
        const state *own = state_of(all, one);
        const double rounding = 1e-6 * one->period + 4.0 * DBL_EPSILON * fabs(time);
        if (all->start + own->steps * one->period <= time + rounding) {
            control(all, one);
            count_air(self, one);
        }
        next = fmin(next, all->start + own->steps * one->period - time);
        all->command[one->vehicle] = least_command(all, one); /* it releases or holds if all its wheelsets do */
    }
    return next;
}

/* Lets an open area follow its command for a step; returns its mean. One that is as good as there is there. */
static double follow(double *area, int open, double pace, double step) {
    const double target = open ? 1.0 : 0.0, apart = *area - target, steps = pace * step;
    if (!(pace > 0.0) || fabs(apart) < SETTLED) return *area = target;
    *area = target + apart * exp(-steps);
    return target - apart * expm1(-steps) / steps;
}

void protection_open(train *self, double step) {
    protections *all = self->slide;
    if (!all) return;
    for (long long int i = 0; i < self->vehicles; ++i) {
        all->held[i] = all->command[i] != PROTECTION_APPLY;
        all->vented[i] = all->command[i] == PROTECTION_RELEASE;
    }
    EACH(all, one) {
        double held[RIG_MOST], vented[RIG_MOST], pressure[RIG_MOST];
        find_pressures(self, one, pressure);
        for (int n = 0; n < one->wheelsets; ++n) {
            wheelset *of = wheelsets_of(all, one) + n;
            held[n] = 1.0 - follow(&of->fills, of->command == WHEEL_SLIDE_APPLY, one->valve_pace, step);
            vented[n] = follow(&of->vents, of->command == WHEEL_SLIDE_VENT, one->valve_pace, step);
            of->speed = speed_of(self, one, n);
            of->before = pressure[n];
        }
        all->held[one->vehicle] = held[0];
        all->vented[one->vehicle] = vented[0];
        pipe_dump_parts(self->air, one->vehicle, held, vented);
    }
    pipe_dump(self->air, all->held, all->vented);
}

void protection_shares(const train *self, long long int vehicle, double *held, double *vented) {
    const protections *all = self->slide;
    const double command = self->input[IN_PROTECTION][vehicle];
    *held = all ? all->held[vehicle] : command != PROTECTION_APPLY;
    *vented = all ? all->vented[vehicle] : command == PROTECTION_RELEASE;
}

void protection_turn(train *self, double step) {
    protections *all = self->slide;
    if (!all) return;
    EACH(all, one)
    for (int n = 0; n < one->wheelsets; ++n) {
        wheelset *of = wheelsets_of(all, one) + n;
        of->rotation += (of->speed + speed_of(self, one, n)) / 2.0 * step / one->radius;
    }
}

/* The vehicles whose wheelsets have cylinders of their own. */
#define EACH_DIVIDED(self, one)                                                                                                \
    EACH(self, one)                                                                                                            \
    if (one->wheelsets > 1)

/* Number of wheelsets with an electric brake, which the command to vent ends. */
static double electric_wheelsets(const protections *self, const protected_vehicle *one) {
    int count = 0;
    for (int n = 0; n < one->wheelsets; ++n) count += wheelsets_of(self, one)[n].command != WHEEL_SLIDE_VENT;
    return count;
}

void protection_brake(train *self) {
    protections *all = self->slide;
    if (!all) return;
    EACH_DIVIDED(all, one) {
        const long long int i = one->vehicle;
        double after[RIG_MOST], sum = 0.0;
        find_pressures(self, one, after);
        self->blended[i] *= electric_wheelsets(all, one) / one->wheelsets;
        for (int n = 0; n < one->wheelsets; ++n) {
            wheelset *of = wheelsets_of(all, one) + n;
            const double middle = (of->before + after[n]) / 2.0, speed = speed_of(self, one, n);
            train_brake_at_1(&middle, &speed, self->brake + i, &of->force, self->stride);
            sum += of->force = extra_parked(self, i, of->force);
        }
        self->held[i] = sum / one->wheelsets;
    }
}

void protection_share(train *self) {
    protections *all = self->slide;
    if (!all) return;
    EACH_DIVIDED(all, one) {
        double *share = train_detail_brake(self, one->vehicle), sum = 0.0;
        const wheelset *of = wheelsets_of(all, one);
        const double held = self->held[one->vehicle], electric = self->blends ? self->blended[one->vehicle] : 0.0;
        for (int n = 0; n < one->wheelsets; ++n) sum += of[n].force;
        const double rubs = sum > 0.0 ? (held - electric) / sum : 0.0,
                     pulls = electric / fmax(electric_wheelsets(all, one), 1.0);
        for (int n = 0; n < one->wheelsets && share; ++n) {
            const double force = rubs * of[n].force + (of[n].command != WHEEL_SLIDE_VENT ? pulls : 0.0);
            share[n] = held > 0.0 ? one->wheelsets * force / held : 1.0;
        }
    }
}

void protection_outputs(train *self) {
    protections *all = self->slide;
    rows_copy(self->output[OUT_PROTECTION_STATE],
              all ? all->command : self->given_before + (self->input[IN_PROTECTION] - self->input[0]), self->vehicles);
    for (long long int n = 0; all && n < all->count; ++n) {
        const protected_vehicle *one = &all->each[n];
        const state *own = state_of(all, one);
        self->output[OUT_PROTECTION_STATE][one->vehicle] = largest_command(all, one);
        if (own->failed_at >= 0.0) self->output[OUT_PROTECTION_STATE][one->vehicle] = PROTECTION_FAILED;
        self->output[OUT_PROTECTION_AIR][one->vehicle] = own->air;
    }
}

/* The start of the run, commands of all vehicles, and the states. */
long long int protection_numbers(const train *self) {
    return self->slide ? 1 + self->vehicles + (long long int)(self->slide->bytes / sizeof(double)) : 0;
}

void protection_save(const train *self, double *numbers) {
    const protections *all = self->slide;
    if (!all) return;
    *numbers++ = all->start;
    rows_copy(numbers, all->command, self->vehicles);
    memcpy(numbers + self->vehicles, all->states, all->bytes);
}

void protection_load(train *self, const double *numbers) {
    protections *all = self->slide;
    if (!all) return;
    all->start = *numbers++;
    rows_copy(all->command, numbers, self->vehicles);
    memcpy(all->states, numbers + self->vehicles, all->bytes);
}
