/* A brake pipe of many cells: the loop over them and over time; what happens in a cell is generated (brake_pipe.py).
 *
 * The method is Heun's, which keeps total variation (Shu and Osher 1988), with heat exchange split off on both sides of it
 * (Strang 1968); steps are as long as waves allow. */
#ifndef PIPE_H
#define PIPE_H

#include "train_layout.h"

#if defined(_WIN32)
#define PIPE_SHOWN __declspec(dllexport)
#else
#define PIPE_SHOWN __attribute__((visibility("default")))
#endif

/* Numbers of a cell: density, momentum, energy. Of a driver's valve: the first of TAP_ROWS. */
enum { PIPE_STATES = 3, VALVE_NUMBERS = TAP_AREA_BEHIND };

/* What is outside an end: effective opening [m2], inner area of the pipe [m2], pressure [Pa], temperature [K]. */
typedef struct {
    double opening, area, pressure, temperature;
} pipe_outside;

/* What has left since the beginning [kg], [J]: through each end, by leaks, to vehicles; heat that walls have given [J]; and air
 * that cylinders have taken [kg]; net by driver's valves, and air that they have let in [kg]. */
typedef struct {
    double end_mass[2], end_energy[2], leak_mass, leak_energy, vehicle_mass, vehicle_energy, heat, cylinder_mass;
    double valve_mass, valve_energy, let_in;
} pipe_passed;

typedef struct pipe pipe;

/* state: PIPE_STATES rows of so many cells; constants: CELL_ROWS rows; both are copied. null: there is no memory. */
PIPE_SHOWN pipe *pipe_create(long long int cells, const double *state, const double *constants);
PIPE_SHOWN void pipe_free(pipe *self);
/* Vehicles with distributors of these kinds take air from these cells; given: of each kind, rows of parameters of its vehicles;
 * all is copied. depth: of the brake; pace: how fast a state of theirs comes to rest at most [1/s]. 0: there is no memory. */
PIPE_SHOWN int pipe_vehicles(pipe *self, long long int count, const long long int *kind, const long long int *cell,
                             const double *const given[KINDS], int depth, double pace);
/* How all distributors begin: pressures that reservoirs are charged to, around, and in the cylinders [Pa]. */
PIPE_SHOWN void pipe_charge(pipe *self, double charged, double around, double cylinder);
/* What wheel-slide protection of each vehicle commands, PROTECTION_APPLY, ... */
void pipe_protect(pipe *self, const double *protection);
/* With DEPTH_DELAY: the pressure in a cell [Pa]. */
void pipe_give(pipe *self, long long int cell, double pressure);
/* Air at rest in all cells, of a density [kg/m3] and pressure [Pa]; nothing has passed. */
void pipe_fill(pipe *self, double density, double pressure);
/* States of the distributors of one kind: rows of so many vehicles as have it. */
PIPE_SHOWN void pipe_vehicle_states(const pipe *self, int kind, double *state);
/* Of each vehicle: the pressure in its cell and in its cylinder [Pa]; null: not asked for. */
PIPE_SHOWN void pipe_pressures(const pipe *self, double *line, double *cylinder);
PIPE_SHOWN void pipe_end(pipe *self, int end, const pipe_outside *outside);
/* A driver's valve, one of MOST_VALVES, at the face before a cell, or behind the last one; numbers: the first of VALVE in
 * brake_pipe.py. What it was before is gone. */
PIPE_SHOWN void pipe_valve(pipe *self, int valve, long long int face, const double numbers[VALVE_NUMBERS]);
/* How the cells before and behind a face are joined. */
PIPE_SHOWN void pipe_join(pipe *self, long long int face, int how);
/* All that a run changes but ends, valves and joints: how many numbers, and from and to a place for them. */
PIPE_SHOWN long long int pipe_numbers(const pipe *self);
PIPE_SHOWN void pipe_save(const pipe *self, double *numbers);
PIPE_SHOWN void pipe_load(pipe *self, const double *numbers);
/* How long a step waves and vehicles allow now [s]. */
PIPE_SHOWN double pipe_longest(pipe *self, double courant);
/* Density, momentum and energy of all cells. */
PIPE_SHOWN void pipe_state(const pipe *self, double *state);
PIPE_SHOWN const pipe_passed *pipe_has_passed(const pipe *self);
/* Goes on by a time [s] in steps of at most `courant` of what a wave needs through a cell; how many steps that took, or
 * -1: some number is not finite, or a density or pressure is not above 0, and the pipe is as it was. */
PIPE_SHOWN long long int pipe_advance(pipe *self, double time, double courant);

#endif
