/* Piecewise polynomials that equations look up; lanes_table.h looks up several at once. */
#ifndef PIECEWISE_H
#define PIECEWISE_H

#include "model.h"

/* Rows (origin, c0, c1, ...) of `terms` numbers: for each piece one, between the first and the last, which hold outside. */
typedef struct {
    int pieces, terms;
    int equal; /* whether all pieces are equally wide except for round-off */
    double per_unit; /* pieces in a unit of the argument, on the mean */
    const double *row;
} piecewise;

/* Search pieces of any width; a NaN finds the last row. */
static inline const double *piecewise_search(const piecewise *table, double at) {
    int low = 0, high = table->pieces + 2;
    while (low + 1 < high) {
        const int middle = (low + high) / 2;
        if (at < table->row[middle * table->terms]) high = middle;
        else low = middle;
    }
    return table->row + low * table->terms;
}

/* Return the row of the piece at a place. */
static inline const double *piecewise_row(const piecewise *table, double at) {
    if (!table->equal) return piecewise_search(table, at);
    double share = (at - table->row[0]) * table->per_unit;
    share = share < 0.0 ? -1.0 : share;
    share = share < table->pieces ? share : table->pieces;
    return table->row + (1 + (int)share) * table->terms;
}

#endif
