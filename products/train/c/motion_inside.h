/* The motion, internal: rows in the layout of rows.h. */
#ifndef MOTION_INSIDE_H
#define MOTION_INSIDE_H

#include "motion.h"

enum { MOTION_FOUND = 3 };

struct motion {
    long long int vehicles, stride;
    int lanes, waiting; /* couplers to be coupled */
    double *memory;
    double *state, *speed, *wheel, *rest, *acting, *given, *coupler, *step, *found, *force, *wish, *lead,
        *sum; /* first cells of first rows */
    int bends_often; /* true if a curve of a coupler has more than FEW_POINTS points */
    int led; /* true if a vehicle's speed is prescribed */
    double *strength; /* NULL: none breaks */
    int broken; /* since the last look */
    double extremes[4];
    long long int summed;
    void (*follow)(void *owner, double step); /* NULL: no other model moves a vehicle */
    void *owner;
};

#define MOTION_LOOPS(lanes)                                                                                                    \
    void motion_force_##lanes(motion *self);                                                                                   \
    void motion_speed_##lanes(motion *self);                                                                                   \
    void motion_slide_##lanes(const motion *self, long long int vehicle, double *result)
MOTION_LOOPS(1);
MOTION_LOOPS(2);
MOTION_LOOPS(4);
MOTION_LOOPS(8);

#endif
