/* Shared part of the FMI 2.0 and FMI 3.0 interfaces around an object (object.h). */
#ifndef FACE_H
#define FACE_H

#include "object.h"
#include "resources.h"
#include "traps.h"

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

typedef struct component component;
/* How a standard names a folder: resources_of_uri, resources_of_path. */
typedef bool face_place(const char *given, char *path, char problem[RESOURCES_PROBLEM]);
/* Differences between FMI 2.0 and FMI 3.0. */
typedef struct {
    const char *name;   /* "FMI 2.0, section 4.2.4" */
    unsigned always_logged; /* a bit for each category that is always logged */
    bool by_elements;   /* whether a value reference is that of one element, and the time has none */
    face_place *place;
    /* Hand a message to the host's logger. */
    void (*tell)(const component *self, kernel_status status, const char *category, const char *sentence);
} face_standard;

struct component {
    fmu_object *object;
    phase now;
    unsigned logged;           /* one bit for each category that the host logs */
    kernel_status last_step;   /* result of fmi2GetStatus: the status of the last step */
    bool exchange;             /* model exchange, not co-simulation */
    bool events;               /* co-simulation with event mode, requested by the host */
    unsigned variables, stride; /* of the object */
    double start_time;
    char *name, *token;
    const face_standard *standard;
    void (*logger)(void);      /* the host's callback, of the type that `tell` calls */
    void *environment;
};

/* Bits of the categories of warnings and errors. */
enum { WARNINGS = 1u << KERNEL_WARNING, ERRORS = 1u << KERNEL_ERROR };

/* A new instance, or NULL after `tell` has logged the reason. The caller fills in standard, log and interface first. */
RUNTIME_LOCAL component *face_instantiate(const component *log, const char *name, const char *token, const char *resources,
                                          int logging);
RUNTIME_LOCAL void face_free(component *self);
RUNTIME_LOCAL kernel_status face_log(component *self, int logging, size_t count, const char *const categories[]);
RUNTIME_LOCAL kernel_status face_error(const component *self, const char *sentence);
/* Log that the object does not have a function of the standard. */
RUNTIME_LOCAL kernel_status face_absent(const component *self, const char *function);
/* Pass the object's messages on to the host and returns `status` unchanged. */
RUNTIME_LOCAL kernel_status face_report(component *self, kernel_status status);
/* Pass them on as errors, and returns one. */
RUNTIME_LOCAL kernel_status face_refuse(component *self);
RUNTIME_LOCAL bool face_legal(const component *self, int phases, const char *function);
/* Return whether the instance is of the other interface than the call; log an error if so. */
RUNTIME_LOCAL bool face_is_cosimulation(const component *self);
RUNTIME_LOCAL bool face_is_exchange(const component *self);
/* Return whether one of two arrays of `count` values is missing; log an error if so. */
RUNTIME_LOCAL bool face_missing(const component *self, size_t count, const void *one, const void *other);
/* Pass on the host's settings before initialisation; NULL: not set. */
RUNTIME_LOCAL kernel_status face_plan(component *self, const double *tolerance, double start, const double *stop);
RUNTIME_LOCAL kernel_status face_initialise(component *self);
RUNTIME_LOCAL kernel_status face_enter(component *self, phase next);
RUNTIME_LOCAL kernel_status face_reset(component *self);

/* Numbers of variables of one kind, which fill `size` values. `put` and `take` convert to and from their type; NULL for
 * doubles. If one cannot be set, none is, and the reason is logged. */
typedef void face_put(void *values, size_t place, double number);
typedef double face_take(const void *values, size_t place);
RUNTIME_LOCAL kernel_status face_get(component *self, int kind, const unsigned *reference, size_t count, void *values,
                                     size_t size, face_put *put);
RUNTIME_LOCAL kernel_status face_set(component *self, int kind, const unsigned *reference, size_t count, const void *values,
                                     size_t size, face_take *take);
RUNTIME_LOCAL kernel_status face_get_texts(component *self, const unsigned *reference, size_t count, const char **text,
                                           size_t size);
RUNTIME_LOCAL kernel_status face_set_texts(component *self, const unsigned *reference, size_t count, const char *const *text,
                                           size_t size);

/* Rates of change, order 1 of each; derivatives along a direction. */
RUNTIME_LOCAL kernel_status face_set_rates(component *self, const unsigned *reference, size_t count, const int *order,
                                           const double *rate);
RUNTIME_LOCAL kernel_status face_get_rates(component *self, const unsigned *reference, size_t count, const int *order,
                                           double *rate, size_t size, const char *function);
RUNTIME_LOCAL kernel_status face_get_directional(component *self, const unsigned *unknown, size_t unknowns,
                                                 const unsigned *known, size_t knowns, const double *change, size_t changes,
                                                 double *result, size_t results, const char *function);

/* Saved states. */
RUNTIME_LOCAL kernel_status face_save(component *self, void **state);
RUNTIME_LOCAL kernel_status face_restore(component *self, const void *state);
RUNTIME_LOCAL kernel_status face_release(void **state);
RUNTIME_LOCAL kernel_status face_saved_size(component *self, const void *state, size_t *size);
RUNTIME_LOCAL kernel_status face_serialise(component *self, const void *state, void *bytes, size_t size);
RUNTIME_LOCAL kernel_status face_deserialise(component *self, const void *bytes, size_t size, void **state);

/* Model exchange: arrays must have the size that is expected. */
RUNTIME_LOCAL kernel_status face_set_time(component *self, double time);
RUNTIME_LOCAL kernel_status face_set_states(component *self, const double *state, size_t count);
typedef enum { READ_STATES, READ_SLOPES, READ_INDICATORS } face_reading;
RUNTIME_LOCAL kernel_status face_read(component *self, double *value, size_t count, face_reading what);
RUNTIME_LOCAL kernel_status face_nominals(component *self, double *nominal, size_t count);
RUNTIME_LOCAL kernel_status face_count(component *self, face_reading what, size_t *count);
RUNTIME_LOCAL kernel_status face_find_modes(component *self, bool *ended, bool *jumped);
RUNTIME_LOCAL kernel_status face_complete_step(component *self, bool *crossed);

/* STATUS is the type of the standard. */
#define REQUIRE(instance, phases, function)                                                                                    \
    MASK_TRAPS;                                                                                                                \
    component *self = (component *)instance;                                                                                   \
    if (!face_legal(self, phases, function)) return (STATUS)KERNEL_ERROR
/* A function of the standard that returns what a function of this header returns; its first parameter is `instance`. */
#define FACE_FUNCTION(name, phases, parameters, returned)                                                                      \
    STATUS name parameters {                                                                                                   \
        REQUIRE(instance, phases, #name);                                                                                      \
        return (STATUS)(returned);                                                                                             \
    }

#endif
