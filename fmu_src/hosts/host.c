/* A host for @MODEL@.fmu on one page: sets what is named, makes 100 steps of 10 ms and prints the outputs. seconds=30 makes
 * 3000 steps. NAME[2]=VALUE sets the second element of an array, and NAME=VALUE all of them.
@2@ * Opening the binary: cc -I../sources host.c -ldl -o host && ./host ../binaries/linux64/@MODEL@.so NAME=VALUE ...
@3@ * Opening the binary: cc -I../sources host.c -ldl -o host && ./host ../binaries/x86_64-linux/@MODEL@.so NAME=VALUE ...
 * Linked with sources: cc -I../sources -DFMI@N@_FUNCTION_PREFIX=@MODEL@_ host.c ../sources/@UNITS@ -lm -o host
 *                      && ./host NAME=VALUE ...
 * Data of the FMU are in its folder resources: beside the binary's folder, or, for a linked program, RESOURCES. */
#include <stdarg.h>
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
@2@    DO(fmi2SetReal) DO(fmi2SetInteger) DO(fmi2GetReal) DO(fmi2GetInteger) DO(fmi2DoStep) DO(fmi2Terminate) \
@2@    DO(fmi2FreeInstance)
@3@    DO(fmi3InstantiateCoSimulation) DO(fmi3EnterInitializationMode) DO(fmi3ExitInitializationMode) DO(fmi3SetFloat64) \
@3@    DO(fmi3SetInt32) DO(fmi3GetFloat64) DO(fmi3GetInt32) DO(fmi3DoStep) DO(fmi3Terminate) DO(fmi3FreeInstance)
#define DECLARE(function) static function##TYPE *function;
#define LOAD(function) memcpy(&function, (void *[]){FIND(library, #function)}, sizeof(void *));
FUNCTIONS(DECLARE)
#endif

#ifndef RESOURCES
#define RESOURCES "../resources"
#endif

enum { MOST = @MOST@ }; /* elements of an array */
/* Names, value references, types (real, integer) and numbers of elements, from modelDescription.xml. */
static const struct variable {
    const char *name;
    fmi@N@ValueReference reference;
    char type;
    size_t count;
} SETTABLE[] = {
@SETTABLE@
}, OUTPUT[] = {
@OUTPUT@
};
static int steps = 100;

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
@2@    va_list rest;
@2@    va_start(rest, message);
@2@    fprintf(stderr, "%s: ", instance);
@2@    vfprintf(stderr, message, rest);
@2@    fputc('\n', stderr);
@2@    va_end(rest);
@3@    fprintf(stderr, "%s\n", message);
}

static void check(int is_right, const char *limit, const char *argument) {
    if (is_right) return;
    fprintf(stderr, "%s; got %s. Correct it.\n", limit, argument);
    exit(1);
}

/* The number that the rest of an argument is. */
static double number_in(const char *text, const char *argument) {
    char *end = NULL;
    const double number = strtod(text, &end);
    const int is_plain = *text && strspn(text, "+-.0123456789eE") == strlen(text);
    check(is_plain && !*end && number - number == 0.0, "A value must be a number, such as 0.2, without a unit", argument);
    return number;
}

/* The element that the rest of an argument begins with, from 1; it ends in ]. */
static size_t element_in(const char *text, const char *argument) {
    const size_t digits = strspn(text, "0123456789");
    check(digits && digits < 8 && text[digits] == ']' && text[digits + 1] == '=',
          "An element must be an integer, as in NAME[2]=VALUE", argument);
    return strtoul(text, NULL, 10);
}

/* Read all elements of a variable. */
@2@static void get(fmi2Component fmu, const struct variable *from, double *value) {
@2@    for (size_t k = 0; k < from->count; ++k) {
@2@        const fmi2ValueReference reference = from->reference + (fmi2ValueReference)k;
@2@        fmi2Integer whole = 0;
@2@        require(from->type == 'r' ? fmi2GetReal(fmu, &reference, 1, value + k)
@2@                                  : fmi2GetInteger(fmu, &reference, 1, &whole), from->name);
@2@        if (from->type == 'i') value[k] = whole;
@2@    }
@3@static void get(fmi3Instance fmu, const struct variable *from, double *value) {
@3@    static fmi3Int32 whole[MOST];
@3@    require(from->type == 'r' ? fmi3GetFloat64(fmu, &from->reference, 1, value, from->count)
@3@                              : fmi3GetInt32(fmu, &from->reference, 1, whole, from->count), from->name);
@3@    for (size_t k = 0; from->type == 'i' && k < from->count; ++k) value[k] = whole[k];
}

/* Set all elements of a variable. */
@2@static void put(fmi2Component fmu, const struct variable *to, const double *value, const char *assignment) {
@2@    for (size_t k = 0; k < to->count; ++k) {
@2@        const fmi2ValueReference reference = to->reference + (fmi2ValueReference)k;
@2@        const fmi2Integer whole = (fmi2Integer)value[k];
@2@        require(to->type == 'r' ? fmi2SetReal(fmu, &reference, 1, value + k) : fmi2SetInteger(fmu, &reference, 1, &whole),
@2@                assignment);
@2@    }
@3@static void put(fmi3Instance fmu, const struct variable *to, const double *value, const char *assignment) {
@3@    static fmi3Int32 whole[MOST];
@3@    for (size_t k = 0; k < to->count; ++k) whole[k] = (fmi3Int32)value[k];
@3@    require(to->type == 'r' ? fmi3SetFloat64(fmu, &to->reference, 1, value, to->count)
@3@                            : fmi3SetInt32(fmu, &to->reference, 1, whole, to->count), assignment);
}

@2@static void set(fmi2Component fmu, const char *assignment) {
@3@static void set(fmi3Instance fmu, const char *assignment) {
    static double value[MOST];
    const size_t length = strcspn(assignment, "[="), equals = strcspn(assignment, "=");
    check(assignment[equals] != 0, "An argument must be NAME=VALUE or NAME[ELEMENT]=VALUE", assignment);
    const int is_one = assignment[length] == '[';
    const double number = number_in(assignment + equals + 1, assignment);
    const size_t element = is_one ? element_in(assignment + length + 1, assignment) : 1;
    if (strncmp(assignment, "seconds=", 8) == 0) {
        check(0.0 <= number && number <= 1e7, "seconds must be from 0 to 1e7", assignment);
        steps = (int)(100.0 * number + 0.5);
        return;
    }
    for (size_t i = 0; i < sizeof SETTABLE / sizeof *SETTABLE; ++i) {
        const struct variable *to = &SETTABLE[i];
        if (strlen(to->name) != length || strncmp(to->name, assignment, length) != 0) continue;
        check(1 <= element && element <= to->count, "An element must be one of the array, from 1 on", assignment);
        check(to->type == 'r' || (-2e9 < number && number < 2e9 && number == (int)number), "The value must be an integer",
              assignment);
        if (is_one) get(fmu, to, value); /* the others keep theirs */
        for (size_t k = 0; k < to->count; ++k)
            if (!is_one || k + 1 == element) value[k] = number;
        put(fmu, to, value, assignment);
        return;
    }
    check(0, "A name must be that of a parameter or input in modelDescription.xml", assignment);
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
@2@                                        fmi2True);
@3@    fmi3Instance fmu = fmi3InstantiateCoSimulation("host", "@GUID@", resources, fmi3False, fmi3True, fmi3False, fmi3False,
@3@                                                   NULL, 0, NULL, log_message, NULL);
    require(fmu ? fmi@N@OK : fmi@N@Error, "The instance");
@2@    require(fmi2SetupExperiment(fmu, fmi2False, 0.0, 0.0, fmi2False, 0.0), "The start time");
@2@    require(fmi2EnterInitializationMode(fmu), "The initialisation");
@3@    require(fmi3EnterInitializationMode(fmu, fmi3False, 0.0, 0.0, fmi3False, 0.0), "The initialisation");
    while (next < count) set(fmu, argument[next++]);
    require(fmi@N@ExitInitializationMode(fmu), "The start");
@2@    for (int n = 0; n < steps; ++n) require(fmi2DoStep(fmu, n * 0.01, 0.01, fmi2True), "A step");
@3@    for (int n = 0; n < steps; ++n) {
@3@        fmi3Boolean event, ended, early;
@3@        fmi3Float64 time;
@3@        require(fmi3DoStep(fmu, n * 0.01, 0.01, fmi3True, &event, &ended, &early, &time), "A step");
@3@    }
    for (size_t i = 0; i < sizeof OUTPUT / sizeof *OUTPUT; ++i) {
        static double value[MOST];
        get(fmu, &OUTPUT[i], value);
        for (size_t k = 0; k < OUTPUT[i].count; ++k)
            if (OUTPUT[i].count == 1) printf("%s %.17g\n", OUTPUT[i].name, value[k]);
            else printf("%s[%d] %.17g\n", OUTPUT[i].name, (int)k + 1, value[k]);
    }
    require(fmi@N@Terminate(fmu), "The end");
    fmi@N@FreeInstance(fmu);
    return 0;
}
