/* Run several FMUs in one process, step by step, and print their outputs. Arguments of each FMU:
 * NAME GUID REFERENCE=VALUE,... REFERENCE,...
 * NAME is a linked table if LINKED is defined; otherwise a library, which is opened with global symbols. */
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "together.h"

enum { MOST = 8, STEPS = 300 };

#ifdef LINKED
#define DECLARE(name) extern const functions name;
LINKED(DECLARE)
#endif

static functions functions_of(const char *name) {
    functions found;
#ifdef LINKED
#define TAKE(one)                                                                                                              \
    if (strcmp(name, #one) == 0) return one;
    LINKED(TAKE)
    exit(2);
#else
    void *library = dlopen(name, RTLD_NOW | RTLD_GLOBAL), *address;
    if (!library) exit(2);
#define LOAD(function) address = dlsym(library, #function), memcpy(&found.function, &address, sizeof address);
    FUNCTIONS(LOAD)
#endif
    return found;
}

static void require(int status) {
    if (status != 0) exit(3);
}

#if VERSION == 2
static void told(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status, fmi2String category,
                 fmi2String message, ...) {
    (void)environment, (void)instance, (void)status, (void)category;
    fprintf(stderr, "%s\n", message);
}

static const fmi2CallbackFunctions CALLBACKS = {told, calloc, free, NULL, NULL};

static void *open_fmu(const functions *fmu, const char *guid) {
    return fmu->fmi2Instantiate("one", fmi2CoSimulation, guid, "", &CALLBACKS, 0, 0);
}

static void start(const functions *fmu, void *instance) {
    require(fmu->fmi2SetupExperiment(instance, 0, 0.0, 0.0, 0, 0.0));
    require(fmu->fmi2EnterInitializationMode(instance));
    require(fmu->fmi2ExitInitializationMode(instance));
}

static void set(const functions *fmu, void *instance, unsigned reference, double value) {
    require(fmu->fmi2SetReal(instance, &reference, 1, &value));
}

static void get(const functions *fmu, void *instance, unsigned reference, double *value) {
    require(fmu->fmi2GetReal(instance, &reference, 1, value));
}

static void step(const functions *fmu, void *instance, double time, double size) {
    require(fmu->fmi2DoStep(instance, time, size, 1));
}
#define FREE fmi2FreeInstance
#else
static void told(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String message) {
    (void)environment, (void)status, (void)category;
    fprintf(stderr, "%s\n", message);
}

static void *open_fmu(const functions *fmu, const char *guid) {
    return fmu->fmi3InstantiateCoSimulation("one", guid, "", 0, 0, 0, 0, NULL, 0, NULL, told, NULL);
}

static void start(const functions *fmu, void *instance) {
    require(fmu->fmi3EnterInitializationMode(instance, 0, 0.0, 0.0, 0, 0.0));
    require(fmu->fmi3ExitInitializationMode(instance));
}

static void set(const functions *fmu, void *instance, unsigned reference, double value) {
    require(fmu->fmi3SetFloat64(instance, &reference, 1, &value, 1));
}

static void get(const functions *fmu, void *instance, unsigned reference, double *value) {
    require(fmu->fmi3GetFloat64(instance, &reference, 1, value, 1));
}

static void step(const functions *fmu, void *instance, double time, double size) {
    fmi3Boolean event, ended, early;
    double reached;
    require(fmu->fmi3DoStep(instance, time, size, 1, &event, &ended, &early, &reached));
}
#define FREE fmi3FreeInstance
#endif

int main(int count, char **argument) {
    functions fmu[MOST];
    void *instance[MOST];
    const int fmus = (count - 1) / 4;
    for (int i = 0; i < fmus; ++i) fmu[i] = functions_of(argument[1 + 4 * i]);
    for (int i = 0; i < fmus; ++i) {
        if (!(instance[i] = open_fmu(&fmu[i], argument[2 + 4 * i]))) return 4;
        for (char *pair = strtok(argument[3 + 4 * i], ","); pair; pair = strtok(NULL, ","))
            set(&fmu[i], instance[i], (unsigned)atoi(pair), strtod(strchr(pair, '=') + 1, NULL));
        start(&fmu[i], instance[i]);
    }
    for (int n = 0; n < STEPS; ++n)
        for (int i = 0; i < fmus; ++i) step(&fmu[i], instance[i], n * 1e-2, 1e-2);
    for (int i = 0; i < fmus; ++i) {
        for (char *asked = strtok(argument[4 + 4 * i], ","); asked; asked = strtok(NULL, ",")) {
            double value;
            get(&fmu[i], instance[i], (unsigned)atoi(asked), &value);
            printf("%s %a\n", asked, value);
        }
        printf("-\n");
        fmu[i].FREE(instance[i]);
    }
    return 0;
}
