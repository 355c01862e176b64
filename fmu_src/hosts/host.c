/* A host for @MODEL@.fmu on one page: sets what is named, makes 100 steps of 10 ms and prints the outputs.
@2@ * Opening the binary: cc -I../sources host.c -ldl -o host && ./host ../binaries/linux64/@MODEL@.so NAME=VALUE ...
@3@ * Opening the binary: cc -I../sources host.c -ldl -o host && ./host ../binaries/x86_64-linux/@MODEL@.so NAME=VALUE ...
 * Linked with sources: cc -I../sources -DFMI@N@_FUNCTION_PREFIX=@MODEL@_ host.c ../sources/all.c -lm -o host
 *                      && ./host NAME=VALUE ...
 * Data of the FMU are in its folder resources: beside the binary's folder, or, for a linked program, RESOURCES. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef FMI@N@_FUNCTION_PREFIX
#include "fmi@N@Functions.h"
#else
#include "fmi@N@FunctionTypes.h"
#ifdef _WIN32
#include <windows.h>
#define OPEN(path) LoadLibraryA(path)
#define FIND(library, name) GetProcAddress(library, name)
#else
#include <dlfcn.h>
#define OPEN(path) dlopen(path, RTLD_NOW)
#define FIND(library, name) dlsym(library, name)
#endif
#define FUNCTIONS(DO) \
@2@    DO(fmi2Instantiate) DO(fmi2SetupExperiment) DO(fmi2EnterInitializationMode) DO(fmi2ExitInitializationMode) \
@2@    DO(fmi2SetReal) DO(fmi2SetInteger) DO(fmi2GetReal) DO(fmi2DoStep) DO(fmi2Terminate) DO(fmi2FreeInstance)
@3@    DO(fmi3InstantiateCoSimulation) DO(fmi3EnterInitializationMode) DO(fmi3ExitInitializationMode) DO(fmi3SetFloat64) \
@3@    DO(fmi3SetInt32) DO(fmi3GetFloat64) DO(fmi3DoStep) DO(fmi3Terminate) DO(fmi3FreeInstance)
#define DECLARE(function) static function##TYPE *function;
#define LOAD(function) memcpy(&function, (void *[]){FIND(library, #function)}, sizeof(void *));
FUNCTIONS(DECLARE)
#endif

#ifndef RESOURCES
#define RESOURCES "../resources"
#endif

/* Names, value references and types (real, integer) from modelDescription.xml. */
static const struct {
    const char *name;
    fmi@N@ValueReference reference;
    char type;
} SETTABLE[] = {
@SETTABLE@
}, OUTPUT[] = {
@OUTPUT@
};

static void require(fmi@N@Status status, const char *what) {
    if (status <= fmi@N@Warning) return;
    fprintf(stderr, "%s was refused with status %d.\n", what, (int)status);
    exit(1);
}

@2@static void log_message(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status,
@2@                        fmi2String category, fmi2String message, ...) {
@3@static void log_message(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category,
@3@                        fmi3String message) {
    (void)environment, (void)status, (void)category;
@2@    fprintf(stderr, "%s: %s\n", instance, message);
@3@    fprintf(stderr, "%s\n", message);
}

@2@static void set(fmi2Component fmu, const char *assignment) {
@3@static void set(fmi3Instance fmu, const char *assignment) {
    const size_t length = strcspn(assignment, "=");
    const char *number = assignment + length + (assignment[length] == '=');
@2@    const fmi2Real real = strtod(number, NULL);
@2@    const fmi2Integer integer = atoi(number);
@3@    const fmi3Float64 real = strtod(number, NULL);
@3@    const fmi3Int32 integer = atoi(number);
    for (size_t i = 0; i < sizeof SETTABLE / sizeof *SETTABLE; ++i) {
        if (strlen(SETTABLE[i].name) != length || strncmp(SETTABLE[i].name, assignment, length) != 0) continue;
        const fmi@N@ValueReference *reference = &SETTABLE[i].reference;
@2@        require(SETTABLE[i].type == 'r' ? fmi2SetReal(fmu, reference, 1, &real)
@2@                                        : fmi2SetInteger(fmu, reference, 1, &integer), assignment);
@3@        require(SETTABLE[i].type == 'r' ? fmi3SetFloat64(fmu, reference, 1, &real, 1)
@3@                                        : fmi3SetInt32(fmu, reference, 1, &integer, 1), assignment);
        return;
    }
    require(fmi@N@Error, assignment);
}

int main(int count, char **argument) {
    int next = 1;
    char resources[4096] = RESOURCES;
#ifndef FMI@N@_FUNCTION_PREFIX
    void *library = count > next ? (void *)OPEN(argument[next++]) : NULL;
    require(library ? fmi@N@OK : fmi@N@Error, "The library as the first argument");
    FUNCTIONS(LOAD)
    const char *last = strrchr(argument[1], '/');
    snprintf(resources, sizeof resources, "%.*s../../resources", last ? (int)(last + 1 - argument[1]) : 0, argument[1]);
#endif
@2@    const fmi2CallbackFunctions callbacks = {log_message, calloc, free, NULL, NULL};
@2@    fmi2Component fmu = fmi2Instantiate("host", fmi2CoSimulation, "@GUID@", resources, &callbacks, fmi2False,
@2@                                        fmi2False);
@3@    fmi3Instance fmu = fmi3InstantiateCoSimulation("host", "@GUID@", resources, fmi3False, fmi3False, fmi3False, fmi3False,
@3@                                                   NULL, 0, NULL, log_message, NULL);
    require(fmu ? fmi@N@OK : fmi@N@Error, "The instance");
    while (next < count) set(fmu, argument[next++]);
@2@    require(fmi2SetupExperiment(fmu, fmi2False, 0.0, 0.0, fmi2False, 0.0), "The start time");
@2@    require(fmi2EnterInitializationMode(fmu), "The initialisation");
@3@    require(fmi3EnterInitializationMode(fmu, fmi3False, 0.0, 0.0, fmi3False, 0.0), "The initialisation");
    require(fmi@N@ExitInitializationMode(fmu), "The start");
@2@    for (int n = 0; n < 100; ++n) require(fmi2DoStep(fmu, n * 0.01, 0.01, fmi2True), "A step");
@3@    for (int n = 0; n < 100; ++n) {
@3@        fmi3Boolean event, ended, early;
@3@        fmi3Float64 time;
@3@        require(fmi3DoStep(fmu, n * 0.01, 0.01, fmi3True, &event, &ended, &early, &time), "A step");
@3@    }
    for (size_t i = 0; i < sizeof OUTPUT / sizeof *OUTPUT; ++i) {
@2@        fmi2Real value = 0.0;
@2@        require(fmi2GetReal(fmu, &OUTPUT[i].reference, 1, &value), OUTPUT[i].name);
@3@        fmi3Float64 value = 0.0;
@3@        require(fmi3GetFloat64(fmu, &OUTPUT[i].reference, 1, &value, 1), OUTPUT[i].name);
        printf("%s %.17g\n", OUTPUT[i].name, value);
    }
    require(fmi@N@Terminate(fmu), "The end");
    fmi@N@FreeInstance(fmu);
    return 0;
}
