/* The test rig between steps of many braked vehicles: sensors are sampled, controllers called, valves set, stops scored.
 *
 * It contains no equations: one row of numbers holds the outputs of a vehicle, another its inputs. */
#ifndef RIG_H
#define RIG_H

#include <stdbool.h>
#include <stddef.h>

#include "encoder.h"
#include "guarded.h"

#if defined(_WIN32)
#define RIG_SHOWN __declspec(dllexport)
#else
#define RIG_SHOWN __attribute__((visibility("default")))
#endif

/* Settings that all vehicles share. Speeds in m/s, times in s, the pressure in Pa. */
typedef struct {
    int wheelsets;
    double radius;            /* of the wheels [m] */
    double period;            /* of the controllers */
    double brake_start;       /* time of the demand of the brake, or of traction */
    double demand;            /* pressure of the full brake [Pa], or share of the largest traction [1] */
    double longest;           /* a run ends at this time */
    double lock_above;        /* speed above which a lock is scored */
    double jerk_time;         /* time constant of both lags on the acceleration, from whose output the jerk is taken */
    double band, check_above;  /* slip up to which a wheel is scored as protected, and speed above which this is checked */
    int reservoir, driven;    /* 1 if a vehicle outputs its reservoir, else 0; 1 if motors drive it, 0 if it has brakes */
    encoder_settings encoder;
} rig_settings;

/* Output of a sensor from a given time on: the true speed; its last reading; 0; twice the true speed. */
enum { SENSOR_WORKS = 0, SENSOR_STUCK = 1, SENSOR_ZERO = 2, SENSOR_DOUBLED = 3 };

/* Faults of one wheelset. `radius`: assumed radius of its wheels over the true one. sensor_from, valve_from: times at which
 * the sensor begins to fail, and the valve sticks in its position [s]. phase: initial rotation of its wheel [teeth]. */
typedef struct {
    double radius, sensor_from, valve_from, phase;
    int sensor, valve_sticks;
} rig_wheelset;

/* State of a run: it continues; it reached its last speed; it took too long; its vehicle failed, or derailed. */
enum { RIG_RUNS = 0, RIG_DONE = 1, RIG_TOO_LONG = 2, RIG_LOST = 3 };

/* Replaces the number of a valve if the controller wrote beyond its memory or beyond its valves. */
enum { RIG_BEYOND = -1 };

/* Results of a run, all numbers at its end. */
typedef struct {
    double distance, speed, time;
    double longest_lock, longest_skid; /* of a locked wheelset: time [s], and travel at any speed [m]; of a driven wheelset:
                                        * time of rotation at more than twice the speed, and 0 */
    double band, checked;      /* samples above the speed, and those of them with all slips in the band */
    double filled;            /* rises of all cylinders' pressures [Pa], or of all motors' torques [N.m] */
    double jerk;              /* largest of the filtered acceleration of the vehicle above check_above [m/s3] */
    double taken, reservoir;  /* air from the reservoir [kg], and the lowest pressure in it [Pa]; without one 0 */
    double sliding[RIG_MOST]; /* energy of sliding between wheels and rails, by wheelset [J] */
    double commands;          /* samples with a command other than to apply, summed over the valves */
    double longest_vent;      /* longest time for which a valve stays at vent [s] */
    double failed_at;         /* time at which its controller failed; NaN: it did not */
    int state, answer, valve; /* answer: command of the failed controller for this valve, from 0 */
} rig_score;

/* Recording of runs: every n-th sample and the last one, while there is room. A sample holds time, speed and distance. Then
 * follow the values of all wheelsets, by kind: angular velocity, sensor reading, cylinder pressure, previous valve
 * position, creep force and load. */
typedef struct {
    long long int every, room; /* recording interval in samples; largest number of recorded samples in a row */
    double *sample;             /* rows x room x (3 + 6 wheelsets) */
    long long int *count;      /* rows: number of recorded samples */
} rig_notes;
/* Interface of the vehicles to a controller outside, such as one in Python: arrays that outlive the rig. */
typedef struct {
    double *time;        /* rows: of the last sample, since the start of the run [s] */
    double *wheel_speed; /* rows x wheelsets: sensor readings at that time [m/s] */
    int *valve;          /* rows x wheelsets: its commands, which are read before the next step */
} rig_desk;

typedef struct rig rig;

/* Outputs of a vehicle, in this order: speed, distance. Then by kind for all wheelsets: rotation [rad], angular velocity
 * [rad/s], cylinder pressure [Pa] (if driven, motor torque [N.m]), creep force [N] and load [N]. Then, if it has a
 * reservoir, air taken [kg] and pressure [Pa]. Inputs of a vehicle: demands of all wheelsets, then their valves. */

/* controller: if its `step` is NULL, Python answers. Returns NULL if out of memory, or if a vehicle has more than RIG_MOST
 * wheelsets. */
RIG_SHOWN rig *rig_create(long long int rows, const rig_settings *settings, const rig_controller *controller,
                          const rig_desk *desk);
RIG_SHOWN void rig_free(rig *self);
/* Starts a run in a row. end_speed: its last one, to which it slows or, driven, accelerates. error: of the edges of each
 * wheelset's sensor, pulses each, or NULL. Both arrays are copied. */
RIG_SHOWN void rig_begin(rig *self, long long int row, double end_speed, const double *error, const rig_wheelset *wheelset);
RIG_SHOWN const rig_score *rig_scores(const rig *self);
/* Records runs that begin after this call; `notes` outlives the rig. */
RIG_SHOWN void rig_write_down(rig *self, const rig_notes *notes);
/* Samples the sensors of a new run for the first time, for the desk. status: of its vehicle, a kernel_status. */
RIG_SHOWN void rig_sample(rig *self, long long int row, int status, const double *outputs);
/* Keeps the brakes of a row applied, because its controller failed. */
RIG_SHOWN void rig_give_up(rig *self, long long int row);
/* Does a complete exchange with the controller in C; returns true if a run continues: `batch_between` of the kernel's
 * batch.h. */
RIG_SHOWN bool rig_between(void *self, long long int first, long long int count, const int *status, const double *outputs,
                           double *inputs);
/* Does half of it for a controller at the desk; returns true if a step follows. It sets the commanded valves or, if these
 * are set, samples the sensors for the next command. An invalid command applies the brake of its row permanently. A
 * `batch_control` of two steps thus makes one step, and ends with the sensor readings after it. */
RIG_SHOWN bool rig_take_or_sample(void *self, long long int first, long long int count, const int *status,
                                  const double *outputs, double *inputs);

#endif
