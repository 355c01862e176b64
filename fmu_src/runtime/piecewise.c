/* Piecewise polynomials: the look-up stays outside the generated functions, which see coefficients only. */
#include "internal.h"

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

/* Writes (origin, c0 ... c_degree) for each table of this rank, whose arguments are in table_at one after the other.
 * Outside its breakpoints a table holds its end value. */
void tables_look_up(kernel *self, int rank) {
    const system_description *system = self->system;
    const double *argument = self->table_at;
    double *coefficient = self->coefficient;
    for (int i = 0; i < system->tables; ++i) {
        const table_description *table = &system->table[i];
        const int terms = table->degree + 1;
        if (table->rank != rank) {
            coefficient += 1 + terms;
            continue;
        }
        const double at = *argument++;
        if (table->line >= 0) {
            line_look_up(self->line, table->line, table->degree, at, &self->line_piece[i], coefficient);
            coefficient += 1 + terms;
            continue;
        }
        const double first = table->breakpoint[0], last = table->breakpoint[table->pieces];
        const int piece = piece_of(table, at);
        const double *source = table->coefficient + (size_t)piece * (size_t)terms;
        coefficient[0] = table->breakpoint[piece];
        for (int power = 0; power < terms; ++power) coefficient[1 + power] = source[power];
        if (at < first || at > last) {
            const double width = table->breakpoint[table->pieces] - table->breakpoint[table->pieces - 1];
            coefficient[1] = at < first ? source[0] : polynomial(source, table->degree, width);
            for (int power = 1; power < terms; ++power) coefficient[1 + power] = 0.0;
        }
        coefficient += 1 + terms;
    }
}
