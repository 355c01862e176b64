/* RODAS: a stiffly accurate Rosenbrock method of order 4 with an embedded method of order 3.
 *
 * Hairer and Wanner, Solving Ordinary Differential Equations II, 2nd ed. 1996, section VI.4 (method RODAS);
 * six stages, one exact Jacobian and one factorisation per step, the time derivative included.
 * Stage i solves (I/(gamma h) - J) k_i = f(t + alpha_i h, x + sum a_ij k_j) + sum c_ij k_j / h + h d_i df/dt. */
#include <math.h>

#include "kernel.h"

enum { STAGES = 6 };
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

static int factorise(double *matrix, int *pivot, int n) {
    for (int column = 0; column < n; ++column) {
        double *head = matrix + (size_t)column * (size_t)n;
        int best = column;
        for (int row = column + 1; row < n; ++row)
            if (fabs(head[row]) > fabs(head[best])) best = row;
        pivot[column] = best;
        if (!(fabs(head[best]) > 0.0)) return 0;
        if (best != column)
            for (int j = 0; j < n; ++j) {
                double *entry = matrix + (size_t)j * (size_t)n;
                const double swap = entry[column];
                entry[column] = entry[best];
                entry[best] = swap;
            }
        const double inverse = 1.0 / head[column];
        for (int row = column + 1; row < n; ++row) head[row] *= inverse;
        for (int j = column + 1; j < n; ++j) {
            double *entry = matrix + (size_t)j * (size_t)n;
            const double factor = entry[column];
            if (factor == 0.0) continue; /* many states are integrals or belong to one wheelset only */
            for (int row = column + 1; row < n; ++row) entry[row] -= factor * head[row];
        }
    }
    return 1;
}

static void solve(const double *matrix, const int *pivot, int n, double *vector) {
    for (int column = 0; column < n; ++column) {
        const double swap = vector[column];
        vector[column] = vector[pivot[column]];
        vector[pivot[column]] = swap;
    }
    for (int column = 0; column < n; ++column) {
        const double *head = matrix + (size_t)column * (size_t)n;
        const double value = vector[column];
        for (int row = column + 1; row < n; ++row) vector[row] -= value * head[row];
    }
    for (int column = n - 1; column >= 0; --column) {
        const double *head = matrix + (size_t)column * (size_t)n;
        const double value = vector[column] /= head[column];
        for (int row = 0; row < column; ++row) vector[row] -= value * head[row];
    }
}

void rosenbrock_linearise(kernel *self, double offset) {
    kernel_evaluate(self, self->system->ode, offset, self->state, self->slope, NULL);
    kernel_evaluate(self, self->system->jacobian, offset, self->state, self->jacobian, self->time_slope);
    self->counters.right_hand_sides++;
    self->counters.jacobians++;
}

double rosenbrock_try(kernel *self, double offset, double size) {
    const int n = self->system->states;
    const double diagonal = 1.0 / (GAMMA * size);
    for (int i = 0; i < n * n; ++i) self->matrix[i] = -self->jacobian[i];
    for (int i = 0; i < n; ++i) self->matrix[i * n + i] += diagonal;
    self->counters.factorisations++;
    if (!factorise(self->matrix, self->pivot, n)) return NAN;

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
            k[i] += sum / size + size * TIME_WEIGHT[stage] * self->time_slope[i];
        }
        solve(self->matrix, self->pivot, n, k);
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
