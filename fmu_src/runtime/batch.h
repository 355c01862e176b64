/* Many runs of one model at once: LANES instances make their trial steps together, each with its own time, step, modes and
 * events; one that is done makes room for the next. Whatever a lane cannot do together it does alone, with the same bits.
 * Only the library for studies holds it. */
#ifndef BATCH_H
#define BATCH_H

#include "kernel.h"

/* A function of a system over several instances: numbers of each lie BATCH_LANES apart. Arguments as in model.h. */
typedef void (*lanes_function)(const double *const *argument, double *const *result);

/* One system in lanes. null: not needed */
typedef struct {
    int lanes, system;
    lanes_function ode, jacobian, output, drive, capacity, condition_margin, largest_change;
    const lanes_function *table_argument; /* one for each rank */
    void (*factorise)(const double *jacobian, const double *diagonal, double *entry);
    void (*substitute)(const double *entry, double *vector);
} batch_functions;

typedef struct batch batch;

/* What each of `count` runs begins with and leaves. Arrays are by rows, a row for each run. A failed run leaves NaN. */
typedef struct {
    long long int count;
    long long int *next; /* the first run that nobody has taken yet: threads share it */
    int variables, outputs;
    const int *variable, *output;
    const double *value; /* count x variables: start values */
    int file;            /* the variable that names the file of all runs */
    const char *path;    /* null: there is none */
    double start, stop;  /* [s] */
    double *result;      /* count x outputs: where a run ends */
    double *end;         /* count: when [s] */
    int *status;         /* count: a kernel_status; KERNEL_DISCARD: the run ended by itself */
    char **said;         /* count, or null: what it said from its initialisation on; batch_free_said frees each */
    bool says_all;       /* or only failed runs say why */
} batch_runs;

/* A step of each of `count` instances. */
typedef struct {
    long long int count;
    kernel *const *instance;
    int inputs, outputs;
    const int *input, *output;
    const double *value; /* count x inputs */
    double size;         /* [s] */
    double *result;      /* count x outputs */
    int *status;         /* count: a kernel_status */
} batch_steps;

/* What stands between steps of the instances from the first on: reads what they show and sets what they are told, rows of
 * outputs and of inputs; whether any goes on. */
typedef bool (*batch_between)(void *context, long long int first, long long int count, const int *status, const double *result,
                              double *value);

/* One for each thread; or further ones beside it, for other instances: those compute in the room of the first, which outlives
 * them, so that it stays in a core's cache. null: there is no memory. */
KERNEL_EXPORT batch *batch_create(const batch *beside);
KERNEL_EXPORT void batch_free(batch *self);
KERNEL_EXPORT int batch_lanes(void);
/* Whether there is memory for it. */
KERNEL_EXPORT bool batch_run(batch *self, const batch_runs *runs);
KERNEL_EXPORT void batch_free_said(char *said);
/* group: a batch for each BATCH_LANES instances, the same at every step. */
KERNEL_EXPORT void batch_step(batch *const *group, const batch_steps *steps);
/* So many steps of all instances, a few at a time, each behind a call of `between`; ends where none of these goes on. first:
 * the number of the first instance for `between`. */
KERNEL_EXPORT void batch_control(batch *const *group, const batch_steps *steps, long long int count, batch_between between,
                                 void *context, long long int first);
/* The outputs of all instances where they stand, into the same arrays as those of a step. */
KERNEL_EXPORT void batch_look(const batch_steps *steps);
/* Before the next step of a group some of whose instances have begun anew. */
KERNEL_EXPORT void batch_forget(batch *self);

#endif
