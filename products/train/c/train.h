/* A train: brake pipe and distributors (pipe.h), brakes of vehicles (vehicle_brake.py), motion and couplers (motion.h), driver's
 * valves and a line. Pressures are absolute. */
#ifndef TRAIN_H
#define TRAIN_H

#if defined(_WIN32)
#define TRAIN_SHOWN __declspec(dllexport)
#else
#define TRAIN_SHOWN __attribute__((visibility("default")))
#endif

#include <stddef.h>

/* A train is given as numbers, groups of rows; products/train/layout.py defines them, its inputs and its outputs. */
#include "train_layout.h"

typedef struct train train;

/* Returns a message on the first invalid number of a train, or NULL (check.c). */
TRAIN_SHOWN const char *train_wrong(const double *numbers, long long int count);
/* Returns NULL if out of memory, or if the numbers are not those of a train. */
TRAIN_SHOWN train *train_create(const double *numbers, long long int count);
TRAIN_SHOWN void train_free(train *self);
/* Sets the initial state: speed [m/s], distance of the head [m], pressures of the pipe and of the cylinders [Pa]. Control
 * chambers and auxiliary reservoirs are charged to the running pressure, or to the pipe's if that is higher; chambers of vacuum
 * brakes, which are released then, if that is lower. */
TRAIN_SHOWN void train_begin(train *self, double time, double speed, double distance, double pipe, double cylinder);
/* State of a wheel-slide protection whose controller failed, beside its commands. */
enum { PROTECTION_FAILED = PROTECTION_RELEASE + 1 };
/* Sets the controller of a vehicle that has one, before a run begins: functions of wheel_slide.h, and the size of its memory.
 * Returns 0 if the vehicle has none, or out of memory. */
TRAIN_SHOWN int train_control(train *self, long long int vehicle, void (*start)(void *, int, double),
                              void (*step)(void *, double, const double *, int *), size_t size);
/* The first vehicle whose controller is not set, and not in this binary; -1: all are here. */
TRAIN_SHOWN long long int train_lacks_controller(const train *self);
TRAIN_SHOWN double *train_input(train *self, int row, long long int *count);
TRAIN_SHOWN const double *train_output(const train *self, int row, long long int *count);
/* Advances by a time [s]. Returns 0; -1 if the result is not finite, -2 if an input is invalid, -3 if a
 * vehicle in detail refused the step (detail.h); the train is unchanged then. */
TRAIN_SHOWN int train_go(train *self, double time);
/* Longest step of a host that couples vehicles by the input external_vehicle [s], and the vehicle that limits it. */
TRAIN_SHOWN double train_longest(const train *self, long long int *vehicle);
/* Row and element of an input beyond its limits, or not possible without a face of the pipe after a vehicle; -1: all are
 * valid. */
TRAIN_SHOWN int train_input_wrong(const train *self, long long int *element);
/* Times of each vehicle at which its wheels first locked, and the coupler behind it first broke [s]; TRAIN_NEVER: not yet. */
#define TRAIN_NEVER 1e300
TRAIN_SHOWN const double *train_locked_at(const train *self);
TRAIN_SHOWN const double *train_broken_at(const train *self);
/* Time at which the joined hose behind each vehicle was first torn by a gap [s]; TRAIN_NEVER: not yet. */
TRAIN_SHOWN const double *train_parted_at(const train *self);
/* Complete state of a run with its inputs: its size, and copies from and to memory. */
TRAIN_SHOWN long long int train_numbers(const train *self);
TRAIN_SHOWN void train_save(const train *self, double *numbers);
TRAIN_SHOWN void train_load(train *self, const double *numbers);
/* Number of steps of the pipe and of the couplers so far. */
TRAIN_SHOWN void train_steps(const train *self, long long int *steps);
/* Pressure of the charged pipe [Pa]: below the surroundings if it holds a vacuum. */
TRAIN_SHOWN double train_charged(const train *self);
/* The pipe, for its balances (pipe.h). */
TRAIN_SHOWN struct pipe *train_air(train *self);
/* State of the motion: rows of position, speed, wheel speed, coupler rest position (motion.h), to read and to set. */
TRAIN_SHOWN void train_motion(const train *self, double *state);
TRAIN_SHOWN void train_set_motion(train *self, const double *state);

#endif
