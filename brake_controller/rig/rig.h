/* The test rig between steps of many braked machines: sensors look, controllers answer, valves are set, stops are scored.
 *
 * It knows nothing of equations: a row of numbers is what a machine shows, another what it is told. */
#ifndef RIG_H
#define RIG_H

#include <stdbool.h>
#include <stddef.h>

#include "encoder.h"

#if defined(_WIN32)
#define RIG_SHOWN __declspec(dllexport)
#else
#define RIG_SHOWN __attribute__((visibility("default")))
#endif

/* What all machines have in common. Speeds in m/s, times in s, the pressure in Pa. */
typedef struct {
    int wheelsets;
    double radius;            /* of the wheels [m] */
    double period;            /* of the controllers */
    double brake_start;       /* when the brake is demanded, or traction */
    double demand;            /* pressure of the full brake [Pa], or share of the largest traction [1] */
    double longest;           /* a run ends at this time */
    double lock_above;        /* speed above which a lock counts */
    double band, look_above;  /* slip up to which a wheel counts as protected, and above which speed it is looked at */
    int reservoir, driven;    /* whether a machine shows its reservoir; whether motors drive it in place of brakes */
    encoder_settings encoder;
} rig_settings;

/* A controller in C: wheel_slide.h; step null: Python answers. */
typedef struct {
    void (*start)(void *memory, int wheelsets, double period);
    void (*step)(void *memory, double time, const double *wheel_speed, int *valve);
    size_t size;
} rig_controller;

/* What a sensor shows from a time on: the truth; its last reading; nothing; twice the truth. */
enum { SENSOR_WORKS = 0, SENSOR_STUCK = 1, SENSOR_ZERO = 2, SENSOR_DOUBLED = 3 };

/* What is wrong with one wheelset. radius: what its wheels' radius is taken for, over the true one; from: when the sensor
 * begins to fail, and when the valve sticks where it stands [s]; phase: share of a tooth by which its wheel is turned at the
 * first look. */
typedef struct {
    double radius, sensor_from, valve_from, phase;
    int sensor, valve_sticks;
} rig_wheelset;

/* How a run stands: it goes on; it came to its last speed; it ran too long; its machine failed, or derailed. */
enum { RIG_RUNS = 0, RIG_DONE = 1, RIG_TOO_LONG = 2, RIG_LOST = 3 };

/* In place of a valve: the controller wrote behind its memory or behind its valves. */
enum { RIG_BEYOND = -1 };

/* Most wheelsets of a machine. */
#define RIG_MOST 16

/* What a run came to, all numbers as of its end. */
typedef struct {
    double distance, speed, time;
    double longest_lock, longest_skid; /* of a wheelset that is locked: time [s], and way at any speed [m]; of one that is
                                        * driven: time for which it turns at more than twice the speed, and 0 */
    double band, looked;      /* looks above the speed, and those of them with all slips in the band */
    double filled;            /* rises of all cylinders' pressures [Pa], or of all motors' torques [N.m] */
    double taken, reservoir;  /* air from the reservoir [kg], and the lowest pressure in it [Pa]; without one 0 */
    double sliding[RIG_MOST]; /* energy of sliding between wheels and rails, by wheelset [J] */
    double commands;          /* looks at which a valve was told anything but to apply, counted by valve */
    double failed_at;         /* when its controller failed; NaN: it did not */
    int state, answer, valve; /* answer: what the controller that failed gave for this valve, from 0 */
} rig_score;

/* Where runs are written down: at every so many looks and at the last one, while there is room. A look is its time, speed and
 * distance; then of each wheelset its angular velocity, what its sensor shows, its cylinder pressure, its valve as it stood until
 * then, its creep force and its load, by kind. */
typedef struct {
    long long int every, room; /* looks between two that are written down; how many of a row there is room for */
    double *look;              /* rows x room x (3 + 6 wheelsets) */
    long long int *count;      /* rows: how many were written down */
} rig_notes;
/* Where a controller outside, such as one in Python, meets the machines: arrays of its own, which outlive the rig. */
typedef struct {
    double *time;        /* rows: of the last look, since the start of the run [s] */
    double *wheel_speed; /* rows x wheelsets: what the sensors showed then [m/s] */
    int *valve;          /* rows x wheelsets: its commands, which are taken before the next step */
} rig_desk;

typedef struct rig rig;

/* What a machine shows, in this order: speed, distance; then of each wheelset its rotation [rad], angular velocity [rad/s],
 * cylinder pressure [Pa], or driven its motor's torque [N.m], creep force [N] and load [N], by kind; then, if it has a
 * reservoir, air taken [kg] and pressure [Pa]. What it is told: demands of all wheelsets, then their valves. */

/* null: there is no memory, or a machine has more than RIG_MOST wheelsets. */
RIG_SHOWN rig *rig_create(long long int rows, const rig_settings *settings, const rig_controller *controller,
                          const rig_desk *desk);
RIG_SHOWN void rig_free(rig *self);
/* A run begins in a row. end_speed: its last one, to which it slows or, driven, speeds up. error: of the edges of each
 * wheelset's sensor, pulses each, or null. Both are copied. */
RIG_SHOWN void rig_begin(rig *self, long long int row, double end_speed, const double *error, const rig_wheelset *wheelset);
RIG_SHOWN const rig_score *rig_scores(const rig *self);
/* Runs that begin from now on are written down there; it outlives the rig. */
RIG_SHOWN void rig_write_down(rig *self, const rig_notes *notes);
/* Sensors of a run that has begun look for the first time, for the desk. status: of its machine, a kernel_status. */
RIG_SHOWN void rig_look(rig *self, long long int row, int status, const double *shown);
/* Brakes of a row stay applied: its controller failed. */
RIG_SHOWN void rig_give_up(rig *self, long long int row);
/* All of it by the controller in C, and whether any run goes on: `batch_between` of the kernel's batch.h. */
RIG_SHOWN bool rig_between(void *self, long long int first, long long int count, const int *status, const double *shown,
                           double *told);
/* Half of it for a controller at the desk, and whether a step follows: valves are set as it said; or, where they have been,
 * sensors look for it. What is no command applies the brake of that row for good. So a `batch_control` of two steps makes one,
 * and ends with what the sensors show behind it. */
RIG_SHOWN bool rig_take_or_look(void *self, long long int first, long long int count, const int *status, const double *shown,
                                double *told);

#endif
