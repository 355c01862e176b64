/* LU factors of M diagonal - J without exchanges: the generated elimination on the places that it fills. */
#include <math.h>

#include "internal.h"

/* Largest ratio of a column's entries to the diagonal one at which the diagonal still serves as the pivot. The rows have
 * different units, so only a diagonal that is next to nothing is refused. */
INSIDE const double PIVOT_RATIO = 1e8;

int sparse_factorise(const kernel *self, factors *of, const double *jacobian, double diagonal) {
    const system_description *system = self->system;
    const int n = system->states;
    double *entry = of->packed;
    for (int i = 0; i < system->factors; ++i) entry[i] = -jacobian[system->factor_place[i]];
    for (int i = 0; i < n; ++i) entry[self->place[i]] += diagonal * self->differential[i];
    system->factorise(entry);
    for (int i = 0; i < n; ++i)
        if (!isfinite(entry[i])) return 0;
    for (int i = n; i < n + system->lower_factors; ++i)
        if (!(fabs(entry[i]) <= PIVOT_RATIO)) return 0;
    return 1;
}
