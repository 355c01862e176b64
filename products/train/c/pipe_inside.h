/* A pipe, internal. A row contains a number of each cell, in the layout of rows.h. */
#ifndef PIPE_INSIDE_H
#define PIPE_INSIDE_H

#include <stdbool.h>

#include "pipe.h"

enum { PIPE_SIDES = 7, PIPE_LEAKS = 2 };

/* A driver's valve: the face, its numbers with the areas of the pipe on both sides, and the pressure there; supply: pressure that
 * feeds it at the start of a step. Each kg that it draws lowers this by `per_mass` [Pa/kg]. */
typedef struct {
    long long int face;
    double numbers[TAP_ROWS], at, supply, per_mass;
} valve_at;
enum { TAP_FOUND = 2, TAPPED = 9, VALVE_OUT = 6, ENERGY_OUT = 7, LET_IN = 8 };

/* Distributors of one kind, of the vehicles of the pipe that have it. */
typedef struct {
    int lanes, kind, form; /* form: of DISTRIBUTOR_FORMS */
    /* The rows of the `count` vehicles are followed by those of the parts of divided cylinders. Each row has its vehicle, a cell
     * that it is connected to, and the row of its vehicle. */
    long long int count, rows, stride, *vehicle, *cell, *of;
    double *memory, *state, *before, *kept, *first, *given, *air, *command, *rate,
        *pressing; /* the first cell of each first row */
} distributors;

/* Blocks of states. */
enum { STATE, BEFORE, KEPT, FIRST };

struct pipe {
    long long int cells, stride;
    int lanes, brake_model;
    bool leaks;
    double *memory;
    double *state, *before, *kept, *first, *given, *side, *flux, *rate, *leak, *time, *jump, *over_volume, *drag,
        *dragged_from; /* dragged_from: speed of waves above which friction may limit the step [m/s]; the first cell of each first row */
    distributors own[KINDS];
    double pace, fastest, found_since; /* of vehicles; of all in the last step; as found since, or 0 [1/s] */
    pipe_outside outside[2];
    int valves, joints; /* number of valves, and of separated faces */
    valve_at valve[MOST_VALVES];
    double drawn[4][MOST_VALVES],
        drawing[MOST_VALVES]; /* fall of supplies since `pipe_supply` [Pa], in the blocks STATE, ...; rate */
    unsigned char *joint;
    double end_flux[2][PIPE_STATES];
    pipe_passed passed;
};

#define PIPE_LOOPS(lanes)                                                                                                      \
    void pipe_sides_##lanes(pipe *self);                                                                                       \
    void pipe_faces_##lanes(pipe *self);                                                                                       \
    void pipe_rates_##lanes(pipe *self);                                                                                       \
    void pipe_leaks_##lanes(pipe *self);                                                                                       \
    void pipe_drag_##lanes(pipe *self);                                                                                        \
    void distributors_answer_##lanes(distributors *self);                                                                      \
    void distributors_press_##lanes(const distributors *self);                                                                 \
    void pipe_warm_##lanes(pipe *self);                                                                                        \
    void pipe_side_##lanes(const double *before, const double *own, const double *behind, double *side);                       \
    void pipe_tapping_##lanes(const double *at, const double *behind, const double *ahead, const double *valve,                \
                              double *found);                                                                                  \
    void pipe_tapped_##lanes(const double *at, const double *behind, const double *ahead, const double *valve, double *found); \
    void pipe_walled_##lanes(const double *air, double *flux);                                                                 \
    void pipe_ending_##lanes(const double *air, const double *outside, double *flux)
PIPE_LOOPS(1);
PIPE_LOOPS(2);
PIPE_LOOPS(4);
PIPE_LOOPS(8);

/* ---- distributors.c ---- */

/* Rates of all distributors; subtracts their air from the rates of their cells. */
void distributors_act(pipe *self, pipe_passed *passed);
/* state = share of the previous state, and the rest of the state after a step with these rates. */
void distributors_go_on(pipe *self, double share, double step);
/* Copies a block of all states. */
void distributors_copy(pipe *self, int to, int from);
/* True if all states are finite and above zero. */
bool distributors_sound(const pipe *self);
/* All states: their number, and copies from and to memory. */
long long int distributors_numbers(const pipe *self);
void distributors_save(const pipe *self, double *numbers);
void distributors_load(pipe *self, const double *numbers);
void distributors_free(pipe *self);

#endif
