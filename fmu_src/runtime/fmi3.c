/* The FMI 3.0 face of the same kernel: co-simulation and model exchange. Value references are those of FMI 2.0, and the
 * time has one of its own. In co-simulation with earlyReturnAllowed a step ends where a wheelset locks or turns again, and
 * where the run ends; without it a step within which the run ends is discarded, and the instance stands where it stood
 * before. A host that uses event mode is told of the former; there is nothing left to update. */
#include <stdlib.h>
#include <string.h>

#include "face.h"
#include "fmi3Functions.h"

#define STATUS fmi3Status

static void tell_host(const component *self, kernel_status status, const char *category, const char *sentence) {
    ((fmi3LogMessageCallback)self->logger)(self->environment, (fmi3Status)status, category, sentence);
}

const char *fmi3GetVersion(void) { return fmi3Version; }

fmi3Status fmi3SetDebugLogging(fmi3Instance instance, fmi3Boolean loggingOn, size_t nCategories,
                               const fmi3String categories[]) {
    REQUIRE(instance, ALWAYS, "fmi3SetDebugLogging");
    return (fmi3Status)face_log(self, loggingOn, nCategories, categories);
}

/* Says why there will be no instance, unless logging is off (section 2.3.1). */
static fmi3Instance refuse(fmi3LogMessageCallback logMessage, fmi3InstanceEnvironment environment, int logging,
                           const char *sentence) {
    if (logMessage && logging) logMessage(environment, fmi3Error, "logStatusError", sentence);
    return NULL;
}

/* What an instance is told at its birth. */
static component log_of(fmi3String name, fmi3InstanceEnvironment environment, fmi3LogMessageCallback logMessage) {
    component log;
    memset(&log, 0, sizeof log);
    log.name = (char *)name;
    log.standard = "FMI 3.0, section 4.2.1";
    log.tell = tell_host;
    log.logger = (void (*)(void))logMessage;
    log.environment = environment;
    return log;
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String instanceName, fmi3String instantiationToken,
                                         fmi3String resourcePath, fmi3Boolean visible, fmi3Boolean loggingOn,
                                         fmi3Boolean eventModeUsed, fmi3Boolean earlyReturnAllowed,
                                         const fmi3ValueReference requiredIntermediateVariables[],
                                         size_t nRequiredIntermediateVariables,
                                         fmi3InstanceEnvironment instanceEnvironment, fmi3LogMessageCallback logMessage,
                                         fmi3IntermediateUpdateCallback intermediateUpdate) {
    (void)visible, (void)requiredIntermediateVariables;
    (void)nRequiredIntermediateVariables, (void)intermediateUpdate;
    component log = log_of(instanceName, instanceEnvironment, logMessage);
    log.events = eventModeUsed;
    component *self = face_take_resources(face_instantiate(&log, instanceName, instantiationToken, loggingOn), resourcePath,
                                          resources_of_path);
    if (self) kernel_stop_at_events(self->machine, earlyReturnAllowed);
    return self;
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String instanceName, fmi3String instantiationToken,
                                          fmi3String resourcePath, fmi3Boolean visible, fmi3Boolean loggingOn,
                                          fmi3InstanceEnvironment instanceEnvironment,
                                          fmi3LogMessageCallback logMessage) {
    (void)visible;
    component log = log_of(instanceName, instanceEnvironment, logMessage);
    log.exchange = true;
    return face_take_resources(face_instantiate(&log, instanceName, instantiationToken, loggingOn), resourcePath,
                               resources_of_path);
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String instanceName, fmi3String instantiationToken,
                                               fmi3String resourcePath, fmi3Boolean visible, fmi3Boolean loggingOn,
                                               fmi3InstanceEnvironment instanceEnvironment,
                                               fmi3LogMessageCallback logMessage, fmi3ClockUpdateCallback clockUpdate,
                                               fmi3LockPreemptionCallback lockPreemption,
                                               fmi3UnlockPreemptionCallback unlockPreemption) {
    (void)instanceName, (void)instantiationToken, (void)resourcePath, (void)visible;
    (void)clockUpdate, (void)lockPreemption, (void)unlockPreemption;
    return refuse(logMessage, instanceEnvironment, loggingOn,
                  "There is no scheduled execution; instantiate for co-simulation or model exchange.");
}

void fmi3FreeInstance(fmi3Instance instance) { face_free((component *)instance); }

fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean toleranceDefined, fmi3Float64 tolerance,
                                       fmi3Float64 startTime, fmi3Boolean stopTimeDefined, fmi3Float64 stopTime) {
    REQUIRE(instance, INSTANTIATED, "fmi3EnterInitializationMode");
    const kernel_status status =
        face_plan(self, toleranceDefined ? &tolerance : NULL, startTime, stopTimeDefined ? &stopTime : NULL);
    if (status <= KERNEL_WARNING) self->now = INITIALISING;
    return (fmi3Status)status;
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance instance) {
    REQUIRE(instance, INITIALISING, "fmi3ExitInitializationMode");
    return (fmi3Status)face_initialise(self);
}

fmi3Status fmi3Terminate(fmi3Instance instance) {
    REQUIRE(instance, RUNNING | STOPPED, "fmi3Terminate");
    return (fmi3Status)face_terminate(self);
}

fmi3Status fmi3Reset(fmi3Instance instance) {
    REQUIRE(instance, ALWAYS, "fmi3Reset");
    return (fmi3Status)face_reset(self);
}

/* ---- variables ---- */

static bool sizes_differ(const component *self, size_t references, size_t values) {
    return references != values && face_error(self, "Give one value for each value reference: there are no arrays.");
}

static bool unusable(const component *self, const void *reference, size_t references, const void *value, size_t values) {
    return sizes_differ(self, references, values) || face_missing(self, values, reference, value);
}

static kernel_status get(component *self, unsigned reference, int kind, double *value) {
    if (kind != KIND_REAL || reference != (unsigned)MODEL.variables) return face_get(self, reference, kind, value);
    *value = self->now & (INSTANTIATED | INITIALISING) ? self->start_time : kernel_time(self->machine);
    return KERNEL_OK;
}

#define DEFINE_GET(function, type, kind)                                                                              \
    fmi3Status function(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,   \
                        type values[], size_t nValues) {                                                              \
        REQUIRE(instance, ALWAYS, #function);                                                                         \
        if (unusable(self, valueReferences, nValueReferences, values, nValues)) return fmi3Error;                     \
        kernel_status worst = KERNEL_OK;                                                                                        \
        for (size_t i = 0; i < nValues; ++i) {                                                                        \
            double number = 0.0;                                                                                      \
            const kernel_status status = get(self, valueReferences[i], kind, &number);                                          \
            values[i] = (type)number;                                                                                 \
            if (status > worst) worst = status;                                                                       \
        }                                                                                                             \
        return (fmi3Status)worst;                                                                                     \
    }

#define DEFINE_SET(function, type, kind)                                                                              \
    fmi3Status function(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,   \
                        const type values[], size_t nValues) {                                                        \
        REQUIRE(instance, SETTABLE, #function);                                                                       \
        if (unusable(self, valueReferences, nValueReferences, values, nValues)) return fmi3Error;                     \
        if (face_fixed(self, nValues, valueReferences, kind)) return fmi3Error;                                       \
        for (size_t i = 0; i < nValues; ++i)                                                                          \
            if (face_refuses(self, valueReferences[i], (double)values[i])) return fmi3Error;                          \
        kernel_status worst = KERNEL_OK;                                                                                        \
        for (size_t i = 0; i < nValues; ++i) {                                                                        \
            const kernel_status status = face_set(self, valueReferences[i], (double)values[i]);                                 \
            if (status > worst) worst = status;                                                                       \
        }                                                                                                             \
        return (fmi3Status)worst;                                                                                     \
    }

DEFINE_GET(fmi3GetFloat64, fmi3Float64, KIND_REAL)
DEFINE_GET(fmi3GetInt32, fmi3Int32, KIND_INTEGER)
DEFINE_GET(fmi3GetBoolean, fmi3Boolean, KIND_BOOLEAN)
DEFINE_SET(fmi3SetFloat64, fmi3Float64, KIND_REAL)
DEFINE_SET(fmi3SetInt32, fmi3Int32, KIND_INTEGER)
DEFINE_SET(fmi3SetBoolean, fmi3Boolean, KIND_BOOLEAN)

/* Types that no variable has. */
#define DEFINE_NONE(name, type)                                                                                       \
    fmi3Status fmi3Get##name(fmi3Instance instance, const fmi3ValueReference valueReferences[],                       \
                             size_t nValueReferences, type values[], size_t nValues) {                                \
        REQUIRE(instance, ALWAYS, "fmi3Get" #name);                                                                   \
        (void)valueReferences, (void)values, (void)nValues;                                                           \
        return nValueReferences ? (fmi3Status)face_error(self, "There are no variables of type " #name ".") : fmi3OK; \
    }                                                                                                                 \
    fmi3Status fmi3Set##name(fmi3Instance instance, const fmi3ValueReference valueReferences[],                       \
                             size_t nValueReferences, const type values[], size_t nValues) {                          \
        REQUIRE(instance, ALWAYS, "fmi3Set" #name);                                                                   \
        (void)valueReferences, (void)values, (void)nValues;                                                           \
        return nValueReferences ? (fmi3Status)face_error(self, "There are no variables of type " #name ".") : fmi3OK; \
    }

DEFINE_NONE(Float32, fmi3Float32)
DEFINE_NONE(Int8, fmi3Int8)
DEFINE_NONE(UInt8, fmi3UInt8)
DEFINE_NONE(Int16, fmi3Int16)
DEFINE_NONE(UInt16, fmi3UInt16)
DEFINE_NONE(UInt32, fmi3UInt32)
DEFINE_NONE(Int64, fmi3Int64)
DEFINE_NONE(UInt64, fmi3UInt64)

fmi3Status fmi3GetString(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                         fmi3String values[], size_t nValues) {
    REQUIRE(instance, ALWAYS, "fmi3GetString");
    if (unusable(self, valueReferences, nValueReferences, values, nValues)) return fmi3Error;
    return (fmi3Status)face_get_texts(self, nValues, valueReferences, values);
}

fmi3Status fmi3SetString(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                         const fmi3String values[], size_t nValues) {
    REQUIRE(instance, SETTABLE, "fmi3SetString");
    if (unusable(self, valueReferences, nValueReferences, values, nValues)) return fmi3Error;
    return (fmi3Status)face_set_texts(self, nValues, valueReferences, values);
}

/* ---- saved states ---- */

fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState *FMUState) {
    REQUIRE(instance, ALWAYS, "fmi3GetFMUState");
    return (fmi3Status)face_save(self, FMUState);
}

fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState FMUState) {
    REQUIRE(instance, ALWAYS, "fmi3SetFMUState");
    return (fmi3Status)face_restore(self, FMUState);
}

fmi3Status fmi3FreeFMUState(fmi3Instance instance, fmi3FMUState *FMUState) {
    REQUIRE(instance, ALWAYS, "fmi3FreeFMUState");
    if (FMUState) {
        free(*FMUState);
        *FMUState = NULL;
    }
    return fmi3OK;
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance instance, fmi3FMUState FMUState, size_t *size) {
    REQUIRE(instance, ALWAYS, "fmi3SerializedFMUStateSize");
    if (face_missing(self, 1, FMUState, size)) return fmi3Error;
    *size = face_saved_size(self);
    return fmi3OK;
}

fmi3Status fmi3SerializeFMUState(fmi3Instance instance, fmi3FMUState FMUState, fmi3Byte serializedState[],
                                 size_t size) {
    REQUIRE(instance, ALWAYS, "fmi3SerializeFMUState");
    return (fmi3Status)face_serialise(self, FMUState, serializedState, size);
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance instance, const fmi3Byte serializedState[], size_t size,
                                   fmi3FMUState *FMUState) {
    REQUIRE(instance, ALWAYS, "fmi3DeserializeFMUState");
    return (fmi3Status)face_deserialise(self, serializedState, size, FMUState);
}

/* ---- derivatives and steps ---- */

fmi3Status fmi3GetDirectionalDerivative(fmi3Instance instance, const fmi3ValueReference unknowns[], size_t nUnknowns,
                                        const fmi3ValueReference knowns[], size_t nKnowns, const fmi3Float64 seed[],
                                        size_t nSeed, fmi3Float64 sensitivity[], size_t nSensitivity) {
    REQUIRE(instance, KNOWN, "fmi3GetDirectionalDerivative");
    if (unusable(self, unknowns, nUnknowns, sensitivity, nSensitivity)) return fmi3Error;
    if (unusable(self, knowns, nKnowns, seed, nSeed)) return fmi3Error;
    const kernel_status status = face_initialise_if_asked(self);
    if (status > KERNEL_WARNING) return (fmi3Status)status;
    return (fmi3Status)face_report(
        self, kernel_get_directional(self->machine, (int)nUnknowns, (const int *)unknowns, (int)nKnowns,
                                     (const int *)knowns, seed, sensitivity));
}

fmi3Status fmi3GetOutputDerivatives(fmi3Instance instance, const fmi3ValueReference valueReferences[],
                                    size_t nValueReferences, const fmi3Int32 orders[], fmi3Float64 values[],
                                    size_t nValues) {
    REQUIRE(instance, STEPPING | STOPPED | TERMINATED, "fmi3GetOutputDerivatives");
    if (face_is_exchange(self)) return fmi3Error;
    if (unusable(self, valueReferences, nValueReferences, values, nValues)) return fmi3Error;
    if (face_missing(self, nValues, orders, orders)) return fmi3Error;
    for (size_t i = 0; i < nValues; ++i)
        if (orders[i] != 1) return (fmi3Status)face_error(self, "Only first derivatives of outputs are provided.");
    return (fmi3Status)face_report(
        self, kernel_get_rates(self->machine, (int)nValues, (const int *)valueReferences, values));
}

fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 currentCommunicationPoint, fmi3Float64 communicationStepSize,
                      fmi3Boolean noSetFMUStatePriorToCurrentPoint, fmi3Boolean *eventHandlingNeeded,
                      fmi3Boolean *terminateSimulation, fmi3Boolean *earlyReturn, fmi3Float64 *lastSuccessfulTime) {
    REQUIRE(instance, STEPPING | STOPPED, "fmi3DoStep");
    (void)noSetFMUStatePriorToCurrentPoint;
    if (face_missing(self, 1, eventHandlingNeeded, terminateSimulation) ||
        face_missing(self, 1, earlyReturn, lastSuccessfulTime))
        return fmi3Error;
    const double end = currentCommunicationPoint + communicationStepSize;
    *eventHandlingNeeded = *terminateSimulation = *earlyReturn = fmi3False;
    *lastSuccessfulTime = kernel_time(self->machine);
    if (self->now == STOPPED)
        return (fmi3Status)face_error(self, "The run has ended, as terminateSimulation said; reset it to start again.");
    self->last_step = face_report(
        self, kernel_step(self->machine, currentCommunicationPoint, communicationStepSize));
    const bool ended = kernel_ended(self->machine);
    if (ended) self->now = STOPPED, self->last_step = KERNEL_OK; /* to reach the end of the run is no failure */
    if (self->last_step > KERNEL_WARNING) return (fmi3Status)self->last_step;
    *terminateSimulation = ended;
    *lastSuccessfulTime = kernel_time(self->machine);
    *earlyReturn = *lastSuccessfulTime < end;
    *eventHandlingNeeded = self->events && *earlyReturn && !ended;
    return (fmi3Status)self->last_step;
}

/* ---- events and model exchange ---- */

enum { INTEGRATING = AT_EVENT | CONTINUOUS };

fmi3Status fmi3EnterEventMode(fmi3Instance instance) {
    REQUIRE(instance, CONTINUOUS | STEPPING, "fmi3EnterEventMode");
    if (!self->exchange && !self->events)
        return (fmi3Status)face_error(self, "Event mode was not asked for; instantiate with eventModeUsed = true.");
    return (fmi3Status)face_enter(self, AT_EVENT);
}

fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance instance) {
    REQUIRE(instance, AT_EVENT, "fmi3EnterContinuousTimeMode");
    if (!self->exchange) return (fmi3Status)face_error(self, "Continuous-time mode is of model exchange; enter step mode.");
    return (fmi3Status)face_enter(self, CONTINUOUS);
}

fmi3Status fmi3EnterStepMode(fmi3Instance instance) {
    REQUIRE(instance, AT_EVENT, "fmi3EnterStepMode");
    if (self->exchange) return (fmi3Status)face_error(self, "Step mode is of co-simulation; enter continuous-time mode.");
    return (fmi3Status)face_enter(self, STEPPING);
}

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance instance, fmi3Boolean *discreteStatesNeedUpdate,
                                    fmi3Boolean *terminateSimulation, fmi3Boolean *nominalsOfContinuousStatesChanged,
                                    fmi3Boolean *valuesOfContinuousStatesChanged, fmi3Boolean *nextEventTimeDefined,
                                    fmi3Float64 *nextEventTime) {
    REQUIRE(instance, AT_EVENT, "fmi3UpdateDiscreteStates");
    if (face_missing(self, 1, discreteStatesNeedUpdate, terminateSimulation) ||
        face_missing(self, 1, nominalsOfContinuousStatesChanged, valuesOfContinuousStatesChanged) ||
        face_missing(self, 1, nextEventTimeDefined, nextEventTime))
        return fmi3Error;
    bool ended = false, jumped = false;
    /* Steps of our own have found modes already, and find them anew after inputs have jumped. */
    const kernel_status status = self->exchange ? face_find_modes(self, &ended, &jumped) : KERNEL_OK;
    *discreteStatesNeedUpdate = *nominalsOfContinuousStatesChanged = *nextEventTimeDefined = fmi3False;
    *nextEventTime = 0.0;
    *terminateSimulation = ended;
    *valuesOfContinuousStatesChanged = jumped;
    return (fmi3Status)status;
}

fmi3Status fmi3CompletedIntegratorStep(fmi3Instance instance, fmi3Boolean noSetFMUStatePriorToCurrentPoint,
                                       fmi3Boolean *enterEventMode, fmi3Boolean *terminateSimulation) {
    REQUIRE(instance, CONTINUOUS, "fmi3CompletedIntegratorStep");
    (void)noSetFMUStatePriorToCurrentPoint;
    if (face_missing(self, 1, enterEventMode, terminateSimulation)) return fmi3Error;
    bool crossed = false;
    const kernel_status status = face_complete_step(self, &crossed);
    *enterEventMode = crossed;
    *terminateSimulation = fmi3False;
    return (fmi3Status)status;
}

fmi3Status fmi3SetTime(fmi3Instance instance, fmi3Float64 time) {
    REQUIRE(instance, INTEGRATING, "fmi3SetTime");
    return (fmi3Status)face_set_time(self, time);
}

fmi3Status fmi3SetContinuousStates(fmi3Instance instance, const fmi3Float64 continuousStates[],
                                   size_t nContinuousStates) {
    REQUIRE(instance, CONTINUOUS, "fmi3SetContinuousStates");
    return (fmi3Status)face_set_states(self, continuousStates, nContinuousStates);
}

#define DEFINE_READ(function, expected, read)                                          \
    fmi3Status function(fmi3Instance instance, fmi3Float64 values[], size_t nValues) { \
        REQUIRE(instance, KNOWN, #function);                                           \
        return (fmi3Status)face_read(self, values, nValues, expected(), read);         \
    }

DEFINE_READ(fmi3GetContinuousStateDerivatives, kernel_exchange_states, kernel_get_slopes)
DEFINE_READ(fmi3GetContinuousStates, kernel_exchange_states, kernel_get_states)
DEFINE_READ(fmi3GetEventIndicators, kernel_exchange_indicators, kernel_get_indicators)

fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance instance, fmi3Float64 nominals[], size_t nContinuousStates) {
    REQUIRE(instance, ALWAYS, "fmi3GetNominalsOfContinuousStates");
    return (fmi3Status)face_nominals(self, nominals, nContinuousStates);
}

#define DEFINE_COUNT(function, count)                                \
    fmi3Status function(fmi3Instance instance, size_t *number) {     \
        REQUIRE(instance, ALWAYS, #function);                        \
        if (face_is_cosimulation(self)) return fmi3Error;            \
        if (face_missing(self, 1, number, number)) return fmi3Error; \
        *number = (size_t)count();                                   \
        return fmi3OK;                                               \
    }

DEFINE_COUNT(fmi3GetNumberOfContinuousStates, kernel_exchange_states)
DEFINE_COUNT(fmi3GetNumberOfEventIndicators, kernel_exchange_indicators)

/* ---- what this FMU does not have ---- */

#define DEFINE_ABSENT(function, what, ...)            \
    fmi3Status function(fmi3Instance instance, __VA_ARGS__) { \
        REQUIRE(instance, ALWAYS, #function);         \
        return (fmi3Status)face_error(self, what);    \
    }
#define DEFINE_ABSENT_PLAIN(function, what)        \
    fmi3Status function(fmi3Instance instance) {   \
        REQUIRE(instance, ALWAYS, #function);      \
        return (fmi3Status)face_error(self, what); \
    }

/* Of a type that no variable has: to read or set none of them is no error. */
#define DEFINE_EMPTY(function, what, ...)                                                                             \
    fmi3Status function(fmi3Instance instance, const fmi3ValueReference a[], size_t references, __VA_ARGS__) {        \
        REQUIRE(instance, ALWAYS, #function);                                                                         \
        return references ? (fmi3Status)face_error(self, what) : fmi3OK;                                              \
    }

#pragma GCC diagnostic ignored "-Wunused-parameter"
static const char NO_MODE[] = "There is no such mode: this FMU has neither clocks nor a configuration.";
static const char NO_CLOCKS[] = "There are no clocks.";

DEFINE_ABSENT_PLAIN(fmi3EnterConfigurationMode, NO_MODE)
DEFINE_ABSENT_PLAIN(fmi3ExitConfigurationMode, NO_MODE)
DEFINE_ABSENT_PLAIN(fmi3EvaluateDiscreteStates, NO_MODE)
DEFINE_EMPTY(fmi3GetBinary, "There are no variables of type Binary.", size_t b[], fmi3Binary c[], size_t d)
DEFINE_EMPTY(fmi3SetBinary, "There are no variables of type Binary.", const size_t b[], const fmi3Binary c[], size_t d)
DEFINE_EMPTY(fmi3GetClock, NO_CLOCKS, fmi3Clock b[])
DEFINE_EMPTY(fmi3SetClock, NO_CLOCKS, const fmi3Clock b[])
DEFINE_ABSENT(fmi3GetIntervalDecimal, NO_CLOCKS, const fmi3ValueReference a[], size_t b, fmi3Float64 c[],
              fmi3IntervalQualifier d[])
DEFINE_ABSENT(fmi3GetIntervalFraction, NO_CLOCKS, const fmi3ValueReference a[], size_t b, fmi3UInt64 c[],
              fmi3UInt64 d[], fmi3IntervalQualifier e[])
DEFINE_ABSENT(fmi3GetShiftDecimal, NO_CLOCKS, const fmi3ValueReference a[], size_t b, fmi3Float64 c[])
DEFINE_ABSENT(fmi3GetShiftFraction, NO_CLOCKS, const fmi3ValueReference a[], size_t b, fmi3UInt64 c[], fmi3UInt64 d[])
DEFINE_ABSENT(fmi3SetIntervalDecimal, NO_CLOCKS, const fmi3ValueReference a[], size_t b, const fmi3Float64 c[])
DEFINE_ABSENT(fmi3SetIntervalFraction, NO_CLOCKS, const fmi3ValueReference a[], size_t b, const fmi3UInt64 c[],
              const fmi3UInt64 d[])
DEFINE_ABSENT(fmi3SetShiftDecimal, NO_CLOCKS, const fmi3ValueReference a[], size_t b, const fmi3Float64 c[])
DEFINE_ABSENT(fmi3SetShiftFraction, NO_CLOCKS, const fmi3ValueReference a[], size_t b, const fmi3UInt64 c[],
              const fmi3UInt64 d[])
DEFINE_ABSENT(fmi3ActivateModelPartition, NO_CLOCKS, fmi3ValueReference a, fmi3Float64 b)
DEFINE_ABSENT(fmi3GetNumberOfVariableDependencies, "Dependencies are in modelDescription.xml and do not change.",
              fmi3ValueReference a, size_t *b)
DEFINE_ABSENT(fmi3GetVariableDependencies, "Dependencies are in modelDescription.xml and do not change.",
              fmi3ValueReference a, size_t b[], fmi3ValueReference c[], size_t d[], fmi3DependencyKind e[], size_t f)
DEFINE_ABSENT(fmi3GetAdjointDerivative, "Adjoint derivatives are not provided.", const fmi3ValueReference a[], size_t b,
              const fmi3ValueReference c[], size_t d, const fmi3Float64 e[], size_t f, fmi3Float64 g[], size_t h)
