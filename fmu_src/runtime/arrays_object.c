/* An object of arrays (arrays.h) with the FMI interfaces. */
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>

#include "arrays.h"
#include "duration.h"
#include "object.h"
#include "resources.h"
#include "sealed.h"
#include "start_values.h"

/* Bytes of a file at most. */
enum { LARGEST = 1 << 27 };

/* State of a run. It has no padding, so that equal states have equal bytes. */
typedef struct {
    double time;
    long long int settled, ended; /* whether outputs match the inputs; whether no step follows */
} run;

struct fmu_object {
    arrays_object *own;
    char *start_values; /* path of a file that may be there; NULL: the host gave no folder */
    run now;
    double stop; /* infinite: not set */
    kernel_sentence message; /* NULL: all messages were delivered */
    char sentence[MESSAGE_SIZE];
};

/* ---- files ---- */

static double *read_numbers(FILE *file, size_t *count) {
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

double *arrays_read(const char *folder, const char *name, size_t *count, char problem[MESSAGE_SIZE]) {
    if (!folder) {
        strcpy(problem, "The folder of resources must be given to the instance; got none.");
        return NULL;
    }
    const size_t length = strlen(folder) + strlen(name) + 2;
    char *path = (char *)malloc(length);
    if (path) print_text(path, length, "%s/%s", folder, name);
    const char *why = NULL;
    FILE *file = path ? resources_open(path, &why) : NULL;
    double *numbers = file ? read_numbers(file, count) : NULL;
    if (file) fclose(file);
    if (!numbers)
        print_text(problem, MESSAGE_SIZE, "%.200s/%s %s; build the FMU again.", folder, name, why ? why : "cannot be read");
    free(path);
    return numbers;
}

bool arrays_is_due(double time, double start, double period, double *count) {
    const double gone = time - start, rounding = 1e-9 + 4.5e-16 * fabs(time); /* [s] */
    if (gone < *count * period - rounding) return false;
    *count = floor((gone + rounding) / period) + 1.0;
    return true;
}

unsigned long long arrays_mark_of(const double *numbers, size_t count) {
    return seal_hash(SEAL_BEGIN, numbers, count * sizeof *numbers);
}

/* ---- description and messages of the object ---- */

static const char *object_token(void) { return ARRAYS_TOKEN; }
static const char *object_name(void) { return ARRAYS_NAME; }
static unsigned object_variables(void) { return ARRAYS; }
static unsigned object_stride(void) { return ARRAYS_STRIDE; }
static const variable_description *object_variable(unsigned number) { return number < ARRAYS ? &ARRAYS_ABOUT[number] : NULL; }

static void object_dispose(fmu_object *self) {
    if (self->own) arrays_free(self->own);
    free(self->start_values);
    free(self);
}

/* Keep the path of start values; false without memory. */
static bool keep_folder(fmu_object *self, const char *folder) {
    if (!folder) return true;
    const size_t length = strlen(folder) + sizeof "/" START_VALUES;
    self->start_values = (char *)malloc(length);
    if (self->start_values) print_text(self->start_values, length, "%s/%s", folder, START_VALUES);
    return self->start_values != NULL;
}

static fmu_object *object_make(const char *folder, bool exchange, char problem[MESSAGE_SIZE]) {
    (void)exchange; /* which the table does not have */
    fmu_object *self = (fmu_object *)calloc(1, sizeof *self);
    if (self && keep_folder(self, folder)) self->own = arrays_create(folder, problem);
    if (self && self->own) return self;
    if (self) object_dispose(self);
    return NULL;
}

static kernel_status say(fmu_object *self, kernel_status status, const char *format, ...) LIKE_PRINTF(3);
static kernel_status say(fmu_object *self, kernel_status status, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    print_list(self->sentence, sizeof self->sentence, format, arguments);
    va_end(arguments);
    self->message.status = status;
    self->message.text = self->sentence;
    return status;
}

static bool object_hear(fmu_object *self, kernel_sentence *heard) {
    *heard = self->message;
    self->message.text = NULL;
    return heard->text != NULL;
}

/* ---- numbers ---- */

static size_t object_length(const fmu_object *self, unsigned variable) {
    size_t count;
    (void)arrays_values(self->own, variable, &count);
    return count;
}

static double *elements(const fmu_object *self, unsigned variable, size_t first) {
    size_t count;
    return arrays_values(self->own, variable, &count) + first;
}

static kernel_status object_get(fmu_object *self, unsigned variable, size_t first, size_t count, double *value) {
    memcpy(value, elements(self, variable, first), count * sizeof *value);
    return KERNEL_OK;
}

static kernel_status refuse(fmu_object *self, unsigned variable, size_t element, double value) {
    const variable_description *about = &ARRAYS_ABOUT[variable];
    const bool bare = !*about->unit || strcmp(about->unit, "1") == 0;
    char place[32] = "";
    if (object_length(self, variable) > 1) print_text(place, sizeof place, "[%zu]", element + 1);
    return say(self, KERNEL_ERROR, "%s%s must be from %g to %g%s%s; got %g.", about->name, place, about->minimum,
               about->maximum, bare ? "" : " ", bare ? "" : about->unit, value);
}

static kernel_status object_check(fmu_object *self, unsigned variable, size_t first, size_t count, const double *value) {
    const variable_description *about = &ARRAYS_ABOUT[variable];
    const bool may_be_lost = !isnan(about->when_lost);
    for (size_t k = 0; k < count; ++k) {
        const bool within = isfinite(value[k]) && value[k] >= about->minimum && value[k] <= about->maximum;
        const bool fits = isnan(value[k]) ? may_be_lost : within;
        if (!fits) return refuse(self, variable, first + k, value[k]);
        const bool is_pressure = about->causality == CAUSALITY_PARAMETER && strcmp(about->unit, "Pa") == 0;
        if (is_pressure && value[k] > 0.0 && value[k] < ARRAYS_LEAST_PRESSURE)
            return say(self, KERNEL_ERROR, "%s must be 0 or from %g to %g Pa; got %g. Give Pa: 1 bar is 100000 Pa.",
                       about->name, ARRAYS_LEAST_PRESSURE, about->maximum, value[k]);
    }
    return KERNEL_OK;
}

static kernel_status object_set(fmu_object *self, unsigned variable, size_t first, size_t count, const double *value) {
    memcpy(elements(self, variable, first), value, count * sizeof *value);
    return KERNEL_OK;
}

/* ---- runs ---- */

/* Find the array of NAME, one of a single element, or of NAME[N], and its element from 0; false if it does not exist. */
static bool find_element(const fmu_object *self, const char *name, unsigned *variable, size_t *element) {
    const size_t length = strcspn(name, "[");
    unsigned number = 1;
    char end = ']';
    for (*variable = 0; *variable < ARRAYS; ++*variable)
        if (strlen(ARRAYS_ABOUT[*variable].name) == length && strncmp(ARRAYS_ABOUT[*variable].name, name, length) == 0) break;
    if (*variable == ARRAYS || (!name[length] && object_length(self, *variable) != 1)) return false;
    if (name[length] && (sscanf(name + length, "[%u%c", &number, &end) != 2 || end != ']')) return false;
    *element = (size_t)number - 1;
    return *element < object_length(self, *variable);
}

static start_taken take_start(fmu_object *self, const char *name, double number) {
    unsigned variable;
    size_t element;
    if (!find_element(self, name, &variable, &element) || ARRAYS_ABOUT[variable].causality == CAUSALITY_OUTPUT)
        return START_UNKNOWN;
    if (object_check(self, variable, element, 1, &number) != KERNEL_OK) return START_REFUSED;
    return object_set(self, variable, element, 1, &number) == KERNEL_OK ? START_TAKEN : START_REFUSED;
}

/* Set the start values of the FMU's own, where there are any. */
static kernel_status own_start_values(fmu_object *self) {
    char problem[MESSAGE_SIZE];
    const char *why;
    FILE *file = resources_open(self->start_values, &why);
    if (why)
        return say(self, KERNEL_ERROR, "The file %s of the resources %s; put a file there that can be read, or nothing.",
                   START_VALUES, why);
    if (!file || start_values_read(file, ARRAYS_NAME, self, take_start, problem)) return KERNEL_OK;
    return *problem ? say(self, KERNEL_ERROR, "%s", problem) : KERNEL_ERROR;
}

static kernel_status object_reset(fmu_object *self) {
    arrays_reset(self->own);
    memset(&self->now, 0, sizeof self->now);
    self->stop = INFINITY;
    return self->start_values ? own_start_values(self) : KERNEL_OK;
}

static kernel_status object_plan(fmu_object *self, const double *tolerance, double start, const double *stop) {
    char problem[DURATION_PROBLEM];
    (void)tolerance;
    if (plan_is_wrong(start, stop, problem)) return say(self, KERNEL_ERROR, "%s", problem);
    if (fabs(start) > FARTHEST_TIME)
        return say(self, KERNEL_ERROR, "The start time must be from -%g to %g s; got %g s. Begin nearer to 0.", FARTHEST_TIME,
                   FARTHEST_TIME, start);
    self->stop = stop ? *stop : INFINITY;
    return KERNEL_OK;
}

static kernel_status object_initialise(fmu_object *self, double start) {
    arrays_start(self->own, start);
    self->now.time = start;
    self->now.settled = 1;
    return KERNEL_OK;
}
static bool object_initialised(const fmu_object *self) { return self->now.settled != 0; }
static void object_reopen(fmu_object *self) { self->now.settled = 0; }

static kernel_status object_step(fmu_object *self, double time, double step) {
    char problem[MESSAGE_SIZE] = "", wrong[DURATION_PROBLEM];
    bool ended = false;
    if (size_is_wrong(step, wrong) || time_is_wrong(time, step, self->now.time, self->stop, wrong))
        return say(self, KERNEL_ERROR, "%s", wrong);
    if (time + step > 2.0 * FARTHEST_TIME)
        return say(self, KERNEL_ERROR, "Steps must end at most at %g s; got a step of %g s at %g s.", 2.0 * FARTHEST_TIME, step,
                   time);
    const kernel_status status = arrays_go(self->own, time, step, &ended, problem);
    if (status != KERNEL_OK || *problem) (void)say(self, status, "%s", problem);
    if (status > KERNEL_WARNING && !ended) return status;
    self->now.time = time + step;
    self->now.ended = ended;
    return status;
}
static double object_time(const fmu_object *self) { return self->now.time; }
static bool object_ended(const fmu_object *self) { return self->now.ended != 0; }

/* ---- saved states ---- */

static size_t object_block_size(const fmu_object *self) {
    return sizeof self->now + arrays_numbers(self->own) * sizeof(double);
}

static void object_copy_block(fmu_object *self, void *bytes) {
    memcpy(bytes, &self->now, sizeof self->now);
    arrays_save(self->own, (double *)((char *)bytes + sizeof self->now));
}

static kernel_status object_take_block(fmu_object *self, const void *bytes) {
    memcpy(&self->now, bytes, sizeof self->now);
    arrays_load(self->own, (const double *)((const char *)bytes + sizeof self->now));
    return KERNEL_OK;
}

static unsigned long long object_mark(const fmu_object *self) { return arrays_mark(self->own); }

RUNTIME_LOCAL const object_functions OBJECT = {
    /* token */ object_token,
    /* name */ object_name,
    /* variables */ object_variables,
    /* variable */ object_variable,
    /* stride */ object_stride,
    /* make */ object_make,
    /* dispose */ object_dispose,
    /* reset */ object_reset,
    /* listen */ NULL,
    /* hear */ object_hear,
    /* length */ object_length,
    /* get */ object_get,
    /* check */ object_check,
    /* set */ object_set,
    /* get_text */ NULL,
    /* set_text */ NULL,
    /* plan */ object_plan,
    /* initialise */ object_initialise,
    /* initialised */ object_initialised,
    /* reopen */ object_reopen,
    /* step */ object_step,
    /* time */ object_time,
    /* ended */ object_ended,
    /* stop_at_events */ NULL,
    /* block_size */ object_block_size,
    /* copy_block */ object_copy_block,
    /* take_block */ object_take_block,
    /* mark */ object_mark,
    /* set_rates */ NULL,
    /* get_rates */ NULL,
    /* get_directional */ NULL,
    /* exchange */ NULL,
};
