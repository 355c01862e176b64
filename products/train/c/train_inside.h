/* The train from inside. */
#ifndef TRAIN_INSIDE_H
#define TRAIN_INSIDE_H

#include "motion.h"
#include "pipe.h"
#include "train.h"

/* What driver's valves did is kept for a while, at multiples of HISTORY_STEP: HISTORY of them. */
enum { HISTORY = 1024, TOLD = 3 }; /* pressure, position, step */
#define HISTORY_STEP 0.01
/* What a run changes beside pipe, motion and inputs: of each valve the pressure that it holds, and its history. */
enum { RUN_TIME, RUN_TOLD, RUN_STEP, RUN_SUMS, RUN_VALVES = RUN_SUMS + TRAIN_SUMS, OF_VALVE = 1 + TOLD * HISTORY };

struct train {
    long long int counts[LAYOUT_OWNERS], vehicles, cells, valves, points, stride;
    int lanes, depth, level; /* level: the line is, and straight */
    double head[HEAD_ROWS];
    pipe *air;
    motion *moves;
    double *memory;
    double *brake, *cylinder, *wheel, *held; /* rows as rows.h lays them: constants, what they hang on, what the brake holds */
    double *mass, *centre, *length;
    long long int *cell, *hint, *face; /* where a vehicle takes air; line; before which cell it ends, or none: 0 */
    double *valve; /* VALVE_ROWS of each valve */
    double *line[POINT_ROWS], *height;
    double *input[TRAIN_INPUTS], *given_before; /* input: one block, so long as `inputs` */
    double *output[OUT_SUMS + 1];
    long long int inputs;
    /* what a run changes beside pipe and motion */
    double *run;
    double *saved;
    long long int steps[2];
};

/* Where each group of numbers begins (check.c). */
void layout_find(const double *numbers, const long long int counts[LAYOUT_OWNERS], const double *at[LAYOUT_GROUPS]);
/* How long an input or an output is. */
long long int layout_input(const long long int counts[LAYOUT_OWNERS], int row);
long long int layout_output(const long long int counts[LAYOUT_OWNERS], int row);

#define TRAIN_LOOPS(lanes) void train_brake_##lanes(train *self)
TRAIN_LOOPS(1);
TRAIN_LOOPS(2);
TRAIN_LOOPS(4);
TRAIN_LOOPS(8);

/* What a driver's valve holds and lets through in a step (valves.c). */
void valves_command(train *self, double step);
/* Remembers it, and tells it to pressures that are given. */
void valves_tell(train *self, double step);
double *valves_run(train *self, long long int valve);
/* Gravity and curves on all vehicles (line.c), in the middle of a step. */
void line_act(train *self, double step);

#endif
