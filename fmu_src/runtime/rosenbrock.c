/* RODAS: a stiffly accurate Rosenbrock method of order 4 with an embedded method of order 3.
 *
 * Hairer and Wanner, Solving Ordinary Differential Equations II, 2nd ed. 1996, section VI.4 (method RODAS);
 * six stages, one exact Jacobian and one factorisation per step, the time derivative included.
 * Stage i solves (M/(gamma h) - J) k_i = f(t + alpha_i h, x + sum a_ij k_j) + M sum c_ij k_j / h + h d_i df/dt, where
 * M is 1 for states with a derivative and 0 for algebraic ones, whose f is a residual. */
#include <math.h>

#include "kernel.h"

enum { STAGES = 6, MAXIMUM_NEWTON_STEPS = 20 };
static const double GAMMA = 0.25;
static const double ALPHA[STAGES] = {0.0, 0.386, 0.21, 0.63, 1.0, 1.0};
static const double TIME_WEIGHT[STAGES] = {0.25, -0.1043, 0.1035, -0.0362, 0.0, 0.0};
static const double A[STAGES][STAGES] = {
    {0},
    {1.544},
    {0.9466785280815826, 0.2557011698983284},
    {3.314825187068521, 2.896124015972201, 0.9986419139977817},
    {1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950},
    {1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950, 1.0},
};
static const double C[STAGES][STAGES] = {
    {0},
    {-5.6688},
    {-2.430093356833875, -0.2063599157091915},
    {-0.1073529058151375, -9.594562251023355, -20.47028614809616},
    {7.496443313967647, -10.24680431464352, -33.99990352819905, 11.70890893206160},
    {8.083246795921522, -7.981132988064893, -31.52159432874371, 16.31930543123136, -6.058818238834054},
};
/* Continuous extension of order 3. */
static const double DENSE[2][5] = {
    {10.12623508344586, -7.487995877610167, -34.80091861555747, -7.992771707568823, 1.025137723295662},
    {-0.6762803392806899, 6.087714651680015, 16.43084320892478, 24.76722511418386, -6.594389125716872},
};

/* Largest ratio of a column's entries to the diagonal one at which the diagonal still serves as the pivot. The rows have
 * different units, so only a diagonal that is next to nothing is refused. */
static const double PIVOT_RATIO = 1e8;
/* Scaled corrections of Newton's method below which no further progress is round-off and not divergence. */
static const double ROUND_OFF = 1e-9;

typedef struct {
    const int *first, *end;
} list;

/* Rows below a pivot, or columns right of it, that may be other than zero. The lists known beforehand hold until a pivot
 * is exchanged; from there on, and where there are none, every row and column counts. */
static list entries_of(const kernel *self, const int *start, const int *entry, int n, int pivot) {
    list found = {self->every + pivot + 1, self->every + n};
    if (pivot < self->exchanged) {
        found.first = entry + start[pivot];
        found.end = entry + start[pivot + 1];
    }
    return found;
}

static list below(const kernel *self, int n, int pivot) {
    return entries_of(self, self->system->below_start, self->system->below, n, pivot);
}

static list right_of(const kernel *self, int n, int pivot) {
    return entries_of(self, self->system->right_start, self->system->right, n, pivot);
}

/* LU factors of self->matrix, n x n by columns, in place. `exchanged`: n where the known lists hold, 0 where not. */
static int factorise(kernel *self, int n, int exchanged) {
    double *matrix = self->matrix;
    self->exchanged = exchanged;
    for (int pivot = 0; pivot < n; ++pivot) {
        double *head = matrix + pivot * n;
        list rows = below(self, n, pivot);
        int best = pivot;
        for (const int *row = rows.first; row < rows.end; ++row)
            if (fabs(head[*row]) > fabs(head[best])) best = *row;
        if (fabs(head[best]) <= PIVOT_RATIO * fabs(head[pivot])) best = pivot;
        self->pivot[pivot] = best;
        if (!(fabs(head[best]) > 0.0)) return 0;
        if (best != pivot) {
            for (int column = pivot; column < n; ++column) {
                double *entry = matrix + column * n;
                const double swap = entry[pivot];
                entry[pivot] = entry[best];
                entry[best] = swap;
            }
            if (self->exchanged > pivot) self->exchanged = pivot;
            rows = below(self, n, pivot);
        }
        const list columns = right_of(self, n, pivot);
        const double inverse = 1.0 / head[pivot];
        for (const int *row = rows.first; row < rows.end; ++row) head[*row] *= inverse;
        for (const int *column = columns.first; column < columns.end; ++column) {
            double *entry = matrix + *column * n;
            const double factor = entry[pivot];
            for (const int *row = rows.first; row < rows.end; ++row) entry[*row] -= factor * head[*row];
        }
    }
    return 1;
}

static void solve(const kernel *self, int n, double *vector) {
    for (int pivot = 0; pivot < n; ++pivot) {
        const double *head = self->matrix + pivot * n;
        const int other = self->pivot[pivot];
        const double value = vector[other];
        vector[other] = vector[pivot];
        vector[pivot] = value;
        const list rows = below(self, n, pivot);
        for (const int *row = rows.first; row < rows.end; ++row) vector[*row] -= value * head[*row];
    }
    for (int pivot = n - 1; pivot >= 0; --pivot) {
        const list columns = right_of(self, n, pivot);
        double value = vector[pivot];
        for (const int *column = columns.first; column < columns.end; ++column)
            value -= self->matrix[*column * n + pivot] * vector[*column];
        vector[pivot] = value / self->matrix[pivot * n + pivot];
    }
}

/* Solves with the factors of the whole matrix; the vector has the order of the states. */
static void solve_states(kernel *self, double *vector) {
    const int n = self->system->states;
    const int *order = self->system->order;
    for (int i = 0; i < n; ++i) self->ordered[i] = vector[order[i]];
    solve(self, n, self->ordered);
    for (int i = 0; i < n; ++i) vector[order[i]] = self->ordered[i];
}

void rosenbrock_linearise(kernel *self, double offset) {
    kernel_evaluate(self, self->system->ode, offset, self->state, self->slope, NULL);
    kernel_evaluate_again(self, self->system->jacobian, offset, self->state, self->nonzero, self->time_slope);
    for (int i = 0; i < self->system->nonzeros; ++i) self->jacobian[self->system->jacobian_place[i]] = self->nonzero[i];
    self->counters.right_hand_sides++;
    self->counters.jacobians++;
}

int rosenbrock_factorise_algebraic(kernel *self) {
    const int n = self->system->states, m = self->system->algebraics;
    const int *algebraic = self->system->algebraic;
    for (int j = 0; j < m; ++j)
        for (int i = 0; i < m; ++i)
            self->matrix[j * m + i] = self->jacobian[self->place[algebraic[j]] * n + self->place[algebraic[i]]];
    return factorise(self, m, 0);
}

void rosenbrock_solve_algebraic(const kernel *self, double *vector) { solve(self, self->system->algebraics, vector); }

int rosenbrock_make_consistent(kernel *self, double offset, double tolerance) {
    const int m = self->system->algebraics;
    const int *algebraic = self->system->algebraic;
    double *correction = self->stage[0], before = INFINITY;
    for (int count = 0; count < MAXIMUM_NEWTON_STEPS; ++count) {
        if (m == 0) return 1;
        for (int i = 0; i < m; ++i) correction[i] = -self->slope[algebraic[i]];
        if (!rosenbrock_factorise_algebraic(self)) return 0;
        rosenbrock_solve_algebraic(self, correction);
        double largest = 0.0;
        for (int i = 0; i < m; ++i) {
            const double scaled = fabs(correction[i]) / self->system->nominal[algebraic[i]];
            if (!isfinite(scaled)) return 0;
            if (scaled > largest) largest = scaled;
        }
        if (largest <= tolerance) return 1;
        if (largest < ROUND_OFF && largest > 0.5 * before) return 1;
        before = largest;
        for (int i = 0; i < m; ++i) self->state[algebraic[i]] += correction[i];
        rosenbrock_linearise(self, offset);
    }
    return 0;
}

double rosenbrock_try(kernel *self, double offset, double size) {
    const int n = self->system->states;
    const double diagonal = 1.0 / (GAMMA * size);
    for (int i = 0; i < n * n; ++i) self->matrix[i] = -self->jacobian[i];
    for (int i = 0; i < n; ++i) self->matrix[self->place[i] * (n + 1)] += diagonal * self->differential[i];
    self->counters.factorisations++;
    if (!factorise(self, n, n)) return NAN;

    for (int stage = 0; stage < STAGES; ++stage) {
        double *k = self->stage[stage];
        if (stage == 0) {
            for (int i = 0; i < n; ++i) k[i] = self->slope[i];
        } else {
            for (int i = 0; i < n; ++i) {
                double sum = self->state[i];
                for (int j = 0; j < stage; ++j) sum += A[stage][j] * self->stage[j][i];
                self->point[i] = sum;
            }
            kernel_evaluate(self, self->system->ode, offset + ALPHA[stage] * size, self->point, k, NULL);
            self->counters.right_hand_sides++;
        }
        for (int i = 0; i < n; ++i) {
            double sum = 0.0;
            for (int j = 0; j < stage; ++j) sum += C[stage][j] * self->stage[j][i];
            k[i] += self->differential[i] * sum / size + size * TIME_WEIGHT[stage] * self->time_slope[i];
        }
        solve_states(self, k);
    }

    /* The last stage is the difference of the two methods. */
    const double tolerance = self->value[MODEL.tolerance];
    double sum = 0.0;
    for (int i = 0; i < n; ++i) {
        self->trial[i] = self->point[i] + self->stage[STAGES - 1][i];
        const double scaled = self->stage[STAGES - 1][i] / (tolerance * self->system->nominal[i]);
        sum += scaled * scaled;
    }
    return sqrt(sum / n);
}

double rosenbrock_next_size(double size, double error) {
    double factor = 0.9 * pow(error, -0.25);
    if (!(factor >= 0.2)) factor = 0.2; /* also when the error is NaN or infinite */
    if (factor > 6.0) factor = 6.0;
    return size * factor;
}

void rosenbrock_interpolate(const kernel *self, double fraction, double *state) {
    for (int i = 0; i < self->system->states; ++i) {
        double bend[2] = {0.0, 0.0};
        for (int j = 0; j < 5; ++j) {
            bend[0] += DENSE[0][j] * self->stage[j][i];
            bend[1] += DENSE[1][j] * self->stage[j][i];
        }
        state[i] = self->state[i] * (1.0 - fraction) +
                   fraction * (self->trial[i] + (1.0 - fraction) * (bend[0] + fraction * bend[1]));
    }
}
