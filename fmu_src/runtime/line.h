/* The line that a vehicle runs on: a file of rows along it, read before the start and not touched afterwards. */
#ifndef LINE_H
#define LINE_H

#include "model.h"

/* What the generated functions look up, in the order of LINE_COLUMNS in system.py; then what only stands behind it. */
enum {
    LINE_HEADING,   /* rad, to the left */
    LINE_CANT,      /* sine of the track's roll: negative where the right rail is higher */
    LINE_RISE,      /* m */
    LINE_AHEAD,     /* m, place in the plan along the first heading, less LINE_AHEAD_FAR: its whole metres */
    LINE_AHEAD_FAR,
    LINE_ASIDE,     /* m, the same to the left of it */
    LINE_ASIDE_FAR,
    LINE_LEVEL, /* m, the way seen from above, in the same two parts */
    LINE_LEVEL_FAR,
    LINE_LATERAL,   /* m, of both rails, the mean */
    LINE_SPREAD,    /* m, of each rail, outwards */
    LINE_LEFT,      /* m, height of the left rail */
    LINE_RIGHT,
    LINE_LEFT_FRICTION, /* factor */
    LINE_RIGHT_FRICTION,
    LINE_FELT,      /* m, length of the shortest thing that is to be felt */
    LINE_DISTANCE,  /* m */
    LINE_CURVATURE, /* 1/m */
    LINE_GRADIENT,  /* rise over distance */
    LINE_ROWS
};

typedef struct {
    int nodes;
    unsigned long long mark; /* of its content: a saved state belongs to one line */
    double *row[LINE_ROWS];  /* null: the file has no such column */
} line_data;

enum { PROBLEM_SIZE = 400 };

INSIDE void line_free(line_data *self);
/* Heading, rise and place of each node from curvature and gradient. */
INSIDE void line_integrate(line_data *self);
/* Origin at a place, coefficients of a table's columns, and the range in which they hold; guess: of the node before it. */
INSIDE void line_look_up(const line_data *self, const table_description *table, double at, int *guess, double held[2],
                         double *coefficient);
/* The line in a file; or null, and a sentence with its row and value. */
/* A number in decimal writing, whatever the host's language. 0: it is none. */
INSIDE int line_read_number(const char *text, double *value);
INSIDE line_data *line_read(const char *path, char problem[PROBLEM_SIZE]);

#endif
