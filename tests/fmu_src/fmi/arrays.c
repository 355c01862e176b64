/* An FMU of FMI 3.0 with arrays: y = gain u, two rows of three. It requests termination at 1 s. */
#include <stdlib.h>
#include <string.h>
#include "fmi3Functions.h"

typedef struct {
    double gain[6], u[3];
    int count;
} instance;

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String path, fmi3Boolean visible,
                                         fmi3Boolean logging, fmi3Boolean events, fmi3Boolean early,
                                         const fmi3ValueReference required[], size_t count, fmi3InstanceEnvironment environment,
                                         fmi3LogMessageCallback log, fmi3IntermediateUpdateCallback update) {
    (void)name, (void)token, (void)path, (void)visible, (void)logging, (void)events, (void)early, (void)required;
    (void)count, (void)environment, (void)log, (void)update;
    return calloc(1, sizeof(instance));
}

void fmi3FreeInstance(fmi3Instance self) { free(self); }

fmi3Status fmi3EnterInitializationMode(fmi3Instance self, fmi3Boolean defined, fmi3Float64 tolerance, fmi3Float64 start,
                                       fmi3Boolean stops, fmi3Float64 stop) {
    (void)self, (void)defined, (void)tolerance, (void)start, (void)stops, (void)stop;
    return fmi3OK;
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance self) {
    (void)self;
    return fmi3OK;
}

fmi3Status fmi3SetFloat64(fmi3Instance self, const fmi3ValueReference refs[], size_t count, const fmi3Float64 values[],
                          size_t values_count) {
    instance *one = self;
    if (count != 1) return fmi3Error;
    double *place = refs[0] == 1 ? one->gain : one->u;
    if (values_count != (refs[0] == 1 ? 6u : 3u)) return fmi3Error;
    memcpy(place, values, values_count * sizeof *values);
    return fmi3OK;
}

fmi3Status fmi3GetFloat64(fmi3Instance self, const fmi3ValueReference refs[], size_t count, fmi3Float64 values[],
                          size_t values_count) {
    const instance *one = self;
    for (size_t i = 0; i < count; ++i) {
        if (refs[i] == 3) {
            for (int row = 0; row < 2; ++row) {
                *values = 0.0;
                for (int k = 0; k < 3; ++k) *values += one->gain[3 * row + k] * one->u[k];
                ++values;
            }
        } else {
            const size_t size = refs[i] == 1 ? 6 : 3;
            memcpy(values, refs[i] == 1 ? one->gain : one->u, size * sizeof *values);
            values += size;
        }
    }
    (void)values_count;
    return fmi3OK;
}

fmi3Status fmi3SetInt32(fmi3Instance self, const fmi3ValueReference refs[], size_t count, const fmi3Int32 values[],
                        size_t values_count) {
    (void)refs, (void)count, (void)values_count;
    ((instance *)self)->count = values[0];
    return fmi3OK;
}

fmi3Status fmi3GetInt32(fmi3Instance self, const fmi3ValueReference refs[], size_t count, fmi3Int32 values[],
                        size_t values_count) {
    (void)refs, (void)count, (void)values_count;
    values[0] = ((instance *)self)->count;
    return fmi3OK;
}

fmi3Status fmi3DoStep(fmi3Instance self, fmi3Float64 time, fmi3Float64 size, fmi3Boolean no_set, fmi3Boolean *event,
                      fmi3Boolean *terminate, fmi3Boolean *early, fmi3Float64 *last) {
    (void)self, (void)no_set;
    *event = *early = fmi3False;
    *last = time + size;
    *terminate = *last > 1.0;
    return fmi3OK;
}
