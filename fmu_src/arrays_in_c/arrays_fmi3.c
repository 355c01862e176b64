/* FMI 3.0 for co-simulation around an object of arrays: each array is a variable, its number the value reference; the time has
 * the one behind the last. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "arrays.h"
#include "fmi3Functions.h"

static void tell_host(const arrays_component *self, arrays_status status, const char *sentence)
{
    const char *category[] = {"events", "logStatusWarning", "logStatusDiscard", "logStatusError"};
    ((fmi3LogMessageCallback)self->logger)(self->environment, (fmi3Status)status, category[status], sentence);
}

#define REQUIRE(phases, function)                             \
    arrays_component *self = (arrays_component *)instance;    \
    if (!arrays_may(self, phases, function)) return fmi3Error

static fmi3Status error(const arrays_component *self, const char *sentence)
{
    return (fmi3Status)arrays_say(self, ARRAYS_ERROR, "%s", sentence);
}

const char *fmi3GetVersion(void) { return fmi3Version; }

fmi3Status fmi3SetDebugLogging(fmi3Instance instance, fmi3Boolean on, size_t count, const fmi3String categories[])
{
    REQUIRE(ALWAYS, "fmi3SetDebugLogging");
    (void)on, (void)count, (void)categories; /* warnings and errors are always told, and there is nothing else */
    return fmi3OK;
}

static arrays_component log_of(fmi3String name, fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger)
{
    arrays_component log;
    memset(&log, 0, sizeof log);
    log.name = (char *)name;
    log.standard = "FMI 3.0, section 4.2.1";
    log.failed = ARRAYS_DISCARD;
    log.tell = tell_host;
    log.logger = (void (*)(void))logger;
    log.environment = environment;
    return log;
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                         fmi3Boolean logging, fmi3Boolean events, fmi3Boolean early,
                                         const fmi3ValueReference required[], size_t count, fmi3InstanceEnvironment environment,
                                         fmi3LogMessageCallback logger, fmi3IntermediateUpdateCallback update)
{
    (void)visible, (void)logging, (void)events, (void)early, (void)required, (void)count, (void)update;
    const arrays_component log = log_of(name, environment, logger);
    return arrays_instantiate(&log, name, token, resources, resources_of_path);
}

static fmi3Instance refuse(fmi3String name, fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger)
{
    const arrays_component log = log_of(name, environment, logger);
    error(&log, "Take this FMU for co-simulation; it has nothing else.");
    return NULL;
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                          fmi3Boolean logging, fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger)
{
    (void)token, (void)resources, (void)visible, (void)logging;
    return refuse(name, environment, logger);
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                               fmi3Boolean logging, fmi3InstanceEnvironment environment,
                                               fmi3LogMessageCallback logger, fmi3ClockUpdateCallback clock,
                                               fmi3LockPreemptionCallback lock, fmi3UnlockPreemptionCallback unlock)
{
    (void)token, (void)resources, (void)visible, (void)logging, (void)clock, (void)lock, (void)unlock;
    return refuse(name, environment, logger);
}

void fmi3FreeInstance(fmi3Instance instance) { arrays_release((arrays_component *)instance); }

fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean tolerant, fmi3Float64 tolerance, fmi3Float64 start,
                                       fmi3Boolean stops, fmi3Float64 stop)
{
    REQUIRE(INSTANTIATED, "fmi3EnterInitializationMode");
    (void)tolerant, (void)tolerance, (void)stops, (void)stop;
    const arrays_status status = arrays_plan(self, start);
    if (status == ARRAYS_OK) self->now = INITIALISING;
    return (fmi3Status)status;
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance instance)
{
    REQUIRE(INITIALISING, "fmi3ExitInitializationMode");
    return (fmi3Status)arrays_initialise(self);
}

fmi3Status fmi3Terminate(fmi3Instance instance)
{
    REQUIRE(RUNNING | STOPPED, "fmi3Terminate");
    self->now = STOPPED;
    return fmi3OK;
}

fmi3Status fmi3Reset(fmi3Instance instance)
{
    REQUIRE(ALWAYS, "fmi3Reset");
    arrays_begin_anew(self);
    return fmi3OK;
}

/* Whether these are arrays of this kind and so many values are theirs; the time may be among them where that is not whole. */
static bool counts(const arrays_component *self, const fmi3ValueReference vr[], size_t count, size_t values, int whole,
                   const char *function)
{
    size_t due = 0;
    for (size_t i = 0; i < count; ++i) {
        const bool time = vr[i] == (unsigned)ARRAYS && !whole;
        if (!time && !arrays_find(self, vr[i], 0, whole, function)) return false;
        due += time ? 1 : arrays_length(self, vr[i]);
    }
    if (due != values)
        arrays_say(self, ARRAYS_ERROR, "%s: give all elements of each array, %zu values: they were %zu.", function, due, values);
    return due == values;
}

#define GET(function, type, is_whole)                                                                                          \
    fmi3Status function(fmi3Instance instance, const fmi3ValueReference vr[], size_t count, type values[], size_t size)        \
    {                                                                                                                          \
        REQUIRE(ALWAYS, #function);                                                                                            \
        if ((count && !vr) || (size && !values)) return error(self, #function ": give places for the values.");                \
        if (!counts(self, vr, count, size, is_whole, #function)) return fmi3Error;                                             \
        arrays_settle(self);                                                                                                   \
        for (size_t i = 0; i < count; ++i) {                                                                                   \
            if (vr[i] == (unsigned)ARRAYS && !is_whole) {                                                                      \
                *values++ = (type)self->time;                                                                                  \
                continue;                                                                                                      \
            }                                                                                                                  \
            const double *found = arrays_find(self, vr[i], 0, is_whole, #function);                                            \
            if (!found) return fmi3Error;                                                                                      \
            for (size_t k = 0; k < arrays_length(self, vr[i]); ++k) *values++ = (type)found[k];                                \
        }                                                                                                                      \
        return fmi3OK;                                                                                                         \
    }
#define SET(function, type, is_whole)                                                                                          \
    fmi3Status function(fmi3Instance instance, const fmi3ValueReference vr[], size_t count, const type values[], size_t size)  \
    {                                                                                                                          \
        REQUIRE(INSTANTIATED | INITIALISING | RUNNING, #function);                                                             \
        if ((count && !vr) || (size && !values)) return error(self, #function ": give all values.");                           \
        if (!counts(self, vr, count, size, is_whole, #function)) return fmi3Error;                                             \
        const type *value = values;                                                                                            \
        for (size_t i = 0; i < count; ++i) {                                                                                   \
            if (!arrays_find(self, vr[i], 0, is_whole, #function)) return fmi3Error;                                           \
            for (size_t k = 0; k < arrays_length(self, vr[i]); ++k)                                                            \
                if (!arrays_settable(self, vr[i], k, (double)*value++)) return fmi3Error;                                      \
        }                                                                                                                      \
        value = values;                                                                                                        \
        self->stale = true;                                                                                                    \
        for (size_t i = 0; i < count; ++i) {                                                                                   \
            double *found = arrays_find(self, vr[i], 0, is_whole, #function);                                                  \
            for (size_t k = 0; k < arrays_length(self, vr[i]); ++k) found[k] = (double)*value++;                               \
        }                                                                                                                      \
        return fmi3OK;                                                                                                         \
    }
GET(fmi3GetFloat64, fmi3Float64, 0)
GET(fmi3GetInt32, fmi3Int32, 1)
SET(fmi3SetFloat64, fmi3Float64, 0)
SET(fmi3SetInt32, fmi3Int32, 1)

/* There are none of these. */
#define NONE(name, type)                                                                                                  \
    fmi3Status fmi3Get##name(fmi3Instance instance, const fmi3ValueReference vr[], size_t count, type values[], size_t n) \
    {                                                                                                                     \
        REQUIRE(ALWAYS, "fmi3Get" #name);                                                                                 \
        (void)vr, (void)values, (void)n;                                                                                  \
        return count ? error(self, "No variable has the type " #name ".") : fmi3OK;                                       \
    }                                                                                                                     \
    fmi3Status fmi3Set##name(fmi3Instance instance, const fmi3ValueReference vr[], size_t count, const type values[],     \
                             size_t n)                                                                                    \
    {                                                                                                                     \
        REQUIRE(ALWAYS, "fmi3Set" #name);                                                                                 \
        (void)vr, (void)values, (void)n;                                                                                  \
        return count ? error(self, "No variable has the type " #name ".") : fmi3OK;                                       \
    }
NONE(Float32, fmi3Float32)
NONE(Int8, fmi3Int8)
NONE(UInt8, fmi3UInt8)
NONE(Int16, fmi3Int16)
NONE(UInt16, fmi3UInt16)
NONE(UInt32, fmi3UInt32)
NONE(Int64, fmi3Int64)
NONE(UInt64, fmi3UInt64)
NONE(Boolean, fmi3Boolean)
NONE(String, fmi3String)

fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 time, fmi3Float64 size, fmi3Boolean no_way_back, fmi3Boolean *event,
                      fmi3Boolean *terminate, fmi3Boolean *early, fmi3Float64 *last)
{
    REQUIRE(RUNNING, "fmi3DoStep");
    (void)no_way_back;
    if (!event || !terminate || !early || !last) return error(self, "fmi3DoStep: give places for its four answers.");
    *event = *terminate = *early = fmi3False;
    const arrays_status status = arrays_step(self, time, size);
    *last = self->time;
    return (fmi3Status)status;
}

/* ---- saved states ---- */

fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState *state)
{
    REQUIRE(ALWAYS, "fmi3GetFMUState");
    return (fmi3Status)arrays_keep(self, state);
}

fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState state)
{
    REQUIRE(ALWAYS, "fmi3SetFMUState");
    return (fmi3Status)arrays_take_back(self, state);
}

fmi3Status fmi3FreeFMUState(fmi3Instance instance, fmi3FMUState *state)
{
    REQUIRE(ALWAYS, "fmi3FreeFMUState");
    if (state) {
        free(*state);
        *state = NULL;
    }
    return fmi3OK;
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance instance, fmi3FMUState state, size_t *size)
{
    REQUIRE(ALWAYS, "fmi3SerializedFMUStateSize");
    return (fmi3Status)arrays_size(self, state, size);
}

fmi3Status fmi3SerializeFMUState(fmi3Instance instance, fmi3FMUState state, fmi3Byte bytes[], size_t size)
{
    REQUIRE(ALWAYS, "fmi3SerializeFMUState");
    return (fmi3Status)arrays_serialise(self, state, bytes, size);
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance instance, const fmi3Byte bytes[], size_t size, fmi3FMUState *state)
{
    REQUIRE(ALWAYS, "fmi3DeserializeFMUState");
    return (fmi3Status)arrays_deserialise(self, bytes, size, state);
}

/* ---- what this FMU does not offer ---- */

#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif
#define OFFERS_NOT(function, ...)                                                   \
    fmi3Status function(fmi3Instance instance, __VA_ARGS__)                         \
    {                                                                               \
        REQUIRE(ALWAYS, #function);                                                 \
        return error(self, #function " is not offered; see modelDescription.xml."); \
    }
#define OFFERS_NOT_PLAIN(function)                                                  \
    fmi3Status function(fmi3Instance instance)                                      \
    {                                                                               \
        REQUIRE(ALWAYS, #function);                                                 \
        return error(self, #function " is not offered; see modelDescription.xml."); \
    }
OFFERS_NOT_PLAIN(fmi3EnterEventMode)
OFFERS_NOT_PLAIN(fmi3EnterContinuousTimeMode)
OFFERS_NOT_PLAIN(fmi3EnterStepMode)
OFFERS_NOT_PLAIN(fmi3EnterConfigurationMode)
OFFERS_NOT_PLAIN(fmi3ExitConfigurationMode)
OFFERS_NOT_PLAIN(fmi3EvaluateDiscreteStates)
OFFERS_NOT(fmi3GetBinary, const fmi3ValueReference a[], size_t n, size_t b[], fmi3Binary c[], size_t d)
OFFERS_NOT(fmi3SetBinary, const fmi3ValueReference a[], size_t n, const size_t b[], const fmi3Binary c[], size_t d)
OFFERS_NOT(fmi3GetClock, const fmi3ValueReference a[], size_t n, fmi3Clock b[])
OFFERS_NOT(fmi3SetClock, const fmi3ValueReference a[], size_t n, const fmi3Clock b[])
OFFERS_NOT(fmi3GetIntervalDecimal, const fmi3ValueReference a[], size_t b, fmi3Float64 c[], fmi3IntervalQualifier d[])
OFFERS_NOT(fmi3GetIntervalFraction, const fmi3ValueReference a[], size_t b, fmi3UInt64 c[], fmi3UInt64 d[],
           fmi3IntervalQualifier e[])
OFFERS_NOT(fmi3GetShiftDecimal, const fmi3ValueReference a[], size_t b, fmi3Float64 c[])
OFFERS_NOT(fmi3GetShiftFraction, const fmi3ValueReference a[], size_t b, fmi3UInt64 c[], fmi3UInt64 d[])
OFFERS_NOT(fmi3SetIntervalDecimal, const fmi3ValueReference a[], size_t b, const fmi3Float64 c[])
OFFERS_NOT(fmi3SetIntervalFraction, const fmi3ValueReference a[], size_t b, const fmi3UInt64 c[], const fmi3UInt64 d[])
OFFERS_NOT(fmi3SetShiftDecimal, const fmi3ValueReference a[], size_t b, const fmi3Float64 c[])
OFFERS_NOT(fmi3SetShiftFraction, const fmi3ValueReference a[], size_t b, const fmi3UInt64 c[], const fmi3UInt64 d[])
OFFERS_NOT(fmi3ActivateModelPartition, fmi3ValueReference a, fmi3Float64 b)
OFFERS_NOT(fmi3GetNumberOfVariableDependencies, fmi3ValueReference a, size_t *b)
OFFERS_NOT(fmi3GetVariableDependencies, fmi3ValueReference a, size_t b[], fmi3ValueReference c[], size_t d[],
           fmi3DependencyKind e[], size_t f)
OFFERS_NOT(fmi3GetDirectionalDerivative, const fmi3ValueReference a[], size_t b, const fmi3ValueReference c[], size_t d,
           const fmi3Float64 e[], size_t f, fmi3Float64 g[], size_t h)
OFFERS_NOT(fmi3GetAdjointDerivative, const fmi3ValueReference a[], size_t b, const fmi3ValueReference c[], size_t d,
           const fmi3Float64 e[], size_t f, fmi3Float64 g[], size_t h)
OFFERS_NOT(fmi3GetOutputDerivatives, const fmi3ValueReference a[], size_t b, const fmi3Int32 c[], fmi3Float64 d[], size_t e)
OFFERS_NOT(fmi3UpdateDiscreteStates, fmi3Boolean *a, fmi3Boolean *b, fmi3Boolean *c, fmi3Boolean *d, fmi3Boolean *e,
           fmi3Float64 *f)
OFFERS_NOT(fmi3CompletedIntegratorStep, fmi3Boolean a, fmi3Boolean *b, fmi3Boolean *c)
OFFERS_NOT(fmi3SetTime, fmi3Float64 a)
OFFERS_NOT(fmi3SetContinuousStates, const fmi3Float64 a[], size_t b)
OFFERS_NOT(fmi3GetContinuousStateDerivatives, fmi3Float64 a[], size_t b)
OFFERS_NOT(fmi3GetEventIndicators, fmi3Float64 a[], size_t b)
OFFERS_NOT(fmi3GetContinuousStates, fmi3Float64 a[], size_t b)
OFFERS_NOT(fmi3GetNominalsOfContinuousStates, fmi3Float64 a[], size_t b)
OFFERS_NOT(fmi3GetNumberOfEventIndicators, size_t *a)
OFFERS_NOT(fmi3GetNumberOfContinuousStates, size_t *a)
