/* The FMI 2.0 co-simulation face of a kernel. It knows the standard; the kernel knows the machine. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2Functions.h"
#include "kernel.h"

typedef enum { INSTANTIATED = 1, INITIALISING = 2, STEPPING = 4, STOPPED = 8, TERMINATED = 16 } phase;

typedef struct {
    kernel *machine;
    phase now;
    unsigned logged; /* one bit for each category that the host wants to hear */
    fmi2Status last_step;
    double start_time;
    char *name;
    fmi2CallbackLogger logger;
    fmi2ComponentEnvironment environment;
} component;

/* By status. Errors and ended runs are always told. */
static const char *const CATEGORY[] = {"events", "logStatusWarning", "logStatusDiscard", "logStatusError"};
enum { CATEGORIES = 4, EVERYTHING = 15, ALWAYS_TOLD = 12 };

/* The sentence is the format itself, so that hosts that do not expand arguments show it too; hence % is doubled. */
static void say(const component *self, fmi2Status status, const char *sentence) {
    const unsigned category = status <= fmi2Error ? (unsigned)status : (unsigned)fmi2Error;
    if (!self->logger || !((self->logged | ALWAYS_TOLD) & (1u << category))) return;
    char text[2 * MESSAGE_SIZE];
    size_t length = 0;
    for (const char *c = sentence; *c && length < sizeof text - 3; ++c) {
        if (*c == '%') text[length++] = '%';
        text[length++] = *c;
    }
    text[length] = '\0';
    self->logger(self->environment, self->name, status, CATEGORY[category], text);
}

/* Passes the kernel's journal on to the host and returns `status` unchanged. */
static fmi2Status report(component *self, int status) {
    char line[MESSAGE_SIZE + 8];
    const char *cursor = kernel_journal(self->machine);
    while (*cursor) {
        const size_t length = strcspn(cursor, "\n");
        const size_t kept = length < sizeof line - 1 ? length : sizeof line - 1;
        memcpy(line, cursor, kept);
        line[kept] = '\0';
        if (kept > 2) say(self, (fmi2Status)(line[0] - '0'), line + 2);
        cursor += length + (cursor[length] == '\n');
    }
    return (fmi2Status)status;
}

static int legal(const component *self, int phases, const char *function) {
    if (!self) return 0;
    if ((int)self->now & phases) return 1;
    char sentence[160];
    snprintf(sentence, sizeof sentence, "%s must not be called now; see the state machine of FMI 2.0, section 4.2.4.",
             function);
    say(self, fmi2Error, sentence);
    return 0;
}

static fmi2Status no_such(component *self, size_t count, const char *sentence) {
    if (count == 0) return fmi2OK;
    say(self, fmi2Error, sentence);
    return fmi2Error;
}

#define REQUIRE(phases, function) \
    component *self = c;          \
    if (!legal(self, phases, function)) return fmi2Error

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean loggingOn, size_t nCategories,
                               const fmi2String categories[]) {
    REQUIRE(INSTANTIATED | INITIALISING | STEPPING | STOPPED | TERMINATED, "fmi2SetDebugLogging");
    if (nCategories == 0) {
        self->logged = loggingOn ? EVERYTHING : 0;
        return fmi2OK;
    }
    for (size_t i = 0; i < nCategories; ++i) {
        unsigned bit = 0;
        for (unsigned j = 0; j < CATEGORIES; ++j)
            if (categories[i] && strcmp(categories[i], CATEGORY[j]) == 0) bit = 1u << j;
        if (!bit) return no_such(self, 1, "There is no such log category; modelDescription.xml lists them.");
        self->logged = loggingOn ? self->logged | bit : self->logged & ~bit;
    }
    return fmi2OK;
}

fmi2Component fmi2Instantiate(fmi2String instanceName, fmi2Type fmuType, fmi2String fmuGUID,
                              fmi2String fmuResourceLocation, const fmi2CallbackFunctions *functions,
                              fmi2Boolean visible, fmi2Boolean loggingOn) {
    (void)fmuResourceLocation;
    (void)visible;
    if (!functions || !instanceName) return NULL;
    component *self = calloc(1, sizeof *self);
    if (!self) return NULL;
    self->logger = functions->logger;
    self->environment = functions->componentEnvironment;
    self->logged = loggingOn ? EVERYTHING : 0;
    self->name = malloc(strlen(instanceName) + 1);
    if (self->name) strcpy(self->name, instanceName);
    self->machine = kernel_create();
    self->now = INSTANTIATED;
    const char *problem = NULL;
    if (!self->name || !self->machine)
        problem = "There is not enough memory for an instance.";
    else if (fmuType != fmi2CoSimulation)
        problem = "Only co-simulation is supported.";
    else if (!fmuGUID || strcmp(fmuGUID, MODEL.guid) != 0)
        problem = "The GUID of modelDescription.xml is not that of the binary; build both together.";
    if (!problem) return self;
    if (self->name) say(self, fmi2Error, problem);
    fmi2FreeInstance(self);
    return NULL;
}

void fmi2FreeInstance(fmi2Component c) {
    component *self = c;
    if (!self) return;
    kernel_free(self->machine);
    free(self->name);
    free(self);
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean toleranceDefined, fmi2Real tolerance, fmi2Real startTime,
                               fmi2Boolean stopTimeDefined, fmi2Real stopTime) {
    REQUIRE(INSTANTIATED, "fmi2SetupExperiment");
    (void)stopTimeDefined;
    (void)stopTime;
    self->start_time = startTime;
    if (!toleranceDefined) return fmi2OK;
    return report(self, kernel_set(self->machine, MODEL.tolerance, tolerance));
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
    REQUIRE(INSTANTIATED, "fmi2EnterInitializationMode");
    self->now = INITIALISING;
    return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    REQUIRE(INITIALISING, "fmi2ExitInitializationMode");
    const int status = kernel_initialise(self->machine, self->start_time);
    if (status <= KERNEL_WARNING) self->now = STEPPING;
    return report(self, status);
}

fmi2Status fmi2Terminate(fmi2Component c) {
    REQUIRE(STEPPING | STOPPED, "fmi2Terminate");
    self->now = TERMINATED;
    return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component c) {
    REQUIRE(INSTANTIATED | INITIALISING | STEPPING | STOPPED | TERMINATED, "fmi2Reset");
    kernel_reset(self->machine);
    self->now = INSTANTIATED;
    return fmi2OK;
}

/* ---- variables: every value is a double in the kernel; the type is only checked here ---- */

static int wrong_type(const component *self, fmi2ValueReference reference, int kind) {
    static const char *const name[] = {"Real", "Integer", "Boolean"};
    if (reference < (unsigned)MODEL.variables && MODEL.variable[reference].kind == kind) return 0;
    char sentence[160];
    snprintf(sentence, sizeof sentence, "Value reference %u is not a variable of type %s of %s.", reference, name[kind],
             MODEL.name);
    say(self, fmi2Error, sentence);
    return 1;
}

/* What is asked for during initialisation belongs to the values set so far. */
static fmi2Status initialise_if_asked(component *self) {
    if (self->now != INITIALISING || kernel_state_count(self->machine)) return fmi2OK;
    return report(self, kernel_initialise(self->machine, self->start_time));
}

static fmi2Status read(component *self, fmi2ValueReference reference, int kind, double *value) {
    if (wrong_type(self, reference, kind)) return fmi2Error;
    const fmi2Status status = initialise_if_asked(self);
    if (status > fmi2Warning) return status;
    return report(self, kernel_get(self->machine, (int)reference, value));
}

static fmi2Status write(component *self, fmi2ValueReference reference, int kind, double value) {
    if (wrong_type(self, reference, kind)) return fmi2Error;
    if (self->now == INITIALISING) kernel_reopen(self->machine);
    return report(self, kernel_set(self->machine, (int)reference, value));
}

enum { ALWAYS = INSTANTIATED | INITIALISING | STEPPING | STOPPED | TERMINATED };

#define DEFINE_GET(function, type, kind)                                                                     \
    fmi2Status function(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, type value[]) {          \
        REQUIRE(ALWAYS, #function);                                                                          \
        fmi2Status worst = fmi2OK;                                                                           \
        for (size_t i = 0; i < nvr; ++i) {                                                                   \
            double number = 0.0;                                                                             \
            const fmi2Status status = read(self, vr[i], kind, &number);                                      \
            value[i] = (type)number;                                                                         \
            if (status > worst) worst = status;                                                              \
        }                                                                                                    \
        return worst;                                                                                        \
    }

#define DEFINE_SET(function, type, kind)                                                                     \
    fmi2Status function(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const type value[]) {    \
        REQUIRE(INSTANTIATED | INITIALISING | STEPPING, #function);                                          \
        fmi2Status worst = fmi2OK;                                                                           \
        for (size_t i = 0; i < nvr; ++i) {                                                                   \
            const fmi2Status status = write(self, vr[i], kind, (double)value[i]);                            \
            if (status > worst) worst = status;                                                              \
        }                                                                                                    \
        return worst;                                                                                        \
    }

DEFINE_GET(fmi2GetReal, fmi2Real, KIND_REAL)
DEFINE_GET(fmi2GetInteger, fmi2Integer, KIND_INTEGER)
DEFINE_GET(fmi2GetBoolean, fmi2Boolean, KIND_BOOLEAN)
DEFINE_SET(fmi2SetReal, fmi2Real, KIND_REAL)
DEFINE_SET(fmi2SetInteger, fmi2Integer, KIND_INTEGER)
DEFINE_SET(fmi2SetBoolean, fmi2Boolean, KIND_BOOLEAN)

fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2String value[]) {
    REQUIRE(ALWAYS, "fmi2GetString");
    (void)vr;
    (void)value;
    return no_such(self, nvr, "There are no variables of type String.");
}

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2String value[]) {
    REQUIRE(ALWAYS, "fmi2SetString");
    (void)vr;
    (void)value;
    return no_such(self, nvr, "There are no variables of type String.");
}

/* ---- saved states: a copy of the kernel's one block, and the phase ---- */

typedef struct {
    size_t size;
    unsigned long long checksum; /* of the kernel's bytes and the GUID: bytes that were changed on the way are refused */
    double start_time;
    int now, last_step; /* phase and fmi2Status */
} saved_header;

static size_t saved_size(const component *self) { return sizeof(saved_header) + kernel_state_size(self->machine); }

/* FNV-1a, 64 bits. */
static unsigned long long hash_of(unsigned long long hash, const void *bytes, size_t size) {
    const unsigned char *byte = bytes;
    for (size_t i = 0; i < size; ++i) hash = (hash ^ byte[i]) * 1099511628211ull;
    return hash;
}

static unsigned long long checksum(const component *self, saved_header header, const void *kernel_bytes) {
    unsigned long long hash = hash_of(14695981039346656037ull, MODEL.guid, strlen(MODEL.guid));
    hash = hash_of(hash, &header.start_time, sizeof header.start_time);
    hash = hash_of(hash, &header.now, sizeof header.now);
    hash = hash_of(hash, &header.last_step, sizeof header.last_step);
    return hash_of(hash, kernel_bytes, kernel_state_size(self->machine));
}

/* Whether the bytes are a saved state of this model. */
static int is_saved(const component *self, const void *bytes, size_t size) {
    saved_header header;
    if (!bytes || size < saved_size(self)) return 0;
    memcpy(&header, bytes, sizeof header);
    return header.size == saved_size(self) &&
           header.checksum == checksum(self, header, (const char *)bytes + sizeof header);
}

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *FMUstate) {
    REQUIRE(ALWAYS, "fmi2GetFMUstate");
    const size_t size = saved_size(self);
    if (!*FMUstate) *FMUstate = calloc(1, size);
    if (!*FMUstate) return no_such(self, 1, "There is not enough memory for a saved state.");
    saved_header header = {size, 0, self->start_time, (int)self->now, (int)self->last_step};
    kernel_save(self->machine, (char *)*FMUstate + sizeof header);
    header.checksum = checksum(self, header, (char *)*FMUstate + sizeof header);
    memcpy(*FMUstate, &header, sizeof header);
    return fmi2OK;
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate FMUstate) {
    REQUIRE(ALWAYS, "fmi2SetFMUstate");
    saved_header header;
    if (!FMUstate) return no_such(self, 1, "There is no saved state to return to.");
    if (!is_saved(self, FMUstate, saved_size(self)))
        return no_such(self, 1, "The saved state belongs to another model, or its bytes were changed.");
    memcpy(&header, FMUstate, sizeof header);
    self->now = (phase)header.now;
    self->last_step = (fmi2Status)header.last_step;
    self->start_time = header.start_time;
    return report(self, kernel_restore(self->machine, (char *)FMUstate + sizeof header));
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *FMUstate) {
    REQUIRE(ALWAYS, "fmi2FreeFMUstate");
    if (FMUstate) {
        free(*FMUstate);
        *FMUstate = NULL;
    }
    return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate FMUstate, size_t *size) {
    REQUIRE(ALWAYS, "fmi2SerializedFMUstateSize");
    (void)FMUstate;
    *size = saved_size(self);
    return fmi2OK;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate FMUstate, fmi2Byte bytes[], size_t size) {
    REQUIRE(ALWAYS, "fmi2SerializeFMUstate");
    if (!FMUstate || size < saved_size(self)) return no_such(self, 1, "The buffer is too small for the saved state.");
    memcpy(bytes, FMUstate, saved_size(self));
    return fmi2OK;
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *FMUstate) {
    REQUIRE(ALWAYS, "fmi2DeSerializeFMUstate");
    if (!is_saved(self, bytes, size))
        return no_such(self, 1, "The serialised state belongs to another model, or its bytes were changed.");
    if (!*FMUstate) *FMUstate = malloc(saved_size(self));
    if (!*FMUstate) return no_such(self, 1, "There is not enough memory for a saved state.");
    memcpy(*FMUstate, bytes, saved_size(self));
    return fmi2OK;
}

/* ---- stepping ---- */

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                                       const fmi2Integer order[], const fmi2Real value[]) {
    REQUIRE(INITIALISING | STEPPING, "fmi2SetRealInputDerivatives");
    for (size_t i = 0; i < nvr; ++i) {
        if (order[i] != 1) return no_such(self, 1, "Only first derivatives of inputs are used.");
        if (wrong_type(self, vr[i], KIND_REAL)) return fmi2Error;
        const fmi2Status status = report(self, kernel_set_rate(self->machine, (int)vr[i], value[i]));
        if (status != fmi2OK) return status;
    }
    return fmi2OK;
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                                        const fmi2Integer order[], fmi2Real value[]) {
    REQUIRE(STEPPING | STOPPED | TERMINATED, "fmi2GetRealOutputDerivatives");
    for (size_t i = 0; i < nvr; ++i)
        if (order[i] != 1) return no_such(self, 1, "Only first derivatives of outputs are provided.");
    return report(self, kernel_get_rates(self->machine, (int)nvr, (const int *)vr, value));
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference vUnknown_ref[], size_t nUnknown,
                                        const fmi2ValueReference vKnown_ref[], size_t nKnown, const fmi2Real dvKnown[],
                                        fmi2Real dvUnknown[]) {
    REQUIRE(INITIALISING | STEPPING | STOPPED | TERMINATED, "fmi2GetDirectionalDerivative");
    const fmi2Status status = initialise_if_asked(self);
    if (status > fmi2Warning) return status;
    return report(self, kernel_get_directional(self->machine, (int)nUnknown, (const int *)vUnknown_ref, (int)nKnown,
                                               (const int *)vKnown_ref, dvKnown, dvUnknown));
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real currentCommunicationPoint, fmi2Real communicationStepSize,
                      fmi2Boolean noSetFMUStatePriorToCurrentPoint) {
    REQUIRE(STEPPING | STOPPED, "fmi2DoStep");
    (void)noSetFMUStatePriorToCurrentPoint;
    self->last_step = (fmi2Status)kernel_step(self->machine, currentCommunicationPoint, communicationStepSize);
    if (self->last_step == fmi2Discard) self->now = STOPPED;
    return report(self, (int)self->last_step);
}

fmi2Status fmi2CancelStep(fmi2Component c) {
    REQUIRE(ALWAYS, "fmi2CancelStep");
    return no_such(self, 1, "A step is never pending, so there is nothing to cancel.");
}

fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind s, fmi2Status *value) {
    REQUIRE(ALWAYS, "fmi2GetStatus");
    if (s != fmi2DoStepStatus) return fmi2Discard;
    *value = self->last_step;
    return fmi2OK;
}

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind s, fmi2Real *value) {
    REQUIRE(ALWAYS, "fmi2GetRealStatus");
    if (s != fmi2LastSuccessfulTime) return fmi2Discard;
    *value = kernel_time(self->machine);
    return fmi2OK;
}

fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind s, fmi2Integer *value) {
    (void)c;
    (void)s;
    (void)value;
    return fmi2Discard;
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind s, fmi2Boolean *value) {
    REQUIRE(ALWAYS, "fmi2GetBooleanStatus");
    if (s != fmi2Terminated) return fmi2Discard;
    *value = kernel_ended(self->machine) != 0;
    return fmi2OK;
}

fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind s, fmi2String *value) {
    (void)c;
    (void)s;
    (void)value;
    return fmi2Discard;
}
