/* A table that an instance reads from a file before the start and does not change afterwards. The model defines the meaning of
 * its columns, the columns computed from them and the polynomials between its rows: see table_file_description in model.h. */
#ifndef TABLE_FILE_H
#define TABLE_FILE_H

#include "model.h"

enum { PROBLEM_SIZE = 400, MOST_TERMS = 6, MOST_COLUMNS = 32 };

struct table_file {
    int rows;
    unsigned long long mark; /* of the content: a saved state belongs to one table */
    double *column[MOST_COLUMNS]; /* those of the description, null where missing, then those that the model adds */
};

/* Return the table in a file; NULL, with a message that shows its row and value, on error. */
RUNTIME_LOCAL table_file *table_read(const char *path, char problem[PROBLEM_SIZE]);
RUNTIME_LOCAL void table_free(table_file *self);
/* Read a number in decimal notation, in any locale of the host, and its decimal mark (0 if it has none). False if it is not a
 * number. */
RUNTIME_LOCAL bool table_read_number(const char *text, double *value, char *mark);
/* Return the origin at a place, the coefficients of the pieces that are looked up there, and their range of validity. guess:
 * the row before the previous place. */
RUNTIME_LOCAL void table_look_up(const table_file *self, const table_description *table, double at, int *guess, double held[2],
                                 double *coefficient);

/* A part of the way from a row to the next one, from `from` to `to` after the row, on which every piece is one polynomial.
 * Values are straight between rows; a corner at a row is rounded over the `rounding` of the description on either side, and
 * rows that are less than twice that apart are joined by one curve. */
struct table_part {
    int row;
    double from, to;
    double rounded; /* distance after its row over which a corner is rounded */
    bool straight;
};

enum { MOST_PARTS = 3 };

/* The parts of the way from a row to the next; how many. */
RUNTIME_LOCAL int table_parts(const table_file *self, int row, table_part part[MOST_PARTS]);
/* For the model's C: coefficients, lowest power first, from the beginning of a part on. All have room for MOST_TERMS.
 * Straight from row to row, corners too; */
RUNTIME_LOCAL void table_straight(const table_file *self, int column, const table_part *part, double *c);
/* with corners rounded, two continuous derivatives, and never outside the two rows; */
RUNTIME_LOCAL void table_smooth(const table_file *self, int column, const table_part *part, double *c);
/* the integral of a column whose corners are rounded with one continuous derivative. start: its value at the row. */
RUNTIME_LOCAL void table_integral(const table_file *self, int column, const table_part *part, double start, double *c);
/* Value, slope and bend at two places; the gain in value between them and the distance. */
RUNTIME_LOCAL void table_quintic(const double first[3], const double second[3], double gain, double distance, double *c);
RUNTIME_LOCAL double table_value(const double *c, double x);
RUNTIME_LOCAL double table_slope(const double *c, double x);

#endif
