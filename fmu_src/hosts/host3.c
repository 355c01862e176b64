/* A host for @MODEL@.fmu on one page: sets what is named, makes 100 steps of 10 ms and prints the outputs.
 * Opening the binary: cc -I../sources host.c -ldl -o host && ./host ../binaries/x86_64-linux/@MODEL@.so NAME=VALUE ...
 * Linked with sources: cc -I../sources -DFMI3_FUNCTION_PREFIX=@MODEL@_ host.c ../sources/all.c -lm -o host
 *                      && ./host NAME=VALUE ... */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef FMI3_FUNCTION_PREFIX
#include "fmi3Functions.h"
#else
#include "fmi3FunctionTypes.h"
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
    DO(fmi3InstantiateCoSimulation) DO(fmi3EnterInitializationMode) DO(fmi3ExitInitializationMode) DO(fmi3SetFloat64) \
    DO(fmi3SetInt32) DO(fmi3GetFloat64) DO(fmi3DoStep) DO(fmi3Terminate) DO(fmi3FreeInstance)
#define DECLARE(function) static function##TYPE *function;
#define LOAD(function) memcpy(&function, (void *[]){FIND(library, #function)}, sizeof(void *));
FUNCTIONS(DECLARE)
#endif

/* Names, value references and types (real, integer) from modelDescription.xml. */
static const struct {
    const char *name;
    fmi3ValueReference reference;
    char type;
} SETTABLE[] = {
@SETTABLE@
}, OUTPUT[] = {
@OUTPUT@
};

static void require(fmi3Status status, const char *what) {
    if (status <= fmi3Warning) return;
    fprintf(stderr, "%s was refused with status %d.\n", what, (int)status);
    exit(1);
}

static void log_message(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category,
                        fmi3String message) {
    (void)environment, (void)status, (void)category;
    fprintf(stderr, "%s\n", message);
}

static void set(fmi3Instance fmu, const char *assignment) {
    const size_t length = strcspn(assignment, "=");
    const char *number = assignment + length + (assignment[length] == '=');
    const fmi3Float64 real = strtod(number, NULL);
    const fmi3Int32 integer = atoi(number);
    for (size_t i = 0; i < sizeof SETTABLE / sizeof *SETTABLE; ++i) {
        if (strlen(SETTABLE[i].name) != length || strncmp(SETTABLE[i].name, assignment, length) != 0) continue;
        const fmi3ValueReference *reference = &SETTABLE[i].reference;
        require(SETTABLE[i].type == 'r' ? fmi3SetFloat64(fmu, reference, 1, &real, 1)
                                        : fmi3SetInt32(fmu, reference, 1, &integer, 1), assignment);
        return;
    }
    require(fmi3Error, assignment);
}

int main(int count, char **argument) {
    int next = 1;
#ifndef FMI3_FUNCTION_PREFIX
    void *library = count > next ? (void *)OPEN(argument[next++]) : NULL;
    require(library ? fmi3OK : fmi3Error, "The library as the first argument");
    FUNCTIONS(LOAD)
#endif
    fmi3Instance fmu = fmi3InstantiateCoSimulation("host", "@GUID@", "", fmi3False, fmi3False, fmi3False, fmi3False, NULL,
                                                   0, NULL, log_message, NULL);
    require(fmu ? fmi3OK : fmi3Error, "The instance");
    while (next < count) set(fmu, argument[next++]);
    require(fmi3EnterInitializationMode(fmu, fmi3False, 0.0, 0.0, fmi3False, 0.0), "The initialisation");
    require(fmi3ExitInitializationMode(fmu), "The start");
    for (int n = 0; n < 100; ++n) {
        fmi3Boolean event, ended, early;
        fmi3Float64 time;
        require(fmi3DoStep(fmu, n * 0.01, 0.01, fmi3True, &event, &ended, &early, &time), "A step");
    }
    for (size_t i = 0; i < sizeof OUTPUT / sizeof *OUTPUT; ++i) {
        fmi3Float64 value = 0.0;
        require(fmi3GetFloat64(fmu, &OUTPUT[i].reference, 1, &value, 1), OUTPUT[i].name);
        printf("%s %.17g\n", OUTPUT[i].name, value);
    }
    require(fmi3Terminate(fmu), "The end");
    fmi3FreeInstance(fmu);
    return 0;
}
