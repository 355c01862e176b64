/* An instance: a constant model, the state of its run, and the workspaces of methods; and internal functions of the runtime. */
#ifndef INSTANCE_H
#define INSTANCE_H

#include "duration.h"
#include "kernel.h"
#include "known.h"
#include "record_file.h"
#include "state.h"
#include "table_file.h"
#include "workspace.h"

typedef struct {
    long long int capacity, written;
    double interval;
    int columns;
    const int *variable;
    double *buffer;
} kernel_recorder;

enum { MOST_TRIALS = 5000000 }; /* steps tried in one kernel_step; a run that needs more is stuck */

/* Values of integration_method. */
enum { METHOD_EXACT = 1, METHOD_REUSED = 2, METHOD_EXPLICIT = 3 };

/* Memory for the arrays of an instance: the largest of each number over the systems that it may run. */
typedef struct {
    int states, algebraics, nonzeros, factors, inputs, parameters, derived, frictions, outputs, tables, table_coefficients;
    int limits, conditions;
} dimensions;

/* Settings of the host. */
typedef struct {
    bool stops_at_events, whole_steps;
    unsigned unheard; /* a bit for each status whose messages are not written */
    double stop_time; /* infinite: not set */
} host_requests;

struct kernel {
    const system_description *system; /* the chosen one; null before initialisation */
    int lanes; /* how many copies of a repeated component generated functions compute at once */
    table_file *table; /* null: none */
    char *table_path;
    bool own_table; /* the table is the FMU's own file */
    record_file *records; /* null: none */
    char *records_path;
    dimensions room;
    run_state run;
    given_values given;
    step_workspace work;
    kept_workspace kept;
    mode_workspace modes;
    reading_workspace reading;
    steady_workspace steady;
    host_workspace host;
    host_requests requested;
    const known_place *known[2]; /* where a step begins and where its trial ends; NULL: no results are known there */
    bool reads_outputs_later; /* a step leaves outputs to be computed when they are read */
    kernel_counters counters;
    kernel_recorder *recorder;
    message_log messages;
    char *warned; /* one flag per variable: the warning "has no effect here" was given, or the value is the FMU's own */
    double *backup; /* of the block of the run, at the start of a step */
    double *scratch; /* memory of the workspaces */
    int *pivots;
};

/* Write a message to the log; kernel_fail also to kernel_message, and it returns the status. */
RUNTIME_LOCAL void kernel_note(kernel *self, kernel_status status, const char *format, ...) LIKE_PRINTF(3);
RUNTIME_LOCAL kernel_status kernel_fail(kernel *self, kernel_status status, const char *format, ...) LIKE_PRINTF(3);
/* Return whether messages of this status are read: writing one costs more than a step at the point level. */
RUNTIME_LOCAL bool kernel_is_heard(const kernel *self, kernel_status status);
/* As kernel_fail, with a model's message: it is not a format, but its first %s is replaced by a time. */
RUNTIME_LOCAL kernel_status kernel_say_when(kernel *self, kernel_status status, const char *sentence, const char *when);
/* Take back the messages since there were `noted` records. */
RUNTIME_LOCAL void kernel_take_back(kernel *self, unsigned long long noted);
/* Checks of variables return a status, with a message. */
RUNTIME_LOCAL kernel_status kernel_check_reference(kernel *self, int variable);
RUNTIME_LOCAL const char *kernel_name_of_table_file(void);
RUNTIME_LOCAL kernel_status kernel_check_value(kernel *self, const variable_description *variable, double value, double kept);
RUNTIME_LOCAL kernel_status kernel_warn_without_effect(kernel *self, int variable);
RUNTIME_LOCAL kernel_status kernel_warn_of_idle_parameters(kernel *self);
RUNTIME_LOCAL kernel_status kernel_warn_of_small_pressure(kernel *self, int variable);
/* The value of a variable is from the FMU's own files: no warning if it has no effect, until it is set to another. */
RUNTIME_LOCAL void kernel_keep_own(kernel *self, int variable);
/* Report why the run ended at a time; return a discard. */
RUNTIME_LOCAL kernel_status kernel_say_end(kernel *self, double time);
/* Report that the run ended `reached` seconds into a step that is taken back; there were `noted` records before it. */
RUNTIME_LOCAL kernel_status kernel_discard(kernel *self, unsigned long long noted, double reached);
RUNTIME_LOCAL void kernel_leave_table(kernel *self);
RUNTIME_LOCAL void kernel_leave_records(kernel *self);
/* Set the data that follow from the chosen system and the parameters and are not restored with them. */
RUNTIME_LOCAL void kernel_enter_system(kernel *self);
RUNTIME_LOCAL void kernel_gather_inputs(kernel *self);
/* Gather inputs and place the origin of a step at the present time; an error before the initialisation. */
RUNTIME_LOCAL kernel_status kernel_prepare(kernel *self, const char *what);
RUNTIME_LOCAL void kernel_compute_outputs(kernel *self, double offset, const double *state);
/* First output that is not a finite number, or null. */
RUNTIME_LOCAL const char *kernel_output_not_finite(const kernel *self);
/* Inputs and table pieces that are valid `offset` seconds after the start of the step; and the table pieces alone. */
RUNTIME_LOCAL void kernel_locate(kernel *self, double offset, const double *state);
RUNTIME_LOCAL void kernel_look_up(kernel *self, double offset, const double *state);
/* A generated function at a place: with the inputs and table pieces located before, or locating them; with one result. */
RUNTIME_LOCAL void kernel_call(kernel *self, generated_function function, double offset, const double *state, double **result);
RUNTIME_LOCAL void kernel_evaluate_again(kernel *self, generated_function function, double offset, const double *state,
                                         double *result);
RUNTIME_LOCAL void kernel_evaluate(kernel *self, generated_function function, double offset, const double *state,
                                   double *result);

#endif
