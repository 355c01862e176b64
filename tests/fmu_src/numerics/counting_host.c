/* Host in C that makes the steps of a plan on an FMU of FMI 2.0 and prints its outputs after each. It counts memory calls and
 * locks of a step. With seccomp in strict mode, a system call within a step kills it.
 *
 *   counting_host LIBRARY PLAN [guarded | calling]     calling: guarded, and the host makes a system call within a step
 *
 * PLAN: guid, folder of the resources, step [s], number of steps.
 * Parameters: their number, then kind, reference and value of each.
 * Inputs: their number, then kind and reference of each.
 * Outputs: likewise.
 * Then a row of inputs for each step. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <linux/seccomp.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "fmi2Functions.h"

/* ---- memory and locks are counted here; the library finds these functions before those of the system ---- */

extern void *__libc_malloc(size_t), *__libc_calloc(size_t, size_t), *__libc_realloc(void *, size_t);
extern void __libc_free(void *);
static volatile int within_step;
static long taken[2], locked[2]; /* before the steps, and within them */

void *malloc(size_t size) { return ++taken[within_step], __libc_malloc(size); }
void *calloc(size_t count, size_t size) { return ++taken[within_step], __libc_calloc(count, size); }
void *realloc(void *old, size_t size) { return ++taken[within_step], __libc_realloc(old, size); }
void free(void *old) { ++taken[within_step], __libc_free(old); }

int pthread_mutex_lock(pthread_mutex_t *mutex) {
    static int (*lock)(pthread_mutex_t *);
    if (!lock) *(void **)&lock = dlsym(RTLD_NEXT, "pthread_mutex_lock");
    ++locked[within_step];
    return lock(mutex);
}

/* ---- the plan -------------------------------------------------------------------------------------------------- */

typedef struct {
    char kind; /* r, i, b */
    unsigned reference;
} variable;

static fmi2SetRealTYPE *set_real;
static fmi2SetIntegerTYPE *set_integer;
static fmi2SetBooleanTYPE *set_boolean;
static fmi2GetRealTYPE *get_real;
static fmi2GetIntegerTYPE *get_integer;
static fmi2GetBooleanTYPE *get_boolean;

static void fail(const char *what) {
    fprintf(stderr, "%s\n", what);
    exit(1);
}

static fmi2Status set(fmi2Component component, variable one, double value) {
    const int whole = (int)value;
    if (one.kind == 'r') return set_real(component, &one.reference, 1, &value);
    return (one.kind == 'i' ? set_integer : set_boolean)(component, &one.reference, 1, &whole);
}

static double get(fmi2Component component, variable one) {
    double value = 0.0;
    int whole = 0;
    if (one.kind == 'r') return get_real(component, &one.reference, 1, &value), value;
    return (one.kind == 'i' ? get_integer : get_boolean)(component, &one.reference, 1, &whole), (double)whole;
}

static variable read_variable(FILE *plan) {
    variable one;
    if (fscanf(plan, " %c%u", &one.kind, &one.reference) != 2) fail("The plan ends within a variable.");
    return one;
}

static double read_number(FILE *plan) {
    double number;
    if (fscanf(plan, "%lf", &number) != 1) fail("The plan ends before a number.");
    return number;
}

static variable *read_variables(FILE *plan, int *count) {
    *count = (int)read_number(plan);
    variable *all = (variable *)malloc((size_t)(*count + 1) * sizeof *all);
    for (int i = 0; i < *count; ++i) all[i] = read_variable(plan);
    return all;
}

static void *find(void *library, const char *name) {
    void *found = dlsym(library, name);
    if (!found) fail(name);
    return found;
}

int main(int count, char **argument) {
    if (count < 3) fail("counting_host LIBRARY PLAN [guarded | calling]");
    void *library = dlopen(argument[1], RTLD_NOW);
    if (!library) fail(dlerror());
    *(void **)&set_real = find(library, "fmi2SetReal");
    *(void **)&set_integer = find(library, "fmi2SetInteger");
    *(void **)&set_boolean = find(library, "fmi2SetBoolean");
    *(void **)&get_real = find(library, "fmi2GetReal");
    *(void **)&get_integer = find(library, "fmi2GetInteger");
    *(void **)&get_boolean = find(library, "fmi2GetBoolean");
    fmi2InstantiateTYPE *instantiate;
    fmi2SetupExperimentTYPE *setup;
    fmi2EnterInitializationModeTYPE *enter;
    fmi2ExitInitializationModeTYPE *leave;
    fmi2DoStepTYPE *step;
    *(void **)&instantiate = find(library, "fmi2Instantiate");
    *(void **)&setup = find(library, "fmi2SetupExperiment");
    *(void **)&enter = find(library, "fmi2EnterInitializationMode");
    *(void **)&leave = find(library, "fmi2ExitInitializationMode");
    *(void **)&step = find(library, "fmi2DoStep");

    FILE *plan = fopen(argument[2], "r");
    static char guid[100], resources[4000];
    if (!plan || fscanf(plan, "%99s %3999s", guid, resources) != 2) fail("There is no plan.");
    const double size = read_number(plan);
    const int steps = (int)read_number(plan), parameters = (int)read_number(plan);
    static const fmi2CallbackFunctions callbacks;
    fmi2Component component = instantiate("counting_host", fmi2CoSimulation, guid, resources, &callbacks, 0, 0);
    if (!component) fail("The FMU was not instantiated.");
    for (int i = 0; i < parameters; ++i) {
        const variable one = read_variable(plan);
        if (set(component, one, read_number(plan)) > fmi2Warning) fail("A parameter was refused.");
    }
    int inputs, outputs;
    variable *input = read_variables(plan, &inputs), *output = read_variables(plan, &outputs);
    double *row = (double *)malloc((size_t)(steps * inputs + 1) * sizeof *row);
    double *seen = (double *)calloc((size_t)(steps * (outputs + 1)), sizeof *seen);
    for (int i = 0; i < steps * inputs; ++i) row[i] = read_number(plan);
    fclose(plan);
    setup(component, 0, 0.0, 0.0, 0, 0.0);
    if (enter(component) > fmi2Warning || leave(component) > fmi2Warning) fail("The initialisation failed.");
    const int calling = count > 3 && strcmp(argument[3], "calling") == 0;
    if (count > 3 && prctl(PR_SET_SECCOMP, SECCOMP_MODE_STRICT) != 0) fail("The system has no seccomp.");

    int made = 0;
    fmi2Status status = fmi2OK;
    for (; made < steps && status <= fmi2Warning; ++made) {
        for (int i = 0; i < inputs; ++i) set(component, input[i], row[made * inputs + i]);
        within_step = 1;
        if (calling) (void)getppid();
        status = step(component, made * size, size, 1);
        within_step = 0;
        for (int i = 0; i < outputs; ++i) seen[made * outputs + i] = get(component, output[i]);
    }
    char line[400];
    for (int i = 0; i < made; ++i)
        for (int k = 0; k < outputs; ++k) {
            const int length = snprintf(line, sizeof line, "%.17g%c", seen[i * outputs + k], k + 1 < outputs ? ' ' : '\n');
            if (write(1, line, (size_t)length) != length) return 1;
        }
    const int length =
        snprintf(line, sizeof line, "%d %ld %ld %ld %ld\n", (int)status, taken[0], taken[1], locked[0], locked[1]);
    if (write(1, line, (size_t)length) != length) return 1;
    syscall(SYS_exit, 0);
    return 0;
}
