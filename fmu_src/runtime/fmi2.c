/* The FMI 2.0 face of a kernel: co-simulation and model exchange. */
#include <stdlib.h>
#include <string.h>

#include "face.h"
#include "fmi2Functions.h"

#define STATUS fmi2Status

/* The sentence is the format itself, so that hosts that do not expand arguments show it too; hence % is doubled. */
static void tell_host(const component *self, kernel_status status, const char *category, const char *sentence) {
    char text[2 * MESSAGE_SIZE]; /* even of nothing but % */
    size_t length = 0;
    for (const char *c = sentence; *c; ++c) {
        if (*c == '%') text[length++] = '%';
        text[length++] = *c;
    }
    text[length] = '\0';
    ((fmi2CallbackLogger)self->logger)(self->environment, self->name, (fmi2Status)status, category, text);
}

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean loggingOn, size_t nCategories,
                               const fmi2String categories[]) {
    REQUIRE(c, ALWAYS, "fmi2SetDebugLogging");
    return (fmi2Status)face_log(self, loggingOn, nCategories, categories);
}

fmi2Component fmi2Instantiate(fmi2String instanceName, fmi2Type fmuType, fmi2String fmuGUID,
                              fmi2String fmuResourceLocation, const fmi2CallbackFunctions *functions,
                              fmi2Boolean visible, fmi2Boolean loggingOn) {
    (void)visible;
    if (!functions) return NULL;
    component log;
    memset(&log, 0, sizeof log);
    log.name = (char *)instanceName;
    log.standard = "FMI 2.0, section 4.2.4";
    log.told = WARNINGS | ERRORS; /* section 2.1.3: of these the host is always told */
    log.tell = tell_host;
    log.logger = (void (*)(void))functions->logger;
    log.environment = functions->componentEnvironment;
    log.exchange = fmuType == fmi2ModelExchange;
    return face_take_resources(face_instantiate(&log, instanceName, fmuGUID, loggingOn), fmuResourceLocation,
                               resources_of_uri);
}

void fmi2FreeInstance(fmi2Component c) { face_free((component *)c); }

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean toleranceDefined, fmi2Real tolerance, fmi2Real startTime,
                               fmi2Boolean stopTimeDefined, fmi2Real stopTime) {
    REQUIRE(c, INSTANTIATED, "fmi2SetupExperiment");
    return (fmi2Status)face_plan(self, toleranceDefined ? &tolerance : NULL, startTime,
                                 stopTimeDefined ? &stopTime : NULL);
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
    REQUIRE(c, INSTANTIATED, "fmi2EnterInitializationMode");
    self->now = INITIALISING;
    return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    REQUIRE(c, INITIALISING, "fmi2ExitInitializationMode");
    return (fmi2Status)face_initialise(self);
}

fmi2Status fmi2Terminate(fmi2Component c) {
    REQUIRE(c, RUNNING | STOPPED, "fmi2Terminate");
    return (fmi2Status)face_terminate(self);
}

fmi2Status fmi2Reset(fmi2Component c) {
    REQUIRE(c, ALWAYS, "fmi2Reset");
    return (fmi2Status)face_reset(self);
}

#define DEFINE_GET(function, type, kind)                                                                     \
    fmi2Status function(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, type value[]) {          \
        REQUIRE(c, ALWAYS, #function);                                                                       \
        if (face_missing(self, nvr, vr, value)) return fmi2Error;                                            \
        kernel_status worst = KERNEL_OK;                                                                               \
        for (size_t i = 0; i < nvr; ++i) {                                                                   \
            double number = 0.0;                                                                             \
            const kernel_status status = face_get(self, vr[i], kind, &number);                                         \
            value[i] = (type)number;                                                                         \
            if (status > worst) worst = status;                                                              \
        }                                                                                                    \
        return (fmi2Status)worst;                                                                            \
    }

#define DEFINE_SET(function, type, kind)                                                                     \
    fmi2Status function(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const type value[]) {    \
        REQUIRE(c, SETTABLE, #function);                                       \
        if (face_missing(self, nvr, vr, value)) return fmi2Error;                                            \
        if (face_fixed(self, nvr, vr, kind)) return fmi2Error;                                               \
        for (size_t i = 0; i < nvr; ++i)                                                                     \
            if (face_refuses(self, vr[i], (double)value[i])) return fmi2Error;                               \
        kernel_status worst = KERNEL_OK;                                                                               \
        for (size_t i = 0; i < nvr; ++i) {                                                                   \
            const kernel_status status = face_set(self, vr[i], (double)value[i]);                                      \
            if (status > worst) worst = status;                                                              \
        }                                                                                                    \
        return (fmi2Status)worst;                                                                            \
    }

DEFINE_GET(fmi2GetReal, fmi2Real, KIND_REAL)
DEFINE_GET(fmi2GetInteger, fmi2Integer, KIND_INTEGER)
DEFINE_GET(fmi2GetBoolean, fmi2Boolean, KIND_BOOLEAN)
DEFINE_SET(fmi2SetReal, fmi2Real, KIND_REAL)
DEFINE_SET(fmi2SetInteger, fmi2Integer, KIND_INTEGER)
DEFINE_SET(fmi2SetBoolean, fmi2Boolean, KIND_BOOLEAN)

fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2String value[]) {
    REQUIRE(c, ALWAYS, "fmi2GetString");
    if (face_missing(self, nvr, vr, value)) return fmi2Error;
    return (fmi2Status)face_get_texts(self, nvr, vr, value);
}

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2String value[]) {
    REQUIRE(c, SETTABLE, "fmi2SetString");
    if (face_missing(self, nvr, vr, value)) return fmi2Error;
    return (fmi2Status)face_set_texts(self, nvr, vr, value);
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
    if (FMUstate) {
        free(*FMUstate);
        *FMUstate = NULL;
    }
    return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate FMUstate, size_t *size) {
    REQUIRE(c, ALWAYS, "fmi2SerializedFMUstateSize");
    if (face_missing(self, 1, FMUstate, size)) return fmi2Error;
    *size = face_saved_size(self);
    return fmi2OK;
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

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                                       const fmi2Integer order[], const fmi2Real value[]) {
    REQUIRE(c, INSTANTIATED | INITIALISING | STEPPING, "fmi2SetRealInputDerivatives");
    if (face_missing(self, nvr, vr, value) || face_missing(self, nvr, order, order)) return fmi2Error;
    for (size_t i = 0; i < nvr; ++i)
        if (order[i] != 1) return (fmi2Status)face_error(self, "Only first derivatives of inputs are used.");
    return (fmi2Status)face_set_rates(self, nvr, vr, value);
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                                        const fmi2Integer order[], fmi2Real value[]) {
    REQUIRE(c, STEPPING | STOPPED | TERMINATED, "fmi2GetRealOutputDerivatives");
    if (face_is_exchange(self)) return fmi2Error;
    if (face_missing(self, nvr, vr, value) || face_missing(self, nvr, order, order)) return fmi2Error;
    for (size_t i = 0; i < nvr; ++i)
        if (order[i] != 1) return (fmi2Status)face_error(self, "Only first derivatives of outputs are provided.");
    return (fmi2Status)face_report(self, kernel_get_rates(self->machine, (int)nvr, (const int *)vr, value));
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference vUnknown_ref[], size_t nUnknown,
                                        const fmi2ValueReference vKnown_ref[], size_t nKnown, const fmi2Real dvKnown[],
                                        fmi2Real dvUnknown[]) {
    REQUIRE(c, KNOWN, "fmi2GetDirectionalDerivative");
    if (face_missing(self, nUnknown, vUnknown_ref, dvUnknown) || face_missing(self, nKnown, vKnown_ref, dvKnown))
        return fmi2Error;
    const kernel_status status = face_initialise_if_asked(self);
    if (status > KERNEL_WARNING) return (fmi2Status)status;
    return (fmi2Status)face_report(
        self, kernel_get_directional(self->machine, (int)nUnknown, (const int *)vUnknown_ref, (int)nKnown,
                                     (const int *)vKnown_ref, dvKnown, dvUnknown));
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real currentCommunicationPoint, fmi2Real communicationStepSize,
                      fmi2Boolean noSetFMUStatePriorToCurrentPoint) {
    REQUIRE(c, STEPPING, "fmi2DoStep");
    (void)noSetFMUStatePriorToCurrentPoint;
    self->last_step = kernel_step(self->machine, currentCommunicationPoint, communicationStepSize);
    if (self->last_step == KERNEL_DISCARD) self->now = STOPPED;
    return (fmi2Status)face_report(self, self->last_step);
}

/* Only a step that goes on in the background, which none does here, could be cancelled or asked about in advance. */
enum { INITIALISED = STEPPING | STOPPED | TERMINATED };

fmi2Status fmi2CancelStep(fmi2Component c) {
    REQUIRE(c, ALWAYS, "fmi2CancelStep");
    return (fmi2Status)face_error(self, "A step is never pending, so there is nothing to cancel.");
}

#define DEFINE_STATUS(function, type, kind, answer)                                     \
    fmi2Status function(fmi2Component c, const fmi2StatusKind s, type *value) {         \
        REQUIRE(c, INITIALISED, #function);                                             \
        if (face_is_exchange(self)) return fmi2Error;                                   \
        if (s != (kind)) return fmi2Discard;                                            \
        if (face_missing(self, 1, value, value)) return fmi2Error;                      \
        *value = answer;                                                                \
        return fmi2OK;                                                                  \
    }

DEFINE_STATUS(fmi2GetStatus, fmi2Status, fmi2DoStepStatus, (fmi2Status)self->last_step)
DEFINE_STATUS(fmi2GetRealStatus, fmi2Real, fmi2LastSuccessfulTime, kernel_time(self->machine))
DEFINE_STATUS(fmi2GetBooleanStatus, fmi2Boolean, fmi2Terminated, kernel_ended(self->machine))

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

#define DEFINE_READ(function, expected, read)                                   \
    fmi2Status function(fmi2Component c, fmi2Real values[], size_t count) {     \
        REQUIRE(c, KNOWN, #function);                                           \
        return (fmi2Status)face_read(self, values, count, expected(), read);    \
    }

DEFINE_READ(fmi2GetDerivatives, kernel_exchange_states, kernel_get_slopes)
DEFINE_READ(fmi2GetContinuousStates, kernel_exchange_states, kernel_get_states)
DEFINE_READ(fmi2GetEventIndicators, kernel_exchange_indicators, kernel_get_indicators)

fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component c, fmi2Real x_nominal[], size_t nx) {
    REQUIRE(c, ALWAYS, "fmi2GetNominalsOfContinuousStates");
    return (fmi2Status)face_nominals(self, x_nominal, nx);
}
