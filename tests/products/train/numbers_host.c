/* Test program for FMI 2.0 and 3.0 that makes trains of damaged numbers: some are changed, or the end is cut off. Each gives
 * either no instance and one error message, or a train that runs.
 *
 * Usage: numbers_host FOLDER FOLDER SEED ROUNDS; the second folder is written to. Exit status: 1 if a check fails. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "arrays.h"
#include "fmi2Functions.h"
#include "fmi3Functions.h"

enum { MOST = 1 << 16 };

static unsigned long long random_state;
static int heard, broken;
static long long made, refused;

static unsigned random_number(unsigned below) { /* xorshift64 */
    random_state ^= random_state << 13;
    random_state ^= random_state >> 7;
    random_state ^= random_state << 17;
    return (unsigned)(random_state >> 20) % below;
}

static void promise(int kept, const char *what) {
    if (!kept && ++broken < 20) printf("broken: %s\n", what);
}

static void listen2(fmi2ComponentEnvironment e, fmi2String name, fmi2Status status, fmi2String category, fmi2String sentence,
                    ...) {
    (void)e, (void)name, (void)status, (void)category;
    promise(strlen(sentence) > 10, "what is told is a sentence");
    ++heard;
}

static void listen3(fmi3InstanceEnvironment e, fmi3Status status, fmi3String category, fmi3String sentence) {
    listen2(e, NULL, (fmi2Status)status, category, sentence);
}

static void *instantiate(int three, const char *folder) {
    static const fmi2CallbackFunctions calls = {listen2, calloc, free, NULL, NULL};
    char uri[4096];
    snprintf(uri, sizeof uri, "%s%s", three ? "" : "file://", folder);
    return three ? fmi3InstantiateCoSimulation("train", ARRAYS_TOKEN, uri, 0, 1, 0, 0, NULL, 0, NULL, listen3, NULL)
                 : fmi2Instantiate("train", fmi2CoSimulation, ARRAYS_TOKEN, uri, &calls, 0, 1);
}

static int start(int three, void *one) {
    if (three)
        return fmi3EnterInitializationMode(one, 0, 0.0, 0.0, 0, 0.0) == fmi3OK && fmi3ExitInitializationMode(one) == fmi3OK;
    return fmi2SetupExperiment(one, 0, 0.0, 0.0, 0, 0.0) == fmi2OK && fmi2EnterInitializationMode(one) == fmi2OK &&
           fmi2ExitInitializationMode(one) == fmi2OK;
}

/* Pull, brake, and make four steps. */
static void run(int three, void *one) {
    static const double size = 0.02;
    const unsigned positions = 4, pull = three ? 6 : 6 * ARRAYS_STRIDE;
    const double force = 1e4;
    const int emergency = 4;
    fmi3Boolean event, terminate, early;
    double last;
    (void)(three ? (int)fmi3SetInt32(one, &positions, 1, &emergency, 1) : (int)fmi2SetReal(one, &pull, 1, &force));
    for (int n = 0; n < 4; ++n)
        (void)(three ? (int)fmi3DoStep(one, n * size, size, 1, &event, &terminate, &early, &last)
                     : (int)fmi2DoStep(one, n * size, size, 1));
}

static FILE *opened(const char *folder, const char *how) {
    char path[4096];
    snprintf(path, sizeof path, "%s/train.bin", folder);
    FILE *file = fopen(path, how);
    if (!file) exit(2);
    return file;
}

static double any_other(double value) {
    static const double wild[] = {NAN, INFINITY, -INFINITY, 1e300, -1e300, -1.0, 0.5, 0.0, 1e6, 4e9};
    const unsigned choice = random_number(14);
    const unsigned long long bits = random_state;
    if (choice < 10) return wild[choice];
    if (choice == 10) memcpy(&value, &bits, sizeof value);
    return choice == 11 ? -value : choice == 12 ? value + 1.0 : choice == 13 ? value * 1.1 : value;
}

static void write_damaged(const double *good, size_t count, const char *folder) {
    static double numbers[MOST];
    memcpy(numbers, good, count * sizeof *good);
    for (unsigned n = 1 + random_number(3); n > 0; --n) {
        const size_t at = random_number(3) ? random_number((unsigned)count) : random_number(10);
        numbers[at] = any_other(numbers[at]);
    }
    FILE *file = opened(folder, "wb");
    const size_t bytes = count * sizeof *good, cut = random_number(10) ? 0 : random_number((unsigned)bytes);
    if (fwrite(numbers, 1, bytes - cut, file) != bytes - cut) exit(2);
    fclose(file);
}

int main(int argc, char **argv) {
    static double good[MOST];
    if (argc != 5) return 2;
    random_state = strtoull(argv[3], NULL, 10) * 2654435761u + 88172645463325252ull;
    FILE *file = opened(argv[1], "rb");
    const size_t count = fread(good, sizeof *good, MOST, file);
    fclose(file);
    for (long long n = atoll(argv[4]); n > 0; --n) {
        const int three = (int)(n & 1);
        write_damaged(good, count, argv[2]);
        heard = 0;
        void *one = instantiate(three, argv[2]);
        promise(heard == !one, "no instance and one sentence, or an instance");
        *(one ? &made : &refused) += 1;
        if (one && start(three, one)) run(three, one);
        if (three) fmi3FreeInstance(one);
        else fmi2FreeInstance(one);
    }
    printf("%lld made, %lld refused, %d promises broken\n", made, refused, broken);
    return broken != 0;
}
