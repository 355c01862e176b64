/* Vehicles in detail of the train's FMU (detail.h). A train without them has no_details_fmu.c. */
#ifndef DETAILS_FMU_H
#define DETAILS_FMU_H

#include "print_text.h"
#include "status.h"
#include "train.h"

typedef struct fmu_details fmu_details;
/* Makes the kernels of the file details.bin in a folder, which move vehicles of the train from then on. Returns NULL, with one
 * message in `problem`, if that fails; without a message if the train has no vehicles in detail. */
fmu_details *details_create(const char *folder, train *own, char problem[MESSAGE_SIZE]);
void details_free(fmu_details *self);
/* Begins a run after that of the train, at its time [s], speed [m/s] and distance [m]. */
void details_start(fmu_details *self, train *own, double time, double speed, double distance);
/* Returns whether the run could not begin, with the reason in `problem`. */
int details_refused(const fmu_details *self, char problem[MESSAGE_SIZE]);
/* Copies the outputs of all kernels, in the order of their arrays. */
void details_outputs(const fmu_details *self, double *values);
/* Returns a hash of the file; 0 without one. */
unsigned long long details_mark(const fmu_details *self);
/* Adds the messages of a step to `problem`. */
void details_hear(fmu_details *self, char problem[MESSAGE_SIZE]);

#endif
