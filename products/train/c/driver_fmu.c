/* A driver under the braking curves of ETCS as an object of arrays (arrays.h) of one element each: from the train's speed and
 * place and the limits of BrakingCurves to the driver's valve and traction. The law is in products/train/driver_fmu.py.
 *
 * The driver acts at the start of the first step that begins at or after each multiple of the period, 0 excepted: some masters
 * connect inputs after the first step. Commands of the on-board unit act at once. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "arrays.h"
#include "driver_arrays.h"

struct arrays_object {
    double values[ARRAYS_MOST];
    double start_time, acted; /* [s]; multiples of the period so far */
    double added;             /* integral part of the demand, a share of the whole brake */
    double braking, arrived;  /* 1: to a stop; at the target */
};

arrays_object *arrays_create(const char *folder, char problem[MESSAGE_SIZE]) {
    (void)folder; /* it is made of no files */
    arrays_object *self = (arrays_object *)calloc(1, sizeof *self);
    if (!self) strcpy(problem, "There is no memory for the driver.");
    return self;
}

void arrays_free(arrays_object *self) { free(self); }

double *arrays_values(const arrays_object *self, unsigned array, size_t *count) {
    *count = 1;
    return (double *)&self->values[array];
}

void arrays_reset(arrays_object *self) {
    memset(self, 0, sizeof *self);
    memcpy(self->values, STARTS, sizeof STARTS);
}

/* ---- the law ---- */

static double share(double value) { return fmin(fmax(value, 0.0), 1.0); }

static void find_places(arrays_object *self) {
    double *value = self->values;
    value[PLACE] = value[DISTANCE] + value[FRONT];
    value[DISTANCE_TO_TARGET] = value[TARGET] - value[PLACE];
}

/* Demand that holds a speed: above 0 of the brake, below 0 of the motors. `alone`: whether nothing else brakes or coasts. */
static double holding(arrays_object *self, double speed, bool alone) {
    const double *value = self->values, fast = speed - (value[V_P] - value[BELOW]), least = -value[LARGEST_TRACTION] / PULLS;
    const double demand = self->added + value[GAIN] * fast;
    if (alone && ((least < demand && demand < 1.0) || demand * fast < 0.0)) /* no wind-up beyond brake and motors */
        self->added += value[GAIN] / value[MEMORY] * fast * value[PERIOD];
    return demand;
}

/* Share of the deceleration of SBD that stops the train `short` before the target, after a build-up time. */
static double needed(const double *value, double speed) {
    const double by_full_service = value[DISTANCE_P] - speed * (value[BRAKE_TIME] + T_DRIVER);
    const double way = value[DISTANCE_TO_TARGET] - value[SHORT] - speed * value[BRAKE_TIME];
    if (speed == 0.0) return 0.0;
    return way > 0.0 ? share(by_full_service / way) : 1.0;
}

/* Whether the train is at its target: until that is moved. */
static bool is_there(const arrays_object *self, double speed) {
    const double to = self->values[DISTANCE_TO_TARGET], near = self->values[SHORT];
    return to < near + speed * self->values[BRAKE_TIME] || (to < MOVED * near && (speed < STANDS || self->arrived != 0.0));
}

/* Whether motors may pull: the permitted speed is that of the train only further on. */
static bool may_pull(const double *value, double speed) {
    return value[DISTANCE_TO_TARGET] - value[DISTANCE_P] >= AHEAD * speed * (value[BRAKE_TIME] + T_DRIVER);
}

static void act(arrays_object *self) {
    double *value = self->values;
    value[VIGILANCE] = 1.0 - value[VIGILANCE];
    const double speed = fmax(value[SPEED], 0.0), stop = needed(value, speed);
    self->braking = stop >= (self->braking != 0.0 ? value[BRAKES_AT] / 2.0 : value[BRAKES_AT]);
    self->arrived = is_there(self, speed);
    const bool alone = may_pull(value, speed) && self->braking == 0.0, stays = self->arrived != 0.0 || value[SPEED] < BACK;
    const double held = holding(self, speed, alone);
    const double air = fmax(fmax(share(held), self->braking != 0.0 ? stop : 0.0), stays ? HOLDS : 0.0);
    value[TRACTION] = air > 0.0 || !alone ? 0.0 : fmin(-PULLS * held, value[LARGEST_TRACTION]);
    value[DRIVER_POSITION] = air < LEAST / 2.0 ? RUNNING : SERVICE;
    value[DRIVER_STEP] = share((air - LEAST) / (1.0 - LEAST));
}

/* Commands of the on-board unit go before the driver's. */
static void obey(double *value) {
    const bool emergency = value[EMERGENCY_BRAKE] != 0.0, service = value[SERVICE_BRAKE] != 0.0;
    if (emergency || service || value[TRACTION_CUT_OFF] != 0.0) value[TRACTION] = 0.0;
    if (service) value[DRIVER_STEP] = 1.0;
    if (emergency || service) value[DRIVER_POSITION] = emergency ? EMERGENCY : SERVICE;
}

/* ---- runs ---- */

void arrays_start(arrays_object *self, double time) {
    self->start_time = time;
    self->acted = 1.0;
    self->added = self->braking = self->arrived = 0.0;
    memcpy(self->values + FIRST_OUTPUT, STARTS + FIRST_OUTPUT, (ARRAYS_MOST - FIRST_OUTPUT) * sizeof(double));
    find_places(self);
}

kernel_status arrays_go(arrays_object *self, double time, double step, bool *ended, char problem[MESSAGE_SIZE]) {
    (void)step, (void)ended, (void)problem;
    find_places(self);
    if (arrays_is_due(time, self->start_time, self->values[PERIOD], &self->acted)) act(self);
    obey(self->values);
    return KERNEL_OK;
}

/* Its mark is equal wherever a state may be restored. */
unsigned long long arrays_mark(const arrays_object *self) {
    (void)self;
    return 0;
}
size_t arrays_numbers(const arrays_object *self) { return sizeof *self / sizeof(double); }
void arrays_save(const arrays_object *self, double *numbers) { memcpy(numbers, self, sizeof *self); }
void arrays_load(arrays_object *self, const double *numbers) { memcpy(self, numbers, sizeof *self); }
