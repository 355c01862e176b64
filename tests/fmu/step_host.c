/* Calls every function of fmi2_step.c as a host may, and as none should; 0: all answers were as they are due. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2Functions.h"
#include "step_model.h"

static int told;
static void tell(fmi2ComponentEnvironment e, fmi2String n, fmi2Status s, fmi2String c, fmi2String text, ...)
{
    (void)e, (void)n, (void)s, (void)c, (void)text;
    ++told;
}
#define DUE(status, call)                                                                  \
    if ((call) != (status)) {                                                              \
        fprintf(stderr, "line %d: another status than %s was due\n", __LINE__, #status);   \
        return 1;                                                                          \
    }

int main(void)
{
    const fmi2CallbackFunctions functions = {tell, calloc, free, NULL, NULL};
    if (fmi2Instantiate("one", fmi2CoSimulation, "another", "", &functions, 0, 0) || told != 1) return 2;
    if (fmi2Instantiate("one", fmi2ModelExchange, GUID, "", &functions, 0, 0) || told != 2) return 2;
    if (fmi2Instantiate(NULL, fmi2CoSimulation, GUID, "", &functions, 0, 0) || told != 3) return 2;
    if (fmi2Instantiate("one", fmi2CoSimulation, GUID, "", NULL, 0, 0)) return 2;
    fmi2Component c = fmi2Instantiate("one", fmi2CoSimulation, GUID, "", &functions, 0, 1);
    if (!c) return 3;
    const fmi2ValueReference input = 0, period = INPUTS, output = INPUTS + 1, none = INPUTS + OUTPUTS + 1;
    fmi2Real number = 1.0, bad = -1.0;
    fmi2Integer valve = 7;
    fmi2Boolean truth = 0;
    fmi2FMUstate state = NULL, again = NULL;
    size_t size = 0;
    DUE(fmi2Error, fmi2DoStep(c, 0.0, 0.005, 1)) /* too soon */
    DUE(fmi2OK, fmi2SetupExperiment(c, 0, 0.0, 0.0, 0, 0.0))
    DUE(fmi2Error, fmi2SetReal(c, &period, 1, &bad))
    DUE(fmi2OK, fmi2SetReal(c, &period, 1, &(fmi2Real){0.005}))
    DUE(fmi2OK, fmi2EnterInitializationMode(c))
    DUE(fmi2OK, fmi2SetReal(c, &input, 1, &number))
    DUE(fmi2Error, fmi2SetReal(c, &none, 1, &number))
    DUE(fmi2Error, fmi2SetReal(c, NULL, 1, &number))
    DUE(fmi2OK, fmi2ExitInitializationMode(c))
    DUE(fmi2OK, fmi2DoStep(c, 0.0, 0.005, 1))
    DUE(fmi2OK, fmi2GetInteger(c, &output, 1, &valve))
    DUE(fmi2Error, fmi2GetInteger(c, &input, 1, &valve))
    DUE(fmi2Error, fmi2GetInteger(c, &none, 1, &valve))
    DUE(fmi2OK, fmi2GetReal(c, &period, 1, &number))
    DUE(fmi2Error, fmi2GetReal(c, &output, 1, &number))
    DUE(fmi2Error, fmi2GetBoolean(c, &input, 1, &truth))
    DUE(fmi2OK, fmi2GetString(c, NULL, 0, NULL))
    DUE(fmi2OK, fmi2GetFMUstate(c, &state))
    DUE(fmi2OK, fmi2SerializedFMUstateSize(c, state, &size))
    fmi2Byte *bytes = (fmi2Byte *)malloc(size);
    DUE(fmi2Error, fmi2SerializeFMUstate(c, state, bytes, size - 1))
    DUE(fmi2OK, fmi2SerializeFMUstate(c, state, bytes, size))
    DUE(fmi2Error, fmi2DeSerializeFMUstate(c, bytes, size - 1, &again))
    DUE(fmi2OK, fmi2DeSerializeFMUstate(c, bytes, size, &again))
    for (int i = 1; i < 2000; ++i) DUE(fmi2OK, fmi2DoStep(c, 0.005 * i, 0.005, 1))
    DUE(fmi2OK, fmi2SetFMUstate(c, again))
    DUE(fmi2Error, fmi2SetFMUstate(c, NULL))
    DUE(fmi2OK, fmi2FreeFMUstate(c, &state))
    DUE(fmi2OK, fmi2FreeFMUstate(c, &again))
    DUE(fmi2OK, fmi2FreeFMUstate(c, &again))
    free(bytes);
    DUE(fmi2Error, fmi2DoStep(c, 0.005, -1.0, 1))
    DUE(fmi2Error, fmi2CancelStep(c))
    DUE(fmi2Error, fmi2GetRealStatus(c, fmi2LastSuccessfulTime, &number))
    DUE(fmi2OK, fmi2Terminate(c))
    DUE(fmi2Error, fmi2DoStep(c, 0.01, 0.005, 1))
    DUE(fmi2OK, fmi2Reset(c))
    fmi2FreeInstance(c);
    fmi2FreeInstance(NULL);
    DUE(fmi2Error, fmi2Reset(NULL))
    return 0;
}
