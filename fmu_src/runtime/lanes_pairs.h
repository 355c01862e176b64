/* A function of two numbers at once, for code of one number: a processor computes two in the time of one. Same bits. */
#ifndef LANES_PAIRS_H
#define LANES_PAIRS_H

#include "lanes_widest.h"

#if LANES_WIDEST > 1
#define LANES 2
#else
#define LANES 1
#endif
#include "lanes.h"

enum { PAIR_STEP = LANES };

#define PAIR(name) \
    LANES_APART void pair_##name(double x, double y, double *of_x, double *of_y) \
    { \
        double two[2] = {x, y}; \
        for (int i = 0; i < 2; i += PAIR_STEP) \
            real_store(two + i, real_##name(real_load(two + i))); \
        *of_x = two[0]; \
        *of_y = two[1]; \
    }
PAIR(exp)
PAIR(log)
PAIR(atan)
PAIR(tan)
PAIR(asin)
PAIR(cbrt)
#undef PAIR

LANES_APART void pair_sin_cos(double x, double y, double *sin_x, double *cos_x, double *sin_y, double *cos_y)
{
    double two[2] = {x, y}, sines[2], cosines[2];
    for (int i = 0; i < 2; i += PAIR_STEP) {
        real sine, cosine;
        real_sin_cos(real_load(two + i), &sine, &cosine);
        real_store(sines + i, sine);
        real_store(cosines + i, cosine);
    }
    *sin_x = sines[0];
    *sin_y = sines[1];
    *cos_x = cosines[0];
    *cos_y = cosines[1];
}

#include "lanes_end.h"
#endif
