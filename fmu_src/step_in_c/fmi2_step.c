/* FMI 2.0 co-simulation around an object of three functions in C: its memory, its start, its step.
 *
 * step_model.h, written beside it, names the functions and numbers the variables: real inputs, then the parameter `period`,
 * then integer outputs. The object is asked at the start of the first step that begins at or after each multiple of the
 * period; its outputs hold in between. An answer outside its limits, or an input that is no number, makes the outputs safe. */
#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "duration.h"
#include "fmi2Functions.h"
#include "sealed.h"
#include "step_model.h"

/* Rounding that a host's times may have [s]. */
#define ROUNDING 1e-9
#define SHORTEST_PERIOD 1e-6
#define LONGEST_PERIOD 1.0

typedef enum { INSTANTIATED = 1, INITIALISING = 2, RUNNING = 4, STOPPED = 8 } phase;
enum { ALWAYS = INSTANTIATED | INITIALISING | RUNNING | STOPPED };

/* All that a run changes; the object's memory lies behind it. */
typedef struct {
    phase now;
    bool failed;
    int output[OUTPUTS];
    double input[INPUTS], period, start_time;
    long long int asked;
} values;

typedef struct {
    fmi2CallbackLogger logger;
    fmi2ComponentEnvironment environment;
    char *name;
    size_t memory; /* bytes behind the values */
    values *now;
} component;

/* The object's memory begins where any type may. */
static size_t offset(void) { return (sizeof(values) + 63) / 64 * 64; }
static size_t whole(const component *self) { return offset() + self->memory; }
static void *memory_of(const component *self) { return (char *)self->now + offset(); }

/* The sentence is the format itself, so that hosts that do not expand arguments show it too; hence % is doubled. */
static fmi2Status say(const component *self, fmi2Status status, const char *format, ...)
{
    char sentence[512], text[2 * sizeof sentence];
    size_t length = 0;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(sentence, sizeof sentence, format, arguments);
    va_end(arguments);
    for (const char *c = sentence; *c; ++c) {
        if (*c == '%') text[length++] = '%';
        text[length++] = *c;
    }
    text[length] = '\0';
    const char *category = status == fmi2Warning ? "logStatusWarning" : status == fmi2Discard ? "logStatusDiscard" : "logStatusError";
    if (self->logger) self->logger(self->environment, self->name, status, category, text);
    return status;
}

static void begin(component *self)
{
    memset(self->now, 0, whole(self));
    self->now->now = INSTANTIATED;
    self->now->period = PERIOD;
    for (int i = 0; i < OUTPUTS; ++i) self->now->output[i] = SAFE;
}

/* Whether a function may be called now. */
static bool may(const component *self, int phases, const char *function)
{
    if (!self) return false;
    if (self->now->now & phases) return true;
    say(self, fmi2Error, "%s may not be called now; see the calling sequence of FMI 2.0, section 4.2.4.", function);
    return false;
}
#define REQUIRE(phases, function)                   \
    component *self = (component *)c;               \
    if (!may(self, phases, function)) return fmi2Error

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t count, const fmi2String categories[])
{
    REQUIRE(ALWAYS, "fmi2SetDebugLogging");
    (void)on, (void)count, (void)categories; /* warnings and errors are always told, and there is nothing else */
    return fmi2OK;
}

void fmi2FreeInstance(fmi2Component c)
{
    component *self = (component *)c;
    if (!self) return;
    free(self->name);
    free(self->now);
    free(self);
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging)
{
    (void)resources, (void)visible, (void)logging;
    component *self = functions ? (component *)calloc(1, sizeof *self) : NULL;
    if (!self) return NULL;
    self->logger = functions->logger;
    self->environment = functions->componentEnvironment;
    self->memory = MEMORY(COUNT);
    self->name = (char *)malloc(strlen(name ? name : "") + 1);
    const char *problem = !name || !*name             ? "Give the instance a name."
                          : type != fmi2CoSimulation  ? "Take this FMU for co-simulation; it has no model exchange."
                          : !guid || strcmp(guid, GUID) ? "The GUID is another FMU's; take modelDescription.xml and binary of one FMU."
                          : self->memory > LARGEST_MEMORY ? "The object asks for more memory than it may have."
                                                          : NULL;
    if (self->name) strcpy(self->name, name ? name : "");
    self->now = problem || !self->name ? NULL : (values *)malloc(whole(self));
    if (problem) say(self, fmi2Error, "%s", problem);
    if (self->now) {
        begin(self);
        return self;
    }
    fmi2FreeInstance(self);
    return NULL;
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean tolerant, fmi2Real tolerance, fmi2Real start, fmi2Boolean stops,
                               fmi2Real stop)
{
    REQUIRE(INSTANTIATED, "fmi2SetupExperiment");
    (void)tolerant, (void)tolerance, (void)stops, (void)stop;
    if (!(fabs(start) <= FARTHEST_TIME))
        return say(self, fmi2Error, "The start time must be from -%g to %g s; got %g s. Begin nearer to 0.", FARTHEST_TIME, FARTHEST_TIME, start);
    self->now->start_time = start;
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    REQUIRE(INSTANTIATED, "fmi2EnterInitializationMode");
    self->now->now = INITIALISING;
    return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    REQUIRE(INITIALISING, "fmi2ExitInitializationMode");
    START(memory_of(self), COUNT, self->now->period);
    self->now->now = RUNNING;
    return fmi2OK;
}

fmi2Status fmi2Terminate(fmi2Component c)
{
    REQUIRE(RUNNING | STOPPED, "fmi2Terminate");
    self->now->now = STOPPED;
    return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component c)
{
    REQUIRE(ALWAYS, "fmi2Reset");
    begin(self);
    return fmi2OK;
}

static fmi2Status unknown(const component *self, const char *function, fmi2ValueReference reference)
{
    return say(self, fmi2Error, "%s: no such variable has the reference %u; see modelDescription.xml.", function, reference);
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t count, fmi2Real value[])
{
    REQUIRE(ALWAYS, "fmi2GetReal");
    if (count && (!vr || !value)) return say(self, fmi2Error, "fmi2GetReal: give places for %zu values.", count);
    for (size_t i = 0; i < count; ++i) {
        if (vr[i] > INPUTS) return unknown(self, "fmi2GetReal", vr[i]);
        value[i] = vr[i] == INPUTS ? self->now->period : self->now->input[vr[i]];
    }
    return fmi2OK;
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t count, const fmi2Real value[])
{
    REQUIRE(INSTANTIATED | INITIALISING | RUNNING, "fmi2SetReal");
    if (count && (!vr || !value)) return say(self, fmi2Error, "fmi2SetReal: give %zu values.", count);
    for (size_t i = 0; i < count; ++i) {
        if (vr[i] > INPUTS) return unknown(self, "fmi2SetReal", vr[i]);
        if (vr[i] < INPUTS) continue;
        if (self->now->now == RUNNING) return say(self, fmi2Error, "Set period before the start; it is fixed from then on.");
        if (!(value[i] >= SHORTEST_PERIOD && value[i] <= LONGEST_PERIOD))
            return say(self, fmi2Error, "Set period to %g to %g s: it was %g s.", SHORTEST_PERIOD, LONGEST_PERIOD, value[i]);
    }
    for (size_t i = 0; i < count; ++i) {
        if (vr[i] == INPUTS)
            self->now->period = value[i];
        else
            self->now->input[vr[i]] = value[i];
    }
    return fmi2OK;
}

fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t count, fmi2Integer value[])
{
    REQUIRE(ALWAYS, "fmi2GetInteger");
    if (count && (!vr || !value)) return say(self, fmi2Error, "fmi2GetInteger: give places for %zu values.", count);
    for (size_t i = 0; i < count; ++i) {
        if (vr[i] <= INPUTS || vr[i] > INPUTS + OUTPUTS) return unknown(self, "fmi2GetInteger", vr[i]);
        value[i] = self->now->output[vr[i] - INPUTS - 1];
    }
    return fmi2OK;
}

/* There are none of these. */
#define NONE(function, type)                                                                          \
    fmi2Status function(fmi2Component c, const fmi2ValueReference vr[], size_t count, type value[])   \
    {                                                                                                 \
        REQUIRE(ALWAYS, #function);                                                                   \
        (void)value;                                                                                  \
        return count ? unknown(self, #function, vr ? vr[0] : 0) : fmi2OK;                             \
    }
NONE(fmi2GetBoolean, fmi2Boolean)
NONE(fmi2GetString, fmi2String)
NONE(fmi2SetInteger, const fmi2Integer)
NONE(fmi2SetBoolean, const fmi2Boolean)
NONE(fmi2SetString, const fmi2String)

/* Asks the object at a time; false: it failed. */
static bool ask(component *self, double time)
{
    values *now = self->now;
    int answer[OUTPUTS];
    memcpy(answer, now->output, sizeof answer);
    STEP(memory_of(self), time, now->input, answer);
    for (int i = 0; i < OUTPUTS; ++i)
        if (answer[i] < LEAST || answer[i] > MOST) {
            say(self, fmi2Discard, "The controller gave %d for output %d at %g s where %d to %d was due; its outputs are %d from now on.",
                answer[i], i + 1, time, LEAST, MOST, SAFE);
            return false;
        }
    memcpy(now->output, answer, sizeof answer);
    return true;
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real size, fmi2Boolean no_way_back)
{
    REQUIRE(RUNNING, "fmi2DoStep");
    (void)no_way_back;
    values *now = self->now;
    if (!(fabs(time) <= 2.0 * FARTHEST_TIME && isfinite(size) && size >= 0.0))
        return say(self, fmi2Error, "fmi2DoStep needs a time of at most %g s and a size of at least 0 s; got %g s and %g s.",
                   2.0 * FARTHEST_TIME, time, size);
    if (size > LONGEST_STEP) return say(self, fmi2Error, "Take steps of at most %g s: this one was of %g s at %g s.", LONGEST_STEP, size, time);
    if (now->failed) return fmi2Discard;
    if (time - now->start_time < (double)now->asked * now->period - ROUNDING) return fmi2OK;
    now->asked = (long long int)floor((time - now->start_time) / now->period + ROUNDING) + 1;
    for (int i = 0; i < INPUTS; ++i)
        if (!isfinite(now->input[i])) {
            for (int k = 0; k < OUTPUTS; ++k) now->output[k] = SAFE;
            return say(self, fmi2Warning, "Input %d is no finite number at %g s: the outputs are %d.", i + 1, time, SAFE);
        }
    if (ask(self, time)) return fmi2OK;
    now->failed = true;
    for (int i = 0; i < OUTPUTS; ++i) now->output[i] = SAFE;
    return fmi2Discard;
}

/* ---- saved states: behind the seal of all faces the values, and the object's memory ---- */

static size_t size_of_state(const component *self) { return sealed_size(whole(self)); }

/* Whether so many bytes are a whole state of this FMU; false: it was told. */
static bool is_ours(const component *self, const void *state, size_t size)
{
    char problem[SEALED_PROBLEM];
    if (seal_holds(state, size, seal_model(GUID), whole(self), problem)) return true;
    say(self, fmi2Error, "%s", problem);
    return false;
}

/* Room for a state: what is there already, if it is one of this FMU. */
static bool make_room(const component *self, fmi2FMUstate *state, const char *function)
{
    if (!state)
        say(self, fmi2Error, "%s: give a place for the state.", function);
    else if (*state && !seal_is_of(*state, seal_model(GUID), whole(self)))
        say(self, fmi2Error, "%s: the place holds no state of this FMU; give one that it has saved, or a null pointer.", function);
    else if (!*state && !(*state = malloc(size_of_state(self))))
        say(self, fmi2Error, "There is no memory for a saved state of %zu bytes.", size_of_state(self));
    else
        return true;
    return false;
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    REQUIRE(ALWAYS, "fmi2FreeFMUstate");
    if (state) {
        free(*state);
        *state = NULL;
    }
    return fmi2OK;
}

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    REQUIRE(ALWAYS, "fmi2GetFMUstate");
    if (!make_room(self, state, "fmi2GetFMUstate")) return fmi2Error;
    memcpy(sealed_block(*state), self->now, whole(self));
    seal_state(*state, seal_model(GUID), whole(self));
    return fmi2OK;
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state)
{
    REQUIRE(ALWAYS, "fmi2SetFMUstate");
    if (!is_ours(self, state, size_of_state(self))) return fmi2Error;
    memcpy(self->now, sealed_content(state), whole(self));
    return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size)
{
    REQUIRE(ALWAYS, "fmi2SerializedFMUstateSize");
    if (!state || !size) return say(self, fmi2Error, "fmi2SerializedFMUstateSize: give a state and a place for its size.");
    *size = size_of_state(self);
    return fmi2OK;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size)
{
    REQUIRE(ALWAYS, "fmi2SerializeFMUstate");
    if (!is_ours(self, state, size_of_state(self))) return fmi2Error;
    if (!bytes || size < size_of_state(self))
        return say(self, fmi2Error, "fmi2SerializeFMUstate: give room for %zu bytes.", size_of_state(self));
    memcpy(bytes, state, size_of_state(self));
    return fmi2OK;
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state)
{
    REQUIRE(ALWAYS, "fmi2DeSerializeFMUstate");
    if (!is_ours(self, bytes, size) || !make_room(self, state, "fmi2DeSerializeFMUstate")) return fmi2Error;
    memcpy(*state, bytes, size);
    return fmi2OK;
}

/* ---- what this FMU does not offer ---- */

#define OFFERS_NOT(function, ...)                                                           \
    fmi2Status function(fmi2Component c, __VA_ARGS__)                                       \
    {                                                                                       \
        REQUIRE(ALWAYS, #function);                                                         \
        return say(self, fmi2Error, "%s is not offered; see modelDescription.xml.", #function); \
    }
#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif
OFFERS_NOT(fmi2GetDirectionalDerivative, const fmi2ValueReference unknowns[], size_t count, const fmi2ValueReference knowns[],
           size_t known, const fmi2Real change[], fmi2Real found[])
OFFERS_NOT(fmi2SetRealInputDerivatives, const fmi2ValueReference vr[], size_t count, const fmi2Integer order[],
           const fmi2Real value[])
OFFERS_NOT(fmi2GetRealOutputDerivatives, const fmi2ValueReference vr[], size_t count, const fmi2Integer order[], fmi2Real value[])
OFFERS_NOT(fmi2GetStatus, const fmi2StatusKind kind, fmi2Status *value)
OFFERS_NOT(fmi2GetRealStatus, const fmi2StatusKind kind, fmi2Real *value)
OFFERS_NOT(fmi2GetIntegerStatus, const fmi2StatusKind kind, fmi2Integer *value)
OFFERS_NOT(fmi2GetBooleanStatus, const fmi2StatusKind kind, fmi2Boolean *value)
OFFERS_NOT(fmi2GetStringStatus, const fmi2StatusKind kind, fmi2String *value)

fmi2Status fmi2CancelStep(fmi2Component c)
{
    REQUIRE(ALWAYS, "fmi2CancelStep");
    return say(self, fmi2Error, "fmi2CancelStep: no step is ever under way.");
}
