/* A host for @SYSTEM@.ssp on one page: connects its FMUs, makes steps of @STEP@ s up to a time and prints the outputs.
 * Unpack the .ssp and each FMU in it into a folder of its component's name, from the folder of the .ssp:
@UNPACK@
 * Then: cc -I@FIRST@/sources documentation/host.c -ldl -o host && ./host . SECONDS */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2FunctionTypes.h"
#ifdef _WIN32
#include <windows.h>
#define PLATFORM "win64"
#define SUFFIX ".dll"
#define OPEN(path) LoadLibraryA(path)
#define FIND(library, name) GetProcAddress(library, name)
#else
#include <dlfcn.h>
#ifdef __APPLE__
#define PLATFORM "darwin64"
#define SUFFIX ".dylib"
#else
#ifdef __aarch64__
#define PLATFORM "aarch64-linux"
#else
#define PLATFORM "linux64"
#endif
#define SUFFIX ".so"
#endif
#define OPEN(path) dlopen(path, RTLD_NOW)
#define FIND(library, name) dlsym(library, name)
#endif

#define FUNCTIONS(DO) \
    DO(Instantiate) DO(SetupExperiment) DO(EnterInitializationMode) DO(ExitInitializationMode) DO(GetReal) DO(SetReal) \
    DO(GetInteger) DO(SetInteger) DO(GetBoolean) DO(SetBoolean) DO(DoStep) DO(Terminate) DO(FreeInstance)
#define MEMBER(name) fmi2##name##TYPE *name;
#define LOAD(name) memcpy(&fmu->name, (void *[]){FIND(library, "fmi2" #name)}, sizeof(void *));

/* Components: name, file of the library, GUID. Their start values are in their FMUs. */
static const struct {
    const char *name, *library, *guid;
} COMPONENT[] = {
@COMPONENTS@
};
enum { COMPONENTS = sizeof COMPONENT / sizeof *COMPONENT };

/* From an output to an input, each a component and a value reference; R, I or B: the type, 0 after the last. */
typedef struct {
    int component;
    fmi2ValueReference reference;
} place;
static const struct {
    place from, to;
    char type;
} WIRE[] = {
@WIRES@
};
static const struct {
    place from;
    char type;
    const char *name;
} OUTPUT[] = {
@OUTPUTS@
};

typedef struct {
    fmi2Component instance;
    FUNCTIONS(MEMBER)
} slave;
static slave SLAVE[COMPONENTS];

static void require(fmi2Status status, const char *what) {
    if (status <= fmi2Warning) return;
    fprintf(stderr, "%s was refused with status %d.\n", what, (int)status);
    exit(1);
}

static void log_message(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status, fmi2String category,
                        fmi2String message, ...) {
    (void)environment, (void)status, (void)category;
    va_list rest;
    va_start(rest, message);
    fprintf(stderr, "%s: ", instance);
    vfprintf(stderr, message, rest);
    fputc('\n', stderr);
    va_end(rest);
}
static const fmi2CallbackFunctions CALLBACKS = {log_message, calloc, free, NULL, NULL};

static void make(int number, const char *folder) {
    const char *name = COMPONENT[number].name;
    char path[4096];
    slave *fmu = &SLAVE[number];
    snprintf(path, sizeof path, "%s/%s/binaries/" PLATFORM "/%s" SUFFIX, folder, name, COMPONENT[number].library);
    void *library = (void *)OPEN(path);
    require(library ? fmi2OK : fmi2Error, path);
    FUNCTIONS(LOAD)
    snprintf(path, sizeof path, "%s/%s/resources", folder, name);
    fmu->instance = fmu->Instantiate(name, fmi2CoSimulation, COMPONENT[number].guid, path, &CALLBACKS, fmi2False, fmi2True);
    require(fmu->instance ? fmi2OK : fmi2Error, name);
    require(fmu->SetupExperiment(fmu->instance, fmi2False, 0.0, 0.0, fmi2False, 0.0), name);
    require(fmu->EnterInitializationMode(fmu->instance), name);
}

static double get(place from, char type) {
    const slave *fmu = &SLAVE[from.component];
    fmi2Real real = 0.0;
    int whole = 0;
    require(type == 'R'   ? fmu->GetReal(fmu->instance, &from.reference, 1, &real)
            : type == 'I' ? fmu->GetInteger(fmu->instance, &from.reference, 1, &whole)
                          : fmu->GetBoolean(fmu->instance, &from.reference, 1, &whole), COMPONENT[from.component].name);
    return type == 'R' ? real : whole;
}

static void set(place to, char type, double real) {
    const slave *fmu = &SLAVE[to.component];
    const int whole = (int)real;
    require(type == 'R'   ? fmu->SetReal(fmu->instance, &to.reference, 1, &real)
            : type == 'I' ? fmu->SetInteger(fmu->instance, &to.reference, 1, &whole)
                          : fmu->SetBoolean(fmu->instance, &to.reference, 1, &whole), COMPONENT[to.component].name);
}

/* Pass all outputs on to the inputs, as they are at one time. */
static void transfer(void) {
    static double value[sizeof WIRE / sizeof *WIRE];
    for (size_t n = 0; WIRE[n].type; ++n) value[n] = get(WIRE[n].from, WIRE[n].type);
    for (size_t n = 0; WIRE[n].type; ++n) set(WIRE[n].to, WIRE[n].type, value[n]);
}

int main(int count, char **argument) {
    char *end = NULL;
    const double step = @STEP@, seconds = count == 3 ? strtod(argument[2], &end) : 0.0;
    if (!(end && !*end && seconds > 0.0 && seconds / step < 2e9)) {
        fprintf(stderr, "The call must be host FOLDER SECONDS, with a number above 0; got %s.\n",
                count == 3 ? argument[2] : "no number");
        return 1;
    }
    for (int k = 0; k < COMPONENTS; ++k) make(k, argument[1]);
    for (int k = 0; k < COMPONENTS; ++k) transfer(); /* as long as a value may take through all of them */
    for (int k = 0; k < COMPONENTS; ++k)
        require(SLAVE[k].ExitInitializationMode(SLAVE[k].instance), COMPONENT[k].name);
    for (int n = 0; n < (int)(seconds / step + 0.5); ++n) {
        for (int k = 0; k < COMPONENTS; ++k)
            require(SLAVE[k].DoStep(SLAVE[k].instance, n * step, step, fmi2True), COMPONENT[k].name);
        transfer();
    }
    for (size_t n = 0; n < sizeof OUTPUT / sizeof *OUTPUT; ++n)
        printf("%s %.17g\n", OUTPUT[n].name, get(OUTPUT[n].from, OUTPUT[n].type));
    for (int k = 0; k < COMPONENTS; ++k) {
        require(SLAVE[k].Terminate(SLAVE[k].instance), COMPONENT[k].name);
        SLAVE[k].FreeInstance(SLAVE[k].instance);
    }
    return 0;
}
