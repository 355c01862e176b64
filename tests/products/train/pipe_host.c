/* Test program for all functions of a pipe. Exit status: 0 if they work. */
#include <math.h>
#include <stdlib.h>

#include "pipe.h"

int main(void) {
    for (int cells = 1; cells < 40; cells += 7) {
        double *state = malloc(sizeof(double) * (size_t)(3 * cells)), *given = malloc(sizeof(double) * (size_t)(8 * cells));
        const double constants[] = {7.5, 0.03, 293.15, 1.0, 1.0, 1e-7, 101325.0, 0.5}, air[] = {6.0, 0.0, 1.25e6};
        for (int i = 0; i < 3 * cells; ++i) state[i] = air[i / cells];
        for (int i = 0; i < 8 * cells; ++i) given[i] = constants[i / cells];
        pipe *self = pipe_create(cells, state, given);
        if (!self) return 1;
        const pipe_outside open = {4e-4, 7e-4, 101325.0, 293.15}, wrong = {4e-4, 7e-4, NAN, 293.15};
        pipe_end(self, 0, &open);
        if (pipe_advance(self, 2.0, 0.8) <= 0) return 2;
        pipe_end(self, 1, &wrong);
        if (pipe_advance(self, 2.0, 0.8) != -1) return 3;
        pipe_state(self, state);
        if (!(state[0] > 0.0 && pipe_has_passed(self)->leak_mass > 0.0)) return 4;
        pipe_free(self);
        free(state);
        free(given);
    }
    pipe_free(NULL);
    return 0;
}
