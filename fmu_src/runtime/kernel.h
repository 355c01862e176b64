/* The kernel: one simulated machine, seen as a table of variables and a step function.
 *
 * The equations are generated C (functions of the arguments below), the model is constant data,
 * and everything that changes lives in one `kernel` block, so that saving a state is a copy.
 * There are no globals besides the constant MODEL, hence any number of instances may run at once. */
#ifndef KERNEL_H
#define KERNEL_H

#include <stddef.h>

#if defined(_WIN32)
#define KERNEL_EXPORT __declspec(dllexport)
#else
#define KERNEL_EXPORT __attribute__((visibility("default")))
#endif

/* The numbers are those of fmi2Status, so that a face can pass them on unchanged. */
enum { KERNEL_OK = 0, KERNEL_WARNING = 1, KERNEL_DISCARD = 2, KERNEL_ERROR = 3 };

/* Arguments of every generated function, in this order. */
enum {
    ARG_TIME,
    ARG_STATES,
    ARG_INPUTS,
    ARG_INPUT_RATES,
    ARG_PARAMETERS,
    ARG_DERIVED,
    ARG_MODES,
    ARG_TABLES,
    ARG_SEED, /* direction (time, states, inputs) of the derivatives along it; the other functions have no such argument */
    ARG_COUNT
};
typedef int (*generated_function)(const double **argument, double **result, long long int *integer_work, double *work,
                                  int memory);

enum { KIND_REAL, KIND_INTEGER, KIND_BOOLEAN };
enum { CAUSALITY_PARAMETER, CAUSALITY_INPUT, CAUSALITY_OUTPUT, CAUSALITY_LOCAL }; /* the last: a state */

typedef struct {
    const char *name;
    const char *unit;
    int kind, causality;
    double start, minimum, maximum;
    double when_lost; /* what the equations see when a NaN arrives; NaN: a NaN is refused */
} variable_description;

/* A piecewise polynomial. Piece i holds on [breakpoint[i], breakpoint[i+1]] and is a polynomial of `degree` in
 * (argument - breakpoint[i]); outside the breakpoints the end value is held. */
typedef struct {
    int pieces, degree;
    int rank; /* tables of rank 0 have arguments without tables; rank 1 needs values of rank 0, and so on */
    const double *breakpoint;
    const double *coefficient; /* pieces x (degree + 1), lowest power first */
} table_description;

/* Dry friction on one velocity state: sliding forward (+1), backward (-1) or stuck (0). */
typedef struct {
    const char *label, *stuck_word, *sliding_word;
    int velocity; /* index of the state */
} friction_description;

typedef struct {
    const char *name;
    int states, algebraics, nonzeros, inputs, parameters, derived, frictions, outputs;
    int tables, table_ranks, table_coefficients;
    int limits;           /* states whose change within a step is limited */
    int ends, conditions; /* the conditions that end a run, and with those that only warn */
    const int *input_variable, *parameter_variable, *output_variable; /* indices into the model's variables */
    const int *state_variable;                                        /* the same; -1: an algebraic state */
    const double *nominal;                                            /* scale of each state, for the error control */
    const int *order; /* of elimination: entry i is the state that comes i-th in the linear equations */
    const int *jacobian_place; /* of each nonzero of the Jacobian in a matrix of that order, stored by columns */
    /* For each pivot, the rows below it and the columns right of it that are not zero when it is their turn. */
    const int *below_start, *below, *right_start, *right;
    const int *algebraic; /* indices of the states that a residual instead of a derivative determines */
    const int *limited;   /* indices of the states whose change within a step is limited */
    const friction_description *friction;
    const table_description *table;
    const char *const *sentence; /* of each condition; contains one %s for the time */
    /* null: not needed */
    generated_function derive, start, ode, jacobian, output, drive, capacity, condition_margin, largest_change;
    generated_function output_along, residual_along; /* derivatives of outputs and of residuals along the seed */
    const generated_function *table_argument; /* one for each rank */
} system_description;

typedef struct {
    const char *name, *guid;
    int variables, systems;
    int selector;  /* variable that chooses the system, counted from 1; -1: there is only one */
    int tolerance, integration_method, integration_step; /* variables that every model has */
    const variable_description *variable;
    const system_description *system;
} model_description;

extern const model_description MODEL;

/* What a rollback restores besides the doubles. Plain data. */
typedef struct {
    double time;
    double proposed_step;
    double kept_time, kept_until, kept_size; /* of the kept Jacobian: when it was taken, how long it serves, its step */
    double guard_said;           /* what the last warning about fixed steps was about; 0: none yet */
    int kept_steps;              /* steps that the kept Jacobian has served; -1: there is none */
    int pause;                   /* short steps before a Jacobian is kept again */
    int guard_wait;              /* steps until the stability of an explicit method is looked at again */
    int system; /* -1 before initialisation */
    int ended;  /* 1 + index of the end condition that stopped the run; 0: running */
    int outputs_stale;
} kernel_snapshot;

typedef struct {
    long long int right_hand_sides, jacobians, factorisations, steps, rejected, events;
} kernel_counters;

typedef struct {
    long long int capacity, written;
    double interval;
    int columns;
    const int *variable;
    double *buffer;
} kernel_recorder;

enum { MESSAGE_SIZE = 512, JOURNAL_SIZE = 4096, CLOCK_SIZE = 48 };

/* Values of integration_method. */
enum { METHOD_EXACT = 1, METHOD_REUSED = 2, METHOD_EXPLICIT = 3 };

enum { KEPT_NOTHING, KEPT_JACOBIAN, KEPT_FACTORS };

/* A matrix by columns and its LU factors, see linear.c. */
typedef struct {
    double *matrix, *packed;
    int *pivot;
    int size;
    int exchanged; /* first pivot that was exchanged with another row */
} factors;

typedef struct rosenbrock_tableau rosenbrock_tableau;

typedef struct kernel {
    kernel_snapshot now;
    const system_description *system;
    /* Restored by a rollback (the first `restored` doubles of `block`). */
    double *value, *input_rate, *last_rate, *state, *mode, *said, *derived;
    double *kept_state, *kept_input, *kept_mode; /* where the kept Jacobian was taken */
    size_t restored;
    /* Not restored: work space of one step. */
    double *parameter, *input, *rate, *stage_input, *coefficient, *table_at;
    double *trial, *slope, *time_slope, *nonzero, *jacobian, *kept_jacobian, *stage[6], *point, *ordered, *differential;
    /* `ordered` has room for two vectors. */
    double *between, *first_slope, *last_slope;
    double *drive, *capacity, *margin, *output, *backup, *seed, *output_rate, *largest_change;
    factors whole, algebraic, kept, kept_algebraic;
    int *place, *every; /* of the states in the order of elimination; 0, 1, 2 ... */
    int method;
    int kept_ready;    /* what there is of the kept Jacobian besides its place */
    int factors_serve; /* the factors `algebraic` are good enough for Newton's method */
    int stops_at_events, whole_steps;
    double stop_time; /* infinite: the host named none */
    char *warned; /* one flag per variable: "has no effect here" is said once */
    kernel_counters counters;
    kernel_recorder *recorder;
    double step_origin; /* time at the start of the current kernel_step; stages add an offset to it */
    char message[MESSAGE_SIZE];
    char journal[JOURNAL_SIZE]; /* lines "status sentence", drained by the face */
    size_t journal_length;
    double *block;
    int *places;
} kernel;

/* Public face, for fmi2.c and kernel.py. Status codes as above; the sentence is in kernel_message. */
KERNEL_EXPORT kernel *kernel_create(void);
KERNEL_EXPORT void kernel_free(kernel *self);
KERNEL_EXPORT void kernel_reset(kernel *self);
KERNEL_EXPORT int kernel_set(kernel *self, int variable, double value);
KERNEL_EXPORT int kernel_set_rate(kernel *self, int variable, double rate);
KERNEL_EXPORT int kernel_get(kernel *self, int variable, double *value);
/* First derivatives of outputs by time at the end of the last step, the inputs going on as they did within it. */
KERNEL_EXPORT int kernel_get_rates(kernel *self, int count, const int *variable, double *rate);
/* Derivatives of outputs along a change of inputs and states; states that are not named are held. */
KERNEL_EXPORT int kernel_get_directional(kernel *self, int unknowns, const int *unknown, int knowns, const int *known,
                                         const double *change, double *result);
KERNEL_EXPORT int kernel_initialise(kernel *self, double time);
KERNEL_EXPORT void kernel_reopen(kernel *self);
KERNEL_EXPORT int kernel_step(kernel *self, double time, double size);
/* Before initialisation, what the host plans; null: it says nothing. A tolerance that does not serve is only warned of. */
KERNEL_EXPORT int kernel_plan(kernel *self, const double *tolerance, double start, const double *stop);
/* Whether a step ends early, with OK, where a friction begins to stick or to slide; kernel_time tells where. If not, a
 * step within which the run ends is discarded, and the state is the one before it. Of a kernel that was told neither,
 * the state is the one at the end of the run. */
KERNEL_EXPORT void kernel_stop_at_events(kernel *self, int stops);
KERNEL_EXPORT int kernel_record(kernel *self, double time, double size, double interval, int columns,
                                const int *variable, double *buffer, long long int rows);
KERNEL_EXPORT size_t kernel_state_size(const kernel *self);
KERNEL_EXPORT void kernel_save(const kernel *self, void *bytes);
KERNEL_EXPORT int kernel_restore(kernel *self, const void *bytes);
KERNEL_EXPORT double kernel_time(const kernel *self);
KERNEL_EXPORT int kernel_ended(const kernel *self);
KERNEL_EXPORT const char *kernel_message(const kernel *self);
KERNEL_EXPORT const char *kernel_journal(kernel *self);
KERNEL_EXPORT void kernel_counts(const kernel *self, long long int counts[6]);
KERNEL_EXPORT int kernel_variable_count(void);
KERNEL_EXPORT const char *kernel_variable_name(int variable);
KERNEL_EXPORT int kernel_state_count(const kernel *self);
/* State, right-hand side (n values each) and Jacobian (n x n, by rows), once the algebraic states are consistent. */
KERNEL_EXPORT int kernel_linearise(kernel *self, double *state, double *slope, double *jacobian);
/* The equations for other methods, which start where the kernel stands: time goes on from there, inputs along their
 * ramps, modes as they are. Slopes of the differential states (m values) at a time and place, the algebraic states solved
 * for, and their Jacobian (m x m, by rows) unless null; */
KERNEL_EXPORT int kernel_slopes_at(kernel *self, double time, const double *place, double *slope, double *jacobian);
/* the smallest margin of modes and end conditions there: a switch is where it turns negative; */
KERNEL_EXPORT int kernel_margin_at(kernel *self, double time, const double *place, double *margin);
/* slopes, and residuals of algebraic states, of all n states, and their Jacobian (n x n, by rows) unless null. */
KERNEL_EXPORT int kernel_equations_at(kernel *self, double time, const double *state, double *slope, double *jacobian);
/* The kernel goes there and switches what has crossed; with `crossed`, what is nearest to it, if it is on this side.
 * `place` is what it is afterwards. */
KERNEL_EXPORT int kernel_arrive(kernel *self, double time, double *place, int crossed);
/* For benchmarks: call the right-hand side, the Jacobian or the step function `repeat` times at the present state. */
KERNEL_EXPORT int kernel_repeat_right_hand_side(kernel *self, long long int repeat);
KERNEL_EXPORT int kernel_repeat_jacobian(kernel *self, long long int repeat);
KERNEL_EXPORT int kernel_repeat_step(kernel *self, double time, double size, long long int repeat);

/* Inside the runtime. */
int kernel_fail(kernel *self, int status, const char *format, ...);
void kernel_note(kernel *self, int status, const char *format, ...);
/* A time in seconds for a sentence, with so many digits, and more where it has more than three before the point. */
const char *kernel_clock(double time, int digits, char text[CLOCK_SIZE]);
/* Whether a step may begin and end there. */
int kernel_check_times(kernel *self, double time, double size);
/* Says that the run ended `reached` seconds into a step that is taken back; the journal was `heard` long before it. */
int kernel_discard(kernel *self, size_t heard, double reached);
void kernel_gather_inputs(kernel *self);
void kernel_compute_outputs(kernel *self, double offset, const double *state);
/* Inputs and table pieces that hold `offset` seconds after the start of the step; and the table pieces alone. */
void kernel_locate(kernel *self, double offset, const double *state);
void kernel_look_up(kernel *self, double offset, const double *state);
/* A generated function at a place: with the inputs and table pieces located before, or locating them; with one result. */
void kernel_call(kernel *self, generated_function function, double offset, const double *state, double **result);
void kernel_evaluate_again(kernel *self, generated_function function, double offset, const double *state, double *result);
void kernel_evaluate(kernel *self, generated_function function, double offset, const double *state, double *result);
void tables_look_up(const system_description *system, int rank, const double *argument, double *coefficient);
/* Linear equations: factors of M diagonal - J, in the order of the states; and of the algebraic part of J. 0: singular. */
int linear_factorise_step(kernel *self, factors *of, const double *jacobian, double diagonal);
void linear_solve_step(kernel *self, const factors *of, double *vector);
int linear_factorise_algebraic(kernel *self, factors *of, const double *jacobian);
void linear_solve_algebraic(const kernel *self, const factors *of, double *vector);
/* Algebraic states, the others held, solved until their scaled change is below `tolerance` or round-off; all leave the
 * slopes in self->slope, and 0 means no success. Newton's method from self->jacobian, which is that of `state`; */
int algebraic_solve(kernel *self, double offset, double *state, double tolerance);
/* with given factors throughout, the old values kept where that fails; */
int algebraic_follow(kernel *self, const factors *of, double offset, double *state, double tolerance);
/* with the last factors while they serve, and otherwise with new ones. */
int algebraic_find(kernel *self, double offset, double *state, double tolerance);
/* Jacobian without algebraic states at the present state, by rows. */
int algebraic_reduce(kernel *self, double offset, double *jacobian);
/* Rosenbrock methods. The error of a trial step is in units of the tolerance; a value that is not <= 1, NaN included,
 * means "reject". The new state is in self->trial. */
extern const rosenbrock_tableau RODAS, ROS34PW2;
void rosenbrock_evaluate_jacobian(kernel *self, double offset, const double *state, double *jacobian);
void rosenbrock_linearise(kernel *self, double offset, const double *state);
int rosenbrock_factorise(kernel *self, const rosenbrock_tableau *method, factors *of, const double *jacobian, double size);
double rosenbrock_step(kernel *self, const rosenbrock_tableau *method, const factors *of, double offset, double size);
double rosenbrock_try(kernel *self, double offset, double size); /* with RODAS; linearise first */
double rosenbrock_next_size(const rosenbrock_tableau *method, double size, double error);
void rosenbrock_interpolate(const kernel *self, double fraction, double *state);
/* With ROS34PW2: a step with the kept Jacobian, made anew when it is too old or the step fails. */
double reuse_try(kernel *self, double offset, double size);
/* Keeps the Jacobian of the present state until some time; whether it serves; and a step with it, as it is. */
void reuse_remember(kernel *self, double offset, double until);
int reuse_serves(const kernel *self, double offset);
double reuse_short_step(kernel *self, double offset, double size);
double runge_kutta_try(kernel *self, double offset, double size); /* its error is 0 or NaN */
int runge_kutta_guard(kernel *self, double offset, double size);
/* The step loop, and one trial step with the chosen method. */
int integrate(kernel *self, double size, double *reached);
double integrate_try(kernel *self, double offset, double size);
/* Modes and end conditions. */
void modes_refresh(kernel *self, double offset);
double modes_margin(kernel *self, double offset, const double *state);
double modes_locate(kernel *self, double offset, double size);
int modes_switch(kernel *self, double offset, double least);
int modes_warn(kernel *self, double offset);

#endif
