/* Linear equations of a step: LU factors of I/(gamma h) - J, and of the part of J that belongs to the algebraic states. */
#include <math.h>

#include "internal.h"

/* Largest ratio of a column's entries to the diagonal one at which the diagonal still serves as the pivot. The rows have
 * different units, so only a diagonal that is next to nothing is refused. */
static const double PIVOT_RATIO = 1e8;

typedef struct {
    const int *first, *end;
} list;

/* Rows below a pivot, or columns right of it, that may be other than zero. The lists known beforehand hold until a pivot
 * is exchanged; from there on, and where there are none, every row and column counts. */
static list entries_of(const kernel *self, const factors *of, const int *start, const int *entry, int pivot) {
    list found = {self->every + pivot + 1, self->every + of->size};
    if (pivot < of->exchanged) {
        found.first = entry + start[pivot];
        found.end = entry + start[pivot + 1];
    }
    return found;
}

static list below(const kernel *self, const factors *of, int pivot) {
    return entries_of(self, of, self->system->below_start, self->system->below, pivot);
}

static list right_of(const kernel *self, const factors *of, int pivot) {
    return entries_of(self, of, self->system->right_start, self->system->right, pivot);
}

/* Factors of of->matrix, by columns, in place. `known`: first pivot for which the system's lists do not hold. Returns 0
 * for a singular matrix. */
static int factorise(kernel *self, factors *of, int known) {
    const int n = of->size;
    of->exchanged = known;
    for (int pivot = 0; pivot < n; ++pivot) {
        double *head = of->matrix + pivot * n;
        list rows = below(self, of, pivot);
        int best = pivot;
        for (const int *row = rows.first; row < rows.end; ++row)
            if (fabs(head[*row]) > fabs(head[best])) best = *row;
        if (fabs(head[best]) <= PIVOT_RATIO * fabs(head[pivot])) best = pivot;
        of->pivot[pivot] = best;
        if (!(fabs(head[best]) > 0.0)) return 0;
        if (best != pivot) {
            for (int column = pivot; column < n; ++column) {
                double *entry = of->matrix + column * n;
                const double swap = entry[pivot];
                entry[pivot] = entry[best];
                entry[best] = swap;
            }
            if (of->exchanged > pivot) of->exchanged = pivot;
            rows = below(self, of, pivot);
        }
        const list columns = right_of(self, of, pivot);
        const double inverse = 1.0 / head[pivot];
        for (const int *row = rows.first; row < rows.end; ++row) head[*row] *= inverse;
        for (const int *column = columns.first; column < columns.end; ++column) {
            double *entry = of->matrix + *column * n;
            const double factor = entry[pivot];
            for (const int *row = rows.first; row < rows.end; ++row) entry[*row] -= factor * head[*row];
        }
    }
    return 1;
}

/* The entries of the factors one after the other in the order of their use, for the many solutions that read them. */
static void pack(const kernel *self, factors *of) {
    const int n = of->size;
    double *entry = of->packed;
    for (int pivot = 0; pivot < n; ++pivot) {
        const list rows = below(self, of, pivot);
        for (const int *row = rows.first; row < rows.end; ++row) *entry++ = of->matrix[pivot * n + *row];
    }
    for (int pivot = n - 1; pivot >= 0; --pivot) {
        const list columns = right_of(self, of, pivot);
        *entry++ = 1.0 / of->matrix[pivot * (n + 1)];
        for (const int *column = columns.first; column < columns.end; ++column)
            *entry++ = of->matrix[*column * n + pivot];
    }
}

static void solve(const kernel *self, const factors *of, double *vector) {
    const int n = of->size;
    const double *entry = of->packed;
    for (int pivot = 0; pivot < n; ++pivot) {
        const int other = of->pivot[pivot];
        const double value = vector[other];
        vector[other] = vector[pivot];
        vector[pivot] = value;
        const list rows = below(self, of, pivot);
        for (const int *row = rows.first; row < rows.end; ++row) vector[*row] -= value * *entry++;
    }
    for (int pivot = n - 1; pivot >= 0; --pivot) {
        const list columns = right_of(self, of, pivot);
        const double inverse = *entry++;
        double value = vector[pivot];
        for (const int *column = columns.first; column < columns.end; ++column) value -= *entry++ * vector[*column];
        vector[pivot] = value * inverse;
    }
}

/* Minus the Jacobian; of a matrix that was factorised without an exchange only the entries that its factors have. */
static void negate(const kernel *self, factors *of, const double *jacobian) {
    const int n = of->size;
    if (of->outside) {
        for (int i = 0; i < n * n; ++i) of->matrix[i] = -jacobian[i];
        return;
    }
    of->exchanged = n;
    for (int pivot = 0; pivot < n; ++pivot) {
        const list rows = below(self, of, pivot), columns = right_of(self, of, pivot);
        const int head = pivot * n;
        of->matrix[head + pivot] = -jacobian[head + pivot];
        for (const int *row = rows.first; row < rows.end; ++row) of->matrix[head + *row] = -jacobian[head + *row];
        for (const int *column = columns.first; column < columns.end; ++column)
            of->matrix[*column * n + pivot] = -jacobian[*column * n + pivot];
    }
}

int linear_factorise_step(kernel *self, factors *of, const double *jacobian, double diagonal) {
    const int n = of->size = self->system->states;
    negate(self, of, jacobian);
    for (int i = 0; i < n; ++i) of->matrix[self->place[i] * (n + 1)] += diagonal * self->differential[i];
    self->counters.factorisations++;
    const int regular = factorise(self, of, n);
    of->outside = of->exchanged < n;
    if (!regular) return 0;
    pack(self, of);
    return 1;
}

void linear_solve_step(kernel *self, const factors *of, double *vector) {
    const int n = self->system->states;
    const int *order = self->system->order;
    for (int i = 0; i < n; ++i) self->ordered[i] = vector[order[i]];
    solve(self, of, self->ordered);
    for (int i = 0; i < n; ++i) vector[order[i]] = self->ordered[i];
}

int linear_factorise_algebraic(kernel *self, factors *of, const double *jacobian) {
    const int n = self->system->states, m = of->size = self->system->algebraics;
    const int *algebraic = self->system->algebraic;
    for (int j = 0; j < m; ++j)
        for (int i = 0; i < m; ++i)
            of->matrix[j * m + i] = jacobian[self->place[algebraic[j]] * n + self->place[algebraic[i]]];
    if (!factorise(self, of, 0)) return 0;
    pack(self, of);
    return 1;
}

void linear_solve_algebraic(const kernel *self, const factors *of, double *vector) { solve(self, of, vector); }
