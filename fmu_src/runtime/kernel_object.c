/* A kernel with the FMI interfaces: its variables are scalars, and its own files may give start values and a table. */
#include "instance.h"
#include "object.h"
#include "resources.h"
#include "start_values.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char OWN_START_VALUES[] = "/" START_VALUES; /* among the resources */

struct fmu_object {
    kernel *machine;
    bool exchange;
    char *resources; /* folder of the FMU's own files, with room for their names; NULL: not given */
    size_t folder_length;
};

static const char *object_token(void) { return MODEL.guid; }
static const char *object_name(void) { return MODEL.name; }
static unsigned object_variables(void) { return (unsigned)MODEL.variables; }
static unsigned object_stride(void) { return 1; }

/* Numbers after that of the time are slopes and event indicators, which can only be read. */
static const variable_description *object_variable(unsigned number) {
    static const variable_description EXCHANGED = {"", "1", KIND_REAL, CAUSALITY_LOCAL, 0.0, -INFINITY, INFINITY, NAN};
    if (number < (unsigned)MODEL.variables) return &MODEL.variable[number];
    return kernel_exchanged_number((int)number) < 0 ? NULL : &EXCHANGED;
}

static void object_dispose(fmu_object *self) {
    kernel_free(self->machine);
    free(self->resources);
    free(self);
}

static bool keep_folder(fmu_object *self, const char *folder) {
    const size_t of_table = MODEL.table_file ? strlen(MODEL.table_file->resource) + 1 : 0;
    const size_t of_records = MODEL.record_file ? strlen(MODEL.record_file->resource) + 1 : 0;
    self->folder_length = strlen(folder);
    self->resources = (char *)malloc(self->folder_length + of_table + of_records + sizeof OWN_START_VALUES);
    if (self->resources) strcpy(self->resources, folder);
    return self->resources != NULL;
}

static fmu_object *object_make(const char *folder, bool exchange, char problem[MESSAGE_SIZE]) {
    if (exchange && kernel_exchange_states() == 0) {
        strcpy(problem, "There is no model exchange, as modelDescription.xml says: these equations have algebraic states.");
        return NULL;
    }
    fmu_object *self = (fmu_object *)calloc(1, sizeof *self);
    if (!self) return NULL;
    self->exchange = exchange;
    self->machine = kernel_create();
    if (self->machine && (!folder || keep_folder(self, folder))) return self;
    object_dispose(self);
    return NULL;
}

/* ---- the FMU's own files ---- */

/* Open one of the FMU's own files, with its path in self->resources until the next call. NULL if it does not exist, or with an
 * error in `status`. */
static FILE *own_file(fmu_object *self, const char *name, kernel_status *status) {
    const char *why;
    strcpy(self->resources + self->folder_length, name);
    FILE *file = resources_open(self->resources, &why);
    if (why) {
        const size_t length = strlen(self->resources), shown = 300; /* its end, which has the file's own name */
        *status = kernel_fail(self->machine, KERNEL_ERROR, "%s%s %s; put a file there that can be read, or nothing.",
                              length > shown ? "..." : "", self->resources + (length > shown ? length - shown : 0), why);
    }
    return file;
}

static start_taken take_start(fmu_object *self, const char *name, double number) {
    for (int i = 0; i < MODEL.variables; ++i) {
        if (strcmp(name, MODEL.variable[i].name) != 0) continue;
        const kernel_status status = kernel_set(self->machine, i, number);
        if (MODEL.variable[i].causality == CAUSALITY_PARAMETER) kernel_keep_own(self->machine, i);
        return status <= KERNEL_WARNING ? START_TAKEN : START_REFUSED;
    }
    return START_UNKNOWN;
}

static kernel_status own_start_values(fmu_object *self) {
    char problem[MESSAGE_SIZE];
    kernel_status status = KERNEL_OK;
    FILE *file = own_file(self, OWN_START_VALUES, &status);
    if (!file || start_values_read(file, MODEL.name, self, take_start, problem)) return status;
    return *problem ? kernel_fail(self->machine, KERNEL_ERROR, "%s", problem) : KERNEL_ERROR;
}

/* Return the name of the FMU's own file for a variable that names a file; NULL for another variable. */
static const char *resource_of(int variable) {
    if (MODEL.table_file && variable == MODEL.table_file->variable) return MODEL.table_file->resource;
    return MODEL.record_file && variable == MODEL.record_file->variable ? MODEL.record_file->resource : NULL;
}

/* Set the variable of a file to the FMU's own one, if there is one. */
static kernel_status own_data(fmu_object *self, const char *resource, int variable, bool *found) {
    kernel_status status = KERNEL_OK;
    FILE *file = own_file(self, resource, &status);
    *found = file != NULL;
    if (!file) return status;
    fclose(file);
    status = kernel_set_text(self->machine, variable, self->resources);
    if (status == KERNEL_OK) kernel_keep_own(self->machine, variable);
    return status;
}

/* Start values are those of the FMU's own files, where there are any: `start_values.csv` has rows NAME,VALUE, and the
 * resources that a table file and a file of records are called are these files. */
static kernel_status object_reset(fmu_object *self) {
    kernel_reset(self->machine);
    if (!self->resources) return KERNEL_OK;
    kernel_status status = own_start_values(self);
    for (int i = 0; i < MODEL.variables && status <= KERNEL_WARNING; ++i) {
        bool found;
        if (resource_of(i)) status = own_data(self, resource_of(i), i, &found);
    }
    return status;
}

/* ---- the kernel's functions, by the names of the table ---- */

static void object_listen(fmu_object *self, unsigned statuses) { kernel_listen(self->machine, statuses); }
static bool object_hear(fmu_object *self, kernel_sentence *heard) { return kernel_hear(self->machine, heard); }

static size_t object_length(const fmu_object *self, unsigned variable) {
    (void)self, (void)variable;
    return 1;
}

static kernel_status object_get(fmu_object *self, unsigned variable, size_t first, size_t count, double *value) {
    (void)first, (void)count;
    const int exchanged = kernel_exchanged_number((int)variable);
    return exchanged >= 0 ? kernel_get_exchanged(self->machine, exchanged, value)
                          : kernel_get(self->machine, (int)variable, value);
}

static kernel_status object_check(fmu_object *self, unsigned variable, size_t first, size_t count, const double *value) {
    (void)first, (void)count;
    return kernel_check_set(self->machine, (int)variable, *value);
}

static kernel_status object_set(fmu_object *self, unsigned variable, size_t first, size_t count, const double *value) {
    (void)first, (void)count;
    return kernel_set(self->machine, (int)variable, *value);
}

static kernel_status object_get_text(fmu_object *self, unsigned variable, const char **text) {
    return kernel_get_text(self->machine, (int)variable, text);
}

/* An empty text selects the FMU's own file: hosts set every start value of modelDescription.xml, this empty one too. */
static kernel_status object_set_text(fmu_object *self, unsigned variable, const char *text) {
    const char *own = text && !*text && self->resources ? resource_of((int)variable) : NULL;
    bool found = false;
    const kernel_status status = own ? own_data(self, own, (int)variable, &found) : KERNEL_OK;
    return found || status > KERNEL_WARNING ? status : kernel_set_text(self->machine, (int)variable, text);
}

static kernel_status object_plan(fmu_object *self, const double *tolerance, double start, const double *stop) {
    return kernel_plan(self->machine, tolerance, start, stop);
}

static kernel_status object_initialise(fmu_object *self, double start) {
    const kernel_status status = kernel_initialise(self->machine, start);
    return self->exchange && status <= KERNEL_WARNING && kernel_check_exchange(self->machine) != KERNEL_OK ? KERNEL_ERROR
                                                                                                           : status;
}
static bool object_initialised(const fmu_object *self) { return kernel_state_count(self->machine) != 0; }
static void object_reopen(fmu_object *self) { kernel_reopen(self->machine); }

static kernel_status object_step(fmu_object *self, double time, double size) { return kernel_step(self->machine, time, size); }
static double object_time(const fmu_object *self) { return kernel_time(self->machine); }
static bool object_ended(const fmu_object *self) { return kernel_ended(self->machine); }
static void object_stop_at_events(fmu_object *self, bool stops) { kernel_stop_at_events(self->machine, stops); }

static size_t object_block_size(const fmu_object *self) { return kernel_block_size(self->machine); }
static void object_copy_block(fmu_object *self, void *bytes) { kernel_copy_block(self->machine, bytes); }
static kernel_status object_take_block(fmu_object *self, const void *bytes) { return kernel_take_block(self->machine, bytes); }

static kernel_status object_set_rates(fmu_object *self, size_t count, const unsigned *variable, const double *rate) {
    kernel_status status = KERNEL_OK;
    for (size_t i = 0; i < count && status == KERNEL_OK; ++i)
        status = kernel_check_rate(self->machine, (int)variable[i], rate[i]);
    for (size_t i = 0; i < count && status == KERNEL_OK; ++i)
        status = kernel_set_rate(self->machine, (int)variable[i], rate[i]);
    return status;
}

static kernel_status object_get_rates(fmu_object *self, size_t count, const unsigned *variable, double *rate) {
    return kernel_get_rates(self->machine, (int)count, (const int *)variable, rate);
}

static kernel_status object_get_directional(fmu_object *self, size_t unknowns, const unsigned *unknown, size_t knowns,
                                            const unsigned *known, const double *change, double *result) {
    return kernel_get_directional(self->machine, (int)unknowns, (const int *)unknown, (int)knowns, (const int *)known, change,
                                  result);
}

/* ---- model exchange ---- */

static kernel_status object_set_time(fmu_object *self, double time) { return kernel_set_time(self->machine, time); }
static kernel_status object_set_states(fmu_object *self, const double *state) {
    return kernel_set_states(self->machine, state);
}
static kernel_status object_get_states(fmu_object *self, double *state) { return kernel_get_states(self->machine, state); }
static kernel_status object_get_slopes(fmu_object *self, double *slope) { return kernel_get_slopes(self->machine, slope); }
static kernel_status object_get_indicators(fmu_object *self, double *indicator) {
    return kernel_get_indicators(self->machine, indicator);
}
static kernel_status object_find_modes(fmu_object *self, bool *jumped) { return kernel_find_modes(self->machine, jumped); }
static kernel_status object_complete_step(fmu_object *self, bool *crossed) {
    return kernel_complete_step(self->machine, crossed);
}

static const object_exchange EXCHANGE = {
    kernel_exchange_states, kernel_exchange_indicators, object_set_time,     object_set_states, object_get_states,
    object_get_slopes,      object_get_indicators,      kernel_get_nominals, object_find_modes, object_complete_step,
};

RUNTIME_LOCAL const object_functions OBJECT = {
    /* token */ object_token,
    /* name */ object_name,
    /* variables */ object_variables,
    /* variable */ object_variable,
    /* stride */ object_stride,
    /* make */ object_make,
    /* dispose */ object_dispose,
    /* reset */ object_reset,
    /* listen */ object_listen,
    /* hear */ object_hear,
    /* length */ object_length,
    /* get */ object_get,
    /* check */ object_check,
    /* set */ object_set,
    /* get_text */ object_get_text,
    /* set_text */ object_set_text,
    /* plan */ object_plan,
    /* initialise */ object_initialise,
    /* initialised */ object_initialised,
    /* reopen */ object_reopen,
    /* step */ object_step,
    /* time */ object_time,
    /* ended */ object_ended,
    /* stop_at_events */ object_stop_at_events,
    /* block_size */ object_block_size,
    /* copy_block */ object_copy_block,
    /* take_block */ object_take_block,
    /* mark */ NULL,
    /* set_rates */ object_set_rates,
    /* get_rates */ object_get_rates,
    /* get_directional */ object_get_directional,
    /* exchange */ &EXCHANGE,
};
