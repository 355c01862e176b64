/* A host for @MODEL@.fmu on one page: sets what is named, makes 100 steps of 10 ms and prints the outputs.
 * Opening the binary: cc -I../sources host.c -ldl -o host && ./host ../binaries/linux64/@MODEL@.so NAME=VALUE ...
 * Linked with sources: cc -I../sources -DFMI2_FUNCTION_PREFIX=@MODEL@_ host.c ../sources/all.c -lm -o host
 *                      && ./host NAME=VALUE ... */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef FMI2_FUNCTION_PREFIX
#include "fmi2Functions.h"
#else
#include "fmi2FunctionTypes.h"
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
    DO(fmi2Instantiate) DO(fmi2SetupExperiment) DO(fmi2EnterInitializationMode) DO(fmi2ExitInitializationMode) \
    DO(fmi2SetReal) DO(fmi2SetInteger) DO(fmi2GetReal) DO(fmi2DoStep) DO(fmi2Terminate) DO(fmi2FreeInstance)
#define DECLARE(function) static function##TYPE *function;
#define LOAD(function) memcpy(&function, (void *[]){FIND(library, #function)}, sizeof(void *));
FUNCTIONS(DECLARE)
#endif

/* Names, value references and types (real, integer) from modelDescription.xml. */
static const struct {
    const char *name;
    fmi2ValueReference reference;
    char type;
} SETTABLE[] = {
@SETTABLE@
}, OUTPUT[] = {
@OUTPUT@
};

static void require(fmi2Status status, const char *what) {
    if (status <= fmi2Warning) return;
    fprintf(stderr, "%s was refused with status %d.\n", what, (int)status);
    exit(1);
}

static void log_message(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status,
                        fmi2String category, fmi2String message, ...) {
    (void)environment, (void)status, (void)category;
    fprintf(stderr, "%s: %s\n", instance, message);
}

static void set(fmi2Component fmu, const char *assignment) {
    const size_t length = strcspn(assignment, "=");
    const char *number = assignment + length + (assignment[length] == '=');
    const fmi2Real real = strtod(number, NULL);
    const fmi2Integer integer = atoi(number);
    for (size_t i = 0; i < sizeof SETTABLE / sizeof *SETTABLE; ++i) {
        if (strlen(SETTABLE[i].name) != length || strncmp(SETTABLE[i].name, assignment, length) != 0) continue;
        const fmi2ValueReference *reference = &SETTABLE[i].reference;
        require(SETTABLE[i].type == 'r' ? fmi2SetReal(fmu, reference, 1, &real)
                                        : fmi2SetInteger(fmu, reference, 1, &integer), assignment);
        return;
    }
    require(fmi2Error, assignment);
}

int main(int count, char **argument) {
    int next = 1;
#ifndef FMI2_FUNCTION_PREFIX
    void *library = count > next ? (void *)OPEN(argument[next++]) : NULL;
    require(library ? fmi2OK : fmi2Error, "The library as the first argument");
    FUNCTIONS(LOAD)
#endif
    const fmi2CallbackFunctions callbacks = {log_message, calloc, free, NULL, NULL};
    fmi2Component fmu = fmi2Instantiate("host", fmi2CoSimulation, "@GUID@", "", &callbacks, fmi2False, fmi2False);
    require(fmu ? fmi2OK : fmi2Error, "The instance");
    while (next < count) set(fmu, argument[next++]);
    require(fmi2SetupExperiment(fmu, fmi2False, 0.0, 0.0, fmi2False, 0.0), "The start time");
    require(fmi2EnterInitializationMode(fmu), "The initialisation");
    require(fmi2ExitInitializationMode(fmu), "The start");
    for (int n = 0; n < 100; ++n) require(fmi2DoStep(fmu, n * 0.01, 0.01, fmi2True), "A step");
    for (size_t i = 0; i < sizeof OUTPUT / sizeof *OUTPUT; ++i) {
        fmi2Real value = 0.0;
        require(fmi2GetReal(fmu, &OUTPUT[i].reference, 1, &value), OUTPUT[i].name);
        printf("%s %.17g\n", OUTPUT[i].name, value);
    }
    require(fmi2Terminate(fmu), "The end");
    fmi2FreeInstance(fmu);
    return 0;
}
