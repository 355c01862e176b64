/* What the faces of FMI 2.0 and 3.0 share around an object of arrays. */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "arrays.h"
#include "duration.h"
#include "readable.h"
#include "resources.h"
#include "sealed.h"

/* In a saved state, in front of the object's numbers: where the run was. */
typedef struct {
    unsigned long long now; /* arrays_phase */
    double start, time;
} kept;

/* Bytes of a file at most. */
enum { LARGEST = 1 << 27 };
/* Rounding that a host's times may have. */
static const double ROUNDING = 1e-9;

arrays_status arrays_say(const arrays_component *self, arrays_status status, const char *format, ...)
{
    char sentence[ARRAYS_PROBLEM];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(sentence, sizeof sentence, format, arguments);
    va_end(arguments);
    make_readable(sentence); /* sentences quote paths, which may be anything */
    if (self->tell && self->logger) self->tell(self, status, sentence);
    return status;
}

bool arrays_may(const arrays_component *self, int phases, const char *function)
{
    if (!self) return false;
    if (self->now & phases) return true;
    arrays_say(self, ARRAYS_ERROR, "%s may not be called now; see %s.", function, self->standard);
    return false;
}

static double *read_numbers(FILE *file, size_t *count)
{
    if (fseek(file, 0, SEEK_END) != 0) return NULL;
    const long size = ftell(file);
    rewind(file);
    if (size <= 0 || size >= LARGEST || size % (long)sizeof(double) != 0) return NULL;
    double *numbers = (double *)malloc((size_t)size);
    if (numbers && fread(numbers, 1, (size_t)size, file) != (size_t)size) {
        free(numbers);
        numbers = NULL;
    }
    *count = (size_t)size / sizeof(double);
    return numbers;
}

double *arrays_read(const char *folder, const char *name, size_t *count, char problem[ARRAYS_PROBLEM])
{
    const size_t length = strlen(folder) + strlen(name) + 2;
    char *path = (char *)malloc(length);
    if (path) snprintf(path, length, "%s/%s", folder, name);
    const char *why = NULL;
    FILE *file = path ? resources_open(path, &why) : NULL;
    double *numbers = file ? read_numbers(file, count) : NULL;
    if (file) fclose(file);
    if (!numbers) snprintf(problem, ARRAYS_PROBLEM, "%.200s/%s %s; build the FMU again.", folder, name, why ? why : "cannot be read");
    free(path);
    return numbers;
}

arrays_component *arrays_instantiate(const arrays_component *log, const char *name, const char *token, const char *resources,
                                     arrays_place *place)
{
    char problem[ARRAYS_PROBLEM] = "There is no memory for an instance.";
    arrays_component *self = (arrays_component *)malloc(sizeof *self);
    if (!self) return NULL;
    *self = *log;
    self->now = INSTANTIATED;
    self->name = (char *)malloc(strlen(name ? name : "") + 1);
    char *folder = (char *)malloc(strlen(resources ? resources : "") + 1);
    if (self->name && folder) {
        strcpy(self->name, name ? name : "");
        if (!*self->name)
            snprintf(problem, sizeof problem, "Give the instance a name.");
        else if (!token || strcmp(token, ARRAYS_TOKEN) != 0)
            snprintf(problem, sizeof problem, "The identifier is another FMU's; take modelDescription.xml and binary of one FMU.");
        else if (!resources || !*resources)
            snprintf(problem, sizeof problem, "Give the instance the folder of its resources, which holds what it is made of.");
        else if (place(resources, folder, problem))
            self->object = arrays_create(folder, problem);
    }
    free(folder);
    if (self->object) {
        arrays_begin_anew(self);
        return self;
    }
    arrays_say(self, ARRAYS_ERROR, "%s", problem);
    arrays_release(self);
    return NULL;
}

void arrays_release(arrays_component *self)
{
    if (!self) return;
    if (self->object) arrays_free(self->object);
    free(self->name);
    free(self);
}

void arrays_begin_anew(arrays_component *self)
{
    self->now = INSTANTIATED;
    self->start = self->time = 0.0;
    self->stale = true;
    arrays_reset(self->object);
}

arrays_status arrays_plan(arrays_component *self, double start)
{
    if (!isfinite(start)) return arrays_say(self, ARRAYS_ERROR, "Set the start time to a finite number: it was %g s.", start);
    self->start = self->time = start;
    return ARRAYS_OK;
}

arrays_status arrays_initialise(arrays_component *self)
{
    char problem[ARRAYS_PROBLEM] = "";
    if (!arrays_start(self->object, self->start, problem)) return arrays_say(self, ARRAYS_ERROR, "%s", problem);
    self->now = RUNNING;
    return ARRAYS_OK;
}

arrays_status arrays_step(arrays_component *self, double time, double step)
{
    char problem[ARRAYS_PROBLEM] = "";
    if (!(isfinite(time) && isfinite(step) && step > 0.0))
        return arrays_say(self, ARRAYS_ERROR, "Give doStep a finite time and a step above 0 s: they were %g s and %g s.", time, step);
    if (step > LONGEST_STEP)
        return arrays_say(self, ARRAYS_ERROR, "Take steps of at most %g s: this one was of %g s at %g s.", LONGEST_STEP, step, time);
    if (fabs(time - self->time) > ROUNDING * fmax(1.0, fabs(time)) + 1e-3 * step)
        return arrays_say(self, ARRAYS_ERROR, "Go on from where the last step ended, %g s: this one began at %g s.", self->time, time);
    if (!arrays_go(self->object, time, step, problem)) return arrays_say(self, self->failed, "%s", problem);
    self->time = time + step;
    return ARRAYS_OK;
}

void arrays_settle(arrays_component *self)
{
    char problem[ARRAYS_PROBLEM];
    if (self->now != INITIALISING || !self->stale) return;
    self->stale = !arrays_start(self->object, self->start, problem);
}

size_t arrays_length(const arrays_component *self, unsigned array)
{
    size_t count = 0;
    if (array < (unsigned)ARRAYS) arrays_values(self->object, (int)array, &count);
    return count;
}

double *arrays_find(const arrays_component *self, unsigned array, size_t element, int whole, const char *function)
{
    size_t count = 0;
    double *values = array < (unsigned)ARRAYS ? arrays_values(self->object, (int)array, &count) : NULL;
    if (values && element < count && ARRAYS_ABOUT[array].whole == whole) return values;
    arrays_say(self, ARRAYS_ERROR, "%s: no such variable has the reference; see modelDescription.xml.", function);
    return NULL;
}

bool arrays_settable(const arrays_component *self, unsigned array, size_t element, double value)
{
    const arrays_about *about = &ARRAYS_ABOUT[array];
    const char *wrong = about->causality == ARRAY_OUTPUT                                ? "it is an output and cannot be set"
                        : about->causality == ARRAY_PARAMETER && self->now == RUNNING ? "it is fixed once the run has begun"
                                                                                      : NULL;
    if (wrong)
        arrays_say(self, ARRAYS_ERROR, "Leave %s as it is: %s.", about->name, wrong);
    else if (!(value >= about->least && value <= about->most)) {
        wrong = "limits";
        arrays_say(self, ARRAYS_ERROR, "Set %s[%zu] to %g to %g%s%s: it was %g.", about->name, element + 1, about->least, about->most,
                   *about->unit ? " " : "", about->unit, value);
    }
    return !wrong;
}

unsigned long long arrays_mark_of(unsigned long long mark, const double *numbers, size_t count)
{
    return seal_hash(mark, numbers, count * sizeof *numbers);
}

/* ---- saved states: behind the seal of all faces where the run was, and the object's numbers ---- */

static size_t block_of(const arrays_component *self)
{
    return sizeof(kept) + arrays_numbers(self->object) * sizeof(double);
}

/* A state belongs to one binary and to the files that the object was made of. */
static unsigned long long model_of(const arrays_component *self)
{
    const unsigned long long mark = arrays_mark(self->object);
    return seal_hash(seal_model(ARRAYS_TOKEN), &mark, sizeof mark);
}

/* Whether a state is a whole one of this object; false: it was told. */
static bool is_ours(const arrays_component *self, const void *state, size_t size)
{
    char problem[SEALED_PROBLEM];
    if (seal_holds(state, size, model_of(self), block_of(self), problem)) return true;
    arrays_say(self, ARRAYS_ERROR, "%s", problem);
    return false;
}

/* Room for a state: what is there already, if it is one of this object. */
static bool make_room(const arrays_component *self, void **state)
{
    if (!state) {
        arrays_say(self, ARRAYS_ERROR, "Give a place for the saved state.");
        return false;
    }
    if (*state) {
        if (seal_is_of(*state, model_of(self), block_of(self))) return true;
        arrays_say(self, ARRAYS_ERROR, "The place holds no saved state of this FMU; give one that it has saved, or a null pointer.");
        return false;
    }
    *state = malloc(sealed_size(block_of(self)));
    if (!*state) arrays_say(self, ARRAYS_ERROR, "There is no memory for a saved state of %zu bytes.", sealed_size(block_of(self)));
    return *state != NULL;
}

arrays_status arrays_keep(const arrays_component *self, void **state)
{
    const kept head = {(unsigned long long)self->now, self->start, self->time};
    if (!make_room(self, state)) return ARRAYS_ERROR;
    char *block = (char *)sealed_block(*state);
    memcpy(block, &head, sizeof head);
    arrays_save(self->object, (double *)(block + sizeof head));
    seal_state(*state, model_of(self), block_of(self));
    return ARRAYS_OK;
}

arrays_status arrays_take_back(arrays_component *self, const void *state)
{
    kept head;
    if (!is_ours(self, state, sealed_size(block_of(self)))) return ARRAYS_ERROR;
    const char *block = (const char *)sealed_content(state);
    memcpy(&head, block, sizeof head);
    self->now = (arrays_phase)head.now;
    self->start = head.start;
    self->time = head.time;
    self->stale = true;
    arrays_load(self->object, (const double *)(block + sizeof head));
    return ARRAYS_OK;
}

arrays_status arrays_size(const arrays_component *self, const void *state, size_t *size)
{
    if (!is_ours(self, state, sealed_size(block_of(self)))) return ARRAYS_ERROR;
    if (!size) return arrays_say(self, ARRAYS_ERROR, "Give a place for the size of the saved state.");
    *size = sealed_size(block_of(self));
    return ARRAYS_OK;
}

arrays_status arrays_serialise(const arrays_component *self, const void *state, void *bytes, size_t size)
{
    const size_t due = sealed_size(block_of(self));
    if (!is_ours(self, state, due)) return ARRAYS_ERROR;
    if (!bytes || size < due)
        return arrays_say(self, ARRAYS_ERROR, "Give room for the whole state, %zu bytes: there were %zu.", due, size);
    memcpy(bytes, state, due);
    return ARRAYS_OK;
}

arrays_status arrays_deserialise(const arrays_component *self, const void *bytes, size_t size, void **state)
{
    if (!is_ours(self, bytes, size) || !make_room(self, state)) return ARRAYS_ERROR;
    memcpy(*state, bytes, size);
    return ARRAYS_OK;
}
