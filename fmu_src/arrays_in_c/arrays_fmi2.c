/* FMI 2.0 for co-simulation around an object of arrays: each element is a variable, with the value reference array * 65536 +
 * element. */
#include <stdlib.h>
#include <string.h>

#include "arrays.h"
#include "fmi2Functions.h"

enum { ELEMENTS = 65536 };

/* The sentence is the format itself, so that hosts that do not expand arguments show it too; hence % is doubled. */
static void tell_host(const arrays_component *self, arrays_status status, const char *sentence)
{
    const char *category[] = {"events", "logStatusWarning", "logStatusDiscard", "logStatusError"};
    char text[2 * ARRAYS_PROBLEM]; /* even of nothing but % */
    size_t length = 0;
    for (const char *c = sentence; *c; ++c) {
        if (*c == '%') text[length++] = '%';
        text[length++] = *c;
    }
    text[length] = '\0';
    const char *name = self->name ? self->name : "";
    ((fmi2CallbackLogger)self->logger)(self->environment, name, (fmi2Status)status, category[status], text);
}

#define REQUIRE(phases, function)                           \
    arrays_component *self = (arrays_component *)c;         \
    if (!arrays_may(self, phases, function)) return fmi2Error

static fmi2Status error(const arrays_component *self, const char *sentence)
{
    return (fmi2Status)arrays_say(self, ARRAYS_ERROR, "%s", sentence);
}

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t count, const fmi2String categories[])
{
    REQUIRE(ALWAYS, "fmi2SetDebugLogging");
    (void)on, (void)count, (void)categories; /* warnings and errors are always told, and there is nothing else */
    return fmi2OK;
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging)
{
    (void)visible, (void)logging;
    if (!functions) return NULL;
    arrays_component log;
    memset(&log, 0, sizeof log);
    log.name = (char *)name;
    log.standard = "FMI 2.0, section 4.2.4";
    log.failed = ARRAYS_ERROR; /* behind fmi2Discard hosts would go on from a time that they have to ask for */
    log.tell = tell_host;
    log.logger = (void (*)(void))functions->logger;
    log.environment = functions->componentEnvironment;
    if (type != fmi2CoSimulation) {
        error(&log, "Take this FMU for co-simulation; it has no model exchange.");
        return NULL;
    }
    return arrays_instantiate(&log, name, guid, resources, resources_of_uri);
}

void fmi2FreeInstance(fmi2Component c) { arrays_release((arrays_component *)c); }

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean tolerant, fmi2Real tolerance, fmi2Real start, fmi2Boolean stops,
                               fmi2Real stop)
{
    REQUIRE(INSTANTIATED, "fmi2SetupExperiment");
    (void)tolerant, (void)tolerance, (void)stops, (void)stop;
    return (fmi2Status)arrays_plan(self, start);
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    REQUIRE(INSTANTIATED, "fmi2EnterInitializationMode");
    self->now = INITIALISING;
    return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    REQUIRE(INITIALISING, "fmi2ExitInitializationMode");
    return (fmi2Status)arrays_initialise(self);
}

fmi2Status fmi2Terminate(fmi2Component c)
{
    REQUIRE(RUNNING | STOPPED, "fmi2Terminate");
    self->now = STOPPED;
    return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component c)
{
    REQUIRE(ALWAYS, "fmi2Reset");
    arrays_begin_anew(self);
    return fmi2OK;
}

#define GET(function, type, whole)                                                                            \
    fmi2Status function(fmi2Component c, const fmi2ValueReference vr[], size_t count, type value[])           \
    {                                                                                                         \
        REQUIRE(ALWAYS, #function);                                                                           \
        if (count && (!vr || !value)) return error(self, #function ": give places for the values.");          \
        for (size_t i = 0; i < count; ++i)                                                                    \
            if (!arrays_find(self, vr[i] / ELEMENTS, vr[i] % ELEMENTS, whole, #function)) return fmi2Error;   \
        arrays_settle(self);                                                                                  \
        for (size_t i = 0; i < count; ++i)                                                                    \
            value[i] = (type)arrays_find(self, vr[i] / ELEMENTS, vr[i] % ELEMENTS, whole, #function)[vr[i] % ELEMENTS]; \
        return fmi2OK;                                                                                        \
    }
#define SET(function, type, whole)                                                                            \
    fmi2Status function(fmi2Component c, const fmi2ValueReference vr[], size_t count, const type value[])     \
    {                                                                                                         \
        REQUIRE(INSTANTIATED | INITIALISING | RUNNING, #function);                                            \
        if (count && (!vr || !value)) return error(self, #function ": give a value for each reference.");     \
        for (size_t i = 0; i < count; ++i) {                                                                  \
            const unsigned array = vr[i] / ELEMENTS, element = vr[i] % ELEMENTS;                              \
            if (!arrays_find(self, array, element, whole, #function)) return fmi2Error;                       \
            if (!arrays_settable(self, array, element, (double)value[i])) return fmi2Error;                   \
        }                                                                                                     \
        self->stale = true;                                                                                   \
        for (size_t i = 0; i < count; ++i)                                                                    \
            arrays_find(self, vr[i] / ELEMENTS, vr[i] % ELEMENTS, whole, #function)[vr[i] % ELEMENTS] = (double)value[i]; \
        return fmi2OK;                                                                                        \
    }
GET(fmi2GetReal, fmi2Real, 0)
GET(fmi2GetInteger, fmi2Integer, 1)
SET(fmi2SetReal, fmi2Real, 0)
SET(fmi2SetInteger, fmi2Integer, 1)

/* There are none of these. */
#define NONE(function, type)                                                                          \
    fmi2Status function(fmi2Component c, const fmi2ValueReference vr[], size_t count, type value[])   \
    {                                                                                                 \
        REQUIRE(ALWAYS, #function);                                                                   \
        (void)vr, (void)value;                                                                        \
        return count ? error(self, #function ": no variable has this type.") : fmi2OK;                \
    }
NONE(fmi2GetBoolean, fmi2Boolean)
NONE(fmi2GetString, fmi2String)
NONE(fmi2SetBoolean, const fmi2Boolean)
NONE(fmi2SetString, const fmi2String)

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real size, fmi2Boolean no_way_back)
{
    REQUIRE(RUNNING, "fmi2DoStep");
    (void)no_way_back;
    return (fmi2Status)arrays_step(self, time, size);
}

/* How far it has come, and that it does not ask for an end. */
#define STATUS(function, type, known, answer)                                                                 \
    fmi2Status function(fmi2Component c, const fmi2StatusKind kind, type *value)                              \
    {                                                                                                         \
        REQUIRE(RUNNING | STOPPED, #function);                                                                \
        if (kind != known || !value) return error(self, #function ": ask for " #known ", and give a place."); \
        *value = answer;                                                                                      \
        return fmi2OK;                                                                                        \
    }
STATUS(fmi2GetRealStatus, fmi2Real, fmi2LastSuccessfulTime, self->time)
STATUS(fmi2GetBooleanStatus, fmi2Boolean, fmi2Terminated, fmi2False)

/* ---- saved states ---- */

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
    return (fmi2Status)arrays_keep(self, state);
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state)
{
    REQUIRE(ALWAYS, "fmi2SetFMUstate");
    return (fmi2Status)arrays_take_back(self, state);
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size)
{
    REQUIRE(ALWAYS, "fmi2SerializedFMUstateSize");
    return (fmi2Status)arrays_size(self, state, size);
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size)
{
    REQUIRE(ALWAYS, "fmi2SerializeFMUstate");
    return (fmi2Status)arrays_serialise(self, state, bytes, size);
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state)
{
    REQUIRE(ALWAYS, "fmi2DeSerializeFMUstate");
    return (fmi2Status)arrays_deserialise(self, bytes, size, state);
}

/* ---- what this FMU does not offer ---- */

#define OFFERS_NOT(function, ...)                                                             \
    fmi2Status function(fmi2Component c, __VA_ARGS__)                                         \
    {                                                                                         \
        REQUIRE(ALWAYS, #function);                                                           \
        return error(self, #function " is not offered; see modelDescription.xml.");           \
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
OFFERS_NOT(fmi2GetIntegerStatus, const fmi2StatusKind kind, fmi2Integer *value)
OFFERS_NOT(fmi2GetStringStatus, const fmi2StatusKind kind, fmi2String *value)

fmi2Status fmi2CancelStep(fmi2Component c)
{
    REQUIRE(ALWAYS, "fmi2CancelStep");
    return error(self, "fmi2CancelStep: no step is ever under way.");
}
