/* Hosts of FMI 2.0 and 3.0 that do anything in any order to trains, two of each, and trains of numbers that are none; what a
 * call promises is looked at after each. Usage: arrays_host calls FOLDER FOLDER SEED CALLS, or: arrays_host numbers FOLDER
 * FOLDER SEED ROUNDS, of which the second folder is written to. Exit status 1 when a promise is broken. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "arrays.h"
#include "fmi2Functions.h"
#include "fmi3Functions.h"

enum { HOSTS = 4, STATES = 3, MOST = 512 };
typedef struct {
    int three;
    const char *folder;
    void *instance, *state[STATES];
    double time;
    size_t size;
    unsigned char *bytes;
} host;

static unsigned long long random_state;
static int heard, broken;
static long long outcome[4];
static const char *doing = "";

static unsigned random_number(unsigned below) /* xorshift64 */
{
    random_state ^= random_state << 13;
    random_state ^= random_state >> 7;
    random_state ^= random_state << 17;
    return (unsigned)(random_state >> 20) % below;
}

static void promise(int kept, const char *what)
{
    if (!kept && ++broken < 20) printf("broken in %s: %s\n", doing, what);
}

static void hear(const char *sentence)
{
    const size_t length = strlen(sentence);
    ++heard;
    promise(length > 10 && sentence[length - 1] == '.', sentence);
}

static void listen2(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                    fmi2String sentence, ...)
{
    (void)environment, (void)status;
    promise(name && category, "who speaks and of what");
    hear(sentence);
}

static void listen3(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String sentence)
{
    (void)environment, (void)status;
    promise(category != NULL, "of what is spoken");
    hear(sentence);
}

static void instantiate(host *h)
{
    static const fmi2CallbackFunctions calls = {listen2, calloc, free, NULL, NULL};
    char uri[4096];
    snprintf(uri, sizeof uri, "%s%s", h->three ? "" : "file://", h->folder);
    h->instance = h->three ? fmi3InstantiateCoSimulation("train", ARRAYS_TOKEN, uri, 0, 1, 0, 0, NULL, 0, NULL, listen3, NULL)
                           : fmi2Instantiate("train", fmi2CoSimulation, ARRAYS_TOKEN, uri, &calls, 0, 1);
    h->time = 0.0;
}

static void release(host *h)
{
    for (int n = 0; n < STATES; ++n) {
        if (h->three) (void)fmi3FreeFMUState(h->instance, &h->state[n]);
        else (void)fmi2FreeFMUstate(h->instance, &h->state[n]);
        promise(!h->state[n], "a freed state is gone");
    }
    if (h->three) fmi3FreeInstance(h->instance);
    else fmi2FreeInstance(h->instance);
    h->instance = NULL;
    free(h->bytes);
    h->bytes = NULL;
}

/* ---- states ---- */

static int keep(host *h, void **state)
{
    return h->three ? (int)fmi3GetFMUState(h->instance, state) : (int)fmi2GetFMUstate(h->instance, state);
}

static int take_back(host *h, void *state)
{
    const int status = h->three ? (int)fmi3SetFMUState(h->instance, state) : (int)fmi2SetFMUstate(h->instance, state);
    if (status == 0) h->time = ((arrays_component *)h->instance)->time;
    return status;
}

/* The whole state as bytes, of which the caller disposes. */
static unsigned char *look(host *h, size_t *size)
{
    void *state = NULL;
    int status = keep(h, &state);
    status |= h->three ? (int)fmi3SerializedFMUStateSize(h->instance, state, size)
                       : (int)fmi2SerializedFMUstateSize(h->instance, state, size);
    unsigned char *bytes = malloc(*size);
    if (!bytes) exit(2);
    status |= h->three ? (int)fmi3SerializeFMUState(h->instance, state, bytes, *size)
                       : (int)fmi2SerializeFMUstate(h->instance, state, (fmi2Byte *)bytes, *size);
    if (h->three) (void)fmi3FreeFMUState(h->instance, &state);
    else (void)fmi2FreeFMUstate(h->instance, &state);
    promise(status == 0, "a state is kept and given as bytes at any time");
    return bytes;
}

static int read_bytes(host *h, const unsigned char *bytes, size_t size, void **state)
{
    return h->three ? (int)fmi3DeserializeFMUState(h->instance, bytes, size, state)
                    : (int)fmi2DeSerializeFMUstate(h->instance, (const fmi2Byte *)bytes, size, state);
}

/* Bytes of another host, of another length, with a bit that has changed, or as they were. */
static int any_bytes(host *h, host *hosts)
{
    host *from = random_number(3) ? h : &hosts[random_number(HOSTS)];
    void **state = &h->state[random_number(STATES)];
    if (!from->bytes) from->bytes = look(from, &from->size);
    const size_t at = random_number((unsigned)from->size), cut = random_number(4) ? 0 : random_number((unsigned)from->size) + 1;
    const unsigned char bit = (unsigned char)(random_number(3) ? 0 : 1 << random_number(8));
    const int own = strcmp(from->folder, h->folder) == 0, taken = *state != NULL; /* maybe by another train's */
    unsigned char *copy = malloc(from->size - cut + 1); /* so short that a sanitizer sees what is read beyond */
    if (!copy) exit(2);
    memcpy(copy, from->bytes, from->size - cut);
    if (at < from->size - cut) copy[at] ^= bit;
    const int status = read_bytes(h, copy, from->size - cut, state);
    promise((status == 0) == (own && !cut && !bit) || (status && taken), "only bytes of the same train, as they were, are taken");
    free(copy);
    return status;
}

/* ---- any number anywhere ---- */

static double any_number(void)
{
    static const double wild[] = {NAN, INFINITY, -INFINITY, 1e300, -1e300, 1e-300, -0.0, 7.0, -1.0, 1e7};
    switch (random_number(4)) {
    case 0: return wild[random_number(sizeof wild / sizeof *wild)];
    case 1: return random_number(2001) / 1000.0;
    case 2: return (random_number(2001) - 1000.0) * 1e4;
    default: return random_number(5);
    }
}

static unsigned any_array(void) { return random_number(20) ? random_number((unsigned)ARRAYS + 1) : random_number(1u << 31); }

static int set_or_get2(host *h, int set)
{
    enum { COUNT = 3 };
    fmi2ValueReference vr[COUNT];
    double numbers[COUNT];
    int whole[COUNT], status;
    const int is_whole = random_number(20) ? -1 : (int)random_number(2);
    const unsigned array = any_array() % 65536;
    for (int i = 0; i < COUNT; ++i) {
        vr[i] = array * 65536u + random_number(random_number(10) ? 2 : 65536);
        numbers[i] = any_number();
        whole[i] = random_number(20) ? (int)random_number(3) : (int)random_number(1u << 31);
    }
    const size_t count = random_number(30) ? random_number(COUNT + 1) : 0;
    const int integers = is_whole >= 0 ? is_whole : array < (unsigned)ARRAYS && ARRAYS_ABOUT[array].whole;
    if (set) return integers ? (int)fmi2SetInteger(h->instance, vr, count, whole) : (int)fmi2SetReal(h->instance, vr, count, numbers);
    status = integers ? (int)fmi2GetInteger(h->instance, vr, count, whole) : (int)fmi2GetReal(h->instance, vr, count, numbers);
    for (size_t i = 0; i < count && status == 0 && !integers; ++i) promise(isfinite(numbers[i]), "no NaN leaves with OK");
    return status;
}

static int set_or_get3(host *h, int set)
{
    const unsigned array = any_array();
    const fmi3ValueReference vr[] = {array, array + 1};
    const size_t count = random_number(5) ? 1 : random_number(3);
    size_t due = 0;
    for (size_t i = 0; i < count; ++i) due += vr[i] == (unsigned)ARRAYS ? 1 : arrays_length(h->instance, vr[i]);
    const size_t size = random_number(10) && due < MOST ? due : random_number(MOST);
    double *numbers = malloc((size + 1) * sizeof *numbers); /* malloc: that a sanitizer sees what is read beyond */
    int32_t *whole = malloc((size + 1) * sizeof *whole);
    if (!numbers || !whole) exit(2);
    for (size_t i = 0; i < size; ++i) {
        numbers[i] = random_number(8) ? random_number(1000) * 1e-3 : any_number();
        whole[i] = random_number(20) ? (int32_t)random_number(2) : (int32_t)random_number(1u << 31);
    }
    const int integers = random_number(20) ? array < (unsigned)ARRAYS && ARRAYS_ABOUT[array].whole : (int)random_number(2);
    int status;
    if (set) status = integers ? (int)fmi3SetInt32(h->instance, vr, count, whole, size) : (int)fmi3SetFloat64(h->instance, vr, count, numbers, size);
    else status = integers ? (int)fmi3GetInt32(h->instance, vr, count, whole, size) : (int)fmi3GetFloat64(h->instance, vr, count, numbers, size);
    promise(status != 0 || size == due, "a size that does not fit is refused");
    for (size_t i = 0; i < size && status == 0 && !set && !integers; ++i) promise(isfinite(numbers[i]), "no NaN leaves with OK");
    free(numbers);
    free(whole);
    return status;
}

/* ---- steps ---- */

static void look_at_outputs(host *h)
{
    for (int n = 0; n < ARRAYS; ++n) {
        size_t count;
        const double *values = arrays_values(((arrays_component *)h->instance)->object, n, &count);
        for (size_t i = 0; i < count; ++i) promise(isfinite(values[i]), ARRAYS_ABOUT[n].name);
    }
}

static int step(host *h, double time, double size)
{
    fmi3Boolean event, terminate, early;
    double last = NAN;
    const int status = h->three ? (int)fmi3DoStep(h->instance, time, size, 1, &event, &terminate, &early, &last)
                                : (int)fmi2DoStep(h->instance, time, size, 1);
    outcome[status]++;
    if (status == 0) {
        h->time = time + size;
        look_at_outputs(h);
        promise(size > 0.0 && isfinite(time), "only steps forwards are taken");
    }
    return status;
}

static int any_step(host *h)
{
    static const double sizes[] = {1e-9, 1e-3, 1e-2, 1e-2, 0.1, 0.5}, wild[] = {0.0, -1.0, 1e-300, 1e5, 1e300, INFINITY, NAN};
    static const double off[] = {0.1, -1.0, NAN, INFINITY, 1e300};
    const double usual = random_number(400) ? sizes[random_number(sizeof sizes / sizeof *sizes)] : 100.0;
    const double size = random_number(5) ? usual : wild[random_number(sizeof wild / sizeof *wild)];
    return step(h, random_number(8) ? h->time : h->time + off[random_number(5)], size);
}

static double any_start(void)
{
    static const double starts[] = {5.0, -3.0, 1.7e9, 1e15, NAN, INFINITY};
    return random_number(3) ? 0.0 : starts[random_number(6)];
}

static int enter(host *h)
{
    const double start = any_start();
    int status;
    if (h->three) status = (int)fmi3EnterInitializationMode(h->instance, 0, 0.0, start, 0, 0.0);
    else {
        status = (int)fmi2SetupExperiment(h->instance, 0, 0.0, start, 0, 0.0);
        if (status == 0) return (int)fmi2EnterInitializationMode(h->instance);
    }
    return status;
}

static int leave(host *h)
{
    const int status = h->three ? (int)fmi3ExitInitializationMode(h->instance) : (int)fmi2ExitInitializationMode(h->instance);
    if (status == 0) h->time = ((arrays_component *)h->instance)->time;
    return status;
}

static int reset(host *h) { return h->three ? (int)fmi3Reset(h->instance) : (int)fmi2Reset(h->instance); }
static int terminate(host *h) { return h->three ? (int)fmi3Terminate(h->instance) : (int)fmi2Terminate(h->instance); }

/* Calls that no train offers. */
static int ask_for_more(host *h)
{
    size_t n = 0;
    fmi2Status status;
    fmi3Int64 number = 0;
    const fmi3ValueReference vr = 3;
    if (h->three) return random_number(2) ? (int)fmi3GetNumberOfContinuousStates(h->instance, &n) : (int)fmi3GetInt64(h->instance, &vr, 1, &number, 1);
    return random_number(2) ? (int)fmi2CancelStep(h->instance) : (int)fmi2GetStatus(h->instance, fmi2DoStepStatus, &status);
}

static int act(host *h, host *hosts)
{
    const unsigned choice = random_number(100);
    host *other = random_number(5) ? h : &hosts[random_number(HOSTS)];
    if (choice < 25) return doing = "set", h->three ? set_or_get3(h, 1) : set_or_get2(h, 1);
    if (choice < 40) return doing = "get", h->three ? set_or_get3(h, 0) : set_or_get2(h, 0);
    if (choice < 70) return doing = "step", any_step(h);
    if (choice < 76) return doing = "keep", keep(h, &other->state[random_number(STATES)]);
    if (choice < 82) return doing = "take back", take_back(h, other->state[random_number(STATES)]);
    if (choice < 87) return doing = "bytes", any_bytes(h, hosts);
    if (choice < 91) return doing = "enter", enter(h);
    if (choice < 96) return doing = "leave", leave(h);
    if (choice < 97) return doing = "terminate", terminate(h);
    if (choice < 98) return doing = "more", ask_for_more(h);
    return doing = "reset", reset(h);
}

/* One thing; what fails says why, once, and leaves all as it was. */
static void turn(host *h, host *hosts)
{
    size_t size, size_behind;
    unsigned char *before = look(h, &size);
    heard = 0;
    const int status = act(h, hosts);
    promise(heard == (status != 0), "one sentence where something is refused, and none where not");
    unsigned char *behind = look(h, &size_behind);
    if (status != 0) promise(size == size_behind && memcmp(before, behind, size) == 0, "what fails leaves all as it was");
    free(before);
    free(behind);
}

static void calls(const char *first, const char *second, long long count)
{
    host hosts[HOSTS];
    memset(hosts, 0, sizeof hosts);
    for (int n = 0; n < HOSTS; ++n) {
        hosts[n].three = n & 1;
        hosts[n].folder = n & 2 ? second : first;
        instantiate(&hosts[n]);
        if (!hosts[n].instance) exit(2);
    }
    for (long long n = 0; n < count; ++n) {
        host *h = &hosts[random_number(HOSTS)];
        turn(h, hosts);
        if (!random_number(5) && ((arrays_component *)h->instance)->now != RUNNING) (void)(reset(h) || enter(h) || leave(h));
        if (random_number(200)) continue;
        release(h);
        instantiate(h);
        promise(h->instance != NULL, "an instance");
    }
    for (int n = 0; n < HOSTS; ++n) release(&hosts[n]);
}

/* ---- numbers that are no train's ---- */

static double *read_numbers(const char *folder, size_t *count)
{
    static double numbers[1 << 16];
    char path[4096];
    snprintf(path, sizeof path, "%s/train.bin", folder);
    FILE *file = fopen(path, "rb");
    if (!file) exit(2);
    *count = fread(numbers, sizeof *numbers, 1 << 16, file);
    fclose(file);
    return numbers;
}

static void write_numbers(const char *folder, const double *numbers, size_t bytes)
{
    char path[4096];
    snprintf(path, sizeof path, "%s/train.bin", folder);
    FILE *file = fopen(path, "wb");
    if (!file || fwrite(numbers, 1, bytes, file) != bytes) exit(2);
    fclose(file);
}

static double any_other(double value)
{
    static const double wild[] = {NAN, INFINITY, -INFINITY, 1e300, -1e300, -1.0, 0.5, 0.0, 1e6, 4e9};
    const unsigned choice = random_number(14);
    if (choice < 10) return wild[choice];
    unsigned long long bits = random_state;
    if (choice == 10) memcpy(&value, &bits, sizeof value);
    return choice == 11 ? -value : choice == 12 ? value + 1.0 : choice == 13 ? value * 1.1 : value;
}

/* Some numbers changed, or the end cut off; what is made of it runs, if it is made. */
static void try_numbers(host *h, const double *good, size_t count)
{
    static double numbers[1 << 16];
    memcpy(numbers, good, count * sizeof *good);
    const unsigned changes = 1 + random_number(3);
    for (unsigned n = 0; n < changes; ++n) {
        const size_t at = random_number(3) ? random_number((unsigned)count) : random_number(10);
        numbers[at] = any_other(numbers[at]);
    }
    write_numbers(h->folder, numbers, count * sizeof *good - (random_number(10) ? 0 : random_number((unsigned)(count * sizeof *good))));
    heard = 0;
    instantiate(h);
    outcome[h->instance ? 0 : 3]++;
    promise(heard == !h->instance, "no instance and one sentence, or an instance");
    if (!h->instance) return;
    if (enter(h) == 0 && leave(h) == 0)
        for (int n = 0; n < 4; ++n) {
            (void)(h->three ? set_or_get3(h, 1) : set_or_get2(h, 1));
            (void)step(h, h->time, 0.02);
        }
    release(h);
}

int main(int argc, char **argv)
{
    if (argc != 6) return 2;
    random_state = strtoull(argv[4], NULL, 10) * 2654435761u + 88172645463325252ull;
    const long long rounds = atoll(argv[5]);
    if (strcmp(argv[1], "calls") == 0) calls(argv[2], argv[3], rounds);
    else {
        size_t count;
        const double *good = read_numbers(argv[2], &count);
        doing = "numbers";
        for (long long n = 0; n < rounds; ++n) {
            host h;
            memset(&h, 0, sizeof h);
            h.folder = argv[3];
            h.three = n & 1;
            try_numbers(&h, good, count);
        }
    }
    printf("%lld good, %lld discarded, %lld refused, %d promises broken\n", outcome[0], outcome[2], outcome[3], broken);
    return broken != 0;
}
