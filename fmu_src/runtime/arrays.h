/* An object whose variables are arrays. Their lengths are set when the object is made, so one binary works for objects of all
 * lengths. arrays_object.c connects it to the FMI interfaces. A problem is returned as one message. */
#ifndef ARRAYS_H
#define ARRAYS_H

#include "print_text.h"
#include "status.h"
#include "variable.h"

/* ---- what is generated from Python (arrays_fmu.py) ---- */

extern const variable_description ARRAYS_ABOUT[];
extern const double ARRAYS_LEAST_PRESSURE; /* Pa: of a parameter above 0, of readers/usual.py */
extern const unsigned ARRAYS;
/* The value reference of an element in FMI 2.0 is array * ARRAYS_STRIDE + element. */
extern const unsigned ARRAYS_STRIDE;
/* Token and name of the model. modelDescription.xml must have the same. */
extern const char ARRAYS_TOKEN[], ARRAYS_NAME[];

/* ---- functions of the object ---- */

typedef struct arrays_object arrays_object;
/* Make the object from the files in a folder. The path ends without a separator; NULL if the host gave no folder. Returns
 * NULL, with the reason in `problem`, if that fails. */
arrays_object *arrays_create(const char *folder, char problem[MESSAGE_SIZE]);
void arrays_free(arrays_object *self);
/* Return the values of an array and their number. */
double *arrays_values(const arrays_object *self, unsigned array, size_t *count);
/* Set parameters and inputs to their defaults. */
void arrays_reset(arrays_object *self);
/* Begin a run with its parameters; begin it again if inputs have changed. */
void arrays_start(arrays_object *self, double time);
/* Advance by one step. After a warning the object has advanced and `problem` states the cause. After a discard it is
 * unchanged, or has ended for good. With OK, `problem` may state an event. */
kernel_status arrays_go(arrays_object *self, double time, double step, bool *ended, char problem[MESSAGE_SIZE]);
/* Return a hash that differs between objects made from different files. */
unsigned long long arrays_mark(const arrays_object *self);
/* Everything that a run changes, inputs and outputs included: the count of numbers, and copies to and from an array. */
size_t arrays_numbers(const arrays_object *self);
void arrays_save(const arrays_object *self, double *numbers);
void arrays_load(arrays_object *self, const double *numbers);

/* ---- functions for objects (arrays_object.c) ---- */

/* Return the numbers in a file of a folder. NULL, with the reason in `problem`, if it cannot be read, is empty or contains
 * other data. */
double *arrays_read(const char *folder, const char *name, size_t *count, char problem[MESSAGE_SIZE]);
/* Return whether a step that begins at a time is the first at or after the start and a multiple of the period; `count`, 0 at the
 * start, is the number of multiples so far. A host's times are rounded: each by half of its last bit, and by its sums. */
bool arrays_is_due(double time, double start, double period, double *count);
/* Return a hash of numbers. */
unsigned long long arrays_mark_of(const double *numbers, size_t count);

#endif
