/* Vehicles of a train along the track, and the couplers between them. The equations of a vehicle and of a coupler are generated
 * (vehicle.py, coupler.py). A step is half a displacement, a full change of speed, half a displacement (Störmer and Verlet), as
 * long as the stiffest sticking coupler allows. Positions are relative to those with neutral couplers. */
#ifndef MOTION_H
#define MOTION_H

#include "train_layout.h"

/* A state: rows of all vehicles: position [m], speed, speed of the wheels at the rim [m/s], and the position of zero sticking
 * force of the coupler after each [m]. */
enum { MOTION_STATES = 4 };

typedef struct motion motion;

/* given: MOTION_ROWS rows of all vehicles, coupler: COUPLER_ROWS rows of one less; copied. Returns NULL if out of memory. */
motion *motion_create(long long int vehicles, const double *given, const double *coupler);
void motion_free(motion *self);
void motion_put(motion *self, const double *state);
void motion_get(const motion *self, double *state);
/* Loads on the vehicles from now on, a row of all vehicles, ACTING_SLOPE, ...: for others to write. */
double *motion_acting(motion *self, int row);
const double *motion_place(const motion *self);
const double *motion_speed(const motion *self);
const double *motion_wheel(const motion *self);
/* Tension in each coupler [N]; at -1 and after the last vehicle the forces at the ends of the train, for others to write. */
double *motion_force(motion *self);
/* The same at the present positions, half a step later [N]. */
void motion_force_now(motion *self, double *force);
/* Rail force on each vehicle [N], positive forwards. */
const double *motion_rail(const motion *self);
/* Couples a coupler, numbered from the head, as soon as it is not stretched, or uncouples it at once. */
void motion_couple(motion *self, long long int coupler, int coupled);
int motion_is_coupled(const motion *self, long long int coupler);
/* Prescribes a vehicle's speed and that of its wheels [m/s]; a speed that is not finite ends this. */
void motion_lead(motion *self, long long int vehicle, double speed);
/* Continues with another speed of a vehicle than that after a step of this length; its position is corrected for a uniform
 * change of speed. */
void motion_correct(motion *self, long long int vehicle, double speed, double step);
/* Tension above which each coupler breaks [N]; a broken one is apart until it is coupled again. */
/* Returns 0 if out of memory. */
int motion_strength(motion *self, const double *strength);
int motion_is_broken(const motion *self, long long int coupler);
/* Number of couplers that have broken since the last call. */
int motion_broken(motion *self);
/* Angular frequency of a vehicle between its neighbours, at the sticking stiffness of both couplers [1/s] (Hooke). */
double motion_frequency(const motion *self, long long int vehicle);
/* Mean tension in each coupler since the last restart of the mean [N]. */
void motion_mean(const motion *self, double *force);
void motion_begin_mean(motion *self);
/* Largest tension and largest compression so far [N], each with the number of its coupling, from 1; and their reset. */
void motion_extremes(const motion *self, double found[4]);
void motion_forget(motion *self);
/* Complete state of a run except the loads: its size, and copies from and to memory. */
long long int motion_numbers(const motion *self);
void motion_save(const motion *self, double *numbers);
void motion_load(motion *self, const double *numbers);
/* Lets others move vehicles: `follow` is called after each step, before its last half of displacements, and calls motion_move. */
void motion_follow(motion *self, void (*follow)(void *owner, double step), void *owner);
/* Sets position [m], speed and speed of the wheels [m/s] of a vehicle. */
void motion_move(motion *self, long long int vehicle, double place, double speed, double wheel);
/* Advances by this number of steps. */
void motion_go(motion *self, long long int steps, double step);
/* True if all numbers of the state are finite. */
int motion_sound(const motion *self);

#endif
