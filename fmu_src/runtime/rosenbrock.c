/* Two Rosenbrock methods, both stiffly accurate and L-stable, on systems with algebraic states.
 *
 * RODAS5P: order 5, embedded 4, eight stages, an exact Jacobian for each step; Steinebach, Construction of Rosenbrock-Wanner
 * method Rodas5P and numerical benchmarks within the Julia Differential Equations package, BIT Numerical Mathematics 63 (2023)
 * 27. The family is that of Hairer and Wanner, Solving Ordinary Differential Equations II, 2nd ed. 1996, VI.4.
 *
 * ROS34PW2: order 3, embedded 2, four stages, and both orders with any matrix in the Jacobian's place (a W-method), so that one
 * is used for many steps; Rang and Angermann, BIT Numerical Mathematics 45 (2005) 761-787.
 *
 * Stage i solves (M/(gamma h) - J) k_i = f(t + alpha_i h, x + sum a_ij k_j) + M sum c_ij k_j / h + h d_i df/dt, where M is 1
 * for states with a derivative and 0 for algebraic ones, whose f is a residual. */
#include <math.h>

#include "lanes_widest.h"
#include "method.h"
#include "own_functions.h"
#include "tableau.h"

#if LANES_WIDEST > 1
#define LANES 2
#else
#define LANES 1
#endif
#include "lanes.h"
#include "rosenbrock_stages.h"

RUNTIME_LOCAL const rosenbrock_tableau RODAS5P = {
    /* stages */ 8,
    /* gamma */ 0.21193756319429014,
    /* error_power */ 0.2,
    /* alpha */
    {0.0, 0.6358126895828704, 0.4095798393397535, 0.9769306725060716, 0.4288403609558664, 1.0, 1.0, 1.0},
    /* time_weight */
    {0.21193756319429014, -0.42387512638858027, -0.3384627126235924, 1.8046452872882734, 2.325825639765069},
    /* a */
    {{0},
     {3.0},
     {2.849394379747939, 0.45842242204463923},
     {-6.954028509809101, 2.489845061869568, -10.358996098473584},
     {2.8029986275628964, 0.5072464736228206, -0.3988312541770524, -0.04721187230404641},
     {-7.502846399306121, 2.561846144803919, -11.627539656261098, -0.18268767659942256, 0.030198172008377946},
     {-7.502846399306121, 2.561846144803919, -11.627539656261098, -0.18268767659942256, 0.030198172008377946, 1.0},
     {-7.502846399306121, 2.561846144803919, -11.627539656261098, -0.18268767659942256, 0.030198172008377946, 1.0, 1.0}},
    /* c */
    {{0},
     {-14.155112264123755},
     {-17.97296035885952, -2.859693295451294},
     {147.12150275711716, -1.41221402718213, 71.68940251302358},
     {165.43517024871676, -0.4592823456491126, 42.90938336958603, -5.961986721573306},
     {24.854864614690072, -3.0009227002832186, 47.4931110020768, 5.5814197821558125, -0.6610691825249471},
     {30.91273214028599, -3.1208243349937974, 77.79954646070892, 34.28646028294783, -19.097331116725623, -28.087943162872662},
     {37.80277123390563, -3.2571969029072276, 112.26918849496327, 66.9347231244047, -40.06618937091002, -54.66780262877968,
      -9.48861652309627}},
    /* error */ {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0},
    /* adds_one */ {false, false, false, false, false, false, true, true},
};
/* Continuous extension of RODAS5P, order 4. */
enum { BENDS = 3 };
static const double DENSE[BENDS][MOST_STAGES] = {
    {25.948786856663858, -2.5579724845846235, 10.433815404888879, -2.3679251022685204, 0.524948541321073, 1.1241088310450404,
     0.4272876194431874, -0.17202221070155493},
    {-9.91568850695171, -0.9689944594115154, 3.0438037242978453, -24.495224566215796, 20.176138334709044, 15.98066361424651,
     -6.789040303419874, -6.710236069923372},
    {11.419903575922262, 2.8879645146136994, 72.92137995996029, 80.12511834622643, -52.072871366152654, -59.78993625266729,
     -0.15582684282751913, 4.883087185713722},
};

/* Computed from the printed alpha, gamma and b; no time derivative: to a W-method zero is as good as any. */
RUNTIME_LOCAL const rosenbrock_tableau ROS34PW2 = {
    /* stages */ 4,
    /* gamma */ 0.43586652150845900,
    /* error_power */ 1.0 / 3.0,
    /* alpha */ {0.0, 0.871733043016918, 0.731579957788852, 1.0},
    /* time_weight */ {0},
    /* a */
    {{0}, {2.0}, {1.419217317455765, -0.2592322116729697}, {4.184760482319161, -0.2851920173554959, 2.294280360279042}},
    /* c */
    {{0},
     {-4.588560720558083},
     {-4.184760482319161, 0.2851920173554959},
     {-6.368179200128358, -6.795620944466837, 2.870098604331056}},
    /* error */ {0.2777499476479681, -1.403239895175999, 1.772630127667551, 0.5},
    /* adds_one */ {false},
};

void rosenbrock_evaluate_jacobian(kernel *self, double offset, const double *state, double *jacobian) {
    double *result[3] = {jacobian, self->work.time_slope, self->work.slope};
    kernel_call(self, self->system->jacobian, offset, state, result);
    self->counters.jacobians++;
}

void rosenbrock_linearise(kernel *self, double offset, const double *state) {
    kernel_locate(self, offset, state);
    rosenbrock_evaluate_jacobian(self, offset, state, self->work.jacobian);
}

bool rosenbrock_factorise(kernel *self, const rosenbrock_tableau *method, step_factors *of, const double *jacobian,
                          double size) {
    return linear_factorise_step(self, of, jacobian, 1.0 / (method->gamma * size));
}

/* A step of one instance. */
typedef struct {
    kernel *self;
    const step_factors *factors;
    double offset, size;
} own_step;

static void evaluate_stage(void *of, double alpha, const double *point, double *k) {
    const own_step *step = (const own_step *)of;
    kernel_evaluate(step->self, step->self->system->ode, step->offset + alpha * step->size, point, k);
    step->self->counters.right_hand_sides++;
}

static void solve_stage(void *of, double *k) {
    const own_step *step = (const own_step *)of;
    linear_solve_step(step->self, step->factors, k);
}

double rosenbrock_step(kernel *self, const rosenbrock_tableau *method, const step_factors *of, double offset, double size) {
    const int n = self->system->states;
    step_workspace *work = &self->work;
    own_step step = {self, of, offset, size};
    const stage_work stages = {n,           self->run.state, work->slope, work->time_slope, work->differential, work->point,
                               work->trial, work->stage,     &step,       evaluate_stage,   solve_stage};
    LANES_NAME(rosenbrock_stages)(method, &stages, real_of(size));

    const double allowed = 1.0 / self->run.value[MODEL.tolerance];
    double sum = 0.0;
    for (int i = 0; i < n; ++i) {
        double difference = 0.0;
        for (int j = 0; j < method->stages; ++j) difference += method->error[j] * work->stage[j][i];
        const double scaled = difference * allowed / self->system->nominal[i];
        sum += scaled * scaled;
    }
    return sqrt(sum / n);
}

const rosenbrock_tableau *rosenbrock_method(const kernel *self) {
    return self->work.method == METHOD_REUSED ? &ROS34PW2 : &RODAS5P;
}

double rosenbrock_try(kernel *self, const rosenbrock_tableau *method, double offset, double size) {
    if (!rosenbrock_factorise(self, method, &self->work.factors, self->work.jacobian, size)) return NAN;
    return rosenbrock_step(self, method, &self->work.factors, offset, size);
}

double rosenbrock_allowed_size(const rosenbrock_tableau *method, double size, double error) {
    return 0.9 * size * own_pow(error, -method->error_power);
}

double rosenbrock_next_size(const rosenbrock_tableau *method, double size, double error) {
    const double allowed = rosenbrock_allowed_size(method, size, error);
    if (!(allowed >= 0.2 * size)) return 0.2 * size; /* also when the error is NaN or infinite */
    return fmin(allowed, 6.0 * size);
}

void rosenbrock_interpolate(const kernel *self, double fraction, double *state) {
    const double other = 1.0 - fraction;
    for (int i = 0; i < self->system->states; ++i) {
        double bent = 0.0;
        for (int bend = BENDS - 1; bend >= 0; --bend) {
            bent *= fraction;
            for (int j = 0; j < MOST_STAGES; ++j) bent += DENSE[bend][j] * self->work.stage[j][i];
        }
        state[i] = self->run.state[i] * other + fraction * (self->work.trial[i] + other * bent);
    }
}

#include "lanes_end.h"
