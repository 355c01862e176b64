/* A pipe from inside. Rows hold a number of all cells, as rows.h lays them. */
#ifndef PIPE_INSIDE_H
#define PIPE_INSIDE_H

#include <stdbool.h>

#include "pipe.h"

enum { PIPE_SIDES = 7, PIPE_LEAKS = 2, VEHICLE_RATES = VEHICLE_STATES + 3 };

/* A driver's valve: the face, its numbers with the areas of the pipe on both sides, and the pressure there. */
typedef struct {
    long long int face;
    double numbers[VALVE_NUMBERS + 2], at;
} valve_at;
enum { TAP_FOUND = 2, TAPPED = 9, VALVE_OUT = 6, ENERGY_OUT = 7, LET_IN = 8 };

struct pipe {
    long long int cells, stride;
    int lanes, depth;
    bool leaks;
    double *memory, *own_memory;
    double *state, *before, *kept, *first, *given, *side, *flux, *rate, *leak, *time, *jump, *over_volume; /* the first cell of each first row */
    long long int vehicles, vehicle_stride, *cell; /* which cell a vehicle takes its air from */
    double pace, fastest, looked; /* of vehicles; of all in the last step; as looked for since, or 0 [1/s] */
    double *own, *own_before, *own_kept, *own_first, *own_given, *own_command, *own_pipe, *own_rate; /* the same of vehicles */
    pipe_outside outside[2];
    int valves, joints; /* how many are valves, and how many faces are not joined */
    valve_at valve[MOST_VALVES];
    unsigned char *joint;
    double end_flux[2][PIPE_STATES];
    pipe_passed passed;
};

#define PIPE_LOOPS(lanes)                                                                                                       \
    void pipe_sides_##lanes(pipe *self);                                                                                        \
    void pipe_faces_##lanes(pipe *self);                                                                                        \
    void pipe_rates_##lanes(pipe *self);                                                                                        \
    void pipe_leaks_##lanes(pipe *self);                                                                                        \
    void pipe_distribute_##lanes(pipe *self);                                                                                   \
    void pipe_follow_##lanes(pipe *self);                                                                                       \
    void pipe_warm_##lanes(pipe *self);                                                                                         \
    void pipe_side_##lanes(const double *before, const double *own, const double *behind, double *side);                        \
    void pipe_tapping_##lanes(const double *at, const double *behind, const double *ahead, const double *valve, double *found);  \
    void pipe_tapped_##lanes(const double *at, const double *behind, const double *ahead, const double *valve, double *found);   \
    void pipe_walled_##lanes(const double *air, double *flux);                                                                  \
    void pipe_ending_##lanes(const double *air, const double *outside, double *flux)
PIPE_LOOPS(1);
PIPE_LOOPS(2);
PIPE_LOOPS(4);
PIPE_LOOPS(8);

#endif
