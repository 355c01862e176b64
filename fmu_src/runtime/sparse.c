/* LU factors of M diagonal - J without exchanges, on the places that elimination in the given order fills. The places
 * are known beforehand, so that factors and solutions are rows of multiplications without a search. */
#include <math.h>

#include "internal.h"

/* Largest ratio of a column's entries to the diagonal one at which the diagonal still serves as the pivot. The rows have
 * different units, so only a diagonal that is next to nothing is refused. */
INSIDE const double PIVOT_RATIO = 1e8;

/* One pivot: its column below over it, its row over it after the rows below have lost their share. Returns the place
 * behind the targets that it changed, or null where another pivot must be taken. */
static const unsigned short *eliminate(const system_description *system, double *entry, int pivot,
                                       const unsigned short *target) {
    const int rows = system->below_start[pivot + 1] - system->below_start[pivot];
    double *below = entry + system->states + system->below_start[pivot];
    double largest = 0.0;
    for (int i = 0; i < rows; ++i)
        if (!(fabs(below[i]) <= largest)) largest = fabs(below[i]);
    if (!(largest <= PIVOT_RATIO * fabs(entry[pivot])) || !(fabs(entry[pivot]) > 0.0)) return NULL;
    const double inverse = entry[pivot] = 1.0 / entry[pivot];
    for (int i = 0; i < rows; ++i) below[i] *= inverse;
    for (int k = system->right_start[pivot]; k < system->right_start[pivot + 1]; ++k) {
        double *right = entry + system->right_place[k];
        const double factor = *right;
        *right *= inverse;
        for (int i = 0; i < rows; ++i) entry[target[i]] -= factor * below[i];
        target += rows;
    }
    return target;
}

int sparse_factorise(const kernel *self, factors *of, const double *jacobian, double diagonal) {
    const system_description *system = self->system;
    const int n = system->states, count = n + system->below_start[n] + system->right_start[n];
    double *entry = of->packed;
    for (int i = 0; i < count; ++i) entry[i] = -jacobian[system->factor_place[i]];
    for (int i = 0; i < n; ++i) entry[self->place[i]] += diagonal * self->differential[i];
    const unsigned short *target = system->target;
    for (int pivot = 0; pivot < n && target; ++pivot) target = eliminate(system, entry, pivot, target);
    return target != NULL;
}

/* In one run over the entries: loops of a few rows for each pivot would be mispredicted at their ends. */
static void substitute(const factor_entry *at, int count, const double *entry, double *vector) {
    for (int i = 0; i < count; ++i) vector[at[i].row] -= vector[at[i].column] * entry[i];
}

void sparse_solve(const kernel *self, const factors *of, double *vector) {
    const system_description *system = self->system;
    const int n = system->states, lower = system->below_start[n];
    substitute(system->lower, lower, of->packed + n, vector);
    for (int i = 0; i < n; ++i) vector[i] *= of->packed[i];
    substitute(system->upper, system->right_start[n], of->packed + n + lower, vector);
}
