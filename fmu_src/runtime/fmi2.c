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

FACE_FUNCTION(fmi2SetDebugLogging, ALWAYS,
              (fmi2Component instance, fmi2Boolean loggingOn, size_t nCategories, const fmi2String categories[]),
              face_log(self, loggingOn, nCategories, categories))

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

FACE_FUNCTION(fmi2EnterInitializationMode, INSTANTIATED, (fmi2Component instance), face_enter(self, INITIALISING))
FACE_FUNCTION(fmi2ExitInitializationMode, INITIALISING, (fmi2Component instance), face_initialise(self))
FACE_FUNCTION(fmi2Terminate, RUNNING | STOPPED, (fmi2Component instance), face_enter(self, TERMINATED))
FACE_FUNCTION(fmi2Reset, ALWAYS, (fmi2Component instance), face_reset(self))

/* ---- variables ---- */

static void put_int(void *values, size_t place, double number) { ((int *)values)[place] = (int)number; }
static double take_int(const void *values, size_t place) { return ((const int *)values)[place]; }

#define DEFINE_VARIABLES(name, type, kind, put, take)                                                                          \
    FACE_FUNCTION(fmi2Get##name, ALWAYS, (fmi2Component instance, const fmi2ValueReference vr[], size_t nvr, type value[]),    \
                  face_get(self, kind, vr, nvr, value, nvr, put))                                                              \
    FACE_FUNCTION(fmi2Set##name, SETTABLE,                                                                                     \
                  (fmi2Component instance, const fmi2ValueReference vr[], size_t nvr, const type value[]),                     \
                  face_set(self, kind, vr, nvr, value, nvr, take))

DEFINE_VARIABLES(Real, fmi2Real, KIND_REAL, NULL, NULL)
DEFINE_VARIABLES(Integer, fmi2Integer, KIND_INTEGER, put_int, take_int)
DEFINE_VARIABLES(Boolean, fmi2Boolean, KIND_BOOLEAN, put_int, take_int)

FACE_FUNCTION(fmi2GetString, ALWAYS, (fmi2Component instance, const fmi2ValueReference vr[], size_t nvr, fmi2String value[]),
              face_get_texts(self, vr, nvr, value, nvr))
FACE_FUNCTION(fmi2SetString, SETTABLE,
              (fmi2Component instance, const fmi2ValueReference vr[], size_t nvr, const fmi2String value[]),
              face_set_texts(self, vr, nvr, value, nvr))

/* ---- saved states ---- */

FACE_FUNCTION(fmi2GetFMUstate, ALWAYS, (fmi2Component instance, fmi2FMUstate *FMUstate), face_save(self, FMUstate))
FACE_FUNCTION(fmi2SetFMUstate, ALWAYS, (fmi2Component instance, fmi2FMUstate FMUstate), face_restore(self, FMUstate))
FACE_FUNCTION(fmi2FreeFMUstate, ALWAYS, (fmi2Component instance, fmi2FMUstate *FMUstate), face_release(FMUstate))
FACE_FUNCTION(fmi2SerializedFMUstateSize, ALWAYS, (fmi2Component instance, fmi2FMUstate FMUstate, size_t *size),
              face_saved_size(self, FMUstate, size))
FACE_FUNCTION(fmi2SerializeFMUstate, ALWAYS, (fmi2Component instance, fmi2FMUstate FMUstate, fmi2Byte bytes[], size_t size),
              face_serialise(self, FMUstate, bytes, size))
FACE_FUNCTION(fmi2DeSerializeFMUstate, ALWAYS,
              (fmi2Component instance, const fmi2Byte bytes[], size_t size, fmi2FMUstate *FMUstate),
              face_deserialise(self, bytes, size, FMUstate))

/* ---- stepping ---- */

FACE_FUNCTION(fmi2SetRealInputDerivatives, INSTANTIATED | INITIALISING | STEPPING,
              (fmi2Component instance, const fmi2ValueReference vr[], size_t nvr, const fmi2Integer order[],
               const fmi2Real value[]),
              face_set_rates(self, vr, nvr, order, value))
FACE_FUNCTION(fmi2GetRealOutputDerivatives, STEPPING | STOPPED | TERMINATED,
              (fmi2Component instance, const fmi2ValueReference vr[], size_t nvr, const fmi2Integer order[], fmi2Real value[]),
              face_get_rates(self, vr, nvr, order, value, nvr, "fmi2GetRealOutputDerivatives"))
FACE_FUNCTION(fmi2GetDirectionalDerivative, KNOWN,
              (fmi2Component instance, const fmi2ValueReference vUnknown_ref[], size_t nUnknown,
               const fmi2ValueReference vKnown_ref[], size_t nKnown, const fmi2Real dvKnown[], fmi2Real dvUnknown[]),
              face_get_directional(self, vUnknown_ref, nUnknown, vKnown_ref, nKnown, dvKnown, nKnown, dvUnknown, nUnknown,
                                   "fmi2GetDirectionalDerivative"))

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

FACE_FUNCTION(fmi2CancelStep, ALWAYS, (fmi2Component instance),
              face_error(self, "A step is never pending, so there is nothing to cancel."))

#define DEFINE_STATUS(function, type, known, answer)                                                                           \
    fmi2Status function(fmi2Component c, const fmi2StatusKind s, type *value) {                                                \
        REQUIRE(c, INITIALISED, #function);                                                                                    \
        if (face_is_exchange(self)) return fmi2Error;                                                                          \
        if ((void)s, !(known)) return fmi2Discard;                                                                             \
        if (face_missing(self, 1, value, value)) return fmi2Error;                                                             \
        *value = answer;                                                                                                       \
        return fmi2OK;                                                                                                         \
    }

DEFINE_STATUS(fmi2GetStatus, fmi2Status, s == fmi2DoStepStatus, (fmi2Status)self->last_step)
DEFINE_STATUS(fmi2GetRealStatus, fmi2Real, s == fmi2LastSuccessfulTime, OBJECT.time(self->object))
DEFINE_STATUS(fmi2GetBooleanStatus, fmi2Boolean, s == fmi2Terminated, OBJECT.ended(self->object))
DEFINE_STATUS(fmi2GetIntegerStatus, fmi2Integer, false, 0)
DEFINE_STATUS(fmi2GetStringStatus, fmi2String, false, NULL)

/* ---- model exchange ---- */

enum { INTEGRATING = AT_EVENT | CONTINUOUS };

/* to stay there is allowed by the table of section 3.2.3 */
FACE_FUNCTION(fmi2EnterEventMode, INTEGRATING, (fmi2Component instance), face_enter(self, AT_EVENT))
FACE_FUNCTION(fmi2EnterContinuousTimeMode, AT_EVENT, (fmi2Component instance), face_enter(self, CONTINUOUS))

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

FACE_FUNCTION(fmi2SetTime, INTEGRATING, (fmi2Component instance, fmi2Real time), face_set_time(self, time))
FACE_FUNCTION(fmi2SetContinuousStates, CONTINUOUS, (fmi2Component instance, const fmi2Real x[], size_t nx),
              face_set_states(self, x, nx))

FACE_FUNCTION(fmi2GetDerivatives, KNOWN, (fmi2Component instance, fmi2Real values[], size_t count),
              face_read(self, values, count, READ_SLOPES))
FACE_FUNCTION(fmi2GetContinuousStates, KNOWN, (fmi2Component instance, fmi2Real values[], size_t count),
              face_read(self, values, count, READ_STATES))
FACE_FUNCTION(fmi2GetEventIndicators, KNOWN, (fmi2Component instance, fmi2Real values[], size_t count),
              face_read(self, values, count, READ_INDICATORS))
FACE_FUNCTION(fmi2GetNominalsOfContinuousStates, ALWAYS, (fmi2Component instance, fmi2Real x_nominal[], size_t nx),
              face_nominals(self, x_nominal, nx))
