/* What the faces of FMI 2.0 and 3.0 share: an instance, its phase, its log, its variables and its saved states. The
 * numbers of fmi2Status and fmi3Status are the same, and those of the kernel. */
#ifndef FACE_H
#define FACE_H

#include "kernel.h"
#include "resources.h"

/* STEPPING in co-simulation; CONTINUOUS in model exchange; AT_EVENT, event mode, in either. */
typedef enum {
    INSTANTIATED = 1,
    INITIALISING = 2,
    STEPPING = 4,
    STOPPED = 8,
    TERMINATED = 16,
    AT_EVENT = 32,
    CONTINUOUS = 64,
    RUNNING = STEPPING | AT_EVENT | CONTINUOUS,
    SETTABLE = INSTANTIATED | INITIALISING | RUNNING,
    KNOWN = INITIALISING | RUNNING | STOPPED | TERMINATED, /* from where on there are values and derivatives */
    ALWAYS = INSTANTIATED | KNOWN
} phase;

typedef struct component {
    kernel *machine;
    phase now;
    unsigned logged; /* one bit for each category that the host wants to hear */
    unsigned told;   /* those that it hears whether it wants to or not */
    kernel_status last_step; /* status of the last step */
    bool exchange; /* model exchange, not co-simulation */
    bool events;   /* co-simulation whose host asked for event mode */
    double start_time;
    char *name;
    char *resources; /* folder of the FMU's own files, with room for their names; null: the host named none */
    size_t folder_length;
    const char *standard; /* "FMI 2.0, section 4.2.4" */
    /* Hands a sentence to the host's logger. */
    void (*tell)(const struct component *self, kernel_status status, const char *category, const char *sentence);
    void (*logger)(void); /* the host's callback, of the type that `tell` knows */
    void *environment;
} component;

/* Bits of the categories of warnings and errors. */
enum { WARNINGS = 1u << KERNEL_WARNING, ERRORS = 1u << KERNEL_ERROR };

/* A new instance, or null after `tell` has said why. The caller fills in the fields of the log first. */
RUNTIME_LOCAL component *face_instantiate(const component *log, const char *name, const char *token, int logging);
/* How a standard names a folder: resources_of_uri, resources_of_path. */
typedef bool face_place(const char *given, char *path, char problem[RESOURCES_PROBLEM]);
/* Tells an instance (null: there is none) where its resources are. `start_values.csv` there has rows NAME,VALUE in place of
 * start values, and the resource that a table file is called is its table. Gives it back, or null where these are refused. */
RUNTIME_LOCAL component *face_take_resources(component *self, const char *resources, face_place *place);
RUNTIME_LOCAL void face_free(component *self);
RUNTIME_LOCAL kernel_status face_log(component *self, int logging, size_t count, const char *const categories[]);
RUNTIME_LOCAL kernel_status face_error(const component *self, const char *sentence);
/* Passes the kernel's journal on to the host and returns `status` unchanged. */
RUNTIME_LOCAL kernel_status face_report(component *self, kernel_status status);
RUNTIME_LOCAL bool face_legal(const component *self, int phases, const char *function);
/* Whether the instance is of the other interface than the call, which is then said. */
RUNTIME_LOCAL bool face_is_cosimulation(const component *self);
RUNTIME_LOCAL bool face_is_exchange(const component *self);
/* Whether one of two arrays of `count` values is missing, which is then said. */
RUNTIME_LOCAL bool face_missing(const component *self, size_t count, const void *one, const void *other);
/* What the host says before initialisation; null: it says nothing. */
RUNTIME_LOCAL kernel_status face_plan(component *self, const double *tolerance, double start, const double *stop);
/* What is asked for during initialisation belongs to the values set so far. */
RUNTIME_LOCAL kernel_status face_initialise_if_asked(component *self);
/* Ends the initialisation. */
RUNTIME_LOCAL kernel_status face_initialise(component *self);
RUNTIME_LOCAL kernel_status face_get(component *self, unsigned reference, int kind, double *value);
/* Whether one of the variables cannot be set now, which is then said: then none is set. */
RUNTIME_LOCAL bool face_fixed(component *self, size_t count, const unsigned *reference, int kind);
/* Whether the variable forbids this value, which is then said. */
RUNTIME_LOCAL bool face_refuses(component *self, unsigned reference, double value);
RUNTIME_LOCAL kernel_status face_set(component *self, unsigned reference, double value);
RUNTIME_LOCAL kernel_status face_set_texts(component *self, size_t count, const unsigned *reference, const char *const *text);
RUNTIME_LOCAL kernel_status face_get_texts(component *self, size_t count, const unsigned *reference, const char **text);
RUNTIME_LOCAL kernel_status face_set_rates(component *self, size_t count, const unsigned *reference, const double *rate);
RUNTIME_LOCAL kernel_status face_terminate(component *self);
RUNTIME_LOCAL kernel_status face_reset(component *self);
RUNTIME_LOCAL size_t face_saved_size(const component *self);
RUNTIME_LOCAL kernel_status face_save(component *self, void **state);
RUNTIME_LOCAL kernel_status face_restore(component *self, const void *state);
RUNTIME_LOCAL kernel_status face_serialise(component *self, const void *state, void *bytes, size_t size);
RUNTIME_LOCAL kernel_status face_deserialise(component *self, const void *bytes, size_t size, void **state);
/* Model exchange, face_exchange.c: arrays must have the size that is expected. */
RUNTIME_LOCAL kernel_status face_set_time(component *self, double time);
RUNTIME_LOCAL kernel_status face_set_states(component *self, const double *state, size_t count);
RUNTIME_LOCAL kernel_status face_read(component *self, double *value, size_t count, int expected, kernel_status (*read)(kernel *, double *));
RUNTIME_LOCAL kernel_status face_nominals(component *self, double *nominal, size_t count);
RUNTIME_LOCAL kernel_status face_enter(component *self, phase next);
RUNTIME_LOCAL kernel_status face_find_modes(component *self, bool *ended, bool *jumped);
RUNTIME_LOCAL kernel_status face_complete_step(component *self, bool *crossed);

/* STATUS is the type of the standard. */
#define REQUIRE(instance, phases, function)  \
    component *self = (component *)instance; \
    if (!face_legal(self, phases, function)) return (STATUS)KERNEL_ERROR

#endif
