/* Vehicles of a train along the track, and the couplers between them; what happens at a vehicle and in a coupler is generated
 * (vehicle.py, coupler.py).
 *
 * Half a step of way, a step of speed, half a step of way (Störmer and Verlet), in steps that are as long as the stiffest
 * locked coupler allows. Places are ways from where the couplers are neither long nor short. */
#ifndef MOTION_H
#define MOTION_H

#include "train_layout.h"

/* A state: so many numbers, rows of so many vehicles: place [m], speed, speed of the wheels at the rim [m/s], and where the
 * locked force of the coupler behind is zero [m]. */
enum { MOTION_STATES = 4 };

typedef struct motion motion;

/* given: MOTION_ROWS rows of so many vehicles, coupler: COUPLER_ROWS rows of one less; copied. null: there is no memory. */
motion *motion_create(long long int vehicles, const double *given, const double *coupler);
void motion_free(motion *self);
void motion_put(motion *self, const double *state);
void motion_get(const motion *self, double *state);
/* What acts on a vehicle from now on, a row of all vehicles, ACTING_SLOPE, ...: for others to write. */
double *motion_acting(motion *self, int row);
const double *motion_place(const motion *self);
const double *motion_speed(const motion *self);
const double *motion_wheel(const motion *self);
/* Tension in each coupler [N]; at -1 and behind the last vehicle what pulls at the ends of the train, for others to write. */
double *motion_force(motion *self);
/* The same of where vehicles are now, half a step behind that [N]. */
void motion_force_now(motion *self, double *force);
/* What the rail gives to each vehicle [N], forwards above zero. */
const double *motion_rail(const motion *self);
/* A coupler, counted from the head, is coupled as soon as it is not long, or uncoupled at once. */
void motion_couple(motion *self, long long int coupler, int coupled);
int motion_is_coupled(const motion *self, long long int coupler);
/* A vehicle whose speed is given from outside [m/s], with that of its wheels; not finite: no longer. */
void motion_lead(motion *self, long long int vehicle, double speed);
/* A vehicle goes on with another speed than it came to in a step of this length, and lies where that speed, which came about
 * evenly, has brought it. */
void motion_correct(motion *self, long long int vehicle, double speed, double step);
/* Mean tension in each coupler since it was last asked to begin anew [N]. */
void motion_mean(const motion *self, double *force);
void motion_begin_mean(motion *self);
/* Largest tension and largest compression so far [N], each with the coupling where it was, from 1 on; and to forget them. */
void motion_extremes(const motion *self, double found[4]);
void motion_forget(motion *self);
/* All that a run changes but what acts: how many numbers, and from and to a place for them. */
long long int motion_numbers(const motion *self);
void motion_save(const motion *self, double *numbers);
void motion_load(motion *self, const double *numbers);
/* Goes on by so many steps. */
void motion_go(motion *self, long long int steps, double step);
/* Whether all numbers of the state are finite. */
int motion_sound(const motion *self);

#endif
