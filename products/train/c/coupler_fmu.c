/* One coupler as an object of arrays (arrays.h): from the displacement of its coupling to its tension; curves from
 * resources/coupler.bin. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "arrays.h"
#include "coupler_arrays.h"
#include "train_layout.h"
#define LANES 1
#include "lanes.h"
#include "coupler_cells.h"

/* Between the displacements of two steps the coupler moves at constant speed, in this many parts. */
enum { PARTS = 64 };

struct arrays_object {
    double values[ARRAYS_MOST]; /* WAY, COUPLING_CLOSED, FORCE, MEAN_FORCE, WORK */
    double constants[COUPLER_ROWS], rest, way, force;
    unsigned long long mark; /* of its curves as they were read */
};

/* Returns its curves if their number is right and each is within the limits of its field, as in a train; otherwise NULL, and a
 * message with the reason. */
static double *read_curves(const char *folder, char *problem) {
    size_t count = 0;
    double *found = arrays_read(folder, "coupler.bin", &count, problem);
    if (!found) return NULL;
    int good = count == COUPLER_ROWS && found[0] > 0.0;
    for (size_t n = 0; good && n < COUPLER_ROWS; ++n)
        good = found[n] >= COUPLER_LIMITS[n].least && found[n] <= COUPLER_LIMITS[n].most; /* false for NaN */
    if (good) return found;
    snprintf(problem, MESSAGE_SIZE, "The coupler's curves in %.200s/coupler.bin are damaged; build the FMU again.", folder);
    free(found);
    return NULL;
}

arrays_object *arrays_create(const char *folder, char problem[MESSAGE_SIZE]) {
    double *curves = read_curves(folder, problem);
    if (!curves) return NULL;
    arrays_object *self = (arrays_object *)calloc(1, sizeof *self);
    if (self) {
        memcpy(self->constants, curves, sizeof self->constants);
        self->mark = arrays_mark_of(curves, COUPLER_ROWS);
    } else snprintf(problem, MESSAGE_SIZE, "There is no memory for the coupler.");
    free(curves);
    return self;
}

void arrays_free(arrays_object *self) { free(self); }

double *arrays_values(const arrays_object *self, unsigned array, size_t *count) {
    *count = 1;
    return (double *)&self->values[array];
}

void arrays_reset(arrays_object *self) {
    memset(self->values, 0, sizeof self->values);
    self->values[COUPLING_CLOSED] = 1.0;
    self->rest = self->way = self->force = 0.0;
}

/* Tension at a displacement; moves the point at which the force of the sticking stiffness is zero. */
static double pull(arrays_object *self, double way) {
    const double behind = 0.0;
    double found[2];
    LANES_NAME(cells_coupling)(&way, &behind, &self->rest, self->constants, found, 1);
    self->rest = found[1];
    return found[0];
}

static void find(arrays_object *self) {
    self->way = self->values[WAY];
    self->values[FORCE] = self->values[MEAN_FORCE] = self->force = pull(self, self->way);
}

void arrays_start(arrays_object *self, double time) {
    (void)time;
    self->constants[COUPLER_COUPLING_CLOSED] = self->values[COUPLING_CLOSED];
    self->rest = 0.0;
    self->values[WORK] = 0.0;
    find(self);
}

kernel_status arrays_go(arrays_object *self, double time, double step, bool *ended, char problem[MESSAGE_SIZE]) {
    (void)time, (void)step, (void)ended, (void)problem;
    const double begin = self->way, gone = self->values[WAY] - begin;
    double sum = 0.0, before = self->force;
    /* A coupled joint acts from the time when the vehicles touch. */
    if (self->values[COUPLING_CLOSED] == 0.0 || begin <= 0.0 || self->values[WAY] <= 0.0)
        self->constants[COUPLER_COUPLING_CLOSED] = self->values[COUPLING_CLOSED];
    for (int n = 1; n <= PARTS; ++n) {
        const double force = pull(self, begin + gone * n / PARTS);
        sum += (before + force) / 2.0 / PARTS;
        before = force;
    }
    self->way = self->values[WAY];
    self->force = self->values[FORCE] = before;
    self->values[MEAN_FORCE] = sum;
    self->values[WORK] += sum * gone;
    return KERNEL_OK;
}

/* Its mark is equal wherever a state may be restored. */
size_t arrays_numbers(const arrays_object *self) { return sizeof *self / sizeof(double); }
void arrays_save(const arrays_object *self, double *numbers) { memcpy(numbers, self, sizeof *self); }
void arrays_load(arrays_object *self, const double *numbers) { memcpy(self, numbers, sizeof *self); }
unsigned long long arrays_mark(const arrays_object *self) { return self->mark; }
