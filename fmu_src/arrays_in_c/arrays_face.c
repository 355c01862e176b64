/* What the faces of FMI 2.0 and 3.0 share around an object of arrays. */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "arrays.h"

/* In front of a saved state: which object it belongs to, and where the run was. */
typedef struct {
    char token[48];
    size_t numbers;
    arrays_phase now;
    double start, time;
} kept;

/* Rounding that a host's times may have. */
static const double ROUNDING = 1e-9;

arrays_status arrays_say(const arrays_component *self, arrays_status status, const char *format, ...)
{
    char sentence[ARRAYS_PROBLEM], text[2 * sizeof sentence];
    size_t length = 0;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(sentence, sizeof sentence, format, arguments);
    va_end(arguments);
    /* The sentence is a format for hosts that expand none, too: % is doubled; line breaks end nothing. */
    for (const char *c = sentence; *c; ++c) {
        if (*c == '%') text[length++] = '%';
        text[length++] = *c == '\n' || *c == '\r' ? ' ' : *c;
    }
    text[length] = '\0';
    if (self->tell && self->logger) self->tell(self, status, text);
    return status;
}

bool arrays_may(const arrays_component *self, int phases, const char *function)
{
    if (!self) return false;
    if (self->now & phases) return true;
    arrays_say(self, ARRAYS_ERROR, "%s may not be called now; see %s.", function, self->standard);
    return false;
}

/* The path in a URI "file:///a%20b", or a path as it is, without a separator at its end. */
static void decode(const char *uri, char *path)
{
    char *const begin = path;
    if (strncmp(uri, "file:", 5) == 0) {
        uri += 5;
        if (strncmp(uri, "//", 2) == 0) uri += 2 + strcspn(uri + 2, "/"); /* behind the host's name, which is empty */
        if (uri[0] == '/' && uri[1] && uri[2] == ':') ++uri;               /* "/C:/" */
    }
    while (*uri) {
        unsigned letter;
        const bool coded = uri[0] == '%' && uri[1] && uri[2] && sscanf(uri + 1, "%2x", &letter) == 1;
        *path++ = coded ? (char)letter : *uri;
        uri += coded ? 3 : 1;
    }
    while (path > begin + 1 && (path[-1] == '/' || path[-1] == '\\')) --path;
    *path = '\0';
}

arrays_component *arrays_instantiate(const arrays_component *log, const char *name, const char *token, const char *resources)
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
        decode(resources ? resources : "", folder);
        if (!*self->name)
            snprintf(problem, sizeof problem, "Give the instance a name.");
        else if (!token || strcmp(token, ARRAYS_TOKEN) != 0)
            snprintf(problem, sizeof problem, "The identifier is another FMU's; take modelDescription.xml and binary of one FMU.");
        else if (!*folder)
            snprintf(problem, sizeof problem, "Give the instance the folder of its resources, which holds what it is made of.");
        else
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
    if (fabs(time - self->time) > ROUNDING * fmax(1.0, fabs(time)) + 1e-3 * step)
        return arrays_say(self, ARRAYS_ERROR, "Go on from where the last step ended, %g s: this one began at %g s.", self->time, time);
    if (!arrays_go(self->object, time, step, problem)) return arrays_say(self, ARRAYS_DISCARD, "%s", problem);
    self->time = time + step;
    return ARRAYS_OK;
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
        arrays_say(self, ARRAYS_ERROR, "Set %s[%zu] to %g to %g %s: it was %g.", about->name, element + 1, about->least, about->most,
                   about->unit, value);
    }
    return !wrong;
}

size_t arrays_bytes(const arrays_component *self)
{
    return sizeof(kept) + arrays_numbers(self->object) * sizeof(double);
}

arrays_status arrays_keep(const arrays_component *self, void **state)
{
    kept head = {.numbers = arrays_numbers(self->object), .now = self->now, .start = self->start, .time = self->time};
    memcpy(head.token, ARRAYS_TOKEN, strlen(ARRAYS_TOKEN) < sizeof head.token ? strlen(ARRAYS_TOKEN) : sizeof head.token);
    if (!*state) *state = malloc(arrays_bytes(self));
    if (!*state) return arrays_say(self, ARRAYS_ERROR, "There is no memory for a saved state of %zu bytes.", arrays_bytes(self));
    memcpy(*state, &head, sizeof head);
    arrays_save(self->object, (double *)((char *)*state + sizeof head));
    return ARRAYS_OK;
}

bool arrays_is_state(const arrays_component *self, const void *bytes, size_t size)
{
    kept head;
    if (bytes && size == arrays_bytes(self)) {
        memcpy(&head, bytes, sizeof head);
        const size_t length = strlen(ARRAYS_TOKEN) < sizeof head.token ? strlen(ARRAYS_TOKEN) : sizeof head.token;
        if (memcmp(head.token, ARRAYS_TOKEN, length) == 0 && head.numbers == arrays_numbers(self->object)) return true;
    }
    arrays_say(self, ARRAYS_ERROR, "This state is not one of this FMU with as many variables; give one that it has saved.");
    return false;
}

arrays_status arrays_take_back(arrays_component *self, const void *state)
{
    kept head;
    memcpy(&head, state, sizeof head);
    self->now = head.now;
    self->start = head.start;
    self->time = head.time;
    arrays_load(self->object, (const double *)((const char *)state + sizeof head));
    return ARRAYS_OK;
}
