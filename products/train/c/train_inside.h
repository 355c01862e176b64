/* The train, internal. */
#ifndef TRAIN_INSIDE_H
#define TRAIN_INSIDE_H

#include "motion.h"
#include "pipe.h"
#include "protection.h"
#include "train.h"

/* The states of driver's valves are stored at multiples of HISTORY_STEP: HISTORY of them. */
enum { HISTORY = 1024, TOLD = 3 }; /* pressure, position, step */
#define HISTORY_STEP 0.01
/* Variables of a run outside pipe, motion and inputs: for each valve its pressure and its history. */
enum { RUN_TIME, RUN_TOLD, RUN_STEP, RUN_SUMS, RUN_VALVES = RUN_SUMS + TRAIN_SUMS, OF_VALVE = 1 + TOLD * HISTORY };

typedef struct extra_brakes extra_brakes;
typedef struct drives drives;
typedef struct details details;
typedef struct cab cab;

struct train {
    long long int counts[LAYOUT_OWNERS], vehicles, cells, valves, points, stride;
    int lanes, brake_model, level, even; /* the line is level and straight; its friction is that of the inputs */
    double head[HEAD_ROWS];
    pipe *air;
    motion *moves;
    double *rows, *numbers; /* memory */
    double *brake, *cylinder, *wheel, *held; /* rows (rows.h): constants, variables they depend on, brake forces */
    /* rows of electric commands and brakes: constants, commands, and forces with demanded shares of the cylinders' pressure */
    double *electric, *command, *blended;
    /* rows: constants of heat; work of a step; heat before it (HEATED_ROWS), share of friction or surface, heat after it */
    double *heat, *worked, *warm;
    int heats; /* a vehicle has a brake that warms up */
    int works; /* the work of its brakes is summed */
    int blends; /* a vehicle has an electric command or an electric brake */
    extra_brakes *extra; /* NULL: no vehicle has a track brake or a parking brake */
    details *detail; /* NULL: no vehicle is computed in detail */
    drives *drive; /* NULL: no vehicle has motors, or adhesion that falls over its speed */
    protections *slide; /* NULL: no vehicle has a wheel-slide protection */
    int has_cab; /* a vehicle or valve has what cab.c computes */
    cab *cab;
    double *mass, *centre, *length;
    long long int *cell, *hint, *face; /* cell of each vehicle; row of the line; cell after its end, 0: none */
    double *valve; /* VALVE_ROWS of each valve */
    double *line[POINT_ROWS], *height, *grip; /* integrals of gradient and friction */
    double *input[TRAIN_INPUTS], *given_before; /* input: one block, as long as `inputs` */
    double *output[OUT_SUMS + 1];
    long long int inputs;
    /* variables of a run outside pipe and motion */
    double *run;
    double *saved;
    long long int steps[2];
};

/* Start of each group of numbers (check.c). */
void layout_find(const double *numbers, const long long int counts[LAYOUT_OWNERS], const double *at[LAYOUT_GROUPS]);
/* Allocates `saved` for the state as long as it is; returns 0 if out of memory. */
int train_lay_saved(train *self);
/* Length of an input or an output. */
long long int layout_input(const long long int counts[LAYOUT_OWNERS], int row);
long long int layout_output(const long long int counts[LAYOUT_OWNERS], int row);

#define TRAIN_LOOPS(lanes)                                                                                                     \
    void train_brake_##lanes(train *self);                                                                                     \
    void train_brake_at_##lanes(const double *cylinder, const double *wheel, const double *brake, double *force,               \
                                long long int stride);                                                                         \
    void extra_park_at_##lanes(const double *air, const double *order, const double *parking, double *applied,                 \
                               long long int stride);                                                                          \
    void train_blend_##lanes(train *self);                                                                                     \
    void train_heat_##lanes(train *self);                                                                                      \
    void train_surface_##lanes(train *self);                                                                                   \
    void train_fade_##lanes(train *self);                                                                                      \
    void extra_track_##lanes(train *self);                                                                                     \
    void extra_park_##lanes(train *self);                                                                                      \
    void drive_pull_##lanes(train *self);                                                                                      \
    void drive_adhere_##lanes(train *self);                                                                                    \
    void cab_rate_##lanes(cab *self);                                                                                          \
    void cab_pump_##lanes(cab *self)
TRAIN_LOOPS(1);
TRAIN_LOOPS(2);
TRAIN_LOOPS(4);
TRAIN_LOOPS(8);

/* Penalty in force at a driver's valve, PENALTY_NONE, ... (valves.c). */
double valves_penalty(const train *self, long long int valve);
/* Pressure and flow areas of driver's valves in a step. */
void valves_command(train *self, double step);
/* Stores them, and applies them to given pressures. */
void valves_tell(train *self, double step);
/* Largest share of the brakes that a driver's valve demanded a dead time ago, in the middle of a step. */
double valves_demand(train *self, double step, double dead_time);
double *valves_run(train *self, long long int valve);
/* Gravity, curves and friction of the rails on all vehicles (line.c), in the middle of a step. */
void line_act(train *self, double step);

/* Track brakes and parking brakes (extra_brakes.c): rows (rows.h) of vehicles. */
struct extra_brakes {
    int tracks, parks; /* a vehicle has a track brake; one has a parking brake */
    double *memory;
    const double *speed; /* of the vehicles, a row of the motion */
    double *track, *order, *braked; /* constants; ORDERED; force and both shares at the end of a step */
    double *parking, *screw, *air, *applied; /* constants; SCREWED; force of the air; that of both, and share at the end */
};

enum { EXTRA_RUN = 4 }; /* variables of a run for each vehicle: shares of magnets, eddy currents, parking brake; force [N] */
/* Allocates them if a vehicle has one; returns 0 if out of memory. */
int extra_create(train *self, const double *track, const double *parking);
void extra_free(extra_brakes *self);
double *extra_run(const train *self);
/* Applies parking brakes: they join the brake forces in `held`. Does nothing without one. */
void extra_park(train *self, double step);
/* Returns the force of a vehicle's parking brake, as it was applied last, with another force of the air [N]. */
double extra_parked(const train *self, long long int vehicle, double air);
/* Adds the forces of track brakes to the row ACTING_BODY, after `line_act`. */
void extra_track(train *self, double step);
/* Traction, and adhesion over speed (drive.c): rows (rows.h) of vehicles. */
struct drives {
    int pulls, falls; /* a vehicle has motors; the adhesion of one falls over its speed */
    double part; /* longest part of a step [s] */
    double *memory;
    double *traction, *law; /* constants */
    double *wheel, *command, *force; /* speed in the middle of a part, DRIVEN; mean and last force */
    double *speed, *share, *friction; /* speed or slip; share of the friction at standstill, and that friction */
    double *line, *place; /* pressures of the pipe; positions before a part */
};

enum { DRIVE_RUN = 5 }; /* variables of a run for each vehicle */
/* Allocates them if they are needed; returns 0 if out of memory. */
int drive_create(train *self, const double *traction, const double *law, const double *motion);
void drive_free(drives *self);
double *drive_run(const train *self);
/* Advances the motion by a step, in at least `count` steps of couplers; returns their number. */
long long int drive_go(train *self, long long int count, double step);
/* Adds the work that electric brakes take while the rims go a way, and writes outputs. */
void drive_brake(train *self, const double *way);
void drive_outputs(train *self);

/* Vehicles in detail (detail.c). Their part of outputs of the state and of forces, and of a saved state. */
void detail_free(details *self);
int detail_moves(const train *self, long long int vehicle);
void detail_outputs(train *self);
void detail_forces(train *self);
long long int detail_numbers(const train *self);
void detail_save(const train *self, double *numbers);
void detail_load(train *self, const double *numbers);
/* Continues from positions that were set. */
void detail_settle(train *self);
/* Kernels that refused a step try again. */
void detail_try(train *self);
/* A run begins, whose kernels have not been initialised. */
void detail_forget(train *self);
/* Speed of a wheelset at the rim [m/s]; before its kernel begins, that of the vehicle's wheels. */
double detail_rim(const train *self, long long int vehicle, int wheelset);
/* Advances the train's own clock by the next step, which is returned: to its grid, or over the time that is left. */
double detail_step(const train *self, double left);
/* Largest rest of a time that rounding leaves [s]; 0 without vehicles in detail. */
double detail_rounding(const train *self);
/* Pressures that press the brakes: of distributors, or of direct brakes. */
void find_cylinders(const train *self, double *cylinder);
/* The cab (cab.c): rows (rows.h) of the vehicles that have a direct brake or a main reservoir, and what all have. */
struct cab {
    int lanes, bails; /* bails: the distributor of a vehicle can be bailed off */
    long long int count, stride, *vehicle;
    double pace; /* of direct brakes [1/s] */
    double *memory;
    double *direct, *main; /* constants */
    double *pressure, *before, *order, *rate, *pumped, *pumps; /* PRESSED, DIRECTLY, rates; PUMPED, its results */
    /* of all vehicles: pressure of the direct brake [Pa]; shares of the valves of protection, with bail-off */
    double *full, *held, *vented;
    double *desk; /* VIGILANCE_ROWS of all valves */
};

/* True if the numbers of a train state one. */
int cab_is_stated(const long long int counts[LAYOUT_OWNERS], const double *const at[LAYOUT_GROUPS]);
/* Length of its variables of a run, 0 without one, and their place. */
long long int cab_numbers(const train *self);
double *cab_run(const train *self);
/* Allocates it if it is stated; returns 0 if out of memory. */
int cab_create(train *self, const double *const at[LAYOUT_GROUPS]);
void cab_free(cab *self);
void cab_begin(train *self);
/* Acknowledgements: changes of the input from that before a step. */
void cab_acknowledge(train *self, const double *before);
/* Vigilance devices in a step. */
void cab_watch(train *self, double step);
double cab_penalty(const train *self, long long int valve);
/* Pressure that supplies a driver's valve, and volume of its main reservoir, 0: it stays. */
double cab_supply(const train *self, long long int valve, double *volume);
/* Lets the air of distributors out of cylinders, after `train_blend`. */
void cab_bail_off(train *self);
/* Direct brakes and compressors in a step, after the pipe's; 0: a pressure is not finite and above 0. */
int cab_advance(train *self, double step);
/* Double check valves: a direct brake that has the higher pressure presses the brake. */
void cab_press(const train *self, double *cylinder);
void cab_outputs(train *self);

/* Hoses of vehicles that are apart (hoses.c). */
enum { HOSE_RUN = 2 }; /* variables of a run for each vehicle */
double *hose_run(const train *self);
void hoses_begin(train *self);
/* The input of a hose has changed. */
void hose_changed(train *self, long long int vehicle);
/* The joint behind a vehicle, HOSE_STATE_WHOLE, ...: that of the last step's inputs, unless its hose or coupler has parted. */
int hose_joint(const train *self, long long int vehicle);
/* Parts and joins hoses by the present gaps, for a step; true if one has changed. */
int hoses_look(train *self, double step);

#endif
