/* The common part of both faces. It knows the order of calls; the kernel knows the machine. */
#include "face.h"
#include "sealed.h"
#include "table_file.h"
#include "text_rows.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* By status. */
static const char *const CATEGORY[] = {"events", "logStatusWarning", "logStatusDiscard", "logStatusError"};
enum { CATEGORIES = 4, EVERYTHING = 15 };

static const char START_VALUES[] = "/start_values.csv"; /* among the resources */

static void say(const component *self, kernel_status status, const char *sentence) {
    const unsigned category = status <= KERNEL_ERROR ? (unsigned)status : (unsigned)KERNEL_ERROR;
    if (self->logger && ((self->logged | self->told) & (1u << category)))
        self->tell(self, status, CATEGORY[category], sentence);
}

/* The kernel writes no sentence that is not passed on. */
static void listen(const component *self) {
    kernel_listen(self->machine, self->logger ? self->logged | self->told : 0);
}

kernel_status face_error(const component *self, const char *sentence) {
    say(self, KERNEL_ERROR, sentence);
    return KERNEL_ERROR;
}

kernel_status face_report(component *self, kernel_status status) {
    char sentence[MESSAGE_SIZE]; /* of our own: a logger may call the instance, which then says more */
    kernel_sentence heard;
    while (kernel_hear(self->machine, &heard)) {
        strcpy(sentence, heard.text);
        say(self, heard.status, sentence);
    }
    return status;
}

bool face_legal(const component *self, int phases, const char *function) {
    if (!self) return false;
    if ((int)self->now & phases) return true;
    char sentence[160];
    snprintf(sentence, sizeof sentence, "%s must not be called now; see the state machine of %s.", function,
             self->standard);
    (void)face_error(self, sentence);
    return false;
}

bool face_missing(const component *self, size_t count, const void *one, const void *other) {
    return count && (!one || !other) && face_error(self, "An array is missing: a null pointer was given for its values.");
}

/* Event mode and the end are of both interfaces: what only one of them may do asks for it. */
bool face_is_cosimulation(const component *self) {
    return !self->exchange && face_error(self, "This instance is one of co-simulation, not of model exchange.");
}

bool face_is_exchange(const component *self) {
    return self->exchange && face_error(self, "This instance is one of model exchange, not of co-simulation.");
}

kernel_status face_log(component *self, int logging, size_t count, const char *const categories[]) {
    if (count == 0) {
        self->logged = logging ? EVERYTHING : 0;
        listen(self);
        return KERNEL_OK;
    }
    if (face_missing(self, count, categories, categories)) return KERNEL_ERROR;
    unsigned named = 0;
    for (size_t i = 0; i < count; ++i) {
        unsigned bit = 0;
        for (unsigned j = 0; j < CATEGORIES; ++j)
            if (categories[i] && strcmp(categories[i], CATEGORY[j]) == 0) bit = 1u << j;
        if (!bit) return face_error(self, "There is no such log category; modelDescription.xml lists them.");
        named |= bit;
    }
    self->logged = logging ? named : self->logged & ~named; /* to switch some on means: only these */
    listen(self);
    return KERNEL_OK;
}

component *face_instantiate(const component *log, const char *name, const char *token, int logging) {
    if (!name) {
        component nameless = *log;
        nameless.name = (char *)"";
        nameless.logged = logging ? EVERYTHING : 0;
        (void)face_error(&nameless, "Give the instance a name.");
        return NULL;
    }
    component *self = (component *)calloc(1, sizeof *self);
    if (!self) return NULL;
    *self = *log;
    self->logged = logging ? EVERYTHING : 0;
    self->name = (char *)malloc(strlen(name) + 1);
    if (self->name) strcpy(self->name, name);
    self->machine = kernel_create();
    if (self->machine) listen(self);
    self->now = INSTANTIATED;
    const char *problem = NULL;
    if (!self->name || !self->machine)
        problem = "There is not enough memory for an instance.";
    else if (!token || strcmp(token, MODEL.guid) != 0)
        problem = "The identifier of modelDescription.xml is not that of the binary; build both together.";
    else if (self->exchange && kernel_exchange_states() == 0)
        problem = "There is no model exchange, as modelDescription.xml says: these equations have algebraic states.";
    if (!problem) return self;
    if (self->name) (void)face_error(self, problem);
    face_free(self);
    return NULL;
}

/* A file among the resources, opened, its path in self->resources until the next one's; null: there is none, or `status`
 * is an error, which was told. */
static FILE *own_file(component *self, const char *name, kernel_status *status) {
    char *end = self->resources + self->folder_length, sentence[MESSAGE_SIZE];
    const char *why;
    strcpy(end, name);
    FILE *file = resources_open(self->resources, &why);
    if (why) {
        const size_t length = strlen(self->resources), shown = 300; /* its end, which has the file's own name */
        snprintf(sentence, sizeof sentence, "%s%s %s; put a file there that can be read, or nothing.", length > shown ? "..." : "",
                 self->resources + (length > shown ? length - shown : 0), why);
        kernel_make_readable(sentence);
        *status = face_error(self, sentence);
    }
    return file;
}

static kernel_status refuse_start(component *self, const text_rows *row, const char *problem) {
    char sentence[MESSAGE_SIZE];
    snprintf(sentence, sizeof sentence, "resources%s, row %d: %s.", START_VALUES, row->number, problem);
    kernel_make_readable(sentence);
    return face_error(self, sentence);
}

/* The cells NAME and VALUE of a row, and how many cells are filled; 3: more than these, or quotes do not close. */
static int cells_of_start(char *text, const char *pair[2]) {
    const char separator = text_separator(text);
    char *cell;
    int filled = 0;
    cell_reading found;
    for (int at = 0; (found = text_next_cell(&text, separator, &cell)) == CELL_READ; ++at) {
        filled += *cell != '\0';
        if (*cell && at > 1) return 3;
        if (at < 2) pair[at] = cell;
    }
    return found == CELL_REFUSED ? 3 : filled;
}

/* A row NAME,VALUE of numbers, as a value that is set. */
static kernel_status set_own_start(component *self, text_rows *row) {
    char problem[MESSAGE_SIZE / 2], mark;
    const char *pair[2] = {"", ""};
    const int filled = cells_of_start(row->text, pair);
    double number;
    if (filled == 0) return KERNEL_OK;
    for (int i = 0; filled == 2 && i < MODEL.variables; ++i)
        if (strcmp(pair[0], MODEL.variable[i].name) == 0 && table_read_number(pair[1], &number, &mark))
            return face_report(self, kernel_set(self->machine, i, number));
    snprintf(problem, sizeof problem, "a row must have the name of a variable of %.40s and its number; got '%.60s'. Write NAME,VALUE",
             MODEL.name, pair[0]);
    return refuse_start(self, row, problem);
}

/* Reads start values by the rules of all tables. */
static kernel_status own_start_values(component *self) {
    kernel_status status = KERNEL_OK;
    FILE *file = own_file(self, START_VALUES, &status);
    if (!file) return status;
    text_rows *rows = (text_rows *)malloc(sizeof *rows);
    if (!rows) status = face_error(self, "There is not enough memory for start values.");
    reading found = NO_MORE_ROWS;
    if (rows) text_rows_begin(rows, file);
    while (rows && status <= KERNEL_WARNING && (found = text_rows_next(rows)) == ROW_READ) status = set_own_start(self, rows);
    if (found == ROW_REFUSED) status = refuse_start(self, rows, rows->problem);
    fclose(file);
    free(rows);
    return status;
}

static kernel_status own_table(component *self) {
    kernel_status status = KERNEL_OK;
    FILE *file = MODEL.table_file ? own_file(self, MODEL.table_file->resource, &status) : NULL;
    if (!file) return status;
    fclose(file);
    return face_report(self, kernel_set_text(self->machine, MODEL.table_file->variable, self->resources));
}

/* What the FMU's own files say, where there are any. */
static kernel_status read_resources(component *self) {
    if (!self->resources) return KERNEL_OK;
    const kernel_status status = own_start_values(self);
    return status <= KERNEL_WARNING ? own_table(self) : status;
}

component *face_take_resources(component *self, const char *resources, face_place *place) {
    if (!self || !resources || !*resources) return self;
    char problem[RESOURCES_PROBLEM];
    const size_t of_table = MODEL.table_file ? strlen(MODEL.table_file->resource) + 1 : 0;
    self->resources = (char *)malloc(strlen(resources) + (of_table > sizeof START_VALUES ? of_table : sizeof START_VALUES));
    if (self->resources) {
        if (!place(resources, self->resources, problem)) {
            kernel_make_readable(problem);
            (void)face_error(self, problem);
        } else {
            self->folder_length = strlen(self->resources);
            if (read_resources(self) <= KERNEL_WARNING) return self;
        }
    }
    face_free(self);
    return NULL;
}

void face_free(component *self) {
    if (!self) return;
    kernel_free(self->machine);
    free(self->resources);
    free(self->name);
    free(self);
}

kernel_status face_terminate(component *self) {
    self->now = TERMINATED;
    return KERNEL_OK;
}

kernel_status face_reset(component *self) {
    kernel_reset(self->machine);
    self->now = INSTANTIATED;
    self->start_time = 0.0;
    self->last_step = KERNEL_OK;
    return read_resources(self);
}

kernel_status face_plan(component *self, const double *tolerance, double start, const double *stop) {
    const kernel_status status = kernel_plan(self->machine, tolerance, start, stop);
    if (status <= KERNEL_WARNING) self->start_time = start;
    return face_report(self, status);
}

/* ---- variables: every value is a double in the kernel; the type is only checked here ---- */

static bool wrong_type(const component *self, unsigned reference, int kind) {
    static const char *const name[] = {"Real", "Integer", "Boolean", "String"};
    if (reference < (unsigned)MODEL.variables && MODEL.variable[reference].kind == kind) return false;
    char sentence[160];
    snprintf(sentence, sizeof sentence, "Value reference %u is not a variable of type %s of %s.", reference, name[kind],
             MODEL.name);
    (void)face_error(self, sentence);
    return true;
}

static kernel_status initialise(component *self) {
    kernel_status status = kernel_initialise(self->machine, self->start_time);
    if (self->exchange && status <= KERNEL_WARNING && kernel_check_exchange(self->machine) != KERNEL_OK)
        status = KERNEL_ERROR;
    return face_report(self, status);
}

kernel_status face_initialise_if_asked(component *self) {
    return self->now != INITIALISING || kernel_state_count(self->machine) ? KERNEL_OK : initialise(self);
}

kernel_status face_initialise(component *self) {
    const kernel_status status = initialise(self);
    if (status <= KERNEL_WARNING) self->now = self->exchange || self->events ? AT_EVENT : STEPPING;
    return status;
}

kernel_status face_get(component *self, unsigned reference, int kind, double *value) {
    const int exchanged = kind == KIND_REAL ? kernel_exchanged_number((int)reference) : -1;
    if (exchanged < 0 && wrong_type(self, reference, kind)) return KERNEL_ERROR;
    if (self->now == INSTANTIATED && (exchanged >= 0 || MODEL.variable[reference].causality >= CAUSALITY_OUTPUT))
        return face_error(self, "Outputs and states have values from the initialisation on; enter it first.");
    const kernel_status status = face_initialise_if_asked(self);
    if (status > KERNEL_WARNING) return status;
    return face_report(self, exchanged >= 0 ? kernel_get_exchanged(self->machine, exchanged, value)
                                            : kernel_get(self->machine, (int)reference, value));
}

bool face_fixed(component *self, size_t count, const unsigned *reference, int kind) {
    for (size_t i = 0; i < count; ++i) {
        if (wrong_type(self, reference[i], kind)) return true;
        const int causality = MODEL.variable[reference[i]].causality;
        if (causality == CAUSALITY_INPUT && kind != KIND_REAL && self->now == CONTINUOUS) {
            (void)face_error(self, "Inputs that are no real numbers change at events; enter event mode first.");
            return true;
        }
        if (causality == CAUSALITY_INPUT || (causality == CAUSALITY_PARAMETER && !(self->now & RUNNING))) continue;
        (void)face_report(self, kernel_set(self->machine, (int)reference[i], 0.0)); /* which says why not */
        return true;
    }
    return false;
}

bool face_refuses(component *self, unsigned reference, double value) {
    return face_report(self, kernel_check_set(self->machine, (int)reference, value)) != KERNEL_OK;
}

kernel_status face_set(component *self, unsigned reference, double value) {
    if (self->now == INITIALISING) kernel_reopen(self->machine);
    return face_report(self, kernel_set(self->machine, (int)reference, value));
}

static kernel_status set_text(component *self, unsigned reference, const char *text) {
    if (self->now == INITIALISING) kernel_reopen(self->machine);
    return face_report(self, kernel_set_text(self->machine, (int)reference, text));
}

kernel_status face_set_texts(component *self, size_t count, const unsigned *reference, const char *const *text) {
    kernel_status worst = KERNEL_OK;
    for (size_t i = 0; i < count; ++i)
        if (wrong_type(self, reference[i], KIND_STRING)) return KERNEL_ERROR;
    for (size_t i = 0; i < count; ++i) {
        const kernel_status status = set_text(self, reference[i], text[i]);
        if (status > worst) worst = status;
    }
    return worst;
}

kernel_status face_get_texts(component *self, size_t count, const unsigned *reference, const char **text) {
    kernel_status worst = KERNEL_OK;
    for (size_t i = 0; i < count; ++i) {
        const kernel_status status = wrong_type(self, reference[i], KIND_STRING)
                               ? KERNEL_ERROR
                               : face_report(self, kernel_get_text(self->machine, (int)reference[i], &text[i]));
        if (status > worst) worst = status;
    }
    return worst;
}

kernel_status face_set_rates(component *self, size_t count, const unsigned *reference, const double *rate) {
    if (face_is_exchange(self)) return KERNEL_ERROR;
    kernel_status status = KERNEL_OK;
    for (size_t i = 0; i < count && status == KERNEL_OK; ++i)
        status = wrong_type(self, reference[i], KIND_REAL) ? KERNEL_ERROR
                                                           : kernel_check_rate(self->machine, (int)reference[i], rate[i]);
    for (size_t i = 0; i < count && status == KERNEL_OK; ++i)
        status = kernel_set_rate(self->machine, (int)reference[i], rate[i]);
    return face_report(self, status);
}

/* ---- saved states: behind the seal of all faces the phase, and a copy of the kernel's one block ---- */

typedef struct {
    double start_time;
    long long int now, exchange; /* without gaps: equal states have equal bytes */
} saved_phase;

static size_t block_size(const component *self) { return sizeof(saved_phase) + kernel_block_size(self->machine); }

size_t face_saved_size(const component *self) { return sealed_size(block_size(self)); }

/* Room for a state: what is there already, if it is one of this model; null: there is none, which was told. */
static void *room_for_state(const component *self, void **state) {
    if (face_missing(self, 1, state, state)) return NULL;
    if (*state && !seal_is_of(*state, seal_model(MODEL.guid), block_size(self))) {
        (void)face_error(self, "The place holds no saved state of this FMU; give one that it has saved, or a null pointer.");
        return NULL;
    }
    if (!*state) *state = calloc(1, face_saved_size(self));
    if (!*state) (void)face_error(self, "There is not enough memory for a saved state.");
    return *state;
}

kernel_status face_save(component *self, void **state) {
    const saved_phase kept = {self->start_time, self->now, self->exchange};
    if (!room_for_state(self, state)) return KERNEL_ERROR;
    memcpy(sealed_block(*state), &kept, sizeof kept);
    kernel_copy_block(self->machine, (char *)sealed_block(*state) + sizeof kept);
    seal_state(*state, seal_model(MODEL.guid), block_size(self));
    return KERNEL_OK;
}

kernel_status face_restore(component *self, const void *state) {
    saved_phase kept;
    char problem[SEALED_PROBLEM];
    if (!seal_holds(state, face_saved_size(self), seal_model(MODEL.guid), block_size(self), problem)) return face_error(self, problem);
    memcpy(&kept, sealed_content(state), sizeof kept);
    if (kept.exchange != self->exchange)
        return face_error(self, "The saved state is one of the other interface, co-simulation or model exchange.");
    if (kept.now == AT_EVENT && !self->exchange && !self->events)
        return face_error(self, "The saved state is one in event mode; instantiate with eventModeUsed = true.");
    const kernel_status status = kernel_take_block(self->machine, (const char *)sealed_content(state) + sizeof kept);
    if (status <= KERNEL_WARNING) {
        self->now = (phase)kept.now;
        self->start_time = kept.start_time;
    }
    return face_report(self, status);
}

kernel_status face_serialise(component *self, const void *state, void *bytes, size_t size) {
    char problem[SEALED_PROBLEM];
    if (!seal_holds(state, face_saved_size(self), seal_model(MODEL.guid), block_size(self), problem)) return face_error(self, problem);
    if (!bytes || size < face_saved_size(self)) return face_error(self, "The buffer is too small for the saved state.");
    memcpy(bytes, state, face_saved_size(self));
    return KERNEL_OK;
}

kernel_status face_deserialise(component *self, const void *bytes, size_t size, void **state) {
    char problem[SEALED_PROBLEM];
    if (!seal_holds(bytes, size, seal_model(MODEL.guid), block_size(self), problem)) return face_error(self, problem);
    if (!room_for_state(self, state)) return KERNEL_ERROR;
    memcpy(*state, bytes, face_saved_size(self));
    return KERNEL_OK;
}
