/* The train as an object of arrays (arrays.h): gauge pressures, and its consist from resources/train.bin. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "arrays.h"
#include "detail.h"
#include "details_fmu.h"
#include "duration.h"
#include "train.h"
#include "train_arrays.h"

struct arrays_object {
    train *own;
    fmu_details *details; /* NULL: no vehicle is in detail */
    double *values; /* of all arrays, one after the other */
    double *states; /* of the protection of each vehicle before a step */
    size_t place[ARRAYS_MOST + 1];
    unsigned long long mark; /* of the consist */
};

static size_t length_of(train *own, int array) {
    long long int count = 1;
    if (array >= FIRST_INPUT && array < FIRST_INPUT + TRAIN_INPUTS) train_input(own, array - FIRST_INPUT, &count);
    if (array >= FIRST_OUTPUT && array < FIRST_OUTPUT + OUT_SUMS) train_output(own, array - FIRST_OUTPUT, &count);
    if (array == LOCKED || array == SLIP) train_output(own, OUT_SPEED, &count);
    return (size_t)count;
}

static arrays_object *create(const double *numbers, long long int count, const char *folder, char problem[MESSAGE_SIZE]) {
    arrays_object *self = (arrays_object *)calloc(1, sizeof *self);
    if (self) self->own = train_create(numbers, count);
    if (self && self->own) self->details = details_create(folder, self->own, problem);
    if (self && self->own && !*problem) {
        self->mark = arrays_mark_of(numbers, (size_t)count) ^ details_mark(self->details);
        for (unsigned n = 0; n < ARRAYS; ++n) self->place[n + 1] = self->place[n] + length_of(self->own, (int)n);
        self->values = (double *)calloc(self->place[ARRAYS], sizeof(double));
        self->states = (double *)calloc(length_of(self->own, LOCKED), sizeof(double));
        if (self->values && self->states) return self;
    }
    arrays_free(self);
    return NULL;
}

arrays_object *arrays_create(const char *folder, char problem[MESSAGE_SIZE]) {
    size_t count = 0;
    *problem = '\0';
    double *numbers = arrays_read(folder, "train.bin", &count, problem);
    if (!numbers) return NULL;
    const char *wrong = train_wrong(numbers, (long long int)count);
    arrays_object *self = wrong ? NULL : create(numbers, (long long int)count, folder, problem);
    if (wrong)
        print_text(problem, MESSAGE_SIZE, "The consist %.200s/train.bin is damaged, %s cannot be; build the FMU again.", folder,
                   wrong);
    else if (!self && !*problem) print_text(problem, MESSAGE_SIZE, "There is no memory for the train.");
    else if (self && train_lacks_controller(self->own) >= 0) {
        print_text(problem, MESSAGE_SIZE, "The controller of vehicle %lld is not in this binary; build the FMU again.",
                   train_lacks_controller(self->own) + 1);
        arrays_free(self);
        self = NULL;
    }
    free(numbers);
    return self;
}

void arrays_free(arrays_object *self) {
    if (!self) return;
    train_free(self->own);
    details_free(self->details);
    free(self->values);
    free(self->states);
    free(self);
}

double *arrays_values(const arrays_object *self, unsigned array, size_t *count) {
    *count = self->place[array + 1] - self->place[array];
    return self->values + self->place[array];
}

static double *values_of(const arrays_object *self, int array) { return self->values + self->place[array]; }

static void put_inputs(const arrays_object *self) {
    for (int n = 0; n < TRAIN_INPUTS; ++n) {
        long long int count;
        double *to = train_input(self->own, n, &count);
        memcpy(to, values_of(self, FIRST_INPUT + n), (size_t)count * sizeof(double));
    }
}

static void find_outputs(arrays_object *self) {
    for (int n = 0; n < OUT_SUMS; ++n) {
        long long int count;
        const double *from = train_output(self->own, n, &count),
                     less = n == OUT_PIPE_PRESSURE || n == OUT_CYLINDER_PRESSURE || n == OUT_MAIN_RESERVOIR_PRESSURE ? AMBIENT
                                                                                                                     : 0.0;
        double *to = values_of(self, FIRST_OUTPUT + n);
        for (long long int i = 0; i < count; ++i) to[i] = from[i] - less;
    }
    long long int count;
    const double *speed = train_output(self->own, OUT_SPEED, &count), *wheel = train_output(self->own, OUT_WHEEL_SPEED, &count);
    for (long long int i = 0; i < count; ++i) {
        values_of(self, LOCKED)[i] = wheel[i] == 0.0 && speed[i] != 0.0;
        values_of(self, SLIP)[i] = speed[i] == wheel[i] ? 0.0 : (speed[i] - wheel[i]) / fmax(fabs(speed[i]), fabs(wheel[i]));
    }
    const double *sums = train_output(self->own, OUT_SUMS, &count);
    for (int n = SUM_LARGEST_TENSION; n < TRAIN_SUMS; ++n) *values_of(self, FIRST_SUM + n - SUM_LARGEST_TENSION) = sums[n];
    if (self->details) details_outputs(self->details, values_of(self, FIRST_DETAILED));
}

void arrays_reset(arrays_object *self) {
    train_begin(self->own, 0.0, 0.0, 0.0, train_charged(self->own), AMBIENT);
    memset(self->values, 0, self->place[ARRAYS] * sizeof(double));
    *values_of(self, FIRST_PARAMETER + 2) = train_charged(self->own) - AMBIENT;
    for (int n = 0; n < TRAIN_INPUTS; ++n) {
        long long int count;
        const double *from = train_input(self->own, n, &count);
        memcpy(values_of(self, FIRST_INPUT + n), from, (size_t)count * sizeof(double));
    }
    find_outputs(self);
}

void arrays_start(arrays_object *self, double time) {
    const double *given = values_of(self, FIRST_PARAMETER); /* speed, distance, pressures of pipe and cylinders */
    train_begin(self->own, time, given[0], given[1], given[2] + AMBIENT, given[3] + AMBIENT);
    put_inputs(self);
    if (self->details) details_start(self->details, self->own, time, given[0], given[1]);
    find_outputs(self);
}

/* Write for which vehicles something has occurred for the first time since a time, if any; `at`: times. */
static void say_first(const arrays_object *self, const double *at, double since, const char *subject, const char *verb,
                      char problem[MESSAGE_SIZE]) {
    char when[TIME_TEXT], others[32] = "";
    long long int count, first = 0, more = -1;
    train_output(self->own, OUT_SPEED, &count);
    for (long long int i = count - 1; i >= 0; --i)
        if (at[i] > since && at[i] < TRAIN_NEVER) first = i + 1, ++more;
    if (more < 0) return;
    if (more > 0) print_text(others, sizeof others, " and of %lld behind it", more);
    print_text(problem, MESSAGE_SIZE, "The %s of vehicle %lld%s %s at %s s.", subject, first, others, verb,
               time_text(at[first - 1], 6, when));
}

/* Write the vehicles whose controllers have failed in a step, if any. `before`: states of the protection. */
static void say_failed(const arrays_object *self, const double *before, double time, char problem[MESSAGE_SIZE]) {
    char when[TIME_TEXT];
    long long int count, first = 0;
    train_output(self->own, OUT_SPEED, &count);
    const double *now = values_of(self, FIRST_OUTPUT + OUT_PROTECTION_STATE);
    for (long long int i = count - 1; i >= 0; --i)
        if (now[i] == PROTECTION_FAILED && before[i] != PROTECTION_FAILED) first = i + 1;
    if (first)
        print_text(problem, MESSAGE_SIZE,
                   "The controller of vehicle %lld failed before %s s: its commands must be 0, 1 or 2, and its writes in "
                   "its memory. Its brake stays applied.",
                   first, time_text(time, 6, when));
}

/* Write what is wrong with an element of an input. */
static void say_wrong(const arrays_object *self, int input, long long int element, char problem[MESSAGE_SIZE]) {
    const char *why = input == IN_DRIVER_POSITION ? "Service is by wire: it must be from 0 to 4."
                      : input == IN_PROTECTION    ? "This vehicle has a controller of its own: leave the input at 0."
                      : input == IN_EXTERNAL_VEHICLE && train_detail_turning(self->own, element)
                          ? "This train computes the vehicle in detail: leave the input at 0."
                      : input == IN_EXTERNAL_VEHICLE ? "The sensor of its protection would show no slip: build it without."
                                                     : "A pipe whose cells span vehicles, or with a delay alone, has no hose.";
    print_text(problem, MESSAGE_SIZE, "%s[%lld] must be possible at its place; got %g. %s",
               ARRAYS_ABOUT[FIRST_INPUT + input].name, element + 1, values_of(self, FIRST_INPUT + input)[element], why);
}

/* Message on initial gauge pressures outside the limits of a pipe with air, or with a vacuum; NULL: they are within. */
static const char *wrong_start(const arrays_object *self) {
    const double *given = values_of(self, FIRST_PARAMETER), pipe = given[2], cylinder = given[3];
    if (train_charged(self->own) > AMBIENT)
        return pipe < 0.0 ? "start_pipe_pressure must be at least 0 Pa, as the brakes hold air" : NULL;
    if (pipe > 0.0) return "start_pipe_pressure must be from -95000 to 0 Pa, as the brakes hold a vacuum";
    return cylinder != 0.0 ? "start_cylinder_pressure must be 0 Pa, as the brakes hold a vacuum" : NULL;
}

kernel_status arrays_go(arrays_object *self, double time, double step, bool *ended, char problem[MESSAGE_SIZE]) {
    (void)ended; /* it never ends */
    const char *pressure = wrong_start(self);
    if (pressure) {
        print_text(problem, MESSAGE_SIZE, "%s. Set it before the run.", pressure);
        return KERNEL_ERROR;
    }
    if (details_refused(self->details, problem)) return KERNEL_ERROR;
    put_inputs(self);
    long long int element;
    const int wrong = train_input_wrong(self->own, &element);
    if (wrong >= 0) {
        say_wrong(self, wrong, element, problem);
        return KERNEL_DISCARD;
    }
    const double before = train_output(self->own, OUT_SUMS, &element)[SUM_TIME];
    const double most = train_longest(self->own, &element);
    if (step > most) {
        print_text(
            problem, MESSAGE_SIZE,
            "A step with external_vehicle[%lld] = %g must be at most %.3g s; got %g s. Take a shorter step, or build the "
            "train with this vehicle in detail, which takes any step.",
            element + 1, values_of(self, FIRST_INPUT + IN_EXTERNAL_VEHICLE)[element], most, step);
        return KERNEL_DISCARD;
    }
    const int status = train_go(self->own, step);
    details_hear(self->details, problem);
    if (status == -3) return KERNEL_DISCARD;
    if (status) {
        print_text(problem, MESSAGE_SIZE,
                   "The step of %g s at %g s has no finite solution. The train stays at its start. Check the inputs, or take "
                   "a shorter step.",
                   time, step);
        return KERNEL_DISCARD;
    }
    const double *states = values_of(self, FIRST_OUTPUT + OUT_PROTECTION_STATE);
    memcpy(self->states, states, length_of(self->own, LOCKED) * sizeof(double));
    find_outputs(self);
    char said[4][MESSAGE_SIZE] = {"", "", "", ""};
    say_first(self, train_broken_at(self->own), before, "rear coupler", "broke", said[0]);
    say_first(self, train_locked_at(self->own), before, "wheels", "locked", said[1]);
    say_first(self, train_parted_at(self->own), before, "rear hose", "parted", said[2]);
    say_failed(self, self->states, time + step, said[3]);
    for (int n = 0; n < 4; ++n) {
        const size_t length = strlen(problem);
        if (*said[n]) print_text(problem + length, MESSAGE_SIZE - length, "%s%s", length ? " " : "", said[n]);
    }
    return KERNEL_OK;
}

unsigned long long arrays_mark(const arrays_object *self) { return self->mark; }

size_t arrays_numbers(const arrays_object *self) { return (size_t)train_numbers(self->own) + self->place[ARRAYS]; }

void arrays_save(const arrays_object *self, double *numbers) {
    put_inputs(self); /* values for the next step */
    memcpy(numbers, self->values, self->place[ARRAYS] * sizeof(double));
    train_save(self->own, numbers + self->place[ARRAYS]);
}

void arrays_load(arrays_object *self, const double *numbers) {
    memcpy(self->values, numbers, self->place[ARRAYS] * sizeof(double));
    train_load(self->own, numbers + self->place[ARRAYS]);
}
