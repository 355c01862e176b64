/* The common part of both faces. It knows the order of calls; the kernel knows the machine. */
#include "face.h"
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

/* The path in a URI "file:///a%20b", or a path as it is. */
static void decode(const char *uri, char *path) {
    if (strncmp(uri, "file:", 5) == 0) {
        uri += 5;
        if (strncmp(uri, "//", 2) == 0) uri += 2 + strcspn(uri + 2, "/"); /* behind the host's name, which is empty */
        if (uri[0] == '/' && uri[1] && uri[2] == ':') ++uri;               /* "/C:/" */
    }
    for (; *uri; ++uri) {
        unsigned letter;
        if (uri[0] == '%' && sscanf(uri + 1, "%2x", &letter) == 1 && uri[1] && uri[2]) {
            *path++ = (char)letter;
            uri += 2;
        } else {
            *path++ = *uri;
        }
    }
    *path = '\0';
}

/* A file among the resources, opened, its path in self->resources until the next one's; null: there is none. */
static FILE *own_file(component *self, const char *name) {
    char *end = self->resources + self->folder_length;
    strcpy(end, name);
    return fopen(self->resources, "rb");
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
    FILE *file = own_file(self, START_VALUES);
    if (!file) return KERNEL_OK;
    text_rows *rows = (text_rows *)malloc(sizeof *rows);
    kernel_status status = rows ? KERNEL_OK : face_error(self, "There is not enough memory for start values.");
    reading found = NO_MORE_ROWS;
    if (rows) text_rows_begin(rows, file);
    while (rows && status <= KERNEL_WARNING && (found = text_rows_next(rows)) == ROW_READ) status = set_own_start(self, rows);
    if (found == ROW_REFUSED) status = refuse_start(self, rows, rows->problem);
    fclose(file);
    free(rows);
    return status;
}

static kernel_status own_table(component *self) {
    FILE *file = MODEL.table_file ? own_file(self, MODEL.table_file->resource) : NULL;
    if (!file) return KERNEL_OK;
    fclose(file);
    return face_report(self, kernel_set_text(self->machine, MODEL.table_file->variable, self->resources));
}

/* What the FMU's own files say, where there are any. */
static kernel_status read_resources(component *self) {
    if (!self->resources) return KERNEL_OK;
    const kernel_status status = own_start_values(self);
    return status <= KERNEL_WARNING ? own_table(self) : status;
}

component *face_take_resources(component *self, const char *resources) {
    if (!self || !resources || !*resources) return self;
    const size_t of_table = MODEL.table_file ? strlen(MODEL.table_file->resource) + 1 : 0;
    self->resources = (char *)malloc(strlen(resources) + (of_table > sizeof START_VALUES ? of_table : sizeof START_VALUES));
    if (self->resources) {
        decode(resources, self->resources);
        self->folder_length = strlen(self->resources);
        if (read_resources(self) <= KERNEL_WARNING) return self;
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

/* ---- saved states: a copy of the kernel's one block, and the phase ---- */

typedef struct {
    size_t size;
    unsigned long long checksum; /* of the kernel's bytes and the GUID: bytes that were changed on the way are refused */
    double start_time;
    long long int now, exchange; /* without gaps: equal states have equal bytes */
} saved_header;

size_t face_saved_size(const component *self) { return sizeof(saved_header) + kernel_state_size(self->machine); }

/* FNV-1a, 64 bits. */
static unsigned long long hash_of(unsigned long long hash, const void *bytes, size_t size) {
    const unsigned char *byte = (const unsigned char *)bytes;
    for (size_t i = 0; i < size; ++i) hash = (hash ^ byte[i]) * 1099511628211ull;
    return hash;
}

static unsigned long long checksum(const component *self, saved_header header, const void *kernel_bytes) {
    unsigned long long hash = hash_of(14695981039346656037ull, MODEL.guid, strlen(MODEL.guid));
    hash = hash_of(hash, &header.start_time, sizeof header.start_time);
    hash = hash_of(hash, &header.now, sizeof header.now);
    hash = hash_of(hash, &header.exchange, sizeof header.exchange);
    return hash_of(hash, kernel_bytes, kernel_state_size(self->machine));
}

/* Whether the bytes are a saved state of this model. */
static bool is_saved(const component *self, const void *bytes, size_t size) {
    saved_header header;
    if (!bytes || size < face_saved_size(self)) return false;
    memcpy(&header, bytes, sizeof header);
    return header.size == face_saved_size(self) &&
           header.checksum == checksum(self, header, (const char *)bytes + sizeof header);
}

kernel_status face_save(component *self, void **state) {
    const size_t size = face_saved_size(self);
    if (face_missing(self, 1, state, state)) return KERNEL_ERROR;
    if (!*state) *state = calloc(1, size);
    if (!*state) return face_error(self, "There is not enough memory for a saved state.");
    saved_header header = {size, 0, self->start_time, self->now, self->exchange};
    kernel_save(self->machine, (char *)*state + sizeof header);
    header.checksum = checksum(self, header, (char *)*state + sizeof header);
    memcpy(*state, &header, sizeof header);
    return KERNEL_OK;
}

kernel_status face_restore(component *self, const void *state) {
    saved_header header;
    if (!state) return face_error(self, "There is no saved state to return to.");
    if (!is_saved(self, state, face_saved_size(self)))
        return face_error(self, "The saved state belongs to another model, or its bytes were changed.");
    memcpy(&header, state, sizeof header);
    if (header.exchange != self->exchange)
        return face_error(self, "The saved state is one of the other interface, co-simulation or model exchange.");
    if (header.now == AT_EVENT && !self->exchange && !self->events)
        return face_error(self, "The saved state is one in event mode; instantiate with eventModeUsed = true.");
    const kernel_status status = kernel_restore(self->machine, (const char *)state + sizeof header);
    if (status <= KERNEL_WARNING) {
        self->now = (phase)header.now;
        self->start_time = header.start_time;
    }
    return face_report(self, status);
}

kernel_status face_serialise(component *self, const void *state, void *bytes, size_t size) {
    if (!state || !bytes || size < face_saved_size(self))
        return face_error(self, "The buffer is too small for the saved state.");
    memcpy(bytes, state, face_saved_size(self));
    return KERNEL_OK;
}

kernel_status face_deserialise(component *self, const void *bytes, size_t size, void **state) {
    if (!is_saved(self, bytes, size))
        return face_error(self, "The serialised state belongs to another model, or its bytes were changed.");
    if (face_missing(self, 1, state, state)) return KERNEL_ERROR;
    if (!*state) *state = malloc(face_saved_size(self));
    if (!*state) return face_error(self, "There is not enough memory for a saved state.");
    memcpy(*state, bytes, face_saved_size(self));
    return KERNEL_OK;
}
