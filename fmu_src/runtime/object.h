/* Interface between the FMI functions and an object: a table of functions, OBJECT, which one file fills in (kernel_object.c,
 * arrays_object.c). The FMI functions (face.h) handle the order of calls, the log, references and saved states; the object
 * holds the values. A NULL in the table marks a missing capability. The FMI functions refuse it, and modelDescription.xml,
 * written from the same rows (fmu_src/objects.py), does not claim it. */
#ifndef OBJECT_H
#define OBJECT_H

#include "status.h"
#include "variable.h"

typedef struct fmu_object fmu_object;

/* Functions of model exchange, for an integrator of the host. */
typedef struct {
    int (*states)(void), (*indicators)(void);
    kernel_status (*set_time)(fmu_object *self, double time);
    kernel_status (*set_states)(fmu_object *self, const double *state);
    kernel_status (*get_states)(fmu_object *self, double *state);
    kernel_status (*get_slopes)(fmu_object *self, double *slope);
    kernel_status (*get_indicators)(fmu_object *self, double *indicator);
    void (*get_nominals)(double *nominal);
    kernel_status (*find_modes)(fmu_object *self, bool *jumped);
    kernel_status (*complete_step)(fmu_object *self, bool *crossed);
} object_exchange;

/* Members that are not marked as optional must be set. `hear` returns the messages to a status. */
typedef struct {
    const char *(*token)(void); /* the same as in modelDescription.xml */
    const char *(*name)(void);
    /* Number of variables in the table, and the description of one; NULL if it does not exist. The next number is the time's in
     * FMI 3.0, and numbers after it may be read. */
    unsigned (*variables)(void);
    const variable_description *(*variable)(unsigned number);
    /* The value reference of an element in FMI 2.0 is variable * stride + element; in FMI 3.0 it is the variable's. */
    unsigned (*stride)(void);
    /* Make an object from the files in a folder; NULL if the host gave no folder. Returns NULL, with one message, if that
     * fails. */
    fmu_object *(*make)(const char *folder, bool exchange, char problem[MESSAGE_SIZE]);
    void (*dispose)(fmu_object *self);
    kernel_status (*reset)(fmu_object *self);
    /* Set the statuses, a bit for each, whose messages are read (optional); return the oldest unread message. */
    void (*listen)(fmu_object *self, unsigned statuses);
    bool (*hear)(fmu_object *self, kernel_sentence *heard);
    /* Number of elements of a variable; get some of them; check values, which changes nothing; and set them. */
    size_t (*length)(const fmu_object *self, unsigned variable);
    kernel_status (*get)(fmu_object *self, unsigned variable, size_t first, size_t count, double *value);
    kernel_status (*check)(fmu_object *self, unsigned variable, size_t first, size_t count, const double *value);
    kernel_status (*set)(fmu_object *self, unsigned variable, size_t first, size_t count, const double *value);
    kernel_status (*get_text)(fmu_object *self, unsigned variable, const char **text); /* optional, as the next */
    kernel_status (*set_text)(fmu_object *self, unsigned variable, const char *text);
    /* Set the host's settings; NULL: not set. Begins a run. Returns whether values follow from all that was set since. Forgets
     * them. */
    kernel_status (*plan)(fmu_object *self, const double *tolerance, double start, const double *stop);
    kernel_status (*initialise)(fmu_object *self, double start);
    bool (*initialised)(const fmu_object *self);
    void (*reopen)(fmu_object *self);
    /* A discard has ended the run, or has left the object as it was. */
    kernel_status (*step)(fmu_object *self, double time, double size);
    double (*time)(const fmu_object *self);
    bool (*ended)(const fmu_object *self);
    /* Set whether a step may end early, with OK, at an event (optional). */
    void (*stop_at_events)(fmu_object *self, bool stops);
    /* Everything that a run changes, as a block of memory; and a hash that differs between objects of other files
     * (optional). */
    size_t (*block_size)(const fmu_object *self);
    void (*copy_block)(fmu_object *self, void *bytes);
    kernel_status (*take_block)(fmu_object *self, const void *bytes);
    unsigned long long (*mark)(const fmu_object *self);
    /* First derivatives by time of inputs and outputs, and along a direction (all optional). */
    kernel_status (*set_rates)(fmu_object *self, size_t count, const unsigned *variable, const double *rate);
    kernel_status (*get_rates)(fmu_object *self, size_t count, const unsigned *variable, double *rate);
    kernel_status (*get_directional)(fmu_object *self, size_t unknowns, const unsigned *unknown, size_t knowns,
                                     const unsigned *known, const double *change, double *result);
    const object_exchange *exchange; /* optional */
} object_functions;

#ifndef ONE_UNIT /* there the definition comes first */
extern const object_functions OBJECT;
#endif

#endif
