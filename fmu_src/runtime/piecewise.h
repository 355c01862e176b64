/* Piecewise polynomials that equations look up; lanes_table.h looks up several at once. */
#ifndef PIECEWISE_H
#define PIECEWISE_H

/* Rows (origin, c0, c1, ...) of `terms` numbers: for each piece one, between the first and the last, which hold outside. */
typedef struct {
    int pieces, terms;
    int equal; /* whether all pieces are equally wide but for round-off */
    double per_unit; /* pieces in a unit of the argument, on the mean */
    const double *row;
} piecewise;

/* Of pieces of any width. */
static inline const double *piecewise_search(const piecewise *table, double at)
{
    const int terms = table->terms;
    int low = 0, high = table->pieces + 1;
    if (at < table->row[0])
        return table->row;
    while (low + 1 < high) {
        const int middle = (low + high) / 2;
        if (at < table->row[middle * terms])
            high = middle;
        else
            low = middle;
    }
    return table->row + (at > table->row[(table->pieces + 1) * terms] ? table->pieces + 1 : low > 0 ? low : 1) * terms;
}

#endif
