/* Braking curves of place over speed for one train, exact over arcs: parabolas between steps of speed and of gradient, SUBSET-026,
 * 3.13.8. products/supervision has the same curves in NumPy, for many trains. */
#ifndef BRAKING_ARCS_H
#define BRAKING_ARCS_H

#include <stdbool.h>

/* Steps of a number in train data, and of the product of three such numbers. */
enum { TRAIN_STEPS = 7, PRODUCT_STEPS = 3 * (TRAIN_STEPS - 1) + 1 };

/* A step function of speed: value n holds above boundary n - 1 up to boundary n, which it includes [m/s]. */
typedef struct {
    int count; /* of values */
    double boundary[PRODUCT_STEPS - 1], value[PRODUCT_STEPS];
} speed_steps;

/* Acceleration by the gradient between places of the train's front [m], ascending: slope n holds before edge n [m/s2]. */
typedef struct {
    int edges;
    const double *edge, *slope;
} line_slopes;

/* An arc begins at a place [m] and the square of a speed [m2/s2]; it goes to higher speeds with a deceleration [m/s2]. */
typedef struct {
    double place, square, rate;
} braking_arc;

/* Arcs in the order of speed. `arc` has room for those of all steps of speed and of gradient: `curve_room`. */
typedef struct {
    int count;
    braking_arc *arc;
} braking_curve;

/* A supervision limit: EBD or SBD less the way of the times before the brake acts, 3.13.9.3.2. */
typedef struct {
    const braking_curve *curve;
    double traction, building; /* times with traction and of the build-up [s] */
    double pulled, crept; /* speeds that the train gains in both [m/s] */
    double target; /* speed at the target [m/s] */
    double lag; /* time from this limit to the one that the brake needs [s] */
    bool compensated; /* whether the error of the speed counts */
} supervision_limit;

double steps_at(const speed_steps *self, double speed);
/* Find the product of three step functions, exact at each speed. */
void steps_product(const speed_steps factor[3], speed_steps *product);
int curve_room(int edges);
/* Find the curve through a foot, to rest, and up to a speed [m/s]. */
void curve_find(braking_curve *self, double place, double speed, const speed_steps *brake, const line_slopes *line,
                double most);
/* Return the place at which the curve has a speed; minus infinity if the train cannot brake from it. */
double curve_place(const braking_curve *self, double speed);
/* Return the largest error of a speed that an on-board unit may have, SUBSET-041, 5.3.1.2 [m/s]. */
double speed_error(double speed);
/* Return the speed that the train has when its brake acts after it was at a speed [m/s]. */
double limit_reached(const supervision_limit *self, double speed);
/* Return the place of the front at which the limit has a speed [m]. */
double limit_place(const supervision_limit *self, double speed);
/* Return the speed of the limit at a place, at most `most` [m/s]; 0 if no speed is permitted there. */
double limit_speed(const supervision_limit *self, double place, double most);

#endif
