/* Shared part of the FMI 2.0 and FMI 3.0 interfaces: order of calls, log, references, saved states. The object holds the
 * values. */
#include "face.h"
#include "identity.h"
#include "readable.h"
#include "sealed.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Log categories, indexed by status. */
static const char *const CATEGORY[] = {"events", "logStatusWarning", "logStatusDiscard", "logStatusError"};
enum { CATEGORIES = 4, EVERYTHING = 15 };

/* ---- the log ---- */

static void say(const component *self, kernel_status status, const char *sentence) {
    const unsigned category = status <= KERNEL_ERROR ? (unsigned)status : (unsigned)KERNEL_ERROR;
    if (self->logger && ((self->logged | self->standard->always_logged) & (1u << category)))
        self->standard->tell(self, status, CATEGORY[category], sentence);
}

/* Set the statuses whose messages the object writes: those that are passed on. */
static void listen(const component *self) {
    if (OBJECT.listen) OBJECT.listen(self->object, self->logger ? self->logged | self->standard->always_logged : 0);
}

kernel_status face_error(const component *self, const char *sentence) {
    say(self, KERNEL_ERROR, sentence);
    return KERNEL_ERROR;
}

static kernel_status larger(kernel_status one, kernel_status other) { return one > other ? one : other; }

static void pass_on_one(component *self, const kernel_sentence *heard, kernel_status least) {
    char sentence[MESSAGE_SIZE]; /* a copy: a logger may call the instance, which then writes more */
    strcpy(sentence, heard->text);
    say(self, larger(heard->status, least), sentence);
}

static void pass_on(component *self, kernel_status least) {
    kernel_sentence heard;
    while (OBJECT.hear(self->object, &heard)) pass_on_one(self, &heard, least);
}

kernel_status face_report(component *self, kernel_status status) {
    pass_on(self, KERNEL_OK);
    return status;
}

kernel_status face_refuse(component *self) {
    pass_on(self, KERNEL_ERROR);
    return KERNEL_ERROR;
}

kernel_status face_absent(const component *self, const char *function) {
    char sentence[MESSAGE_SIZE];
    snprintf(sentence, sizeof sentence, "%s is not offered; see modelDescription.xml.", function);
    return face_error(self, sentence);
}

bool face_legal(const component *self, int phases, const char *function) {
    if (!self) return false;
    if ((int)self->now & phases) return true;
    char sentence[160];
    snprintf(sentence, sizeof sentence, "%s must not be called now; see the state machine of %s.", function,
             self->standard->name);
    (void)face_error(self, sentence);
    return false;
}

bool face_missing(const component *self, size_t count, const void *one, const void *other) {
    return count && (!one || !other) && face_error(self, "An array is missing: a null pointer was given for its values.");
}

/* Event mode and the end belong to both interfaces: functions of only one of them check the interface. */
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

/* ---- from phase to phase ---- */

/* Return the folder of the resources, which the host has named in the words of its standard; NULL, and why. */
static char *folder_of(const component *self, const char *resources, char problem[MESSAGE_SIZE]) {
    char *folder = (char *)malloc(strlen(resources) + 1);
    if (folder && self->standard->place(resources, folder, problem)) return folder;
    free(folder);
    return NULL;
}

/* Return whether the token is that of the binary, or of data in the folder (NULL: none); false, with one message, if not. */
static bool token_fits(const char *token, const char *folder, char problem[MESSAGE_SIZE]) {
    if (strcmp(token, OBJECT.token()) == 0) return true;
    if (folder) return identity_is(folder, token, OBJECT.token(), problem);
    strcpy(problem,
           "The identifier of modelDescription.xml is not that of the binary alone. If the FMU has data of its own, give "
           "the location of its resources; got none. Otherwise build both together.");
    return false;
}

static fmu_object *make_object(const component *self, const char *resources, char problem[MESSAGE_SIZE]) {
    const char *wrong = NULL;
    if (!*self->name) wrong = "The instance must have a name; got none.";
    else if (self->exchange && !OBJECT.exchange) wrong = "This FMU has no model exchange. Import it for co-simulation.";
    if (wrong) strcpy(problem, wrong);
    char *folder = !wrong && resources && *resources ? folder_of(self, resources, problem) : NULL;
    const bool placed = !wrong && (folder || !resources || !*resources);
    fmu_object *made = placed && token_fits(self->token, folder, problem) ? OBJECT.make(folder, self->exchange, problem) : NULL;
    free(folder);
    return made;
}

static char *copy_of(const char *text) {
    char *copy = (char *)malloc(strlen(text ? text : "") + 1);
    return copy ? strcpy(copy, text ? text : "") : NULL;
}

component *face_instantiate(const component *log, const char *name, const char *token, const char *resources, int logging) {
    MASK_TRAPS;
    char problem[MESSAGE_SIZE] = "There is not enough memory for an instance.";
    component *self = (component *)malloc(sizeof *self);
    if (!self) return NULL;
    *self = *log;
    self->logged = logging ? EVERYTHING : 0;
    self->variables = OBJECT.variables();
    self->stride = OBJECT.stride();
    self->name = copy_of(name);
    self->token = copy_of(token);
    if (self->name && self->token) self->object = make_object(self, resources, problem);
    if (self->object) {
        listen(self);
        if (face_reset(self) <= KERNEL_WARNING) return self;
    } else if (self->name) { /* which the log shows */
        make_readable(problem); /* it may quote a path with any content */
        (void)face_error(self, problem);
    }
    face_free(self);
    return NULL;
}

void face_free(component *self) {
    if (!self) return;
    if (self->object) OBJECT.dispose(self->object);
    free(self->name);
    free(self->token);
    free(self);
}

kernel_status face_reset(component *self) {
    self->now = INSTANTIATED;
    self->start_time = 0.0;
    self->last_step = KERNEL_OK;
    return face_report(self, OBJECT.reset(self->object));
}

kernel_status face_plan(component *self, const double *tolerance, double start, const double *stop) {
    const kernel_status status = OBJECT.plan(self->object, tolerance, start, stop);
    if (status <= KERNEL_WARNING) self->start_time = start;
    return face_report(self, status);
}

/* A value that is read during initialisation must follow from the values set so far. */
static kernel_status initialise_if_asked(component *self) {
    if (self->now != INITIALISING || OBJECT.initialised(self->object)) return KERNEL_OK;
    return face_report(self, OBJECT.initialise(self->object, self->start_time));
}

kernel_status face_initialise(component *self) {
    const kernel_status status = face_report(self, OBJECT.initialise(self->object, self->start_time));
    if (status <= KERNEL_WARNING) self->now = self->exchange || self->events ? AT_EVENT : STEPPING;
    return status;
}

kernel_status face_enter(component *self, phase next) {
    self->now = next;
    return KERNEL_OK;
}

/* ---- variables: every value is a double in the object; the type is only checked here ---- */

/* Variable and elements of a value reference. */
typedef struct {
    const variable_description *about; /* null: the time */
    unsigned variable;
    size_t first, count;
} place;

static bool refuse_reference(const component *self, unsigned reference, int kind) {
    static const char *const name[] = {"Real", "Integer", "Boolean", "String"};
    char sentence[160];
    snprintf(sentence, sizeof sentence, "Value reference %u is not a variable of type %s of %s.", reference, name[kind],
             OBJECT.name());
    return !face_error(self, sentence);
}

static bool find_place(const component *self, unsigned reference, int kind, bool reading, place *found) {
    const bool whole = !self->standard->by_elements;
    found->variable = whole || self->stride == 1 ? reference : reference / self->stride;
    found->first = whole ? 0 : reference - found->variable * self->stride;
    found->count = 1;
    found->about = reading || found->variable < self->variables ? OBJECT.variable(found->variable) : NULL;
    if (found->about && found->about->kind == kind) {
        const size_t length = OBJECT.length(self->object, found->variable);
        if (whole) found->count = length;
        if (found->first < length) return true;
    }
    if (whole && reading && reference == self->variables && kind == KIND_REAL) return true;
    return refuse_reference(self, reference, kind);
}

static bool sizes_differ(const component *self, size_t due, size_t size) {
    if (due == size) return false;
    char sentence[120];
    snprintf(sentence, sizeof sentence, "The call must have %zu values, all elements of each variable; got %zu.", due, size);
    (void)face_error(self, sentence);
    return true;
}

/* Return whether a reference is of a kind and its values, after `behind` others, fit into `size`; log an error if not. */
static bool find_within(const component *self, unsigned reference, int kind, bool reading, size_t behind, size_t size,
                        place *found) {
    if (!find_place(self, reference, kind, reading, found)) return false;
    return found->count <= size - behind || !sizes_differ(self, behind + found->count, size);
}

static kernel_status get_at(component *self, const place *at, void *values, size_t behind, face_put *put) {
    if (!at->about) {
        ((double *)values)[behind] = self->now & (INSTANTIATED | INITIALISING) ? self->start_time : OBJECT.time(self->object);
        return KERNEL_OK;
    }
    if (at->about->causality >= CAUSALITY_OUTPUT && self->now == INSTANTIATED)
        return face_error(self, "Outputs and states have values from the initialisation on; enter it first.");
    kernel_status status = initialise_if_asked(self);
    if (status > KERNEL_WARNING) return status;
    if (!put) return OBJECT.get(self->object, at->variable, at->first, at->count, (double *)values + behind);
    status = KERNEL_OK;
    for (size_t k = 0; k < at->count; ++k) {
        double number = 0.0;
        status = larger(status, OBJECT.get(self->object, at->variable, at->first + k, 1, &number));
        put(values, behind + k, number);
    }
    return status;
}

kernel_status face_get(component *self, int kind, const unsigned *reference, size_t count, void *values, size_t size,
                       face_put *put) {
    kernel_status worst = KERNEL_OK;
    size_t behind = 0;
    place at;
    if (face_missing(self, count, reference, reference) || face_missing(self, size, values, values)) return KERNEL_ERROR;
    for (size_t i = 0; i < count; ++i, behind += at.count) {
        if (!find_within(self, reference[i], kind, true, behind, size, &at)) return face_report(self, KERNEL_ERROR);
        worst = larger(worst, get_at(self, &at, values, behind, put));
    }
    return face_report(self, sizes_differ(self, behind, size) ? KERNEL_ERROR : worst);
}

typedef kernel_status setting(fmu_object *object, unsigned variable, size_t first, size_t count, const double *value);

/* Check or sets elements. */
static kernel_status at_each(component *self, setting *act, const place *at, const void *values, size_t behind,
                             face_take *take) {
    if (!take) return act(self->object, at->variable, at->first, at->count, (const double *)values + behind);
    kernel_status worst = KERNEL_OK;
    for (size_t k = 0; k < at->count; ++k) {
        const double number = take(values, behind + k);
        worst = larger(worst, act(self->object, at->variable, at->first + k, 1, &number));
    }
    return worst;
}

static bool refuse_fixed(const component *self, const char *name, const char *why) {
    char sentence[MESSAGE_SIZE];
    snprintf(sentence, sizeof sentence, "%s %s", name, why);
    return face_error(self, sentence) != KERNEL_OK;
}

/* Return whether a parameter keeps its values during a run: some hosts set all of them again. */
static bool keeps_value(const component *self, const place *at, const void *values, size_t behind, face_take *take) {
    if (at->about->causality != CAUSALITY_PARAMETER || !(self->now & RUNNING)) return false;
    for (size_t k = 0; k < at->count; ++k) {
        double now;
        const double given = take ? take(values, behind + k) : ((const double *)values)[behind + k];
        if (OBJECT.get(self->object, at->variable, at->first + k, 1, &now) > KERNEL_WARNING || now != given) return false;
    }
    return true;
}

/* Return whether a variable cannot be set now; log the reason. */
static bool is_fixed(const component *self, const variable_description *about) {
    const char *fixed = why_fixed(about, (self->now & RUNNING) != 0);
    if (fixed) return refuse_fixed(self, about->name, fixed);
    return about->kind != KIND_REAL && self->now == CONTINUOUS &&
           face_error(self, "Inputs that are no real numbers change at events; enter event mode first.");
}

/* Return whether all variables can be set, before any is set. */
static bool all_settable(component *self, int kind, const unsigned *reference, size_t count, const void *values, size_t size,
                         face_take *take) {
    size_t behind = 0;
    place at;
    if (face_missing(self, count, reference, reference) || face_missing(self, size, values, values)) return false;
    for (size_t i = 0; i < count; ++i, behind += at.count) {
        if (!find_within(self, reference[i], kind, false, behind, size, &at)) return false;
        if (keeps_value(self, &at, values, behind, take)) continue;
        if (is_fixed(self, at.about)) return false;
        const kernel_status status = at_each(self, OBJECT.check, &at, values, behind, take);
        if (status != KERNEL_OK) return !face_report(self, status);
    }
    return !sizes_differ(self, behind, size);
}

kernel_status face_set(component *self, int kind, const unsigned *reference, size_t count, const void *values, size_t size,
                       face_take *take) {
    kernel_status worst = KERNEL_OK;
    place at;
    if (!all_settable(self, kind, reference, count, values, size, take)) return KERNEL_ERROR;
    if (self->now == INITIALISING && count) OBJECT.reopen(self->object);
    for (size_t i = 0, behind = 0; i < count; ++i, behind += at.count) {
        (void)find_place(self, reference[i], kind, false, &at);
        if (!keeps_value(self, &at, values, behind, take))
            worst = larger(worst, at_each(self, OBJECT.set, &at, values, behind, take));
    }
    return face_report(self, worst);
}

/* String variables are scalars. */
static bool are_texts(const component *self, const unsigned *reference, size_t count, const void *text, size_t size) {
    place at;
    if (sizes_differ(self, count, size) || face_missing(self, count, reference, text)) return false;
    for (size_t i = 0; i < count; ++i)
        if (!find_place(self, reference[i], KIND_STRING, false, &at)) return false;
    return true;
}

kernel_status face_get_texts(component *self, const unsigned *reference, size_t count, const char **text, size_t size) {
    kernel_status worst = KERNEL_OK;
    if (!are_texts(self, reference, count, text, size)) return KERNEL_ERROR;
    for (size_t i = 0; i < count; ++i) worst = larger(worst, OBJECT.get_text(self->object, reference[i], &text[i]));
    return face_report(self, worst);
}

static bool keeps_text(const component *self, unsigned reference, const char *text) {
    const char *now = NULL;
    return self->now & RUNNING && text && OBJECT.get_text(self->object, reference, &now) == KERNEL_OK && now &&
           strcmp(now, text) == 0;
}

kernel_status face_set_texts(component *self, const unsigned *reference, size_t count, const char *const *text, size_t size) {
    kernel_status worst = KERNEL_OK;
    if (!are_texts(self, reference, count, text, size)) return KERNEL_ERROR;
    if (self->now == INITIALISING && count) OBJECT.reopen(self->object);
    for (size_t i = 0; i < count; ++i)
        if (!keeps_text(self, reference[i], text[i]))
            worst = larger(worst, OBJECT.set_text(self->object, reference[i], text[i]));
    return face_report(self, worst);
}

/* ---- derivatives ---- */

static bool is_of_first_order(const component *self, const int *order, size_t count, const char *sentence) {
    if (face_missing(self, count, order, order)) return false;
    for (size_t i = 0; i < count; ++i)
        if (order[i] != 1) return !face_error(self, sentence);
    return true;
}

kernel_status face_set_rates(component *self, const unsigned *reference, size_t count, const int *order, const double *rate) {
    if (!OBJECT.set_rates) return face_absent(self, "fmi2SetRealInputDerivatives");
    place at;
    if (face_missing(self, count, reference, rate) || face_is_exchange(self) ||
        !is_of_first_order(self, order, count, "Only first derivatives of inputs are used."))
        return KERNEL_ERROR;
    for (size_t i = 0; i < count; ++i)
        if (!find_place(self, reference[i], KIND_REAL, false, &at)) return KERNEL_ERROR;
    return face_report(self, OBJECT.set_rates(self->object, count, reference, rate));
}

kernel_status face_get_rates(component *self, const unsigned *reference, size_t count, const int *order, double *rate,
                             size_t size, const char *function) {
    if (!OBJECT.get_rates) return face_absent(self, function);
    if (face_is_exchange(self) || sizes_differ(self, count, size) || face_missing(self, count, reference, rate) ||
        !is_of_first_order(self, order, count, "Only first derivatives of outputs are provided."))
        return KERNEL_ERROR;
    return face_report(self, OBJECT.get_rates(self->object, count, reference, rate));
}

kernel_status face_get_directional(component *self, const unsigned *unknown, size_t unknowns, const unsigned *known,
                                   size_t knowns, const double *change, size_t changes, double *result, size_t results,
                                   const char *function) {
    if (!OBJECT.get_directional) return face_absent(self, function);
    if (sizes_differ(self, unknowns, results) || face_missing(self, unknowns, unknown, result) ||
        sizes_differ(self, knowns, changes) || face_missing(self, knowns, known, change))
        return KERNEL_ERROR;
    const kernel_status status = initialise_if_asked(self);
    if (status > KERNEL_WARNING) return status;
    return face_report(self, OBJECT.get_directional(self->object, unknowns, unknown, knowns, known, change, result));
}

/* ---- saved states: after the seal the phase, and the object's block ---- */

typedef struct {
    double start_time;
    long long int now, exchange; /* without gaps: equal states have equal bytes */
} saved_phase;

static size_t block_size(const component *self) { return sizeof(saved_phase) + OBJECT.block_size(self->object); }

/* A state belongs to one FMU and to the files that its object was made of. */
static unsigned long long model_of(const component *self) {
    const unsigned long long model = seal_model(self->token), mark = OBJECT.mark ? OBJECT.mark(self->object) : 0;
    return OBJECT.mark ? seal_hash(model, &mark, sizeof mark) : model;
}

/* Return whether a state is a complete one of this object; log an error if not. */
static bool is_ours(const component *self, const void *state, size_t size) {
    char problem[SEALED_PROBLEM];
    return seal_holds(state, size, model_of(self), block_size(self), problem) || !face_error(self, problem);
}

/* Return memory for a state: the existing one if it is of this object, or a new one. NULL, with a logged error, if that
 * fails. */
static void *room_for_state(const component *self, void **state) {
    if (face_missing(self, 1, state, state)) return NULL;
    if (*state && !seal_is_of(*state, model_of(self), block_size(self))) {
        (void)face_error(self, "The place holds no saved state of this FMU; give one that it has saved, or a null pointer.");
        return NULL;
    }
    if (!*state) *state = calloc(1, sealed_size(block_size(self)));
    if (!*state) (void)face_error(self, "There is not enough memory for a saved state.");
    return *state;
}

kernel_status face_save(component *self, void **state) {
    const saved_phase kept = {self->start_time, self->now, self->exchange};
    if (!room_for_state(self, state)) return KERNEL_ERROR;
    memcpy(sealed_block(*state), &kept, sizeof kept);
    OBJECT.copy_block(self->object, (char *)sealed_block(*state) + sizeof kept);
    seal_state(*state, model_of(self), block_size(self));
    return KERNEL_OK;
}

kernel_status face_restore(component *self, const void *state) {
    saved_phase kept;
    if (!is_ours(self, state, sealed_size(block_size(self)))) return KERNEL_ERROR;
    memcpy(&kept, sealed_content(state), sizeof kept);
    if (kept.exchange != self->exchange)
        return face_error(self, "The saved state is one of the other interface, co-simulation or model exchange.");
    if (kept.now == AT_EVENT && !self->exchange && !self->events)
        return face_error(self, "The saved state is one in event mode; instantiate with eventModeUsed = true.");
    const kernel_status status = OBJECT.take_block(self->object, (const char *)sealed_content(state) + sizeof kept);
    if (status <= KERNEL_WARNING) {
        self->now = (phase)kept.now;
        self->start_time = kept.start_time;
    }
    return face_report(self, status);
}

kernel_status face_release(void **state) {
    if (state) {
        free(*state);
        *state = NULL;
    }
    return KERNEL_OK;
}

kernel_status face_saved_size(component *self, const void *state, size_t *size) {
    if (face_missing(self, 1, state, size)) return KERNEL_ERROR;
    *size = sealed_size(block_size(self));
    return KERNEL_OK;
}

kernel_status face_serialise(component *self, const void *state, void *bytes, size_t size) {
    const size_t due = sealed_size(block_size(self));
    if (!is_ours(self, state, due)) return KERNEL_ERROR;
    if (!bytes || size < due) return face_error(self, "The buffer is too small for the saved state.");
    memcpy(bytes, state, due);
    return KERNEL_OK;
}

kernel_status face_deserialise(component *self, const void *bytes, size_t size, void **state) {
    if (!is_ours(self, bytes, size) || !room_for_state(self, state)) return KERNEL_ERROR;
    memcpy(*state, bytes, size);
    return KERNEL_OK;
}

/* ---- model exchange ---- */

static bool wrong_size(const component *self, size_t count, int expected, const void *array) {
    if (face_is_cosimulation(self)) return true;
    if (count == (size_t)expected) return face_missing(self, count, array, array);
    char sentence[160];
    snprintf(sentence, sizeof sentence, "The array must have %d values, as in modelDescription.xml; got %zu.", expected, count);
    (void)face_error(self, sentence);
    return true;
}

static int exchange_states(void) { return OBJECT.exchange ? OBJECT.exchange->states() : 0; }
static int exchange_indicators(void) { return OBJECT.exchange ? OBJECT.exchange->indicators() : 0; }

kernel_status face_set_time(component *self, double time) {
    if (face_is_cosimulation(self)) return KERNEL_ERROR;
    return face_report(self, OBJECT.exchange->set_time(self->object, time));
}

kernel_status face_set_states(component *self, const double *state, size_t count) {
    if (wrong_size(self, count, exchange_states(), state)) return KERNEL_ERROR;
    return face_report(self, OBJECT.exchange->set_states(self->object, state));
}

kernel_status face_read(component *self, double *value, size_t count, face_reading what) {
    if (wrong_size(self, count, what == READ_INDICATORS ? exchange_indicators() : exchange_states(), value))
        return KERNEL_ERROR;
    const kernel_status status = initialise_if_asked(self);
    if (status > KERNEL_WARNING) return status;
    const object_exchange *of = OBJECT.exchange;
    return face_report(self, (what == READ_STATES   ? of->get_states
                              : what == READ_SLOPES ? of->get_slopes
                                                    : of->get_indicators)(self->object, value));
}

kernel_status face_nominals(component *self, double *nominal, size_t count) {
    if (wrong_size(self, count, exchange_states(), nominal)) return KERNEL_ERROR;
    OBJECT.exchange->get_nominals(nominal);
    return KERNEL_OK;
}

kernel_status face_count(component *self, face_reading what, size_t *count) {
    if (face_is_cosimulation(self) || face_missing(self, 1, count, count)) return KERNEL_ERROR;
    *count = (size_t)(what == READ_INDICATORS ? exchange_indicators() : exchange_states());
    return KERNEL_OK;
}

kernel_status face_find_modes(component *self, bool *ended, bool *jumped) {
    const kernel_status status = OBJECT.exchange->find_modes(self->object, jumped);
    *ended = OBJECT.ended(self->object);
    if (*ended) self->now = STOPPED;
    return face_report(self, status);
}

kernel_status face_complete_step(component *self, bool *crossed) {
    return face_report(self, OBJECT.exchange->complete_step(self->object, crossed));
}
