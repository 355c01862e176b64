/* A pipe from inside. Rows hold a number of all cells, behind EDGE of them that are no cells; `stride` lies between rows. */
#ifndef PIPE_INSIDE_H
#define PIPE_INSIDE_H

#include <stdbool.h>

#include "pipe.h"

enum { PIPE_EDGE = 8, PIPE_SIDES = 7, PIPE_LEAKS = 2, VEHICLE_RATES = VEHICLE_STATES + 3 };

struct pipe {
    long long int cells, stride;
    int lanes;
    bool leaks;
    double *memory, *own_memory;
    double *state, *before, *kept, *first, *given, *side, *flux, *rate, *leak, *time; /* the first cell of each first row */
    long long int vehicles, vehicle_stride, *cell; /* which cell a vehicle takes its air from */
    double pace;
    double *own, *own_before, *own_kept, *own_first, *own_given, *own_pipe, *own_rate; /* the same of vehicles */
    pipe_outside outside[2];
    double end_flux[2][PIPE_STATES];
    pipe_passed passed;
};

#define PIPE_LOOPS(lanes)                                                                                                       \
    void pipe_sides_##lanes(pipe *self);                                                                                        \
    void pipe_faces_##lanes(pipe *self);                                                                                        \
    void pipe_rates_##lanes(pipe *self);                                                                                        \
    void pipe_leaks_##lanes(pipe *self);                                                                                        \
    void pipe_distribute_##lanes(pipe *self);                                                                                   \
    void pipe_warm_##lanes(pipe *self);                                                                                         \
    void pipe_ending_##lanes(const double *air, const double *outside, double *flux)
PIPE_LOOPS(1);
PIPE_LOOPS(2);
PIPE_LOOPS(4);
PIPE_LOOPS(8);

#endif
