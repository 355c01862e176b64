/* The inside of the kernel: what changes during a run, and what the files of the runtime ask of each other. */
#ifndef INTERNAL_H
#define INTERNAL_H

#include "kernel.h"
#include "table_file.h"

/* What a rollback restores besides the doubles. Plain data. */
typedef struct {
    double time;
    double proposed_step;
    double kept_time, kept_until, kept_size; /* of the kept Jacobian: when it was taken, how long it serves, its step */
    unsigned long long table;    /* mark of the table file; 0: there is none */
    double switched, reluctance; /* model exchange: when something switched last, and what that leaves, see modes.c */
    double guard_said;           /* what the last warning about fixed steps was about; 0: none yet */
    int kept_steps;              /* steps that the kept Jacobian has served; -1: there is none */
    int pause;                   /* short steps before a Jacobian is kept again */
    int switches;                /* steps that ended in a switch, less those that did not */
    int guard_wait;              /* steps until the stability of an explicit method is looked at again */
    int system; /* -1 before initialisation */
    int ended;  /* 1 + index of the end condition that stopped the run; 0: running */
    int outputs_stale;
    int inputs_jumped; /* model exchange: an input was set to another value since modes were found last */
} kernel_snapshot;

typedef struct {
    long long int capacity, written;
    double interval;
    int columns;
    const int *variable;
    double *buffer;
} kernel_recorder;

enum { JOURNAL_SIZE = 8192, CLOCK_SIZE = 48, MOST_STAGES = 8 };
enum { MOST_TRIALS = 5000000 }; /* steps tried in one kernel_step; a run that needs more is stuck */

/* Values of integration_method. */
enum { METHOD_EXACT = 1, METHOD_REUSED = 2, METHOD_EXPLICIT = 3 };

enum { KEPT_NOTHING, KEPT_JACOBIAN, KEPT_FACTORS };

/* LU factors of a matrix by columns, in place, with exchanged rows. */
typedef struct {
    double *matrix;
    int *pivot;
    int size;
} dense_factors;

/* LU factors of a step's matrix: those of the generated elimination, or with exchanges, in the instance's dense matrix. */
typedef struct {
    double *packed;
    bool exchanged;
} step_factors;

typedef struct rosenbrock_tableau rosenbrock_tableau;

struct kernel {
    kernel_snapshot now;
    const system_description *system;
    /* Restored by a rollback (the first `restored` doubles of `block`). */
    double *value, *input_rate, *last_rate, *state, *mode, *said, *derived;
    double *kept_state, *kept_input, *kept_mode; /* where the kept Jacobian was taken */
    size_t restored;
    /* Not restored: work space of one step. */
    double *parameter, *input, *rate, *stage_input, *coefficient, *table_at;
    double *held; /* for each table, the range of its argument in which `coefficient` holds: from, and below */
    double *trial, *slope, *time_slope, *jacobian, *kept_jacobian, *stage[MOST_STAGES], *point, *ordered;
    double *differential;
    /* Of the host's integrator: where its step began, the slopes there and how they differ from those before. */
    double *host_state, *host_slope, *host_change, *host_growth, host_time; /* growth: room for two matrices */
    int host_slope_known, host_steps; /* steps in a row that were those of Euler's method */
    double *place_read; /* where outputs and derivatives are read that have algebraic states */
    /* `ordered` has room for two vectors. */
    double *between, *first_slope, *last_slope;
    double *drive, *capacity, *still, *margin, *output, *backup, *seed, *output_rate, *largest_change;
    step_factors whole, kept;
    dense_factors algebraic, kept_algebraic;
    dense_factors dense; /* the one place for a step's matrix whose rows are exchanged, and whose factors it holds */
    const step_factors *dense_owner;
    table_file *table; /* null: none */
    char *table_path;
    int *row; /* for each table that is looked up in the file, the row before the place where that was last */
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
    char journal[JOURNAL_SIZE]; /* records: a byte of status, a sentence, a zero; the newest are kept */
    char told_of_loss[80];
    size_t journal_length, heard;   /* its end, and the place behind the last record that was heard */
    unsigned long long noted, lost; /* records since the start, and those that nobody heard in time */
    double *block;
    int *places;
};

/* Sentences: into the journal; and kernel_message as well, for a status, which is returned. */
INSIDE void kernel_note(kernel *self, int status, const char *format, ...) LIKE_PRINTF(3);
INSIDE int kernel_fail(kernel *self, int status, const char *format, ...) LIKE_PRINTF(3);
/* As kernel_fail, with a model's sentence: no format, but with a time in place of its first %s. */
INSIDE int kernel_say_when(kernel *self, int status, const char *sentence, const char *when);
/* Forgets what was noted since there were `noted` records. */
INSIDE void kernel_take_back(kernel *self, unsigned long long noted);
/* A time in seconds for a sentence, with so many digits, and more where it has more than three before the point. */
INSIDE const char *kernel_clock(double time, int digits, char text[CLOCK_SIZE]);
/* Variables: a status, with the sentence. */
INSIDE int kernel_check_reference(kernel *self, int variable);
INSIDE const char *kernel_name_of_table_file(void);
INSIDE int kernel_check_value(kernel *self, const variable_description *variable, double value, double kept);
INSIDE int kernel_warn_without_effect(kernel *self, int variable);
INSIDE int kernel_warn_of_idle_parameters(kernel *self);
/* Whether a step may begin and end there. */
INSIDE int kernel_check_times(kernel *self, double time, double size);
/* Says that the run ended `reached` seconds into a step that is taken back; there were `noted` records before it. */
INSIDE int kernel_discard(kernel *self, unsigned long long noted, double reached);
INSIDE void kernel_leave_table(kernel *self);
/* Sets what follows from the chosen system and the parameters and is not restored with them. */
INSIDE void kernel_enter_system(kernel *self);
INSIDE void kernel_gather_inputs(kernel *self);
INSIDE void kernel_compute_outputs(kernel *self, double offset, const double *state);
/* First output that is not a finite number, or null. */
INSIDE const char *kernel_output_not_finite(const kernel *self);
/* Inputs and table pieces that hold `offset` seconds after the start of the step; and the table pieces alone. */
INSIDE void kernel_locate(kernel *self, double offset, const double *state);
INSIDE void kernel_look_up(kernel *self, double offset, const double *state);
/* A generated function at a place: with the inputs and table pieces located before, or locating them; with one result. */
INSIDE void kernel_call(kernel *self, generated_function function, double offset, const double *state, double **result);
INSIDE void kernel_evaluate_again(kernel *self, generated_function function, double offset, const double *state,
                                  double *result);
INSIDE void kernel_evaluate(kernel *self, generated_function function, double offset, const double *state,
                            double *result);
/* Writes (origin, c0 ... c_degree) of the tables from `first` on that are of its rank, whose arguments are in table_at.
 * Returns the first of the next rank. */
INSIDE int tables_look_up(kernel *self, int first);
/* Linear equations: factors of M diagonal - J, in the order of the states; and of the algebraic part of J. Whether the
 * matrix is regular. */
INSIDE bool linear_factorise_step(kernel *self, step_factors *of, const double *jacobian, double diagonal);
INSIDE void linear_solve_step(kernel *self, const step_factors *of, double *vector);
INSIDE bool linear_factorise_algebraic(const kernel *self, dense_factors *of, const double *jacobian);
INSIDE void linear_solve_algebraic(const dense_factors *of, double *vector);
/* Whether factors stand that were made before: others may have taken their place in the dense matrix. */
INSIDE bool linear_has_factors(const kernel *self, const step_factors *of);
/* Adds self->jacobian times a vector; and writes it as a matrix by rows. */
INSIDE void linear_add_product(const kernel *self, const double *vector, double *sum);
INSIDE void linear_write_by_rows(const kernel *self, double *matrix);
/* Algebraic states, the others held, solved until their scaled change is below `tolerance` or round-off; all leave the
 * slopes in self->slope, and 0 means no success. Newton's method from self->jacobian, which is that of `state`; */
INSIDE int algebraic_solve(kernel *self, double offset, double *state, double tolerance);
/* with given factors throughout, the old values kept where that fails; */
INSIDE int algebraic_follow(kernel *self, const dense_factors *of, double offset, double *state, double tolerance);
/* with the last factors while they serve, and otherwise with new ones. */
INSIDE int algebraic_find(kernel *self, double offset, double *state, double tolerance);
/* The present state with algebraic states as the inputs now have them, and the Jacobian there; null: there are none. The
 * state itself stays as it is: a reading changes no run. */
INSIDE const double *algebraic_place(kernel *self);
/* Jacobian without algebraic states at the present state, by rows. */
INSIDE int algebraic_reduce(kernel *self, double offset, double *jacobian);
/* Rosenbrock methods. The error of a trial step is in units of the tolerance; a value that is not <= 1, NaN included,
 * means "reject". The new state is in self->trial. */
#ifndef ONE_UNIT /* there their definitions come first */
extern const rosenbrock_tableau RODAS5P, ROS34PW2;
#endif
INSIDE void rosenbrock_evaluate_jacobian(kernel *self, double offset, const double *state, double *jacobian);
INSIDE void rosenbrock_linearise(kernel *self, double offset, const double *state);
INSIDE int rosenbrock_factorise(kernel *self, const rosenbrock_tableau *method, step_factors *of, const double *jacobian,
                                double size);
INSIDE double rosenbrock_step(kernel *self, const rosenbrock_tableau *method, const step_factors *of, double offset,
                              double size);
INSIDE double rosenbrock_try(kernel *self, double offset, double size); /* with RODAS5P; linearise first */
/* The step whose error would be about the tolerance, and as much of it as one step may differ from the one before. */
INSIDE double rosenbrock_allowed_size(const rosenbrock_tableau *method, double size, double error);
INSIDE double rosenbrock_next_size(const rosenbrock_tableau *method, double size, double error);
INSIDE void rosenbrock_interpolate(const kernel *self, double fraction, double *state);
/* With ROS34PW2: a step with the kept Jacobian, made anew when it is too old or the step fails. */
INSIDE double reuse_try(kernel *self, double offset, double size);
/* Keeps the Jacobian of the present state until some time; whether it serves; and a step with it, as it is. */
INSIDE void reuse_remember(kernel *self, double offset, double until);
INSIDE int reuse_serves(const kernel *self, double offset);
INSIDE double reuse_short_step(kernel *self, double offset, double size);
INSIDE double runge_kutta_try(kernel *self, double offset, double size); /* its error is 0 or NaN */
INSIDE int runge_kutta_guard(kernel *self, double offset, double size);
/* Where the system asks for it, takes the start values in self->state to a steady state. 0: there is none. */
INSIDE int steady_find(kernel *self);
/* Modes and end conditions. The velocity that a friction acts on, and a state in which that is exactly 0. */
INSIDE double modes_velocity(const friction_description *friction, const double *state);
INSIDE void modes_stop(const friction_description *friction, double *state);
INSIDE void modes_refresh(kernel *self, double offset);
INSIDE void modes_hold(const kernel *self, double *state);
INSIDE double modes_direction_margin(const kernel *self, int i, const double *state);
INSIDE double modes_margin(kernel *self, double offset, const double *state);
INSIDE int modes_switch(kernel *self, double offset, double least);
INSIDE int modes_warn(kernel *self, double offset);
/* Model exchange: something has switched or stopped now. */
INSIDE void modes_grow_reluctant(kernel *self);
/* Model exchange: a step of the host begins here; slopes were read; and it ends here, a status where that is warned of. */
INSIDE void explicit_host_begin(kernel *self);
INSIDE void explicit_host_read(kernel *self);
INSIDE int explicit_host_guard(kernel *self);
/* Place of a state of model exchange among those of the chosen system; -1: it does not have that one. */
INSIDE int exchange_state(const kernel *self, int number);
/* One trial step with the chosen method; the length at which it crosses a switch; and the loop over the steps. */
INSIDE double integrate_try(kernel *self, double offset, double size);
INSIDE double modes_locate(kernel *self, double offset, double size);
INSIDE int integrate(kernel *self, double size, double *reached);

#endif
