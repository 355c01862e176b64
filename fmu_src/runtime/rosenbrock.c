/* Two Rosenbrock methods, both stiffly accurate and L-stable, on systems with algebraic states.
 *
 * RODAS: order 4, embedded 3, six stages, an exact Jacobian for each step; Hairer and Wanner, Solving Ordinary
 * Differential Equations II, 2nd ed. 1996, section VI.4.
 * ROS34PW2: order 3, embedded 2, four stages, and both orders with any matrix in the Jacobian's place (a W-method), so
 * that one serves many steps; Rang and Angermann, BIT Numerical Mathematics 45 (2005) 761-787.
 *
 * Stage i solves (M/(gamma h) - J) k_i = f(t + alpha_i h, x + sum a_ij k_j) + M sum c_ij k_j / h + h d_i df/dt, where
 * M is 1 for states with a derivative and 0 for algebraic ones, whose f is a residual. */
#include <math.h>

#include "internal.h"

enum { MOST_STAGES = 6 };

struct rosenbrock_tableau {
    int stages;
    double gamma;
    double error_power; /* of the embedded method's error, for the choice of the next step */
    double alpha[MOST_STAGES], time_weight[MOST_STAGES];
    double a[MOST_STAGES][MOST_STAGES], c[MOST_STAGES][MOST_STAGES];
    double error[MOST_STAGES]; /* weights of the stages in the difference of the two methods */
};

INSIDE const rosenbrock_tableau RODAS = {
    /* stages */ 6,
    /* gamma */ 0.25,
    /* error_power */ 0.25,
    /* alpha */ {0.0, 0.386, 0.21, 0.63, 1.0, 1.0},
    /* time_weight */ {0.25, -0.1043, 0.1035, -0.0362, 0.0, 0.0},
    /* a */
    {{0},
     {1.544},
     {0.9466785280815826, 0.2557011698983284},
     {3.314825187068521, 2.896124015972201, 0.9986419139977817},
     {1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950},
     {1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950, 1.0}},
    /* c */
    {{0},
     {-5.6688},
     {-2.430093356833875, -0.2063599157091915},
     {-0.1073529058151375, -9.594562251023355, -20.47028614809616},
     {7.496443313967647, -10.24680431464352, -33.99990352819905, 11.70890893206160},
     {8.083246795921522, -7.981132988064893, -31.52159432874371, 16.31930543123136, -6.058818238834054}},
    /* error */ {0.0, 0.0, 0.0, 0.0, 0.0, 1.0},
};
/* Continuous extension of RODAS, order 3. */
static const double DENSE[2][5] = {
    {10.12623508344586, -7.487995877610167, -34.80091861555747, -7.992771707568823, 1.025137723295662},
    {-0.6762803392806899, 6.087714651680015, 16.43084320892478, 24.76722511418386, -6.594389125716872},
};

/* Computed from the printed alpha, gamma and b; no time derivative: to a W-method zero is as good as any. */
INSIDE const rosenbrock_tableau ROS34PW2 = {
    /* stages */ 4,
    /* gamma */ 0.43586652150845900,
    /* error_power */ 1.0 / 3.0,
    /* alpha */ {0.0, 0.871733043016918, 0.731579957788852, 1.0},
    /* time_weight */ {0},
    /* a */
    {{0},
     {2.0},
     {1.419217317455765, -0.2592322116729697},
     {4.184760482319161, -0.2851920173554959, 2.294280360279042}},
    /* c */
    {{0},
     {-4.588560720558083},
     {-4.184760482319161, 0.2851920173554959},
     {-6.368179200128358, -6.795620944466837, 2.870098604331056}},
    /* error */ {0.2777499476479681, -1.403239895175999, 1.772630127667551, 0.5},
};

void rosenbrock_evaluate_jacobian(kernel *self, double offset, const double *state, double *jacobian) {
    double *result[3] = {self->nonzero, self->time_slope, self->slope};
    kernel_call(self, self->system->jacobian, offset, state, result);
    for (int i = 0; i < self->system->nonzeros; ++i) jacobian[self->system->jacobian_place[i]] = self->nonzero[i];
    self->counters.jacobians++;
}

void rosenbrock_linearise(kernel *self, double offset, const double *state) {
    kernel_locate(self, offset, state);
    rosenbrock_evaluate_jacobian(self, offset, state, self->jacobian);
}

int rosenbrock_factorise(kernel *self, const rosenbrock_tableau *method, factors *of, const double *jacobian, double size) {
    return linear_factorise_step(self, of, jacobian, 1.0 / (method->gamma * size));
}

double rosenbrock_step(kernel *self, const rosenbrock_tableau *method, const factors *of, double offset, double size) {
    const int n = self->system->states, stages = method->stages;
    const double inverse = 1.0 / size;
    for (int stage = 0; stage < stages; ++stage) {
        double *k = self->stage[stage];
        if (stage == 0) {
            for (int i = 0; i < n; ++i) k[i] = self->slope[i];
        } else {
            for (int i = 0; i < n; ++i) self->point[i] = self->state[i];
            for (int j = 0; j < stage; ++j) {
                const double weight = method->a[stage][j];
                for (int i = 0; i < n; ++i) self->point[i] += weight * self->stage[j][i];
            }
            kernel_evaluate(self, self->system->ode, offset + method->alpha[stage] * size, self->point, k);
            self->counters.right_hand_sides++;
            for (int j = 0; j < stage; ++j) {
                const double weight = method->c[stage][j] * inverse;
                for (int i = 0; i < n; ++i) k[i] += self->differential[i] * weight * self->stage[j][i];
            }
        }
        const double along_time = size * method->time_weight[stage];
        if (along_time != 0.0)
            for (int i = 0; i < n; ++i) k[i] += along_time * self->time_slope[i];
        linear_solve_step(self, of, k);
    }

    const double allowed = 1.0 / self->value[MODEL.tolerance];
    double sum = 0.0;
    for (int i = 0; i < n; ++i) {
        self->trial[i] = self->point[i] + self->stage[stages - 1][i];
        double difference = 0.0;
        for (int j = 0; j < stages; ++j) difference += method->error[j] * self->stage[j][i];
        const double scaled = difference * allowed / self->system->nominal[i];
        sum += scaled * scaled;
    }
    return sqrt(sum / n);
}

double rosenbrock_try(kernel *self, double offset, double size) {
    if (!rosenbrock_factorise(self, &RODAS, &self->whole, self->jacobian, size)) return NAN;
    return rosenbrock_step(self, &RODAS, &self->whole, offset, size);
}

double rosenbrock_next_size(const rosenbrock_tableau *method, double size, double error) {
    double factor = 0.9 * pow(error, -method->error_power);
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
