/* Functions of two numbers at once, for code of one number: a processor computes two in the time of one. Results are
 * bit-identical. */
#ifndef LANES_PAIRS_H
#define LANES_PAIRS_H

#include "lanes_widest.h"

#if LANES_WIDEST > 1
#define LANES 2
#include "lanes.h"

#define PAIR(name)                                                                                                             \
    LANES_APART real both_##name(real x) { return real_##name(x); }                                                            \
    LANES_FUNCTION void pair_##name(double x, double y, double *of_x, double *of_y) {                                          \
        const real both = both_##name((real){x, y});                                                                           \
        *of_x = both[0];                                                                                                       \
        *of_y = both[1];                                                                                                       \
    }

LANES_APART real both_sin_cos(real x, real *cosine) {
    real sine;
    real_sin_cos(x, &sine, cosine);
    return sine;
}

LANES_FUNCTION void pair_sin_cos(double x, double y, double *sin_x, double *cos_x, double *sin_y, double *cos_y) {
    real cosine;
    const real sine = both_sin_cos((real){x, y}, &cosine);
    *sin_x = sine[0];
    *sin_y = sine[1];
    *cos_x = cosine[0];
    *cos_y = cosine[1];
}
#else
#define LANES 1
#include "lanes.h"

#define PAIR(name)                                                                                                             \
    LANES_FUNCTION void pair_##name(double x, double y, double *of_x, double *of_y) {                                          \
        *of_x = real_##name(x);                                                                                                \
        *of_y = real_##name(y);                                                                                                \
    }

LANES_FUNCTION void pair_sin_cos(double x, double y, double *sin_x, double *cos_x, double *sin_y, double *cos_y) {
    real_sin_cos(x, sin_x, cos_x);
    real_sin_cos(y, sin_y, cos_y);
}
#endif

PAIR(exp)
PAIR(log)
PAIR(atan)
PAIR(tan)
PAIR(asin)
PAIR(cbrt)
#undef PAIR

#include "lanes_end.h"
#endif
