/* Vehicles of a train that a kernel (kernel.h) computes in detail. The train calls the kernel through a table of functions, so
 * that it does not depend on a vehicle's generated equations. */
#ifndef DETAIL_H
#define DETAIL_H

#include <stdbool.h>
#include <stddef.h>

#include "status.h"
#include "train.h"

struct kernel;

/* Functions of a kernel; those of its saved state are sealed. */
typedef struct {
    kernel_status (*set)(struct kernel *self, int variable, double value);
    kernel_status (*get)(struct kernel *self, int variable, double *value);
    kernel_status (*step)(struct kernel *self, double time, double size);
    double (*time)(const struct kernel *self);
    size_t (*state_size)(const struct kernel *self);
    void (*save)(const struct kernel *self, void *bytes);
    kernel_status (*restore)(struct kernel *self, const void *bytes, size_t size);
} detail_functions;

enum { DETAIL_WHEELSETS = 16 };

/* Numbers of a kernel's variables; -1: it has no such variable. Inputs of each wheelset and of the couplers, states of the body
 * that carries the couplers, outputs. */
typedef struct {
    int wheelsets, front, rear, place, speed, pitch, pitch_rate, axle_speed;
    int brake[DETAIL_WHEELSETS], traction[DETAIL_WHEELSETS], friction[DETAIL_WHEELSETS];
    int turning[DETAIL_WHEELSETS], creep[DETAIL_WHEELSETS];
    double radius, height; /* of a wheel; of the couplers above the centre of that body [m] */
} detail_variables;

/* Lets a kernel move a vehicle of a train; 0 if out of memory, or if the vehicle does not exist, has a kernel, or a
 * protection for another number of wheelsets. The kernel is the caller's, and must live as long as the train. */
TRAIN_SHOWN int train_detail(train *self, long long int vehicle, struct kernel *machine, const detail_functions *call,
                             const detail_variables *variable);
/* Begins with initialised kernels, after train_begin. */
TRAIN_SHOWN void train_detail_begin(train *self);
/* Longest step of a train with vehicles in detail [s], on its own clock; to be set before the first step. */
TRAIN_SHOWN void train_detail_step(train *self, double step);
/* The vehicle whose kernel refused the last step; -1: none. The message is in its log. */
TRAIN_SHOWN long long int train_detail_failed(const train *self);
/* Share of the brake torque of each wheelset of a vehicle in detail, 1 until it is set, and angular velocities of its wheelsets
 * [rad/s]; NULL for another vehicle. For controllers of wheel slide. */
TRAIN_SHOWN double *train_detail_brake(train *self, long long int vehicle);
TRAIN_SHOWN const double *train_detail_turning(const train *self, long long int vehicle);

#endif
