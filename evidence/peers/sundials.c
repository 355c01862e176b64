/* CVODE and IDA of SUNDIALS 7 on a kernel's equations, called from C. CVODE takes them without algebraic states, IDA
 * with them; both with the exact Jacobian. Prototypes as in the SUNDIALS manual; the libraries come from the wheel of
 * scikit-SUNDAE, which contains no headers. */
#include <math.h>
#include <stdint.h>
#include <string.h>
#include <time.h>

typedef struct kernel kernel;
typedef void *object; /* N_Vector, SUNMatrix, SUNLinearSolver, SUNContext, solver memory */

extern int SUNContext_Create(int communicator, object *context), SUNContext_Free(object *context);
extern int SUNContext_ClearErrHandlers(object context);
extern object N_VNew_Serial(int64_t length, object context), SUNDenseMatrix(int64_t rows, int64_t columns, object context);
extern object SUNLinSol_Dense(object vector, object matrix, object context);
extern double *N_VGetArrayPointer(object vector), *SUNDenseMatrix_Data(object matrix);
extern void N_VDestroy(object vector), SUNMatDestroy(object matrix);
extern int SUNLinSolFree(object solver);

typedef int (*slope_function)(double, object, object, void *);
typedef int (*slope_jacobian)(double, object, object, object, void *, object, object, object);
typedef int (*root_function)(double, object, double *, void *);
extern object CVodeCreate(int multistep, object context);
extern int CVodeInit(object memory, slope_function slope, double time, object place), CVodeSetUserData(object, void *);
extern int CVodeSVtolerances(object, double relative, object absolute), CVodeSetLinearSolver(object, object, object);
extern int CVodeSetJacFn(object, slope_jacobian), CVodeRootInit(object, int, root_function);
extern int CVodeSetMaxStep(object, double), IDASetMaxStep(object, double);
extern int CVodeSetMaxNumSteps(object, long int), CVode(object, double, object, double *, int);
extern int CVodeGetNumSteps(object, long int *), CVodeGetDky(object, double, int, object);
extern int CVodeSetStopTime(object, double), CVodeReInit(object, double, object);
extern void CVodeFree(object *);

typedef int (*residual_function)(double, object, object, object, void *);
typedef int (*residual_jacobian)(double, double, object, object, object, object, void *, object, object, object);
typedef int (*residual_root)(double, object, object, double *, void *);
extern object IDACreate(object context);
extern int IDAInit(object, residual_function, double, object, object), IDASetUserData(object, void *);
extern int IDASVtolerances(object, double, object), IDASetLinearSolver(object, object, object);
extern int IDASetJacFn(object, residual_jacobian), IDARootInit(object, int, residual_root);
extern int IDASetMaxNumSteps(object, long int), IDASolve(object, double, double *, object, object, int);
extern int IDAGetNumSteps(object, long int *), IDASetInitStep(object, double), IDAGetDky(object, double, int, object);
extern int IDASetStopTime(object, double), IDAReInit(object, double, object, object);
extern void IDAFree(object *);

enum { BDF = 2, ONE_STEP = 2, ROOT_RETURN = 2, MOST_STEPS = 2000000, MISSED = -1000 };
/* A margin is at zero directly after a switch; below this value a switch has been passed. */
static const double PASSED = 1e-6;
static const double FIRST_STEP = 1e-6; /* s; the error control takes over */

/* A run from `time` to `end`; samples every `interval` s from time 0. */
typedef struct {
    kernel *machine;
    int (*slopes_at)(kernel *, double, const double *, double *, double *);
    int (*equations_at)(kernel *, double, const double *, double *, double *);
    int (*margin_at)(kernel *, double, const double *, double *);
    int size;             /* of `place`: the differential states for CVODE, all for IDA */
    int differentials;    /* number of differential states */
    const int *chosen;    /* IDA: indices of the differential states */
    const double *inertia; /* IDA: 1 for a differential state, else 0 */
    double time, end, interval, tolerance, longest_step;
    const double *nominal;
    double *place, *slope; /* present state; IDA: its derivatives */
    double *samples;       /* `capacity` rows of `size` */
    long int written, capacity;
    int rooted; /* the last advance ended at a switch */
    long int slopes, jacobians, steps;
    double deadline; /* seconds since 1970 at which the run is given up */
    object context, memory, vector, rate, spare, absolute, matrix, solver;
} run;

static int is_late(const run *of) {
    struct timespec now;
    timespec_get(&now, TIME_UTC);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec > of->deadline;
}

static int cvode_slope(double time, object place, object slope, void *user) {
    run *of = user;
    of->slopes++;
    return of->slopes_at(of->machine, time, N_VGetArrayPointer(place), N_VGetArrayPointer(slope), 0) > 1;
}

/* SUNDIALS stores by columns. */
static void transpose(int n, double *rows) {
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < i; ++j) {
            const double swap = rows[i * n + j];
            rows[i * n + j] = rows[j * n + i];
            rows[j * n + i] = swap;
        }
}

static int cvode_jacobian(double time, object place, object slope, object matrix, void *user, object a, object b, object c) {
    run *of = user;
    (void)slope, (void)b, (void)c;
    double *rows = SUNDenseMatrix_Data(matrix), *spare = N_VGetArrayPointer(a);
    of->jacobians++;
    if (of->slopes_at(of->machine, time, N_VGetArrayPointer(place), spare, rows) > 1) return 1;
    transpose(of->size, rows);
    return 0;
}

static int cvode_root(double time, object place, double *margin, void *user) {
    run *of = user;
    return of->margin_at(of->machine, time, N_VGetArrayPointer(place), margin) > 1;
}

static int ida_residual(double time, object place, object rate, object residual, void *user) {
    run *of = user;
    double *result = N_VGetArrayPointer(residual), *slope = N_VGetArrayPointer(rate);
    of->slopes++;
    if (of->equations_at(of->machine, time, N_VGetArrayPointer(place), result, 0) > 1) return 1;
    for (int i = 0; i < of->size; ++i) {
        result[i] -= of->inertia[i] * slope[i];
        if (!(result[i] - result[i] == 0.0)) return 1;
    }
    return 0;
}

static int ida_jacobian(double time, double factor, object place, object rate, object residual, object matrix, void *user,
                        object a, object b, object c) {
    run *of = user;
    const int n = of->size;
    double *rows = SUNDenseMatrix_Data(matrix);
    (void)rate, (void)residual, (void)b, (void)c;
    of->jacobians++;
    if (of->equations_at(of->machine, time, N_VGetArrayPointer(place), N_VGetArrayPointer(a), rows) > 1) return 1;
    transpose(n, rows);
    for (int i = 0; i < n; ++i) rows[i * (n + 1)] -= factor * of->inertia[i];
    return 0;
}

static int ida_root(double time, object place, object rate, double *margin, void *user) {
    run *of = user;
    double some[256];
    (void)rate;
    for (int i = 0; i < of->differentials; ++i) some[i] = N_VGetArrayPointer(place)[of->chosen[i]];
    return of->margin_at(of->machine, time, some, margin) > 1;
}

typedef int (*interpolation)(object, double, int, object);

static void sample(run *of, object memory, interpolation between, object spare) {
    while (of->written < of->capacity && (double)of->written * of->interval <= of->time + 1e-12) {
        if (between(memory, (double)of->written * of->interval, 0, spare) != 0) return;
        memcpy(of->samples + of->written * of->size, N_VGetArrayPointer(spare), (size_t)of->size * sizeof(double));
        of->written++;
    }
}

static object vector_of(const run *of, const double *values, double factor) {
    object made = N_VNew_Serial(of->size, of->context);
    for (int i = 0; i < of->size; ++i) N_VGetArrayPointer(made)[i] = values ? factor * values[i] : 0.0;
    return made;
}

static void open_common(run *of) {
    SUNContext_Create(0, &of->context);
    SUNContext_ClearErrHandlers(of->context);
    of->vector = vector_of(of, of->place, 1.0);
    of->rate = vector_of(of, of->slope, 1.0);
    of->spare = vector_of(of, 0, 0.0);
    of->absolute = vector_of(of, of->nominal, of->tolerance);
    of->matrix = SUNDenseMatrix(of->size, of->size, of->context);
    of->solver = SUNLinSol_Dense(of->vector, of->matrix, of->context);
}

static void close_common(run *of) {
    SUNLinSolFree(of->solver);
    SUNMatDestroy(of->matrix);
    N_VDestroy(of->vector);
    N_VDestroy(of->rate);
    N_VDestroy(of->spare);
    N_VDestroy(of->absolute);
    SUNContext_Free(&of->context);
}

void cvode_open(run *of) {
    open_common(of);
    of->memory = CVodeCreate(BDF, of->context);
    CVodeInit(of->memory, cvode_slope, of->time, of->vector);
    CVodeSetUserData(of->memory, of);
    CVodeSVtolerances(of->memory, 0.0, of->absolute);
    CVodeSetLinearSolver(of->memory, of->solver, of->matrix);
    CVodeSetJacFn(of->memory, cvode_jacobian);
    CVodeRootInit(of->memory, 1, cvode_root);
    CVodeSetMaxNumSteps(of->memory, MOST_STEPS);
    if (isfinite(of->longest_step)) CVodeSetMaxStep(of->memory, of->longest_step);
}

/* CVODE's root search once missed a switch at a tolerance of 1e-10 without an error; at other tolerances it found
   it. */
static int has_passed_a_switch(run *of) {
    double margin = 0.0;
    return !of->rooted && !cvode_root(of->time, of->vector, &margin, of) && margin < -PASSED;
}

/* Restarts at of->place and of->time and runs to of->end or to a switch. Returns SUNDIALS's flag; negative: failed. */
int cvode_advance(run *of) {
    memcpy(N_VGetArrayPointer(of->vector), of->place, (size_t)of->size * sizeof(double));
    CVodeReInit(of->memory, of->time, of->vector);
    CVodeSetStopTime(of->memory, of->end);
    int flag = 0;
    long int steps = 0;
    for (of->rooted = 0; of->time < of->end && !of->rooted && steps < MOST_STEPS;) {
        flag = CVode(of->memory, of->end, of->vector, &of->time, ONE_STEP);
        if (flag < 0) break;
        of->rooted = flag == ROOT_RETURN;
        sample(of, of->memory, CVodeGetDky, of->spare);
        if (is_late(of)) break;
        CVodeGetNumSteps(of->memory, &steps);
    }
    of->steps += steps;
    memcpy(of->place, N_VGetArrayPointer(of->vector), (size_t)of->size * sizeof(double));
    return has_passed_a_switch(of) ? MISSED : flag;
}

void cvode_close(run *of) {
    CVodeFree(&of->memory);
    close_common(of);
}

/* Simulates a host that sets two inputs at each communication step: with our kernel, and with CVODE, which must restart
 * each time. Returns 0, or the flag of the failure. */
int own_hosted(run *of, int (*set)(kernel *, int, double), int (*step)(kernel *, double, double), const int *input,
               const double *value, long int steps, double size) {
    for (long int i = 0; i < steps; ++i) {
        if (set(of->machine, input[0], value[i]) > 1 || set(of->machine, input[1], value[i]) > 1) return 1;
        if (step(of->machine, (double)i * size, size) > 1) return 2;
    }
    return 0;
}

int cvode_hosted(run *of, int (*set)(kernel *, int, double), int (*arrive)(kernel *, double, double *, int), const int *input,
                 const double *value, long int steps, double size) {
    for (long int i = 0; i < steps; ++i) {
        if (set(of->machine, input[0], value[i]) > 1 || set(of->machine, input[1], value[i]) > 1) return 1;
        of->end = (double)(i + 1) * size;
        if (cvode_advance(of) < 0 || arrive(of->machine, of->time, of->place, of->rooted) > 1) return 2;
    }
    return 0;
}

void ida_open(run *of) {
    open_common(of);
    of->memory = IDACreate(of->context);
    IDAInit(of->memory, ida_residual, of->time, of->vector, of->rate);
    IDASetUserData(of->memory, of);
    IDASVtolerances(of->memory, 0.0, of->absolute);
    IDASetLinearSolver(of->memory, of->solver, of->matrix);
    IDASetJacFn(of->memory, ida_jacobian);
    IDARootInit(of->memory, 1, ida_root);
    IDASetMaxNumSteps(of->memory, MOST_STEPS);
    if (isfinite(of->longest_step)) IDASetMaxStep(of->memory, of->longest_step);
}

/* The same; of->slope holds the derivatives at of->place. */
int ida_advance(run *of) {
    memcpy(N_VGetArrayPointer(of->vector), of->place, (size_t)of->size * sizeof(double));
    memcpy(N_VGetArrayPointer(of->rate), of->slope, (size_t)of->size * sizeof(double));
    IDAReInit(of->memory, of->time, of->vector, of->rate);
    IDASetStopTime(of->memory, of->end);
    IDASetInitStep(of->memory, of->end - of->time < FIRST_STEP ? of->end - of->time : FIRST_STEP);
    int flag = 0;
    long int steps = 0;
    for (of->rooted = 0; of->time < of->end && !of->rooted && steps < MOST_STEPS;) {
        flag = IDASolve(of->memory, of->end, &of->time, of->vector, of->rate, ONE_STEP);
        if (flag < 0) break;
        of->rooted = flag == ROOT_RETURN;
        sample(of, of->memory, IDAGetDky, of->spare);
        if (is_late(of)) break;
        IDAGetNumSteps(of->memory, &steps);
    }
    of->steps += steps;
    memcpy(of->place, N_VGetArrayPointer(of->vector), (size_t)of->size * sizeof(double));
    return flag;
}

void ida_close(run *of) {
    IDAFree(&of->memory);
    close_common(of);
}
