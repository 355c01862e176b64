/* Linear equations of a step: LU factors of M/(gamma h) - J, and of the part of J that belongs to the algebraic states.
 *
 * The first are those of the generated elimination, without exchanges, on the places that it fills. If a pivot is almost zero,
 * and always for the second, the matrix is factorised as a dense one with row exchanges. */
#include <math.h>
#include <string.h>

#include "method.h"

/* Factorise a matrix by columns, in place; return whether it is regular. */
static bool factorise_dense(dense_factors *of) {
    const int n = of->size;
    for (int pivot = 0; pivot < n; ++pivot) {
        double *head = of->matrix + pivot * n;
        int best = pivot;
        for (int row = pivot + 1; row < n; ++row)
            if (fabs(head[row]) > fabs(head[best])) best = row;
        if (fabs(head[best]) <= PIVOT_RATIO * fabs(head[pivot])) best = pivot;
        of->pivot[pivot] = best;
        if (!(fabs(head[best]) > 0.0)) return false;
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
    return true;
}

static void solve_dense(const dense_factors *of, double *vector) {
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

/* Factorise by the generated elimination; return false if a pivot is almost zero. */
static bool factorise_sparse(const kernel *self, double *entry, const double *jacobian, double diagonal) {
    const system_description *system = self->system;
    const int n = system->states;
    double *own = self->work.ordered;
    for (int i = 0; i < n; ++i) own[i] = diagonal * self->work.differential[i];
    system->factorise(jacobian, own, entry);
    for (int i = 0; i < n; ++i)
        if (!isfinite(entry[i])) return false;
    for (int i = n; i < n + system->lower_factors; ++i)
        if (!(fabs(entry[i]) <= PIVOT_RATIO)) return false;
    return true;
}

/* In the one place for a dense matrix, in the order of elimination; other factors that were there are lost. */
static bool factorise_exchanging(kernel *self, step_factors *of, const double *jacobian, double diagonal) {
    const system_description *system = self->system;
    const int n = self->work.dense.size = system->states, *position = system->position;
    self->work.dense_owner = of;
    memset(self->work.dense.matrix, 0, (size_t)(n * n) * sizeof(double));
    for (int j = 0; j < n; ++j)
        for (int i = system->column_start[j]; i < system->column_start[j + 1]; ++i)
            self->work.dense.matrix[position[j] * n + position[system->row[i]]] = -jacobian[i];
    for (int i = 0; i < n; ++i) self->work.dense.matrix[position[i] * (n + 1)] += diagonal * self->work.differential[i];
    return factorise_dense(&self->work.dense);
}

bool linear_factorise_step(kernel *self, step_factors *of, const double *jacobian, double diagonal) {
    self->counters.factorisations++;
    of->exchanged = !factorise_sparse(self, of->packed, jacobian, diagonal);
    return !of->exchanged || factorise_exchanging(self, of, jacobian, diagonal);
}

bool linear_has_factors(const kernel *self, const step_factors *of) { return !of->exchanged || self->work.dense_owner == of; }

void linear_solve_step(kernel *self, const step_factors *of, double *vector) {
    const int n = self->system->states;
    const int *order = self->system->order;
    if (!of->exchanged) {
        self->system->substitute(of->packed, vector);
        return;
    }
    for (int i = 0; i < n; ++i) self->work.ordered[i] = vector[order[i]];
    solve_dense(&self->work.dense, self->work.ordered);
    for (int i = 0; i < n; ++i) vector[order[i]] = self->work.ordered[i];
}

bool linear_factorise_algebraic(const kernel *self, dense_factors *of, const double *jacobian) {
    const system_description *system = self->system;
    const int m = of->size = system->algebraics;
    memset(of->matrix, 0, (size_t)(m * m) * sizeof(double));
    for (int i = 0; i < system->algebraic_nonzeros; ++i)
        of->matrix[system->algebraic_place[i]] = jacobian[system->algebraic_nonzero[i]];
    return factorise_dense(of);
}

void linear_solve_algebraic(const dense_factors *of, double *vector) { solve_dense(of, vector); }

void linear_add_product(const kernel *self, const double *vector, double *sum) {
    const system_description *system = self->system;
    for (int j = 0; j < system->states; ++j)
        for (int i = system->column_start[j]; i < system->column_start[j + 1]; ++i)
            sum[system->row[i]] += self->work.jacobian[i] * vector[j];
}

void linear_write_by_rows(const kernel *self, double *matrix) {
    const system_description *system = self->system;
    const int n = system->states;
    memset(matrix, 0, (size_t)(n * n) * sizeof(double));
    for (int j = 0; j < n; ++j)
        for (int i = system->column_start[j]; i < system->column_start[j + 1]; ++i)
            matrix[system->row[i] * n + j] = self->work.jacobian[i];
}
