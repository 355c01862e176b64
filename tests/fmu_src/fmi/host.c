/* Host in C that opens the binary of an FMU at run time: host LIBRARY GUID REFERENCE_OF_SPEED REFERENCE_OF_BRAKE_TORQUE. */
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>

#include "fmi2FunctionTypes.h"

static void *library;

static void *find(const char *name) {
    void *found = dlsym(library, name);
    if (!found) exit(2);
    return found;
}

static void log_message(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status, fmi2String category,
                        fmi2String message, ...) {
    (void)environment, (void)instance, (void)status, (void)category;
    printf("%s\n", message);
}

int main(int argc, char **argv) {
    if (argc != 5 || !(library = dlopen(argv[1], RTLD_NOW))) return 2;
    union {
        void *found;
        fmi2InstantiateTYPE *call;
    } instantiate = {find("fmi2Instantiate")};
    union {
        void *found;
        fmi2FreeInstanceTYPE *call;
    } free_instance = {find("fmi2FreeInstance")};
    union {
        void *found;
        fmi2SetupExperimentTYPE *call;
    } setup = {find("fmi2SetupExperiment")};
    union {
        void *found;
        fmi2EnterInitializationModeTYPE *call;
    } enter = {find("fmi2EnterInitializationMode")}, leave = {find("fmi2ExitInitializationMode")};
    union {
        void *found;
        fmi2SetRealTYPE *call;
    } set = {find("fmi2SetReal")};
    union {
        void *found;
        fmi2GetRealTYPE *call;
    } get = {find("fmi2GetReal")};
    union {
        void *found;
        fmi2DoStepTYPE *call;
    } step = {find("fmi2DoStep")};

    const fmi2CallbackFunctions callbacks = {log_message, calloc, free, NULL, NULL};
    const fmi2ValueReference speed = (unsigned)atoi(argv[3]), torque = (unsigned)atoi(argv[4]);
    const double capacity = 20e3;
    double value = 0.0;
    for (int round = 0; round < 1000; ++round) {
        fmi2Component c = instantiate.call("host", fmi2CoSimulation, argv[2], "", &callbacks, 0, 0);
        if (!c) return 3;
        if (setup.call(c, 0, 0.0, 0.0, 0, 0.0) || enter.call(c) || leave.call(c)) return 4;
        if (set.call(c, &torque, 1, &capacity) || step.call(c, 0.0, 0.01, 1)) return 5;
        if (get.call(c, &speed, 1, &value)) return 6;
        free_instance.call(c);
    }
    printf("speed %.9g\n", value);
    return 0;
}
