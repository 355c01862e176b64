/* An object of three functions in C, its memory, its start, its step, as an object of arrays (arrays.h) of one element each:
 * real inputs, the parameter `period`, integer outputs.
 *
 * step_model.h, written next to it, names the functions. The step function is called at the start of the first step that begins
 * at or after each multiple of the period; its outputs hold in between. An answer outside its limits, or an input that is no
 * number, makes the outputs safe. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "arrays.h"
#include "step_model.h"

enum { FIRST_OUTPUT = INPUTS + 1, VARIABLES = INPUTS + 1 + OUTPUTS };

/* Everything that a run changes; the memory of the three functions follows it, aligned for any type. */
typedef struct {
    double value[VARIABLES], start_time;
    double called; /* multiples of the period so far */
} values;
enum { OFFSET = (sizeof(values) + 63) / 64 * 64 };

struct arrays_object {
    size_t numbers; /* doubles that hold the values and the memory */
    values *now;
};

static void *memory_of(const arrays_object *self) { return (char *)self->now + OFFSET; }

arrays_object *arrays_create(const char *folder, char problem[MESSAGE_SIZE]) {
    const size_t memory = MEMORY(COUNT);
    (void)folder; /* it is made of no files */
    if (memory > LARGEST_MEMORY) {
        strcpy(problem, "The object asks for more memory than it may have.");
        return NULL;
    }
    arrays_object *self = (arrays_object *)malloc(sizeof *self);
    if (!self) return NULL;
    self->numbers = (OFFSET + memory + sizeof(double) - 1) / sizeof(double);
    self->now = (values *)malloc(self->numbers * sizeof(double));
    if (self->now) return self;
    free(self);
    return NULL;
}

void arrays_free(arrays_object *self) {
    if (!self) return;
    free(self->now);
    free(self);
}

double *arrays_values(const arrays_object *self, unsigned array, size_t *count) {
    *count = 1;
    return self->now->value + array;
}

static void make_safe(arrays_object *self) {
    for (int i = 0; i < OUTPUTS; ++i) self->now->value[FIRST_OUTPUT + i] = SAFE;
}

void arrays_reset(arrays_object *self) {
    memset(self->now, 0, self->numbers * sizeof(double));
    self->now->value[INPUTS] = PERIOD;
    make_safe(self);
}

void arrays_start(arrays_object *self, double time) {
    memset(memory_of(self), 0, self->numbers * sizeof(double) - OFFSET);
    self->now->start_time = time;
    self->now->called = 0.0;
    START(memory_of(self), COUNT, self->now->value[INPUTS]);
}

/* Call the object's step at a time; false if an output is outside its limits. */
static bool ask(arrays_object *self, double time, char problem[MESSAGE_SIZE]) {
    double *output = self->now->value + FIRST_OUTPUT;
    int answer[OUTPUTS];
    for (int i = 0; i < OUTPUTS; ++i) answer[i] = (int)output[i];
    STEP(memory_of(self), time, self->now->value, answer);
    for (int i = 0; i < OUTPUTS; ++i)
        if (answer[i] < LEAST || answer[i] > MOST) {
            print_text(problem, MESSAGE_SIZE,
                       "The controller gave %d for output %d at %g s where %d to %d was due; its outputs are %d from now on.",
                       answer[i], i + 1, time, LEAST, MOST, SAFE);
            return false;
        }
    for (int i = 0; i < OUTPUTS; ++i) output[i] = answer[i];
    return true;
}

kernel_status arrays_go(arrays_object *self, double time, double step, bool *ended, char problem[MESSAGE_SIZE]) {
    values *now = self->now;
    (void)step;
    if (!arrays_is_due(time, now->start_time, now->value[INPUTS], &now->called)) return KERNEL_OK;
    for (int i = 0; i < INPUTS; ++i)
        if (!isfinite(now->value[i])) {
            make_safe(self);
            print_text(problem, MESSAGE_SIZE, "Input %d must be a finite number; got %g at %g s. The outputs are %d.", i + 1,
                       now->value[i], time, SAFE);
            return KERNEL_WARNING;
        }
    if (ask(self, time, problem)) return KERNEL_OK;
    make_safe(self);
    *ended = true;
    return KERNEL_DISCARD;
}

unsigned long long arrays_mark(const arrays_object *self) {
    (void)self;
    return 0;
}
size_t arrays_numbers(const arrays_object *self) { return self->numbers; }
void arrays_save(const arrays_object *self, double *numbers) { memcpy(numbers, self->now, self->numbers * sizeof(double)); }
void arrays_load(arrays_object *self, const double *numbers) { memcpy(self->now, numbers, self->numbers * sizeof(double)); }
