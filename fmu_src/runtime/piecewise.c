/* Piecewise polynomials: the look-up stays outside the generated functions, which see coefficients only. */
#include <math.h>

#include "instance.h"

static int piece_of(const table_description *table, double argument) {
    const double first = table->breakpoint[0], last = table->breakpoint[table->pieces];
    int low = 0, high = table->pieces - 1;
    const double share = (argument - first) / (last - first) * table->pieces;
    if (share > 0.0 && share < table->pieces) { /* with equal pieces the guess is right */
        const int guess = (int)share;
        if (argument >= table->breakpoint[guess]) {
            if (argument < table->breakpoint[guess + 1]) return guess;
            low = guess;
        } else {
            high = guess - 1;
        }
    }
    while (low < high) {
        int middle = (low + high + 1) / 2;
        if (argument >= table->breakpoint[middle])
            low = middle;
        else
            high = middle - 1;
    }
    return low;
}

static double polynomial(const double *coefficient, int degree, double x) {
    double value = coefficient[degree];
    for (int power = degree - 1; power >= 0; --power) value = value * x + coefficient[power];
    return value;
}

/* Origin and coefficients of a table at a place, and the range in which they hold. */
static void look_up(const table_description *table, double at, double held[2], double *coefficient) {
    const int terms = table->degree + 1, piece = piece_of(table, at);
    const double first = table->breakpoint[0], last = table->breakpoint[table->pieces];
    const double *source = table->coefficient + (size_t)piece * (size_t)terms;
    held[0] = coefficient[0] = table->breakpoint[piece];
    held[1] = table->breakpoint[piece + 1];
    for (int power = 0; power < terms; ++power) coefficient[1 + power] = source[power];
    if (!(at < first || at > last)) return; /* a NaN goes into the polynomial and comes out of it */
    held[0] = at < first ? -INFINITY : at;
    held[1] = at < first ? first : INFINITY;
    coefficient[1] = at < first ? source[0] : polynomial(source, table->degree, last - table->breakpoint[piece]);
    for (int power = 1; power < terms; ++power) coefficient[1 + power] = 0.0;
}

static void renew(kernel *self, int number, double at) {
    const table_description *table = &self->system->table[number];
    double *held = self->given.held + 2 * number, *coefficient = self->given.coefficient + table->place;
    if (table->file_pieces)
        table_look_up(self->table, table, at, &self->given.row[number], held, coefficient);
    else
        look_up(table, at, held, coefficient);
}

/* Most arguments have not left the piece that stands there. */
int tables_look_up(kernel *self, int first) {
    const system_description *system = self->system;
    int i = first;
    for (; i < system->tables && system->table[i].rank == system->table[first].rank; ++i) {
        const double at = self->given.table_at[i - first];
        if (!(at >= self->given.held[2 * i] && at < self->given.held[2 * i + 1])) renew(self, i, at);
    }
    return i;
}
