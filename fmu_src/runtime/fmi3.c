/* The FMI 3.0 interface of any object (object.h): co-simulation and model exchange. The time has its own value reference.
 *
 * In co-simulation an object that can stop at events ends a step early at its events, such as a wheelset that locks, and where
 * its run ends, if the host has set earlyReturnAllowed. Else it discards a step within which its run ends, and stays where it
 * was. A step of any other object goes to its end, also the last one. With eventModeUsed, eventHandlingNeeded reports such an
 * event; the step has handled it, so that fmi3UpdateDiscreteStates changes nothing. */
#include <string.h>

#include "face.h"
#include "fmi3Functions.h"

#define STATUS fmi3Status

static void tell_host(const component *self, kernel_status status, const char *category, const char *sentence) {
    ((fmi3LogMessageCallback)self->logger)(self->environment, (fmi3Status)status, category, sentence);
}

/* Section 2.3.1: the callback is not called unless logging is on. */
static const face_standard FMI3 = {"FMI 3.0, section 4.2.1", 0, false, resources_of_path, tell_host};

const char *fmi3GetVersion(void) { return fmi3Version; }

FACE_FUNCTION(fmi3SetDebugLogging, ALWAYS,
              (fmi3Instance instance, fmi3Boolean loggingOn, size_t nCategories, const fmi3String categories[]),
              face_log(self, loggingOn, nCategories, categories))

/* Return the log settings of an instance at its instantiation. */
static component log_of(fmi3InstanceEnvironment environment, fmi3LogMessageCallback logMessage) {
    component log;
    memset(&log, 0, sizeof log);
    log.standard = &FMI3;
    log.logger = (void (*)(void))logMessage;
    log.environment = environment;
    return log;
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String instanceName, fmi3String instantiationToken, fmi3String resourcePath,
                                         fmi3Boolean visible, fmi3Boolean loggingOn, fmi3Boolean eventModeUsed,
                                         fmi3Boolean earlyReturnAllowed,
                                         const fmi3ValueReference requiredIntermediateVariables[],
                                         size_t nRequiredIntermediateVariables, fmi3InstanceEnvironment instanceEnvironment,
                                         fmi3LogMessageCallback logMessage, fmi3IntermediateUpdateCallback intermediateUpdate) {
    (void)visible, (void)requiredIntermediateVariables;
    (void)nRequiredIntermediateVariables, (void)intermediateUpdate;
    component log = log_of(instanceEnvironment, logMessage);
    log.events = eventModeUsed && OBJECT.stop_at_events;
    component *self = face_instantiate(&log, instanceName, instantiationToken, resourcePath, loggingOn);
    if (self && OBJECT.stop_at_events) OBJECT.stop_at_events(self->object, earlyReturnAllowed);
    return self;
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String instanceName, fmi3String instantiationToken, fmi3String resourcePath,
                                          fmi3Boolean visible, fmi3Boolean loggingOn,
                                          fmi3InstanceEnvironment instanceEnvironment, fmi3LogMessageCallback logMessage) {
    (void)visible;
    component log = log_of(instanceEnvironment, logMessage);
    log.exchange = true;
    return face_instantiate(&log, instanceName, instantiationToken, resourcePath, loggingOn);
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String instanceName, fmi3String instantiationToken, fmi3String resourcePath,
                                               fmi3Boolean visible, fmi3Boolean loggingOn,
                                               fmi3InstanceEnvironment instanceEnvironment, fmi3LogMessageCallback logMessage,
                                               fmi3ClockUpdateCallback clockUpdate, fmi3LockPreemptionCallback lockPreemption,
                                               fmi3UnlockPreemptionCallback unlockPreemption) {
    (void)instanceName, (void)instantiationToken, (void)resourcePath, (void)visible;
    (void)clockUpdate, (void)lockPreemption, (void)unlockPreemption;
    if (logMessage && loggingOn)
        logMessage(instanceEnvironment, fmi3Error, "logStatusError",
                   "There is no scheduled execution; instantiate for co-simulation or model exchange.");
    return NULL;
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

FACE_FUNCTION(fmi3ExitInitializationMode, INITIALISING, (fmi3Instance instance), face_initialise(self))
FACE_FUNCTION(fmi3Terminate, RUNNING | STOPPED, (fmi3Instance instance), face_enter(self, TERMINATED))
FACE_FUNCTION(fmi3Reset, ALWAYS, (fmi3Instance instance), face_reset(self))

/* ---- variables ---- */

static void put_int(void *values, size_t place, double number) { ((fmi3Int32 *)values)[place] = (fmi3Int32)number; }
static double take_int(const void *values, size_t place) { return ((const fmi3Int32 *)values)[place]; }
static void put_truth(void *values, size_t place, double number) { ((fmi3Boolean *)values)[place] = (fmi3Boolean)number; }
static double take_truth(const void *values, size_t place) { return ((const fmi3Boolean *)values)[place]; }

#define DEFINE_VARIABLES(name, type, kind, put, take)                                                                          \
    FACE_FUNCTION(                                                                                                             \
        fmi3Get##name, ALWAYS,                                                                                                 \
        (fmi3Instance instance, const fmi3ValueReference references[], size_t nReferences, type values[], size_t nValues),     \
        face_get(self, kind, references, nReferences, values, nValues, put))                                                   \
    FACE_FUNCTION(fmi3Set##name, SETTABLE,                                                                                     \
                  (fmi3Instance instance, const fmi3ValueReference references[], size_t nReferences, const type values[],      \
                   size_t nValues),                                                                                            \
                  face_set(self, kind, references, nReferences, values, nValues, take))

DEFINE_VARIABLES(Float64, fmi3Float64, KIND_REAL, NULL, NULL)
DEFINE_VARIABLES(Int32, fmi3Int32, KIND_INTEGER, put_int, take_int)
DEFINE_VARIABLES(Boolean, fmi3Boolean, KIND_BOOLEAN, put_truth, take_truth)

#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif

/* Functions of a type without variables: reading or setting zero variables is allowed. */
#define NONE_OF(name) nReferences ? face_error(self, "There are no variables of type " name ".") : KERNEL_OK
#define DEFINE_NONE(name, type)                                                                                                \
    FACE_FUNCTION(                                                                                                             \
        fmi3Get##name, ALWAYS,                                                                                                 \
        (fmi3Instance instance, const fmi3ValueReference references[], size_t nReferences, type values[], size_t nValues),     \
        NONE_OF(#name))                                                                                                        \
    FACE_FUNCTION(fmi3Set##name, ALWAYS,                                                                                       \
                  (fmi3Instance instance, const fmi3ValueReference references[], size_t nReferences, const type values[],      \
                   size_t nValues),                                                                                            \
                  NONE_OF(#name))

DEFINE_NONE(Float32, fmi3Float32)
DEFINE_NONE(Int8, fmi3Int8)
DEFINE_NONE(UInt8, fmi3UInt8)
DEFINE_NONE(Int16, fmi3Int16)
DEFINE_NONE(UInt16, fmi3UInt16)
DEFINE_NONE(UInt32, fmi3UInt32)
DEFINE_NONE(Int64, fmi3Int64)
DEFINE_NONE(UInt64, fmi3UInt64)

FACE_FUNCTION(fmi3GetString, ALWAYS,
              (fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences, fmi3String values[],
               size_t nValues),
              face_get_texts(self, valueReferences, nValueReferences, values, nValues))
FACE_FUNCTION(fmi3SetString, SETTABLE,
              (fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
               const fmi3String values[], size_t nValues),
              face_set_texts(self, valueReferences, nValueReferences, values, nValues))

/* ---- saved states ---- */

FACE_FUNCTION(fmi3GetFMUState, ALWAYS, (fmi3Instance instance, fmi3FMUState *FMUState), face_save(self, FMUState))
FACE_FUNCTION(fmi3SetFMUState, ALWAYS, (fmi3Instance instance, fmi3FMUState FMUState), face_restore(self, FMUState))
FACE_FUNCTION(fmi3FreeFMUState, ALWAYS, (fmi3Instance instance, fmi3FMUState *FMUState), face_release(FMUState))
FACE_FUNCTION(fmi3SerializedFMUStateSize, ALWAYS, (fmi3Instance instance, fmi3FMUState FMUState, size_t *size),
              face_saved_size(self, FMUState, size))
FACE_FUNCTION(fmi3SerializeFMUState, ALWAYS,
              (fmi3Instance instance, fmi3FMUState FMUState, fmi3Byte serializedState[], size_t size),
              face_serialise(self, FMUState, serializedState, size))
FACE_FUNCTION(fmi3DeserializeFMUState, ALWAYS,
              (fmi3Instance instance, const fmi3Byte serializedState[], size_t size, fmi3FMUState *FMUState),
              face_deserialise(self, serializedState, size, FMUState))

/* ---- derivatives and steps ---- */

FACE_FUNCTION(fmi3GetDirectionalDerivative, KNOWN,
              (fmi3Instance instance, const fmi3ValueReference unknowns[], size_t nUnknowns, const fmi3ValueReference knowns[],
               size_t nKnowns, const fmi3Float64 seed[], size_t nSeed, fmi3Float64 sensitivity[], size_t nSensitivity),
              face_get_directional(self, unknowns, nUnknowns, knowns, nKnowns, seed, nSeed, sensitivity, nSensitivity,
                                   "fmi3GetDirectionalDerivative"))
FACE_FUNCTION(fmi3GetOutputDerivatives, STEPPING | STOPPED | TERMINATED,
              (fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
               const fmi3Int32 orders[], fmi3Float64 values[], size_t nValues),
              face_get_rates(self, valueReferences, nValueReferences, orders, values, nValues, "fmi3GetOutputDerivatives"))

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
    *lastSuccessfulTime = OBJECT.time(self->object);
    if (self->now == STOPPED)
        return (fmi3Status)face_error(self, "The run has ended, as terminateSimulation said; reset it to start again.");
    kernel_status status = face_report(self, OBJECT.step(self->object, currentCommunicationPoint, communicationStepSize));
    const bool ended = OBJECT.ended(self->object);
    if (ended) self->now = STOPPED, status = KERNEL_OK; /* the end of the run is a normal result */
    if (status > KERNEL_WARNING) return (fmi3Status)status;
    *terminateSimulation = ended;
    *lastSuccessfulTime = OBJECT.time(self->object);
    *earlyReturn = *lastSuccessfulTime < end;
    *eventHandlingNeeded = self->events && *earlyReturn && !ended;
    return (fmi3Status)status;
}

/* ---- events and model exchange ---- */

enum { INTEGRATING = AT_EVENT | CONTINUOUS };

fmi3Status fmi3EnterEventMode(fmi3Instance instance) {
    REQUIRE(instance, CONTINUOUS | STEPPING, "fmi3EnterEventMode");
    if (!self->exchange && !OBJECT.stop_at_events) return (fmi3Status)face_absent(self, "fmi3EnterEventMode");
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
    /* Co-simulation steps have found modes already; they find modes again after inputs have jumped. */
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

FACE_FUNCTION(fmi3SetTime, INTEGRATING, (fmi3Instance instance, fmi3Float64 time), face_set_time(self, time))
FACE_FUNCTION(fmi3SetContinuousStates, CONTINUOUS,
              (fmi3Instance instance, const fmi3Float64 continuousStates[], size_t nContinuousStates),
              face_set_states(self, continuousStates, nContinuousStates))

FACE_FUNCTION(fmi3GetContinuousStateDerivatives, KNOWN, (fmi3Instance instance, fmi3Float64 values[], size_t nValues),
              face_read(self, values, nValues, READ_SLOPES))
FACE_FUNCTION(fmi3GetContinuousStates, KNOWN, (fmi3Instance instance, fmi3Float64 values[], size_t nValues),
              face_read(self, values, nValues, READ_STATES))
FACE_FUNCTION(fmi3GetEventIndicators, KNOWN, (fmi3Instance instance, fmi3Float64 values[], size_t nValues),
              face_read(self, values, nValues, READ_INDICATORS))
FACE_FUNCTION(fmi3GetNominalsOfContinuousStates, ALWAYS,
              (fmi3Instance instance, fmi3Float64 nominals[], size_t nContinuousStates),
              face_nominals(self, nominals, nContinuousStates))
FACE_FUNCTION(fmi3GetNumberOfContinuousStates, ALWAYS, (fmi3Instance instance, size_t *number),
              face_count(self, READ_STATES, number))
FACE_FUNCTION(fmi3GetNumberOfEventIndicators, ALWAYS, (fmi3Instance instance, size_t *number),
              face_count(self, READ_INDICATORS, number))

/* ---- functions that no FMU here has ---- */

#define DEFINE_ABSENT(function, ...)                                                                                           \
    fmi3Status function(fmi3Instance instance, __VA_ARGS__) {                                                                  \
        REQUIRE(instance, ALWAYS, #function);                                                                                  \
        return (fmi3Status)face_absent(self, #function);                                                                       \
    }
/* Reading or setting zero variables is allowed. */
#define DEFINE_EMPTY(function, ...)                                                                                            \
    fmi3Status function(fmi3Instance instance, const fmi3ValueReference a[], size_t references, __VA_ARGS__) {                 \
        REQUIRE(instance, ALWAYS, #function);                                                                                  \
        return references ? (fmi3Status)face_absent(self, #function) : fmi3OK;                                                 \
    }

FACE_FUNCTION(fmi3EnterConfigurationMode, ALWAYS, (fmi3Instance instance), face_absent(self, "fmi3EnterConfigurationMode"))
FACE_FUNCTION(fmi3ExitConfigurationMode, ALWAYS, (fmi3Instance instance), face_absent(self, "fmi3ExitConfigurationMode"))
FACE_FUNCTION(fmi3EvaluateDiscreteStates, ALWAYS, (fmi3Instance instance), face_absent(self, "fmi3EvaluateDiscreteStates"))
DEFINE_EMPTY(fmi3GetBinary, size_t b[], fmi3Binary c[], size_t d)
DEFINE_EMPTY(fmi3SetBinary, const size_t b[], const fmi3Binary c[], size_t d)
DEFINE_EMPTY(fmi3GetClock, fmi3Clock b[])
DEFINE_EMPTY(fmi3SetClock, const fmi3Clock b[])
DEFINE_ABSENT(fmi3GetIntervalDecimal, const fmi3ValueReference a[], size_t b, fmi3Float64 c[], fmi3IntervalQualifier d[])
DEFINE_ABSENT(fmi3GetIntervalFraction, const fmi3ValueReference a[], size_t b, fmi3UInt64 c[], fmi3UInt64 d[],
              fmi3IntervalQualifier e[])
DEFINE_ABSENT(fmi3GetShiftDecimal, const fmi3ValueReference a[], size_t b, fmi3Float64 c[])
DEFINE_ABSENT(fmi3GetShiftFraction, const fmi3ValueReference a[], size_t b, fmi3UInt64 c[], fmi3UInt64 d[])
DEFINE_ABSENT(fmi3SetIntervalDecimal, const fmi3ValueReference a[], size_t b, const fmi3Float64 c[])
DEFINE_ABSENT(fmi3SetIntervalFraction, const fmi3ValueReference a[], size_t b, const fmi3UInt64 c[], const fmi3UInt64 d[])
DEFINE_ABSENT(fmi3SetShiftDecimal, const fmi3ValueReference a[], size_t b, const fmi3Float64 c[])
DEFINE_ABSENT(fmi3SetShiftFraction, const fmi3ValueReference a[], size_t b, const fmi3UInt64 c[], const fmi3UInt64 d[])
DEFINE_ABSENT(fmi3ActivateModelPartition, fmi3ValueReference a, fmi3Float64 b)
DEFINE_ABSENT(fmi3GetNumberOfVariableDependencies, fmi3ValueReference a, size_t *b)
DEFINE_ABSENT(fmi3GetVariableDependencies, fmi3ValueReference a, size_t b[], fmi3ValueReference c[], size_t d[],
              fmi3DependencyKind e[], size_t f)
DEFINE_ABSENT(fmi3GetAdjointDerivative, const fmi3ValueReference a[], size_t b, const fmi3ValueReference c[], size_t d,
              const fmi3Float64 e[], size_t f, fmi3Float64 g[], size_t h)
