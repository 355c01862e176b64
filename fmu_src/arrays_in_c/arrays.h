/* An object whose variables are arrays, the lengths of which it knows only when it is made, behind the faces of FMI 2.0 and
 * FMI 3.0 for co-simulation. One binary serves objects of all lengths. */
#ifndef ARRAYS_H
#define ARRAYS_H

#include <stdbool.h>
#include <stddef.h>

#include "resources.h"

enum { ARRAY_PARAMETER, ARRAY_INPUT, ARRAY_OUTPUT };
enum { ARRAYS_PROBLEM = 512 };

/* An array: its name and unit, how it may be used, whether it holds whole numbers, and limits of them. */
typedef struct {
    const char *name, *unit;
    int causality, whole;
    double least, most;
} arrays_about;

/* ---- what an object gives ---- */

typedef struct arrays_object arrays_object;
extern const arrays_about ARRAYS_ABOUT[];
extern const int ARRAYS;
/* What modelDescription.xml must say, too. */
extern const char ARRAYS_TOKEN[];
/* From the files in a folder, which ends with no separator; null: and one sentence that says why. */
arrays_object *arrays_create(const char *folder, char problem[ARRAYS_PROBLEM]);
void arrays_free(arrays_object *self);
/* Where the numbers of an array are, and how many. */
double *arrays_values(arrays_object *self, int array, size_t *count);
/* Parameters and inputs as they are by default. */
void arrays_reset(arrays_object *self);
/* Begins a run with its parameters; false: and one sentence that says why. Starts again where inputs have changed. */
bool arrays_start(arrays_object *self, double time, char problem[ARRAYS_PROBLEM]);
/* Goes on by a time; false: it cannot, is as it was, and one sentence says why. */
bool arrays_go(arrays_object *self, double time, double step, char problem[ARRAYS_PROBLEM]);
/* What tells objects apart that were made of other files. */
unsigned long long arrays_mark(const arrays_object *self);
/* All that a run changes, inputs and outputs too: how many numbers, and from and to a place for them. */
size_t arrays_numbers(const arrays_object *self);
void arrays_save(const arrays_object *self, double *numbers);
void arrays_load(arrays_object *self, const double *numbers);

/* ---- what is there for objects (arrays_face.c) ---- */

/* The numbers in a file of a folder; null: it cannot be read, is empty or no file of numbers, and one sentence says so. */
double *arrays_read(const char *folder, const char *name, size_t *count, char problem[ARRAYS_PROBLEM]);
/* What tells numbers apart, begun from another mark or from ARRAYS_MARK. */
unsigned long long arrays_mark_of(unsigned long long mark, const double *numbers, size_t count);
#define ARRAYS_MARK 14695981039346656037ULL

/* ---- what both faces share (arrays_face.c) ---- */

typedef enum { ARRAYS_OK, ARRAYS_WARNING, ARRAYS_DISCARD, ARRAYS_ERROR } arrays_status;
typedef enum { INSTANTIATED = 1, INITIALISING = 2, RUNNING = 4, STOPPED = 8 } arrays_phase;
enum { ALWAYS = INSTANTIATED | INITIALISING | RUNNING | STOPPED };

typedef struct arrays_component arrays_component;
struct arrays_component {
    arrays_object *object;
    arrays_phase now;
    double start, time;
    arrays_status failed; /* what a step has that leads nowhere */
    bool stale; /* while it initialises: outputs are not those of what was set */
    char *name;
    const char *standard; /* which section lists the calls that are allowed */
    void (*tell)(const arrays_component *self, arrays_status status, const char *sentence);
    void (*logger)(void);
    void *environment;
};

/* How a standard names a folder: resources_of_uri, resources_of_path. */
typedef bool arrays_place(const char *given, char *path, char problem[RESOURCES_PROBLEM]);
arrays_component *arrays_instantiate(const arrays_component *log, const char *name, const char *token, const char *resources,
                                     arrays_place *place);
void arrays_release(arrays_component *self);
arrays_status arrays_say(const arrays_component *self, arrays_status status, const char *format, ...);
/* Whether a function may be called now. */
bool arrays_may(const arrays_component *self, int phases, const char *function);
arrays_status arrays_plan(arrays_component *self, double start);
arrays_status arrays_initialise(arrays_component *self);
arrays_status arrays_step(arrays_component *self, double time, double step);
void arrays_begin_anew(arrays_component *self);
/* Outputs are those of what was set, also while it initialises. */
void arrays_settle(arrays_component *self);
/* The array for a value reference if it holds numbers of this kind and has such an element; null: it was told. */
double *arrays_find(const arrays_component *self, unsigned array, size_t element, int whole, const char *function);
size_t arrays_length(const arrays_component *self, unsigned array);
/* Whether an element may be set to a value now; false: it was told. */
bool arrays_settable(const arrays_component *self, unsigned array, size_t element, double value);
/* Saved states; those of other FMUs and of objects of other files, and bytes that have changed, are refused. */
arrays_status arrays_keep(const arrays_component *self, void **state);
arrays_status arrays_take_back(arrays_component *self, const void *state);
arrays_status arrays_size(const arrays_component *self, const void *state, size_t *size);
arrays_status arrays_serialise(const arrays_component *self, const void *state, void *bytes, size_t size);
arrays_status arrays_deserialise(const arrays_component *self, const void *bytes, size_t size, void **state);

#endif
