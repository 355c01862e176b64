/* Wheel-speed sensors as an object of arrays (arrays.h) of one element each: from the rotation of each wheelset to the speed that
 * a toothed wheel shows (encoder.h).
 *
 * A sensor is read at the start of the first step that begins at or after each multiple of the period; its output holds in
 * between. */
#include <stdlib.h>
#include <string.h>

#include "arrays.h"
#include "encoder.h"
#include "sensor_arrays.h"

struct arrays_object {
    double values[ARRAYS_MOST]; /* rotations, speeds, parameters */
    double start_time, read; /* [s]; multiples of the period so far */
    encoder sensor[WHEELSETS];
};

arrays_object *arrays_create(const char *folder, char problem[MESSAGE_SIZE]) {
    (void)folder; /* it is made of no files */
    arrays_object *self = (arrays_object *)calloc(1, sizeof *self);
    if (!self) strcpy(problem, "There is no memory for the sensors.");
    return self;
}

void arrays_free(arrays_object *self) { free(self); }

double *arrays_values(const arrays_object *self, unsigned array, size_t *count) {
    *count = 1;
    return (double *)&self->values[array];
}

void arrays_reset(arrays_object *self) {
    memset(self, 0, sizeof *self);
    memcpy(self->values + WHEEL_RADIUS, STARTS, sizeof STARTS);
}

void arrays_start(arrays_object *self, double time) {
    self->start_time = time;
    self->read = 0.0;
    for (int i = 0; i < WHEELSETS; ++i) {
        encoder_begin(&self->sensor[i], NULL, 0.0);
        self->values[SPEEDS + i] = 0.0;
    }
}

kernel_status arrays_go(arrays_object *self, double time, double step, bool *ended, char problem[MESSAGE_SIZE]) {
    (void)step, (void)ended, (void)problem;
    const encoder_settings settings = {(int)self->values[PULSES], self->values[GATE], self->values[TIMER],
                                       self->values[LOWEST_FREQUENCY]};
    if (!arrays_is_due(time, self->start_time, self->values[PERIOD], &self->read)) return KERNEL_OK;
    for (int i = 0; i < WHEELSETS; ++i) {
        const double found = encoder_read(&self->sensor[i], &settings, time - self->start_time, self->values[i]);
        self->values[SPEEDS + i] = found * self->values[WHEEL_RADIUS];
    }
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
