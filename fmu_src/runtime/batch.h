/* Many runs of one model at once. LANES instances make their trial steps together, each with its own time, step, modes and
 * events; when one is done, the next takes its lane. A lane makes all other steps alone, with bit-identical results. Only the
 * library for studies contains this. */
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

/* Input and results of `count` runs. Arrays are by rows, a row for each run. A failed run leaves NaN. */
typedef struct {
    long long int count;
    long long int *next; /* the first run that no thread has taken yet; shared by the threads */
    int variables, outputs;
    const int *variable, *output;
    const double *value; /* count x variables: start values */
    int files;           /* of all runs: the variables that name them, and their paths */
    const int *file;
    const char *const *path;
    double start, stop;  /* [s] */
    double *result;      /* count x outputs: where a run ends */
    double *end;         /* count: when [s] */
    int *status;         /* count: a kernel_status; KERNEL_DISCARD: the run ended by itself */
    char **messages;      /* count, or NULL: messages from the initialisation on; batch_free_message frees each */
    bool all_messages;       /* false: only failed runs report their messages */
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

/* Called between steps for `count` instances from `first` on. Reads rows of outputs and writes rows of inputs. Returns false if
 * none of these instances continues. */
typedef bool (*batch_between)(void *context, long long int first, long long int count, const int *status, const double *result,
                              double *value);

/* Create a batch, one for each thread. With `beside` it creates a further batch for other instances, which computes in the
 * memory of `beside`: that memory stays in a core's cache. `beside` must outlive it. Returns NULL if out of memory. */
KERNEL_EXPORT batch *batch_create(const batch *beside);
KERNEL_EXPORT void batch_free(batch *self);
KERNEL_EXPORT int batch_lanes(void);
/* Return false if out of memory. */
KERNEL_EXPORT bool batch_run(batch *self, const batch_runs *runs);
KERNEL_EXPORT void batch_free_message(char *message);
/* group: a batch for each BATCH_LANES instances, the same at every step. */
KERNEL_EXPORT void batch_step(batch *const *group, const batch_steps *steps);
/* Make `count` steps of all instances, a few instances at a time, each step after a call of `between`. Ends early if none of
 * these continues. first: number of the first instance for `between`. */
KERNEL_EXPORT void batch_control(batch *const *group, const batch_steps *steps, long long int count, batch_between between,
                                 void *context, long long int first);
/* Write the present outputs of all instances into the arrays for those of a step. */
KERNEL_EXPORT void batch_read_outputs(const batch_steps *steps);
/* Must be called before the next step of a group in which instances have begun a new run. */
KERNEL_EXPORT void batch_forget(batch *self);

#endif
