/* Results of generated functions at a place, computed for several instances together. */
#ifndef KNOWN_H
#define KNOWN_H

#include "model.h"

enum { MOST_KNOWN = 4, MOST_RESULTS = 3 };

typedef struct {
    generated_function function;
    const double *result[MOST_RESULTS]; /* null: there are no more */
    int size[MOST_RESULTS];
} known_function;

/* A place: its results are reused if state and modes are bit-identical. Numbers are `lanes` apart, from `lane` on. */
typedef struct known_place {
    int lanes, lane, functions;
    double offset;
    const double *state, *mode;
    known_function *function; /* up to MOST_KNOWN */
} known_place;

#endif
