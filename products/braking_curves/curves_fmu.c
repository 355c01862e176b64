/* Supervision of one target by ETCS (SUBSET-026, 3.13) as an object of arrays (arrays.h): from speed and distance to the limits
 * and to the commands of the brakes. The gradients of a line are in resources/gradients.bin. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "arrays.h"
#include "braking_arcs.h"
#include "curves_arrays.h"

/* Rotating mass where the train has no nominal one [% of the mass], A.3.1; acceleration of gravity [m/s2]. */
#define UPHILL 15.0
#define DOWNHILL 2.0
#define GRAVITY 9.81
/* Largest acceleration that counts while the brake builds up [m/s2]; time between warning and intervention [s]. */
#define BUILDING_UP 0.4
#define T_WARNING 2.0
#define T_DRIVER 4.0
#define KMH (1.0 / 3.6)

enum { EOA = 1 };
enum { SERVICE_LATCH, EMERGENCY_LATCH, WARNING_LATCH, LATCHES };

/* Values that a run changes. */
typedef struct {
    double value[VALUES], latch[LATCHES];
} run_values;

struct arrays_object {
    run_values now;
    int starts; /* number of gradients of the line; 0: the input `gradient` */
    double *start, *rise; /* places where they begin [m], and gradients [permille] */
    double *edge, *slope; /* `line_slopes` of this train */
    int *rising; /* numbers of gradients under the train, in the order of their values: a queue */
    line_slopes line;
    speed_steps safe, service; /* A_brake_safe and A_brake_service */
    braking_curve emergency_curve, service_curve;
    unsigned long long mark; /* of the line */
};

static double given(const arrays_object *self, int array) { return self->now.value[FIRST_OF[array]]; }
static void put(arrays_object *self, int array, double value) { self->now.value[FIRST_OF[array]] = value; }

/* ---- the line ---- */

/* Return the wrong part of a file of gradients; NULL if all is right. */
static const char *gradients_wrong(const double *numbers, size_t count) {
    const double starts = numbers[0];
    if (!(starts >= 0.0 && starts <= MOST_GRADIENTS && starts == floor(starts))) return "their number";
    const size_t n = (size_t)starts;
    if (count != 1 + 2 * n) return "the size of the file";
    for (size_t k = 0; k < n; ++k) {
        const double place = numbers[1 + k];
        if (!(fabs(place) <= FARTHEST_PLACE) || (k > 0 && !(place > numbers[k]))) return "a place";
        if (!(fabs(numbers[1 + n + k]) <= STEEPEST)) return "a gradient";
    }
    return NULL;
}

static bool make_line(arrays_object *self, const double *numbers) {
    const size_t starts = (size_t)numbers[0], inner = starts > 1 ? starts - 1 : 0, edges = 2 * inner;
    self->starts = (int)starts;
    double *block = (double *)calloc(2 * starts + 2 * edges + 1, sizeof(double));
    self->start = block;
    if (!block) return false;
    self->rise = block + starts;
    self->edge = self->rise + starts;
    self->slope = self->edge + edges;
    if (starts) memcpy(block, numbers + 1, 2 * starts * sizeof(double));
    self->line = (line_slopes){(int)edges, self->edge, self->slope};
    self->rising = (int *)calloc(starts + 1, sizeof(int));
    if (!self->rising) return false;
    const size_t room = (size_t)curve_room((int)edges);
    self->emergency_curve.arc = (braking_arc *)calloc(2 * room, sizeof(braking_arc));
    if (!self->emergency_curve.arc) return false;
    self->service_curve.arc = self->emergency_curve.arc + room;
    return true;
}

arrays_object *arrays_create(const char *folder, char problem[MESSAGE_SIZE]) {
    size_t count = 0;
    double *numbers = arrays_read(folder, "gradients.bin", &count, problem);
    if (!numbers) return NULL;
    const char *wrong = gradients_wrong(numbers, count);
    arrays_object *self = wrong ? NULL : (arrays_object *)calloc(1, sizeof *self);
    if (wrong)
        print_text(problem, MESSAGE_SIZE,
                   "The gradients in %.200s/gradients.bin are damaged, %s cannot be; build the FMU again.", folder, wrong);
    else if (!self || !make_line(self, numbers)) {
        strcpy(problem, "There is no memory for the gradients of the line.");
        arrays_free(self);
        self = NULL;
    } else self->mark = arrays_mark_of(numbers, count);
    free(numbers);
    return self;
}

void arrays_free(arrays_object *self) {
    if (!self) return;
    free(self->start);
    free(self->rising);
    free(self->emergency_curve.arc);
    free(self);
}

double *arrays_values(const arrays_object *self, unsigned array, size_t *count) {
    *count = (size_t)(FIRST_OF[array + 1] - FIRST_OF[array]);
    return (double *)&self->now.value[FIRST_OF[array]];
}

void arrays_reset(arrays_object *self) {
    memset(&self->now, 0, sizeof self->now);
    memcpy(self->now.value, STARTS, sizeof STARTS);
}

/* ---- what follows from the parameters ---- */

/* Acceleration by a gradient [permille], 3.13.4.3. */
static double slope_of(const arrays_object *self, double permille) {
    const double nominal = given(self, M_ROTATING_NOM);
    const double share = nominal >= 0.0 ? nominal : permille > 0.0 ? UPHILL : DOWNHILL;
    return GRAVITY * permille / (1000.0 + 10.0 * share);
}

/* Places of the front at which the lowest gradient under the train may change: where it enters a gradient and leaves it. */
static void find_edges(arrays_object *self, double length) {
    const int inner = self->starts > 1 ? self->starts - 1 : 0;
    const double *starts = self->start + 1;
    for (int enters = 0, leaves = 0, n = 0; n < 2 * inner; ++n)
        self->edge[n] = enters < inner && (leaves == inner || starts[enters] <= starts[leaves] + length)
                            ? starts[enters++]
                            : starts[leaves++] + length;
}

/* The lowest gradient under the train between its edges, 3.13.4.2. Each gradient enters and leaves the queue once. */
static void find_slopes(arrays_object *self) {
    const double length = given(self, LENGTH);
    int *queue = self->rising, head = 0, tail = 1; /* the first gradient is in it */
    find_edges(self, length);
    const int edges = self->line.edges;
    queue[0] = 0;
    for (int n = 0, first = 0, last = 0; n <= edges && self->starts; ++n) {
        const double front = !edges       ? 0.0
                             : n == 0     ? self->edge[0] - 1.0
                             : n == edges ? self->edge[n - 1] + 1.0
                                          : (self->edge[n - 1] + self->edge[n]) / 2.0;
        while (last + 1 < self->starts && front > self->start[last + 1]) {
            ++last;
            while (tail > head && self->rise[queue[tail - 1]] >= self->rise[last]) --tail;
            queue[tail++] = last;
        }
        while (first < last && self->start[first + 1] <= front - length) ++first;
        while (queue[head] < first) ++head;
        self->slope[n] = slope_of(self, self->rise[queue[head]]);
    }
}

static speed_steps steps_of(const arrays_object *self, int boundaries, int values) {
    speed_steps found = {TRAIN_STEPS, {0.0}, {0.0}};
    memcpy(found.boundary, self->now.value + FIRST_OF[boundaries], (TRAIN_STEPS - 1) * sizeof(double));
    memcpy(found.value, self->now.value + FIRST_OF[values], TRAIN_STEPS * sizeof(double));
    return found;
}

static void prepare(arrays_object *self) {
    speed_steps factor[3] = {steps_of(self, A_BRAKE_EMERGENCY_SPEED, A_BRAKE_EMERGENCY),
                             steps_of(self, KDRY_RST_SPEED, KDRY_RST), steps_of(self, KWET_RST_SPEED, KWET_RST)};
    const double waived = given(self, M_NVAVADH);
    for (int n = 0; n < TRAIN_STEPS; ++n) factor[2].value[n] += waived * (1.0 - factor[2].value[n]);
    steps_product(factor, &self->safe);
    self->service = steps_of(self, A_BRAKE_SERVICE_SPEED, A_BRAKE_SERVICE);
    find_slopes(self);
}

/* ---- limits ---- */

static double margin(double speed, double slow, double fast, double least, double most) {
    const double share = fmin(fmax((speed / KMH - slow) / (fast - slow), 0.0), 1.0);
    return (least + share * (most - least)) * KMH;
}
static double warning_margin(double speed) { return margin(speed, 110.0, 140.0, 4.0, 5.0); }
static double service_margin(double speed) { return margin(speed, 110.0, 210.0, 5.5, 10.0); }
static double emergency_margin(double speed) { return margin(speed, 110.0, 210.0, 7.5, 15.0); }

/* Limits of the emergency and of the service brake, with the lag of none. */
typedef struct {
    supervision_limit emergency, service;
    bool eoa;
    double wait, T_bs, target; /* build-up times of a commanded service brake, and of the service brake [s]; V_target */
} target_limits;

static target_limits limits_of(const arrays_object *self) {
    const double target = given(self, V_TARGET), factor = target > 0.0 ? given(self, MOVING_TARGET_FACTOR) : 1.0;
    const double T_be = given(self, T_BRAKE_EMERGENCY) * factor, T_bs = given(self, T_BRAKE_SERVICE) * factor;
    const double pulls = fmax(given(self, A_EST), 0.0), wait = given(self, SERVICE_COMMAND) != 0.0 ? T_bs : 0.0;
    double traction = given(self, T_TRACTION_CUT_OFF);
    if (given(self, TRACTION_COMMAND) != 0.0) traction = fmax(traction - (T_WARNING + wait), 0.0);
    const double building = fmax(T_be - traction, 0.0);
    const bool compensated = given(self, Q_NVINHSMICPERM) == 0.0;
    return (target_limits){{&self->emergency_curve, traction, building, pulls * traction, fmin(pulls, BUILDING_UP) * building,
                            target, 0.0, compensated},
                           {&self->service_curve, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, false},
                           given(self, TARGET_KIND) == EOA,
                           wait,
                           T_bs,
                           target};
}

/* Find EBD, and SBD of an end of authority, at a place of the target [m], up to a speed [m/s]. */
static void find_curves(arrays_object *self, const target_limits *limits, double place, double most) {
    const double target = limits->target, foot = limits->eoa ? 0.0 : target + emergency_margin(target);
    const double beyond = limits->eoa ? given(self, BEYOND) : 0.0;
    speed_steps brake = self->safe;
    if (given(self, REDUCED_ADHESION) != 0.0)
        for (int n = 0; n < brake.count; ++n) brake.value[n] = fmin(brake.value[n], given(self, A_NVMAXREDADH));
    if (!self->starts) self->slope[0] = slope_of(self, 1e3 * given(self, GRADIENT));
    curve_find(&self->emergency_curve, place + beyond, foot, &brake, &self->line, most);
    if (limits->eoa) curve_find(&self->service_curve, place, 0.0, &self->service, &self->line, most);
}

/* Place of SBI less a time, the lower one of both brakes. */
static double place_of(const target_limits *limits, double speed, double time) {
    const double lag = (limits->wait + time) * speed, by_emergency = limit_place(&limits->emergency, speed) - lag;
    return limits->eoa ? fmin(by_emergency, limit_place(&limits->service, speed) - lag) : by_emergency;
}

/* Speed of SBI less a time at a place. */
static double speed_of(target_limits *limits, double place, double time, double most) {
    limits->emergency.lag = limits->service.lag = limits->wait + time;
    const double by_emergency = limit_speed(&limits->emergency, place, most);
    const double found = limits->eoa ? fmin(by_emergency, limit_speed(&limits->service, place, most)) : by_emergency;
    limits->emergency.lag = limits->service.lag = 0.0;
    return found;
}

/* A speed between that of the target, or the release speed, and that of the line. */
static double between(const arrays_object *self, const target_limits *limits, double found, double margin_at(double)) {
    const double target = limits->target, line = given(self, V_MRSP);
    const double floor_speed = limits->eoa ? given(self, V_RELEASE) : target + (margin_at ? margin_at(target) : 0.0);
    return fmin(fmax(found, floor_speed), line + (margin_at ? margin_at(line) : 0.0));
}

static void put_distance(arrays_object *self, int array, double place, double limit) {
    put(self, array, fmin(place - limit, AT_ANY_DISTANCE));
}

/* Find limits; the place of the target [m] is `to` before the front. */
static void find_limits(arrays_object *self, double speed, double front, double to) {
    target_limits limits = limits_of(self);
    const double place = front + to, most = given(self, V_MRSP) + emergency_margin(given(self, V_MRSP));
    find_curves(self, &limits, place, limit_reached(&limits.emergency, fmax(speed, most)));
    put(self, V_P, between(self, &limits, speed_of(&limits, front, T_DRIVER, most), NULL));
    put(self, V_W, between(self, &limits, speed_of(&limits, front, T_WARNING, most), warning_margin));
    put(self, V_SBI, between(self, &limits, speed_of(&limits, front, 0.0, most), service_margin));
    put(self, V_EBI, between(self, &limits, limit_speed(&limits.emergency, front, most), emergency_margin));
    const double T_indication = fmax(0.8 * limits.T_bs, 5.0) + (given(self, BASELINE) >= 4.0 ? T_DRIVER : 0.0);
    put_distance(self, DISTANCE_I, place, place_of(&limits, speed, T_DRIVER) - speed * T_indication);
    put_distance(self, DISTANCE_P, place, place_of(&limits, speed, T_DRIVER));
    put_distance(self, DISTANCE_W, place, place_of(&limits, speed, T_WARNING));
    put_distance(self, DISTANCE_SBI, place, place_of(&limits, speed, 0.0));
    put_distance(self, DISTANCE_EBI, place, limit_place(&limits.emergency, speed));
    put_distance(self, DISTANCE_EBD, place, curve_place(&self->emergency_curve, speed));
}

/* ---- commands ---- */

static bool latched(arrays_object *self, int which, bool begins, bool ends) {
    double *latch = &self->now.latch[which];
    *latch = begins || (*latch != 0.0 && !ends);
    return *latch != 0.0;
}

/* Commands of 3.13.10, each until its end: the emergency brake at rest, the others at the permitted speed. */
static void find_commands(arrays_object *self, double speed, double to) {
    const double permitted = given(self, V_P);
    const bool stands = speed <= STANDSTILL, kept = speed <= permitted, eoa = given(self, TARGET_KIND) == EOA;
    const bool has_service = given(self, SERVICE_COMMAND) != 0.0, over = !stands && speed > given(self, V_SBI);
    const bool tripped = !stands && eoa && to < 0.0;
    const bool warns = latched(self, WARNING_LATCH, !stands && speed > given(self, V_W), stands || kept);
    const bool service = latched(self, SERVICE_LATCH, over && has_service, stands || kept);
    const bool emergency =
        latched(self, EMERGENCY_LATCH, tripped || (!stands && speed > given(self, V_EBI)) || (over && !has_service),
                stands || (kept && given(self, Q_NVEMRRLS) != 0.0));
    put(self, INDICATION, speed > permitted || (to <= given(self, DISTANCE_I) && (eoa || speed > given(self, V_TARGET))));
    put(self, WARNING, warns);
    put(self, TRACTION_CUT_OFF, given(self, TRACTION_COMMAND) != 0.0 && (warns || service || emergency));
    put(self, SERVICE_BRAKE, service);
    put(self, EMERGENCY_BRAKE, emergency);
}

/* ---- runs ---- */

enum { STEP_FUNCTIONS = 4 };
static const int BOUNDARIES[STEP_FUNCTIONS] = {A_BRAKE_EMERGENCY_SPEED, A_BRAKE_SERVICE_SPEED, KDRY_RST_SPEED, KWET_RST_SPEED};

/* Write why the boundaries of steps cannot be meant; false if all can. */
static bool is_wrong_step(const arrays_object *self, char problem[MESSAGE_SIZE]) {
    for (int k = 0; k < STEP_FUNCTIONS; ++k)
        for (int n = FIRST_OF[BOUNDARIES[k]]; n < FIRST_OF[BOUNDARIES[k] + 1]; ++n) {
            const char *name = ARRAYS_ABOUT[BOUNDARIES[k]].name;
            const double speed = self->now.value[n];
            if (n > FIRST_OF[BOUNDARIES[k]] && !(speed >= self->now.value[n - 1]))
                print_text(problem, MESSAGE_SIZE, "%s must ascend; got a lower boundary after a higher one. Sort the steps.",
                           name);
            else if (speed > FASTEST_BOUNDARY && speed < UNUSED_BOUNDARY)
                print_text(problem, MESSAGE_SIZE,
                           "%s must be at most %g m/s, or %g if it is not used; got %g. Give m/s, not km/h.", name,
                           FASTEST_BOUNDARY, UNUSED_BOUNDARY, speed);
            else continue;
            return true;
        }
    return false;
}

/* Write why numbers do not go together; false if they do. */
static bool is_wrong(const arrays_object *self, char problem[MESSAGE_SIZE]) {
    const bool eoa = given(self, TARGET_KIND) == EOA;
    const double beyond = given(self, BEYOND), release = given(self, V_RELEASE), rotating = given(self, M_ROTATING_NOM);
    if (is_wrong_step(self, problem)) return true;
    if (eoa && given(self, V_TARGET) > 0.0)
        print_text(problem, MESSAGE_SIZE,
                   "V_target must be 0 m/s at an end of authority (EOA); got %g m/s. Set target_kind to 2 or 3.",
                   given(self, V_TARGET));
    else if (!eoa && (beyond != 0.0 || release != 0.0))
        print_text(problem, MESSAGE_SIZE, "%s must be 0 unless target_kind is 1, an end of authority (EOA); got %g.",
                   beyond != 0.0 ? "beyond" : "V_release", beyond != 0.0 ? beyond : release);
    else if (self->starts && given(self, GRADIENT) != 0.0)
        print_text(problem, MESSAGE_SIZE, "gradient must be 0 in an FMU with a line, which has the gradients; got %g.",
                   given(self, GRADIENT));
    else if (rotating > 0.0 && rotating < SMALLEST_ROTATING)
        print_text(problem, MESSAGE_SIZE, "M_rotating_nom must be at most 0, or at least %g %%; got %g. Give 10 for 10 %%.",
                   SMALLEST_ROTATING, rotating);
    else return false;
    return true;
}

static void find(arrays_object *self) {
    const double speed = fmax(given(self, V_EST), 0.0), to = given(self, DISTANCE_TO_TARGET);
    find_limits(self, speed, given(self, DISTANCE), to);
    find_commands(self, speed, to);
}

/* Outputs of a train that must not move. */
static void make_safe(arrays_object *self) {
    memset(self->now.value + FIRST_OF[V_P], 0, sizeof(double) * (VALUES - (size_t)FIRST_OF[V_P]));
    put(self, SERVICE_BRAKE, 1.0);
    put(self, EMERGENCY_BRAKE, 1.0);
}

void arrays_start(arrays_object *self, double time) {
    char problem[MESSAGE_SIZE];
    (void)time;
    memset(self->now.latch, 0, sizeof self->now.latch);
    prepare(self);
    if (is_wrong(self, problem)) make_safe(self); /* the first step states why */
    else find(self);
}

kernel_status arrays_go(arrays_object *self, double time, double step, bool *ended, char problem[MESSAGE_SIZE]) {
    (void)time, (void)step, (void)ended;
    if (is_wrong(self, problem)) return KERNEL_DISCARD;
    find(self);
    return KERNEL_OK;
}

unsigned long long arrays_mark(const arrays_object *self) { return self->mark; }
size_t arrays_numbers(const arrays_object *self) {
    (void)self;
    return sizeof(run_values) / sizeof(double);
}
void arrays_save(const arrays_object *self, double *numbers) { memcpy(numbers, &self->now, sizeof self->now); }
void arrays_load(arrays_object *self, const double *numbers) {
    memcpy(&self->now, numbers, sizeof self->now);
    prepare(self);
}
