/* Damages the serialised state of an FMU of FMI 2.0: GUID RESOURCES SEED COUNT. Each damaged state must be refused with one
 * sentence, and the instance goes on from the whole one with the same bytes. Linked with the FMU and run under sanitizers;
 * each state has memory of its own, as long as it is, so that a byte read behind it is seen. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2Functions.h"

static unsigned long long generator;
static unsigned random_number(unsigned below) {
    generator = generator * 6364136223846793005ULL + 1442695040888963407ULL;
    return (unsigned)((generator >> 33) % below);
}

static int sentences;
static void hear(fmi2ComponentEnvironment e, fmi2String n, fmi2Status s, fmi2String c, fmi2String text, ...) {
    (void)e, (void)n, (void)c, (void)text;
    sentences += s == fmi2Error;
}

static void due(int truth, const char *what) {
    if (truth) return;
    printf("%s\n", what);
    exit(1);
}

/* One flipped bit, fewer bytes, or more. */
static fmi2Byte *damaged(const fmi2Byte *whole, size_t size, size_t *given) {
    const unsigned kind = random_number(3);
    *given = kind == 0 ? size : kind == 1 ? random_number((unsigned)size) : size + 1 + random_number(64);
    fmi2Byte *bytes = (fmi2Byte *)malloc(*given ? *given : 1);
    if (!bytes) exit(2);
    for (size_t i = 0; i < *given; ++i) bytes[i] = i < size ? whole[i] : (fmi2Byte)random_number(256);
    if (kind == 0) bytes[random_number((unsigned)size)] ^= (fmi2Byte)(1u << random_number(8));
    return bytes;
}

int main(int argc, char **argv) {
    if (argc != 5) return 2;
    const fmi2CallbackFunctions functions = {hear, calloc, free, NULL, NULL};
    fmi2Component c = fmi2Instantiate("one", fmi2CoSimulation, argv[1], argv[2], &functions, 0, 1);
    due(c != NULL, "there is an instance");
    due(fmi2SetupExperiment(c, 0, 0.0, 0.0, 0, 0.0) == fmi2OK && fmi2EnterInitializationMode(c) == fmi2OK, "it begins");
    due(fmi2ExitInitializationMode(c) <= fmi2Warning && fmi2DoStep(c, 0.0, 0.01, 1) <= fmi2Warning, "it steps");
    fmi2FMUstate state = NULL, back = NULL, none = NULL;
    size_t size = 0, same = 0;
    due(fmi2GetFMUstate(c, &state) == fmi2OK && fmi2SerializedFMUstateSize(c, state, &size) == fmi2OK, "it saves");
    fmi2Byte *whole = (fmi2Byte *)malloc(size), *again = (fmi2Byte *)malloc(size);
    if (!whole || !again) return 2;
    due(fmi2SerializeFMUstate(c, state, whole, size) == fmi2OK, "it serialises");
    generator = strtoull(argv[3], NULL, 10);
    sentences = 0;
    const int count = atoi(argv[4]);
    for (int n = 0; n < count; ++n) {
        size_t given = 0;
        fmi2Byte *bytes = damaged(whole, size, &given);
        due(fmi2DeSerializeFMUstate(c, bytes, given, &none) == fmi2Error && !none, "a damaged state is refused");
        due(sentences == n + 1, "with one sentence");
        free(bytes);
    }
    /* The same in the memory of a state that the FMU has given away. */
    for (int n = 0; n < count; ++n) {
        fmi2Byte *bit = (fmi2Byte *)state + random_number((unsigned)size);
        const fmi2Byte mask = (fmi2Byte)(1u << random_number(8));
        *bit ^= mask;
        due(fmi2SetFMUstate(c, state) == fmi2Error, "a state that was changed where it lies is refused");
        *bit ^= mask;
    }
    due(fmi2DoStep(c, 0.01, 0.01, 1) <= fmi2Warning, "it goes on");
    due(fmi2DeSerializeFMUstate(c, whole, size, &back) == fmi2OK && fmi2SetFMUstate(c, back) == fmi2OK, "the whole one is taken");
    due(fmi2GetFMUstate(c, &state) == fmi2OK && fmi2SerializedFMUstateSize(c, state, &same) == fmi2OK && same == size, "saves anew");
    due(fmi2SerializeFMUstate(c, state, again, size) == fmi2OK && memcmp(whole, again, size) == 0, "has the same bytes");
    due(fmi2DoStep(c, 0.01, 86401.0, 1) == fmi2Error && fmi2DoStep(c, 0.01, 1e300, 1) == fmi2Error, "a step above a day is refused");
    due(fmi2DoStep(c, 0.01, 0.01, 1) <= fmi2Warning, "it steps from there");
    (void)fmi2FreeFMUstate(c, &state);
    (void)fmi2FreeFMUstate(c, &back);
    free(whole);
    free(again);
    fmi2FreeInstance(c);
    return 0;
}
