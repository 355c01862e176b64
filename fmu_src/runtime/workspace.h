/* Work arrays of a step. Data here that outlive a step can be computed again from the state of the run. */
#ifndef WORKSPACE_H
#define WORKSPACE_H

#include <stdbool.h>

enum { MOST_STAGES = 8 };

/* Arguments of generated functions in addition to time, states, constants and modes. */
typedef struct {
    double step_origin; /* time at the start of the current kernel_step; places in it have an offset from it */
    double *parameter;
    double *input, *rate;  /* at the origin, and their rates of change */
    double *stage_input;   /* at a place */
    double *coefficient;   /* of table pieces there */
    double *table_at;      /* arguments of tables */
    double *held;          /* for each table, the range of its argument in which `coefficient` holds: from, and below */
    int *row;              /* for each table that is looked up in the file, the row before the last place */
    double *seed;          /* direction of derivatives: time, states, inputs */
} given_values;

/* LU factors of a matrix by columns, in place, with exchanged rows. */
typedef struct {
    double *matrix;
    int *pivot;
    int size;
} dense_factors;

/* LU factors of a step's matrix: those of the generated elimination, or with exchanges, in the one dense matrix. */
typedef struct {
    double *packed;
    bool exchanged;
} step_factors;

/* Work arrays of the methods of integration. Jacobians are nonzeros in the order of the description. */
typedef struct {
    int method;           /* a value of integration_method */
    double *differential; /* 1 for states with a derivative, 0 for algebraic ones */
    double *slope, *time_slope, *jacobian;
    double *stage[MOST_STAGES], *point, *trial; /* stages, the place of the last one, and the state that a step leads to */
    double *largest_change;
    step_factors factors;
    dense_factors dense; /* for a step's matrix whose rows are exchanged, */
    const step_factors *dense_owner; /* and whose factors it holds */
    double *ordered;     /* a vector in the order of elimination */
    dense_factors algebraic;
    bool algebraic_serve; /* its factors are good enough for Newton's method */
    double *correction, *guess, *follow; /* of algebraic states: Newton's, their values before, what follows from others */
    double *direction, *image;           /* a change of all states, and its product with J */
} step_workspace;

typedef enum { KEPT_NOTHING, KEPT_JACOBIAN, KEPT_FACTORS } kept_parts;

/* Data made from the place where the kept Jacobian was taken. */
typedef struct {
    kept_parts ready;
    double *jacobian;
    step_factors factors;
    dense_factors algebraic;
} kept_workspace;

/* Work arrays of frictions and conditions. */
typedef struct {
    double *drive, *capacity, *still;
    double *margin; /* of frictions, of end conditions, of warnings */
    double *reported;   /* of frictions: where it counts that they stick, and where that they slide */
    double *before, *overshoot; /* modes before a round; velocities that passed zero within a step of a fixed size */
} mode_workspace;

/* Work arrays of outputs and their derivatives, and of states between the steps. */
typedef struct {
    double *output, *output_rate, *slope_change;
    double *place; /* where outputs and derivatives are read that have algebraic states */
    double *state, *first_slope, *last_slope; /* a state within a step, and slopes at its ends */
} reading_workspace;

/* Work arrays of the search for a steady state. */
typedef struct {
    double *start, *change, *answer, *pace;
} steady_workspace;

/* Of an integrator of the host: where its step began, the slopes there and how they differ from those before. */
typedef struct {
    double time, *state, *slope, *change;
    double *slope_before; /* an event */
    double *growth, *square; /* matrices of the states of model exchange */
    bool slope_known;
    int steps; /* in a row that were those of Euler's method */
} host_workspace;

#endif
