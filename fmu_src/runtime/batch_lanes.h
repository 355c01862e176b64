/* The inside of a batch: its lanes, and their numbers, of which those of one lane are BATCH_LANES apart. */
#ifndef BATCH_LANES_H
#define BATCH_LANES_H

#include "batch.h"
#include "stepper.h"
#include "tableau.h"

typedef struct {
    double *origin, *offset, *wanted, *allowed, *time; /* [s]; allowed: 1 / tolerance */
    double *state, *input, *rate, *stage_input, *parameter, *derived, *mode, *coefficient, *argument;
    double *slope, *time_slope, *jacobian, *entry, *differential, *point, *trial, *stage[MOST_STAGES];
    double *capacity, *drive, *end_capacity, *end_drive, *margin, *largest_change, *output;
    double *error, *regular; /* regular: whether the matrix of its step was */
} lane_numbers;

typedef struct {
    kernel *self; /* NULL: empty */
    stepper run;
    unsigned long long noted;
    long long int row;
    double size;
    bool begins; /* a kernel_step */
    bool linearised, together; /* whether the lanes have its Jacobian; whether it shares their trial */
    const kernel *constants_of; /* owner of the constants in the lane */
    known_place start, end;
} lane;

struct batch {
    const batch_functions *of;
    const system_description *system;
    const rosenbrock_tableau *tableau;
    lane lane[BATCH_LANES];
    kernel *own[BATCH_LANES];
    kernel_recorder no_rows; /* of a run: its steps are those of a run that is recorded */
    lane_numbers numbers;
    known_place start, end;
    known_function of_start[MOST_KNOWN], of_end[MOST_KNOWN];
    double *room, *constants; /* the numbers; if `room` is NULL, they are in that of another batch */
    int *place; /* of each variable among the outputs; -1: it is none */
    bool ends;  /* whether outputs are known at the end of the trial */
};

extern const batch_functions BATCH;

RUNTIME_LOCAL bool batch_lay_out(batch *self, const batch *beside);
/* Evaluate each lane at its present place: modes if `modes`, the Jacobian, and the largest changes. */
RUNTIME_LOCAL const known_place *batch_start(batch *self, bool modes);
/* Make a trial of each lane with its wanted size and evaluates functions at its end. */
RUNTIME_LOCAL const known_place *batch_try(batch *self);

#endif
