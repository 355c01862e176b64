/* A train: brake pipe and distributors (pipe.h), brakes of vehicles (vehicle_brake.py), motion and couplers (motion.h), driver's
 * valves and a line. Pressures are absolute. */
#ifndef TRAIN_H
#define TRAIN_H

#if defined(_WIN32)
#define TRAIN_SHOWN __declspec(dllexport)
#else
#define TRAIN_SHOWN __attribute__((visibility("default")))
#endif

/* A train is given as numbers, groups of rows; what they are, and inputs and outputs, is said in products/train/layout.py. */
#include "train_layout.h"

typedef struct train train;

/* What of these numbers is not that of a train, or null (check.c). */
TRAIN_SHOWN const char *train_wrong(const double *numbers, long long int count);
/* null: there is no memory, or the numbers are not those of a train. */
TRAIN_SHOWN train *train_create(const double *numbers, long long int count);
TRAIN_SHOWN void train_free(train *self);
/* From the start: speed [m/s], distance of the head [m], pressures of the pipe and of the cylinders [Pa]; control chambers and
 * auxiliary reservoirs are charged to the running pressure, or to the pipe's where that is more. */
TRAIN_SHOWN void train_begin(train *self, double time, double speed, double distance, double pipe, double cylinder);
TRAIN_SHOWN double *train_input(train *self, int row, long long int *count);
TRAIN_SHOWN const double *train_output(const train *self, int row, long long int *count);
/* Goes on by a time [s]; 0, or -1: that leads nowhere, -2: an input is wrong, and the train is as it was. */
TRAIN_SHOWN int train_go(train *self, double time);
/* Row of an input that is beyond its limits, or that cannot be where the pipe has
 * no face behind a vehicle, and the element; -1: there is none. */
TRAIN_SHOWN int train_input_wrong(const train *self, long long int *element);
/* All that a run changes, inputs too: how many numbers, and from and to a place for them. */
TRAIN_SHOWN long long int train_numbers(const train *self);
TRAIN_SHOWN void train_save(const train *self, double *numbers);
TRAIN_SHOWN void train_load(train *self, const double *numbers);
/* Steps of pipe and of couplers so far. */
TRAIN_SHOWN void train_steps(const train *self, long long int *steps);
/* The pipe, for its balances (pipe.h). */
TRAIN_SHOWN struct pipe *train_air(train *self);
/* State of the motion: rows of place, speed, speed of wheels, rest of couplers (motion.h), to read and to set. */
TRAIN_SHOWN void train_motion(const train *self, double *state);
TRAIN_SHOWN void train_set_motion(train *self, const double *state);

#endif
