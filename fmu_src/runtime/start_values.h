/* Start values of an FMU's own among its resources, rows NAME,VALUE of START_VALUES, by the rules of all tables. */
#ifndef START_VALUES_H
#define START_VALUES_H

#include <stdbool.h>
#include <stdio.h>

#include "object.h"

#define START_VALUES "start_values.csv"

typedef enum { START_TAKEN, START_UNKNOWN, START_REFUSED } start_taken;
/* Set a variable to a number; START_REFUSED: with a message of the object. */
typedef start_taken start_take(fmu_object *self, const char *name, double number);

/* Set the variables of all rows, and close the file. Return false if one is refused; `problem` is then the message, or empty if
 * the object has one. */
RUNTIME_LOCAL bool start_values_read(FILE *file, const char *model, fmu_object *self, start_take *take,
                                     char problem[MESSAGE_SIZE]);

#endif
