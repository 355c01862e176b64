/* The FMI 2.0 interface: co-simulation and model exchange. */
#include <string.h>

#include "face.h"
#include "fmi2Functions.h"

#define STATUS fmi2Status

/* The message is passed as the format itself, so that hosts that do not expand arguments show it too; hence % is doubled. */
static void tell_host(const component *self, kernel_status status, const char *category, const char *sentence) {
    char text[2 * MESSAGE_SIZE]; /* sufficient if all are % */
    size_t length = 0;
    for (const char *c = sentence; *c; ++c) {
        if (*c == '%') text[length++] = '%';
        text[length++] = *c;
    }
    text[length] = '\0';
    ((fmi2CallbackLogger)self->logger)(self->environment, self->name, (fmi2Status)status, category, text);
}

/* Section 2.1.3: warnings and errors are always logged. */
static const face_standard FMI2 = {"FMI 2.0, section 4.2.4", WARNINGS | ERRORS, true, resources_of_uri, tell_host};

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean loggingOn, size_t nCategories, const fmi2String categories[]) {
    REQUIRE(c, ALWAYS, "fmi2SetDebugLogging");
    return (fmi2Status)face_log(self, loggingOn, nCategories, categories);
}

fmi2Component fmi2Instantiate(fmi2String instanceName, fmi2Type fmuType, fmi2String fmuGUID, fmi2String fmuResourceLocation,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean loggingOn) {
    (void)visible;
    if (!functions) return NULL;
    component log;
    memset(&log, 0, sizeof log);
    log.standard = &FMI2;
    log.logger = (void (*)(void))functions->logger;
    log.environment = functions->componentEnvironment;
    log.exchange = fmuType == fmi2ModelExchange;
    return face_instantiate(&log, instanceName, fmuGUID, fmuResourceLocation, loggingOn);
}

void fmi2FreeInstance(fmi2Component c) { face_free((component *)c); }

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean toleranceDefined, fmi2Real tolerance, fmi2Real startTime,
                               fmi2Boolean stopTimeDefined, fmi2Real stopTime) {
    REQUIRE(c, INSTANTIATED, "fmi2SetupExperiment");
    return (fmi2Status)face_plan(self, toleranceDefined ? &tolerance : NULL, startTime, stopTimeDefined ? &stopTime : NULL);
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
    REQUIRE(c, INSTANTIATED, "fmi2EnterInitializationMode");
    return (fmi2Status)face_enter(self, INITIALISING);
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    REQUIRE(c, INITIALISING, "fmi2ExitInitializationMode");
    return (fmi2Status)face_initialise(self);
}

fmi2Status fmi2Terminate(fmi2Component c) {
    REQUIRE(c, RUNNING | STOPPED, "fmi2Terminate");
    return (fmi2Status)face_enter(self, TERMINATED);
}

fmi2Status fmi2Reset(fmi2Component c) {
    REQUIRE(c, ALWAYS, "fmi2Reset");
    return (fmi2Status)face_reset(self);
}

/* ---- variables ---- */

static void put_int(void *values, size_t place, double number) { ((int *)values)[place] = (int)number; }
static double take_int(const void *values, size_t place) { return ((const int *)values)[place]; }

#define DEFINE_VARIABLES(name, type, kind, put, take)                                                                          \
    fmi2Status fmi2Get##name(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, type value[]) {                       \
        REQUIRE(c, ALWAYS, "fmi2Get" #name);                                                                                   \
        return (fmi2Status)face_get(self, kind, vr, nvr, value, nvr, put);                                                     \
    }                                                                                                                          \
    fmi2Status fmi2Set##name(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const type value[]) {                 \
        REQUIRE(c, SETTABLE, "fmi2Set" #name);                                                                                 \
        return (fmi2Status)face_set(self, kind, vr, nvr, value, nvr, take);                                                    \
    }

DEFINE_VARIABLES(Real, fmi2Real, KIND_REAL, NULL, NULL)
DEFINE_VARIABLES(Integer, fmi2Integer, KIND_INTEGER, put_int, take_int)
DEFINE_VARIABLES(Boolean, fmi2Boolean, KIND_BOOLEAN, put_int, take_int)

fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2String value[]) {
    REQUIRE(c, ALWAYS, "fmi2GetString");
    return (fmi2Status)face_get_texts(self, vr, nvr, value, nvr);
}

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2String value[]) {
    REQUIRE(c, SETTABLE, "fmi2SetString");
    return (fmi2Status)face_set_texts(self, vr, nvr, value, nvr);
}

/* ---- saved states ---- */

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *FMUstate) {
    REQUIRE(c, ALWAYS, "fmi2GetFMUstate");
    return (fmi2Status)face_save(self, FMUstate);
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate FMUstate) {
    REQUIRE(c, ALWAYS, "fmi2SetFMUstate");
    return (fmi2Status)face_restore(self, FMUstate);
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *FMUstate) {
    REQUIRE(c, ALWAYS, "fmi2FreeFMUstate");
    return (fmi2Status)face_release(FMUstate);
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate FMUstate, size_t *size) {
    REQUIRE(c, ALWAYS, "fmi2SerializedFMUstateSize");
    return (fmi2Status)face_saved_size(self, FMUstate, size);
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate FMUstate, fmi2Byte bytes[], size_t size) {
    REQUIRE(c, ALWAYS, "fmi2SerializeFMUstate");
    return (fmi2Status)face_serialise(self, FMUstate, bytes, size);
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *FMUstate) {
    REQUIRE(c, ALWAYS, "fmi2DeSerializeFMUstate");
    return (fmi2Status)face_deserialise(self, bytes, size, FMUstate);
}

/* ---- stepping ---- */

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Integer order[],
                                       const fmi2Real value[]) {
    REQUIRE(c, INSTANTIATED | INITIALISING | STEPPING, "fmi2SetRealInputDerivatives");
    return (fmi2Status)face_set_rates(self, vr, nvr, order, value);
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Integer order[],
                                        fmi2Real value[]) {
    REQUIRE(c, STEPPING | STOPPED | TERMINATED, "fmi2GetRealOutputDerivatives");
    return (fmi2Status)face_get_rates(self, vr, nvr, order, value, nvr, "fmi2GetRealOutputDerivatives");
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference vUnknown_ref[], size_t nUnknown,
                                        const fmi2ValueReference vKnown_ref[], size_t nKnown, const fmi2Real dvKnown[],
                                        fmi2Real dvUnknown[]) {
    REQUIRE(c, KNOWN, "fmi2GetDirectionalDerivative");
    return (fmi2Status)face_get_directional(self, vUnknown_ref, nUnknown, vKnown_ref, nKnown, dvKnown, nKnown, dvUnknown,
                                            nUnknown, "fmi2GetDirectionalDerivative");
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real currentCommunicationPoint, fmi2Real communicationStepSize,
                      fmi2Boolean noSetFMUStatePriorToCurrentPoint) {
    REQUIRE(c, STEPPING, "fmi2DoStep");
    (void)noSetFMUStatePriorToCurrentPoint;
    self->last_step = OBJECT.step(self->object, currentCommunicationPoint, communicationStepSize);
    if (self->last_step != KERNEL_DISCARD) return (fmi2Status)face_report(self, self->last_step);
    if (OBJECT.ended(self->object)) {
        self->now = STOPPED;
        return (fmi2Status)face_report(self, self->last_step);
    }
    /* The object is unchanged: after fmi2Discard hosts would continue from a time that they have to query. */
    return (fmi2Status)(self->last_step = face_refuse(self));
}

/* Only a pending step could be cancelled or queried in advance; steps here are never pending. */
enum { INITIALISED = STEPPING | STOPPED | TERMINATED };

fmi2Status fmi2CancelStep(fmi2Component c) {
    REQUIRE(c, ALWAYS, "fmi2CancelStep");
    return (fmi2Status)face_error(self, "A step is never pending, so there is nothing to cancel.");
}

#define DEFINE_STATUS(function, type, kind, answer)                                                                            \
    fmi2Status function(fmi2Component c, const fmi2StatusKind s, type *value) {                                                \
        REQUIRE(c, INITIALISED, #function);                                                                                    \
        if (face_is_exchange(self)) return fmi2Error;                                                                          \
        if (s != (kind)) return fmi2Discard;                                                                                   \
        if (face_missing(self, 1, value, value)) return fmi2Error;                                                             \
        *value = answer;                                                                                                       \
        return fmi2OK;                                                                                                         \
    }

DEFINE_STATUS(fmi2GetStatus, fmi2Status, fmi2DoStepStatus, (fmi2Status)self->last_step)
DEFINE_STATUS(fmi2GetRealStatus, fmi2Real, fmi2LastSuccessfulTime, OBJECT.time(self->object))
DEFINE_STATUS(fmi2GetBooleanStatus, fmi2Boolean, fmi2Terminated, OBJECT.ended(self->object))

fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind s, fmi2Integer *value) {
    REQUIRE(c, INITIALISED, "fmi2GetIntegerStatus");
    if (face_is_exchange(self)) return fmi2Error;
    (void)s, (void)value;
    return fmi2Discard;
}

fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind s, fmi2String *value) {
    REQUIRE(c, INITIALISED, "fmi2GetStringStatus");
    if (face_is_exchange(self)) return fmi2Error;
    (void)s, (void)value;
    return fmi2Discard;
}

/* ---- model exchange ---- */

enum { INTEGRATING = AT_EVENT | CONTINUOUS };

fmi2Status fmi2EnterEventMode(fmi2Component c) {
    REQUIRE(c, INTEGRATING, "fmi2EnterEventMode"); /* to stay there is allowed by the table of section 3.2.3 */
    return (fmi2Status)face_enter(self, AT_EVENT);
}

fmi2Status fmi2EnterContinuousTimeMode(fmi2Component c) {
    REQUIRE(c, AT_EVENT, "fmi2EnterContinuousTimeMode");
    return (fmi2Status)face_enter(self, CONTINUOUS);
}

fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *fmi2eventInfo) {
    REQUIRE(c, AT_EVENT, "fmi2NewDiscreteStates");
    if (face_missing(self, 1, fmi2eventInfo, fmi2eventInfo)) return fmi2Error;
    memset(fmi2eventInfo, 0, sizeof *fmi2eventInfo);
    bool ended = false, jumped = false;
    const kernel_status status = face_find_modes(self, &ended, &jumped);
    fmi2eventInfo->terminateSimulation = ended;
    fmi2eventInfo->valuesOfContinuousStatesChanged = jumped;
    return (fmi2Status)status;
}

fmi2Status fmi2CompletedIntegratorStep(fmi2Component c, fmi2Boolean noSetFMUStatePriorToCurrentPoint,
                                       fmi2Boolean *enterEventMode, fmi2Boolean *terminateSimulation) {
    REQUIRE(c, CONTINUOUS, "fmi2CompletedIntegratorStep");
    (void)noSetFMUStatePriorToCurrentPoint;
    if (face_missing(self, 1, enterEventMode, terminateSimulation)) return fmi2Error;
    *terminateSimulation = fmi2False;
    bool crossed = false;
    const kernel_status status = face_complete_step(self, &crossed);
    *enterEventMode = crossed;
    return (fmi2Status)status;
}

fmi2Status fmi2SetTime(fmi2Component c, fmi2Real time) {
    REQUIRE(c, INTEGRATING, "fmi2SetTime");
    return (fmi2Status)face_set_time(self, time);
}

fmi2Status fmi2SetContinuousStates(fmi2Component c, const fmi2Real x[], size_t nx) {
    REQUIRE(c, CONTINUOUS, "fmi2SetContinuousStates");
    return (fmi2Status)face_set_states(self, x, nx);
}

#define DEFINE_READ(function, what)                                                                                            \
    fmi2Status function(fmi2Component c, fmi2Real values[], size_t count) {                                                    \
        REQUIRE(c, KNOWN, #function);                                                                                          \
        return (fmi2Status)face_read(self, values, count, what);                                                               \
    }

DEFINE_READ(fmi2GetDerivatives, READ_SLOPES)
DEFINE_READ(fmi2GetContinuousStates, READ_STATES)
DEFINE_READ(fmi2GetEventIndicators, READ_INDICATORS)

fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component c, fmi2Real x_nominal[], size_t nx) {
    REQUIRE(c, ALWAYS, "fmi2GetNominalsOfContinuousStates");
    return (fmi2Status)face_nominals(self, x_nominal, nx);
}
