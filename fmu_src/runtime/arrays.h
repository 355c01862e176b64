/* An object whose variables are arrays, the lengths of which it knows only when it is made: one binary serves objects of all
 * lengths. arrays_object.c puts it behind the faces. Problems are one sentence. */
#ifndef ARRAYS_H
#define ARRAYS_H

#include "status.h"
#include "variable.h"

/* ---- what is generated from Python (arrays_fmu.py) ---- */

extern const variable_description ARRAYS_ABOUT[];
extern const unsigned ARRAYS;
/* The value reference of an element in FMI 2.0 is array * ARRAYS_STRIDE + element. */
extern const unsigned ARRAYS_STRIDE;
/* What modelDescription.xml must say, too, and the name there. */
extern const char ARRAYS_TOKEN[], ARRAYS_NAME[];

/* ---- what an object gives ---- */

typedef struct arrays_object arrays_object;
/* From the files in a folder, which ends with no separator; null: the host named none. Null: and why. */
arrays_object *arrays_create(const char *folder, char problem[MESSAGE_SIZE]);
void arrays_free(arrays_object *self);
/* Where the numbers of an array are, and how many. */
double *arrays_values(const arrays_object *self, unsigned array, size_t *count);
/* Parameters and inputs as they are by default. */
void arrays_reset(arrays_object *self);
/* Begins a run with its parameters; starts again where inputs have changed. */
void arrays_start(arrays_object *self, double time);
/* Goes on by a time. Behind a warning it has, and says what of; behind a discard it is as it was, or has ended for good. */
kernel_status arrays_go(arrays_object *self, double time, double step, bool *ended, char problem[MESSAGE_SIZE]);
/* What tells objects apart that were made of other files. */
unsigned long long arrays_mark(const arrays_object *self);
/* All that a run changes, inputs and outputs too: how many numbers, and from and to a place for them. */
size_t arrays_numbers(const arrays_object *self);
void arrays_save(const arrays_object *self, double *numbers);
void arrays_load(arrays_object *self, const double *numbers);

/* ---- what is there for objects (arrays_object.c) ---- */

/* The numbers in a file of a folder; null: it cannot be read, is empty or no file of numbers, and why. */
double *arrays_read(const char *folder, const char *name, size_t *count, char problem[MESSAGE_SIZE]);
/* What tells numbers apart. */
unsigned long long arrays_mark_of(const double *numbers, size_t count);

#endif
