/* A brake pipe of many cells: the loop over them and over time; the equations of a cell are generated (brake_pipe.py). The
 * method is Heun's, which keeps total variation (Shu and Osher 1988), with heat exchange split off on both sides of it (Strang
 * 1968); steps are as long as waves allow. */
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

/* Conditions outside an end: effective opening [m2], inner area of the pipe [m2], pressure [Pa], temperature [K]. */
typedef struct {
    double opening, area, pressure, temperature;
} pipe_outside;

/* Total outflow [kg], [J]: through each end, by leaks, to vehicles. Heat from the walls [J]. Air that cylinders took [kg]. Net
 * flow through driver's valves, and the air that they supplied [kg]. */
typedef struct {
    double end_mass[2], end_energy[2], leak_mass, leak_energy, vehicle_mass, vehicle_energy, heat, cylinder_mass;
    double valve_mass, valve_energy, let_in;
} pipe_passed;

typedef struct pipe pipe;

/* state: PIPE_STATES rows of all cells; constants: CELL_ROWS rows; both are copied. Returns NULL if out of memory. */
PIPE_SHOWN pipe *pipe_create(long long int cells, const double *state, const double *constants);
PIPE_SHOWN void pipe_free(pipe *self);
/* Connects vehicles with distributors of these kinds to these cells; all numbers are copied. parts: number of equal parts of
 * each vehicle's cylinder. It is not divided below 2, or with NULL. given: rows of parameters of the vehicles of each kind. pace:
 * fastest decay rate of their states [1/s]. Returns 0 if out of memory.
 *
 * A part has its share of the cylinder's volume and chokes, and magnet valves of its own. Its pressure changes at the rate that
 * the whole cylinder would have at this pressure. All other states of the distributor, and its flows, have the mean rates of the
 * parts: flows of a choke are in proportion to its area. */
PIPE_SHOWN int pipe_vehicles(pipe *self, long long int count, const long long int *kind, const long long int *cell,
                             const double *parts, const double *const given[KINDS], int brake_model, double pace);
/* Initial state of all distributors: pressure of the charged reservoirs, ambient pressure, pressure in the cylinders [Pa]. */
PIPE_SHOWN void pipe_charge(pipe *self, double charged, double around, double cylinder);
/* Commands of the wheel-slide protection of each vehicle, PROTECTION_APPLY, ... */
void pipe_protect(pipe *self, const double *protection);
/* The same as shares of open areas: of the valve that shuts the cylinders off, and of the one that vents them. */
void pipe_dump(pipe *self, const double *held, const double *vented);
/* The same for the parts of a divided cylinder; all vented; and the pressures that press their brakes [Pa]. */
void pipe_dump_parts(pipe *self, long long int vehicle, const double *held, const double *vented);
void pipe_vent_parts(pipe *self, long long int vehicle);
void pipe_part_pressures(const pipe *self, long long int vehicle, double *pressure);
/* Electric commands of each vehicle: demanded share of the full pressure of its cylinders, ordered share of full service. */
void pipe_demand(pipe *self, const double *share, const double *ordered);
/* 1 if an electric command acts on the pipe at a vehicle. */
int pipe_is_assisted(const pipe *self);
/* With BRAKE_MODEL_DELAY: sets the pressure in a cell [Pa]. */
void pipe_give(pipe *self, long long int cell, double pressure);
/* Air at rest in all cells, of a density [kg/m3] and pressure [Pa]; resets the outflow. */
void pipe_fill(pipe *self, double density, double pressure);
/* States of the distributors of one kind: rows of the vehicles that have it. */
PIPE_SHOWN void pipe_vehicle_states(const pipe *self, int kind, double *state);
/* Of each vehicle: the pressure in its cell, and that which presses its brake [Pa]; NULL: not required. */
PIPE_SHOWN void pipe_pressures(const pipe *self, double *line, double *cylinder);
PIPE_SHOWN void pipe_end(pipe *self, int end, const pipe_outside *outside);
/* Sets a driver's valve, one of MOST_VALVES, at the face before a cell, or after the last one; numbers: the first of VALVE in
 * brake_pipe.py. Its previous values are lost. */
PIPE_SHOWN void pipe_valve(pipe *self, int valve, long long int face, const double numbers[VALVE_NUMBERS]);
/* Lets a driver's valve draw from a reservoir of this volume [m3] from now on, whose pressure falls (Boyle); 0: it stays. Stands
 * after `pipe_valve`. */
PIPE_SHOWN void pipe_supply(pipe *self, int valve, double volume);
/* Fall of that pressure since then [Pa]. */
PIPE_SHOWN double pipe_drawn(const pipe *self, int valve);
/* u = share * first + (1 - share) * (u + step * rate). */
void pipe_mix(double *u, const double *first, const double *rate, long long int count, double share, double step);
/* Sets the joint of the cells at a face. */
PIPE_SHOWN void pipe_join(pipe *self, long long int face, int how);
/* Complete state of a run except ends, valves and joints: its size, and copies from and to memory. */
PIPE_SHOWN long long int pipe_numbers(const pipe *self);
PIPE_SHOWN void pipe_save(const pipe *self, double *numbers);
PIPE_SHOWN void pipe_load(pipe *self, const double *numbers);
/* Longest step that waves and vehicles allow now [s]. */
PIPE_SHOWN double pipe_longest(pipe *self, double courant);
/* Density, momentum and energy of all cells. */
PIPE_SHOWN void pipe_state(const pipe *self, double *state);
PIPE_SHOWN const pipe_passed *pipe_has_passed(const pipe *self);
/* Advances by a time [s] in steps of at most `courant` times the travel time of a wave through a cell. Returns the number of
 * steps, or -1 if a number is not finite, or a density or pressure is not above 0; the pipe is unchanged then. */
PIPE_SHOWN long long int pipe_advance(pipe *self, double time, double courant);

#endif
