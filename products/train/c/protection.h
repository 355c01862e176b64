/* Wheel-slide protection of a train's vehicles: each has an encoder on its wheels, a controller that steps on its own clock, and
 * magnet valves at its cylinders. One wheelset is one wheel speed in and one valve out. A vehicle in detail has all its wheelsets,
 * each with a cylinder; another one has one for all. Does nothing in a train without it. */
#ifndef PROTECTION_H
#define PROTECTION_H

#include "guarded.h"
#include "train.h"

typedef struct protections protections;

/* Allocates what vehicles with a controller need; returns 0 if out of memory, or for a controller that asks for too much. */
int protection_create(train *self, const double *given);
void protection_free(protections *self);
/* Number of wheel speeds of a vehicle's controller; 0: it has no controller. */
int protection_wheelsets(const train *self, long long int vehicle);
/* Starts sensors and controllers of a run. */
void protection_begin(train *self);
/* Commands of all vehicles, PROTECTION_APPLY, ...: those of the controllers, and inputs elsewhere. */
const double *protection_commands(const train *self);
/* Lets controllers step that are due at a time [s]. Returns the time to the next step of any [s]. */
double protection_sample(train *self, double time);
/* Opens and closes magnet valves in a step, before the pipe advances; and turns the sensors, after the motion. */
void protection_open(train *self, double step);
void protection_turn(train *self, double step);
/* Shares of a vehicle's valves in that step: closed to the supply, and open to the surroundings. */
void protection_shares(const train *self, long long int vehicle, double *held, double *vented);
/* Brake forces of vehicles whose wheelsets have cylinders of their own: the sum of their air and parking brakes; and, when all
 * brakes are known, the share of each wheelset (detail.h). */
void protection_brake(train *self);
void protection_share(train *self);
void protection_outputs(train *self);
/* Complete state of sensors, controllers and valves: its size in numbers, and copies from and to memory. */
long long int protection_numbers(const train *self);
void protection_save(const train *self, double *numbers);
void protection_load(train *self, const double *numbers);

#endif
