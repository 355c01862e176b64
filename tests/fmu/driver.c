/* A host in C: uses an FMU correctly and incorrectly. Linked with the FMU's sources and run under sanitizers.
 * Prints one line; exit status 1 when an answer is not what FMI 2.0 asks for. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2Functions.h"
#include "kernel.h"

static int sentences = 0;

static void log_message(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status,
                        fmi2String category, fmi2String message, ...) {
    (void)environment, (void)instance, (void)category, (void)status;
    if (strlen(message) > 10) ++sentences;
}

static int failures = 0;
static void expect(int truth, const char *what) {
    if (truth) return;
    printf("FAILED: %s\n", what);
    ++failures;
}

static unsigned reference(const char *name) {
    for (int i = 0; i < MODEL.variables; ++i)
        if (strcmp(MODEL.variable[i].name, name) == 0) return (unsigned)i;
    return 9999;
}

static fmi2Status set(fmi2Component c, const char *name, double value) {
    const unsigned vr = reference(name);
    return fmi2SetReal(c, &vr, 1, &value);
}

static double get(fmi2Component c, const char *name) {
    const unsigned vr = reference(name);
    double value = NAN;
    expect(fmi2GetReal(c, &vr, 1, &value) == fmi2OK, name);
    return value;
}

static fmi2Component start(const fmi2CallbackFunctions *callbacks) {
    fmi2Component c = fmi2Instantiate("bogie", fmi2CoSimulation, MODEL.guid, "", callbacks, fmi2False, fmi2True);
    if (!c) exit(2);
    expect(fmi2SetupExperiment(c, fmi2False, 0.0, 0.0, fmi2False, 0.0) == fmi2OK, "setup");
    return c;
}

static void refuse_what_is_wrong(const fmi2CallbackFunctions *callbacks) {
    expect(!fmi2Instantiate("x", fmi2CoSimulation, "{0}", "", callbacks, fmi2False, fmi2False), "wrong GUID");
    expect(!fmi2Instantiate(NULL, fmi2CoSimulation, MODEL.guid, "", callbacks, fmi2False, fmi2False), "no name");
    fmi2Component c = start(callbacks);
    const unsigned beyond = 100000, level = reference("level");
    double real = 0.0;
    int integer = 4;
    expect(fmi2DoStep(c, 0.0, 0.1, fmi2True) == fmi2Error, "step before initialisation");
    expect(fmi2ExitInitializationMode(c) == fmi2Error, "exit before enter");
    expect(fmi2GetReal(c, &beyond, 1, &real) == fmi2Error, "reference out of range");
    expect(fmi2GetReal(c, &level, 1, &real) == fmi2Error, "Integer read as Real");
    expect(fmi2SetInteger(c, &level, 1, &integer) == fmi2Error, "level 4");
    expect(set(c, "wheelset_mass", 0.0) == fmi2Error, "no mass");
    expect(set(c, "wheelset_mass", -INFINITY) == fmi2Error, "infinite mass");
    expect(fmi2EnterInitializationMode(c) == fmi2OK && fmi2ExitInitializationMode(c) == fmi2OK, "initialisation");
    expect(set(c, "brake_torque_1", -1.0) == fmi2Error, "negative capacity");
    expect(set(c, "brake_torque_1", NAN) == fmi2Error, "NaN capacity");
    expect(set(c, "wheelset_mass", 1000.0) == fmi2Error, "parameter after initialisation");
    expect(set(c, "speed", 1.0) == fmi2Error, "output set");
    const double sizes[] = {0.0, -1.0, NAN, INFINITY};
    for (int i = 0; i < 4; ++i) expect(fmi2DoStep(c, 0.0, sizes[i], fmi2True) == fmi2Error, "bad step size");
    expect(fmi2DoStep(c, 5.0, 0.1, fmi2True) == fmi2Error, "step from another time");
    expect(get(c, "brake_torque_1") == 0.0 && get(c, "speed") == 25.0, "values kept after refusals");
    expect(fmi2DoStep(c, 0.0, 1e-9, fmi2True) == fmi2OK && fmi2DoStep(c, 1e-9, 1e4, fmi2True) == fmi2OK, "tiny, huge");
    expect(isfinite(get(c, "speed")), "finite speed");
    fmi2FreeInstance(c);
    fmi2FreeInstance(NULL);
}

static void brake_save_and_repeat(const fmi2CallbackFunctions *callbacks) {
    fmi2Component c = start(callbacks);
    expect(fmi2EnterInitializationMode(c) == fmi2OK, "enter");
    set(c, "brake_torque_1", 60e3);
    expect(get(c, "speed") == 25.0, "output during initialisation");
    expect(fmi2ExitInitializationMode(c) == fmi2OK, "exit");
    for (int i = 0; i < 300; ++i) expect(fmi2DoStep(c, i * 1e-3, 1e-3, fmi2False) == fmi2OK, "step");
    fmi2FMUstate saved = NULL;
    expect(fmi2GetFMUstate(c, &saved) == fmi2OK, "save");
    size_t size = 0;
    expect(fmi2SerializedFMUstateSize(c, saved, &size) == fmi2OK, "size");
    char *bytes = malloc(size);
    expect(fmi2SerializeFMUstate(c, saved, bytes, size) == fmi2OK, "serialise");
    expect(fmi2DeSerializeFMUstate(c, bytes, size - 1, &saved) == fmi2Error, "short buffer");
    double ends[2];
    for (int round = 0; round < 2; ++round) {
        expect(fmi2SetFMUstate(c, saved) == fmi2OK, "restore");
        for (int i = 300; i < 900; ++i) expect(fmi2DoStep(c, i * 1e-3, 1e-3, fmi2False) == fmi2OK, "step on");
        ends[round] = get(c, "speed");
        if (round == 0) expect(fmi2DeSerializeFMUstate(c, bytes, size, &saved) == fmi2OK, "deserialise");
    }
    expect(ends[0] == ends[1], "bit-identical after a rollback");
    expect(get(c, "angular_velocity_1") == 0.0, "locked");
    expect(fmi2FreeFMUstate(c, &saved) == fmi2OK && saved == NULL, "free state");
    expect(fmi2Terminate(c) == fmi2OK && fmi2DoStep(c, 0.9, 0.1, fmi2True) == fmi2Error, "step after terminate");
    expect(fmi2Reset(c) == fmi2OK, "reset");
    free(bytes);
    fmi2FreeInstance(c);
}

enum { STATES = 14, INDICATORS = 7 };

/* In model exchange by Euler's method, until the first wheelset locks. */
static void integrate_by_hand(const fmi2CallbackFunctions *callbacks) {
    fmi2Component c = fmi2Instantiate("bogie", fmi2ModelExchange, MODEL.guid, "", callbacks, fmi2False, fmi2True);
    if (!c) exit(2);
    const unsigned level = reference("level");
    const int spatial = 3, planar = 2;
    double state[STATES], slope[STATES], indicator[INDICATORS], time = 0.0;
    int event = 0, ended = 0;
    expect(fmi2SetInteger(c, &level, 1, &spatial) == fmi2OK && fmi2EnterInitializationMode(c) == fmi2OK, "enter");
    expect(fmi2GetContinuousStates(c, state, STATES) == fmi2Error, "states of another level");
    expect(fmi2ExitInitializationMode(c) == fmi2Error, "another level");
    expect(fmi2SetInteger(c, &level, 1, &planar) == fmi2OK && set(c, "brake_torque_1", 60e3) == fmi2OK, "level 2");
    expect(fmi2GetDerivatives(c, slope, STATES) == fmi2OK, "derivatives during initialisation");
    expect(fmi2ExitInitializationMode(c) == fmi2OK, "exit");
    expect(fmi2DoStep(c, 0.0, 0.1, fmi2True) == fmi2Error, "step in model exchange");
    fmi2EventInfo info;
    expect(fmi2NewDiscreteStates(c, NULL) == fmi2Error && fmi2NewDiscreteStates(c, &info) == fmi2OK, "first event");
    expect(fmi2EnterContinuousTimeMode(c) == fmi2OK && fmi2GetContinuousStates(c, state, STATES) == fmi2OK, "go");
    for (const double size = 1e-5; !event && time < 2.0; time += size) {
        expect(fmi2GetDerivatives(c, slope, STATES) == fmi2OK, "derivatives");
        for (int i = 0; i < STATES; ++i) state[i] += size * slope[i];
        expect(fmi2SetTime(c, time + size) == fmi2OK && fmi2SetContinuousStates(c, state, STATES) == fmi2OK, "place");
        expect(fmi2CompletedIntegratorStep(c, fmi2True, &event, &ended) == fmi2OK && !ended, "completed step");
    }
    expect(fmi2GetEventIndicators(c, indicator, INDICATORS) == fmi2OK && indicator[2] < 0.0, "indicator of wheelset 1");
    expect(fmi2EnterEventMode(c) == fmi2OK && fmi2NewDiscreteStates(c, &info) == fmi2OK, "event");
    expect(info.valuesOfContinuousStatesChanged && !info.terminateSimulation, "a velocity was set to 0");
    expect(get(c, "angular_velocity_1") == 0.0 && time > 0.6 && time < 0.7, "locked");
    expect(fmi2GetEventIndicators(c, indicator, INDICATORS) == fmi2OK && indicator[2] > 0.0, "indicator behind it");
    expect(fmi2Terminate(c) == fmi2OK, "terminate");
    fmi2FreeInstance(c);
}

int main(void) {
    const fmi2CallbackFunctions callbacks = {log_message, calloc, free, NULL, NULL};
    refuse_what_is_wrong(&callbacks);
    brake_save_and_repeat(&callbacks);
    integrate_by_hand(&callbacks);
    printf("%d failures, %d sentences\n", failures, sentences);
    return failures ? 1 : 0;
}
