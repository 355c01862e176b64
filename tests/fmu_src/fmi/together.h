/* Function table of an FMU, for FMI VERSION 2 or 3. */
#if VERSION == 2
#include "fmi2FunctionTypes.h"
#define FUNCTIONS(DO)                                                                                                          \
    DO(fmi2Instantiate)                                                                                                        \
    DO(fmi2SetupExperiment)                                                                                                    \
    DO(fmi2EnterInitializationMode)                                                                                            \
    DO(fmi2ExitInitializationMode) DO(fmi2SetReal) DO(fmi2GetReal) DO(fmi2DoStep) DO(fmi2FreeInstance)
#else
#include "fmi3FunctionTypes.h"
#define FUNCTIONS(DO)                                                                                                          \
    DO(fmi3InstantiateCoSimulation)                                                                                            \
    DO(fmi3EnterInitializationMode)                                                                                            \
    DO(fmi3ExitInitializationMode) DO(fmi3SetFloat64) DO(fmi3GetFloat64) DO(fmi3DoStep) DO(fmi3FreeInstance)
#endif

typedef struct {
#define MEMBER(function) function##TYPE *function;
    FUNCTIONS(MEMBER)
} functions;
