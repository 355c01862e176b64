/* A train: brake pipe and distributors (pipe.h), brakes of vehicles (vehicle_brake.py), motion and couplers (motion.h), driver's
 * valves and a line. Pressures are absolute. */
#ifndef TRAIN_H
#define TRAIN_H

#if defined(_WIN32)
#define TRAIN_SHOWN __declspec(dllexport)
#else
#define TRAIN_SHOWN __attribute__((visibility("default")))
#endif

/* A train is given as numbers, written by products/train/numbers.py: a head, then rows. TRAIN_HEAD numbers: */
enum {
    HEAD_VEHICLES, HEAD_CELLS, HEAD_VALVES, HEAD_POINTS, /* of the line */
    HEAD_DEPTH,                                          /* of the brake, pipe.h */
    HEAD_PACE,                                           /* how fast vehicles come to rest at most, pipe.h [1/s] */
    HEAD_COURANT,                                        /* of a step of the pipe, pipe.h */
    HEAD_BOUND, HEAD_SHARE,                              /* longest stable step of the couplers [s], and what share of it is taken */
    HEAD_PROPAGATION,                                    /* of what the pipe is told, where its pressures are given [m/s] */
    TRAIN_HEAD
};

/* A driver's valve. Areas are effective. */
enum {
    VALVE_FACE,                                          /* before which cell */
    VALVE_FEEDING, VALVE_EXHAUST, VALVE_EMERGENCY,       /* areas [m2] */
    VALVE_BAND, VALVE_SUPPLY, VALVE_WARMTH, VALVE_AROUND, /* [Pa], [Pa], [K], [Pa] */
    VALVE_RUNNING, VALVE_OVERCHARGE, VALVE_FIRST, VALVE_FULL, /* pressures; falls of the first step and of full service [Pa] */
    VALVE_DOWN, VALVE_UP, VALVE_SLOWLY, VALVE_QUICKLY,   /* rates of the pressure that it holds: service, release, overcharge, emergency [Pa/s] */
    VALVE_PLACE,                                         /* from the head, backwards below 0 [m] */
    VALVE_DELAY,                                         /* behind the first valve [s], while its own position is 0; below 0: never */
    VALVE_ROWS
};

/* Positions of a driver's valve. */
enum { VALVE_SHUT_OFF, VALVE_IS_RUNNING, VALVE_OVERCHARGED, VALVE_IN_SERVICE, VALVE_IN_EMERGENCY };
/* What wheel-slide protection of a vehicle commands. */
enum { PROTECTION_APPLY, PROTECTION_HOLD, PROTECTION_RELEASE };

/* What is set from outside: of each valve, of each vehicle, of each coupling, and forces at the head and at the end [N]. */
enum { IN_POSITION, IN_STEP, IN_PULL, IN_FRICTION, IN_PROTECTION, IN_COUPLED, IN_JOINED, IN_ENDS, IN_LED, IN_LED_SPEED, TRAIN_INPUTS };
/* How a vehicle is led by what computes it in detail: not at all; it has that speed; it goes on from that speed by itself. */
enum { LED_NOT, LED_HELD, LED_CORRECTED };
/* What is found: of each vehicle, of each coupling, and of the train, TRAIN_SUMS. */
enum { OUT_DISTANCE, OUT_SPEED, OUT_WHEEL, OUT_PIPE, OUT_CYLINDER, OUT_BRAKE, OUT_RAIL, OUT_FORCE, OUT_MEAN, OUT_SUMS, TRAIN_OUTPUTS };
enum { SUM_TIME, SUM_TENSION, SUM_TENSION_AT, SUM_COMPRESSION, SUM_COMPRESSION_AT, SUM_AIR, TRAIN_SUMS };

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
/* Row of an input that is beyond its limits (INPUT_LIMITS of products/train/train.py), or that cannot be where the pipe has
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
