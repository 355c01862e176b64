/* Mathematical functions of one number for the control of steps, bit-identical on any machine: see lanes.h. */
#ifndef OWN_FUNCTIONS_H
#define OWN_FUNCTIONS_H

#define LANES 1
#include "lanes.h"
static inline double own_exp(double x) { return real_exp(x); }
static inline double own_log(double x) { return real_log(x); }
static inline double own_pow(double x, double y) { return real_pow(x, y); }
#include "lanes_end.h"

#endif
