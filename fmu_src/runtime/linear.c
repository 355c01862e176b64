/* Linear equations of a step: LU factors of M/(gamma h) - J, and of the part of J that belongs to the algebraic states.
 *
 * The first come from sparse.c; where a pivot there is next to nothing, and for the second, all entries count and rows
 * are exchanged. */
#include <math.h>

#include "internal.h"

/* Factors of of->matrix, by columns, in place. Returns 0 for a singular matrix. */
static int factorise(factors *of) {
    const int n = of->size;
    for (int pivot = 0; pivot < n; ++pivot) {
        double *head = of->matrix + pivot * n;
        int best = pivot;
        for (int row = pivot + 1; row < n; ++row)
            if (fabs(head[row]) > fabs(head[best])) best = row;
        if (fabs(head[best]) <= PIVOT_RATIO * fabs(head[pivot])) best = pivot;
        of->pivot[pivot] = best;
        if (!(fabs(head[best]) > 0.0)) return 0;
        for (int column = pivot; column < n && best != pivot; ++column) {
            double *entry = of->matrix + column * n;
            const double swap = entry[pivot];
            entry[pivot] = entry[best];
            entry[best] = swap;
        }
        const double inverse = 1.0 / head[pivot];
        for (int row = pivot + 1; row < n; ++row) head[row] *= inverse;
        for (int column = pivot + 1; column < n; ++column) {
            double *entry = of->matrix + column * n;
            const double factor = entry[pivot];
            if (factor == 0.0) continue;
            for (int row = pivot + 1; row < n; ++row) entry[row] -= factor * head[row];
        }
    }
    return 1;
}

static void solve(const factors *of, double *vector) {
    const int n = of->size;
    for (int pivot = 0; pivot < n; ++pivot) {
        const int other = of->pivot[pivot];
        const double value = vector[other], *head = of->matrix + pivot * n;
        vector[other] = vector[pivot];
        vector[pivot] = value;
        for (int row = pivot + 1; row < n; ++row) vector[row] -= value * head[row];
    }
    for (int pivot = n - 1; pivot >= 0; --pivot) {
        const double *head = of->matrix + pivot * n;
        const double value = vector[pivot] / head[pivot];
        vector[pivot] = value;
        for (int row = 0; row < pivot; ++row) vector[row] -= value * head[row];
    }
}

int linear_factorise_step(kernel *self, factors *of, const double *jacobian, double diagonal) {
    const int n = of->size = self->system->states;
    self->counters.factorisations++;
    of->sparse = sparse_factorise(self, of, jacobian, diagonal);
    if (of->sparse) return 1;
    for (int i = 0; i < n * n; ++i) of->matrix[i] = -jacobian[i];
    for (int i = 0; i < n; ++i) of->matrix[self->place[i] * (n + 1)] += diagonal * self->differential[i];
    return factorise(of);
}

void linear_solve_step(kernel *self, const factors *of, double *vector) {
    const int n = self->system->states;
    const int *order = self->system->order;
    if (of->sparse) {
        self->system->substitute(of->packed, vector);
        return;
    }
    for (int i = 0; i < n; ++i) self->ordered[i] = vector[order[i]];
    solve(of, self->ordered);
    for (int i = 0; i < n; ++i) vector[order[i]] = self->ordered[i];
}

int linear_factorise_algebraic(kernel *self, factors *of, const double *jacobian) {
    const int n = self->system->states, m = of->size = self->system->algebraics;
    const int *algebraic = self->system->algebraic;
    for (int j = 0; j < m; ++j)
        for (int i = 0; i < m; ++i)
            of->matrix[j * m + i] = jacobian[self->place[algebraic[j]] * n + self->place[algebraic[i]]];
    return factorise(of);
}

void linear_solve_algebraic(const factors *of, double *vector) { solve(of, vector); }
