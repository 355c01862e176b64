/* A host that does not know what it does: random calls in any order with values from the sane to the absurd, on several
 * instances at once. Usage: fuzz SEED CALLS LINE..., files of lines, good and bad. Exit status 1 when a number that is not finite comes with OK. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2Functions.h"
#include "kernel.h"

enum { INSTANCES = 3, NAMES = 4 };

static unsigned long long random_state;
static unsigned random_number(unsigned below) { /* xorshift64 */
    random_state ^= random_state << 13;
    random_state ^= random_state >> 7;
    random_state ^= random_state << 17;
    return (unsigned)(random_state >> 20) % below;
}

static double fraction(void) { return random_number(1000001) / 1e6; }

static double any_value(const variable_description *variable) {
    static const double wild[] = {0.0, -0.0, 1e-300, -1e-300, 1e300, -1e300, 1e-9, 1e9, -1e9};
    switch (random_number(20)) {
        case 0: return NAN;
        case 1: return random_number(2) ? INFINITY : -INFINITY;
        case 2: return wild[random_number(9)];
        case 3: return variable ? variable->minimum : -1.0;
        case 4: return variable ? variable->maximum : 1.0;
        case 5: return variable ? variable->start : 0.0;
        case 6: return (fraction() - 0.5) * 2e5;
        default: return variable ? variable->start * (0.5 + fraction()) : fraction();
    }
}

static double any_size(void) {
    static const double sizes[] = {0.0, -1.0, 1e-12, 1e-6, 1e-3, 1e-3, 1e-3, 1e-2, 0.1, 0.5};
    const unsigned choice = random_number(14);
    if (choice < 10) return sizes[choice];
    return choice == 10 ? NAN : choice == 11 ? INFINITY : fraction();
}

static void log_message(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status,
                        fmi2String category, fmi2String message, ...) {
    (void)environment, (void)instance, (void)status;
    if (!category || strlen(message) < 10) printf("a log entry without a sentence\n");
}

static long long not_finite = 0, refused = 0, steps = 0, places = 0; /* the last two: those that were reached */

typedef struct {
    fmi2Component component;
    fmi2FMUstate saved;
    double time;
    int exchange;
} slot;

static void count(fmi2Status status) { refused += status > fmi2Warning; }

static void check(fmi2Status status, const double *values, size_t size) {
    count(status);
    for (size_t i = 0; i < size; ++i)
        if (status <= fmi2Warning && !isfinite(values[i])) ++not_finite;
}

/* A few references, some of them out of range. */
static size_t any_references(fmi2ValueReference *vr) {
    const size_t size = random_number(NAMES + 1);
    for (size_t i = 0; i < size; ++i)
        vr[i] = random_number(40) == 0 ? random_number(4000000000u) : random_number((unsigned)MODEL.variables);
    return size;
}

static const variable_description *known(fmi2ValueReference reference) {
    return reference < (unsigned)MODEL.variables ? &MODEL.variable[reference] : NULL;
}

static int lines = 0;
static char **line_files;

/* The line's variable or any other, a file, none, or nothing at all. */
static void use_lines(fmi2Component c) {
    const fmi2ValueReference vr = random_number(4) ? (unsigned)MODEL.table_file->variable : random_number((unsigned)MODEL.variables);
    fmi2String path = random_number(3) && lines ? line_files[random_number((unsigned)lines)] : random_number(9) ? "" : NULL;
    count(fmi2SetString(c, &vr, random_number(9) ? 1 : 0, &path));
    fmi2String text = "";
    const fmi2Status status = fmi2GetString(c, &vr, 1, &text);
    count(status);
    if (status <= fmi2Warning && strlen(text) > 1000) printf("a path of %zu letters\n", strlen(text));
}

static void use_variables(slot *s, fmi2Component c) {
    fmi2ValueReference vr[NAMES], other[NAMES];
    double reals[NAMES] = {0}, changes[NAMES];
    int integers[NAMES] = {0}, order[NAMES];
    const size_t size = any_references(vr), others = any_references(other);
    for (size_t i = 0; i < NAMES; ++i) {
        changes[i] = any_value(NULL);
        order[i] = random_number(10) ? 1 : (int)random_number(3);
    }
    (void)s;
    switch (random_number(10)) {
        case 0:
        case 1:
            check(fmi2GetReal(c, vr, size, reals), reals, size);
            break;
        case 2:
        case 3:
        case 4:
            for (size_t i = 0; i < size; ++i) reals[i] = any_value(i < size ? known(vr[i]) : NULL);
            count(fmi2SetReal(c, vr, size, reals));
            break;
        case 5:
            for (size_t i = 0; i < size; ++i) integers[i] = (int)random_number(6) - 1;
            count(random_number(2) ? fmi2SetInteger(c, vr, size, integers) : fmi2SetBoolean(c, vr, size, integers));
            count(fmi2GetInteger(c, vr, size, integers));
            count(fmi2GetBoolean(c, vr, size, integers));
            break;
        case 6:
            check(fmi2GetRealOutputDerivatives(c, vr, size, order, reals), reals, size);
            break;
        case 7:
            count(fmi2SetRealInputDerivatives(c, vr, size, order, changes));
            break;
        case 8:
            use_lines(c);
            break;
        default:
            check(fmi2GetDirectionalDerivative(c, vr, size, other, others, changes, reals), reals, size);
    }
}

static void use_states(slot *s, fmi2Component c) {
    size_t size = 0;
    switch (random_number(4)) {
        case 0:
            count(fmi2GetFMUstate(c, &s->saved));
            break;
        case 1:
            if (s->saved) count(fmi2SetFMUstate(c, s->saved));
            break;
        case 2:
            count(fmi2FreeFMUstate(c, &s->saved));
            break;
        default:
            if (!s->saved || fmi2SerializedFMUstateSize(c, s->saved, &size) != fmi2OK) return;
            char *bytes = malloc(size);
            if (!bytes || fmi2SerializeFMUstate(c, s->saved, bytes, size) != fmi2OK) exit(2);
            if (random_number(2)) bytes[random_number((unsigned)size)] ^= (char)(1 + random_number(255));
            const size_t given = random_number(4) ? size : random_number((unsigned)size);
            count(fmi2DeSerializeFMUstate(c, bytes, given, &s->saved));
            free(bytes);
    }
}

static void change_phase(slot *s, fmi2Component c) {
    switch (random_number(9)) {
        case 0:
            count(fmi2SetupExperiment(c, random_number(2), any_value(NULL), random_number(4) ? 0.0 : any_value(NULL),
                                      random_number(2), any_value(NULL)));
            break;
        case 1: count(fmi2EnterInitializationMode(c)); break;
        case 2: count(fmi2ExitInitializationMode(c)); break;
        case 3:
            if (random_number(4) == 0) count(fmi2Terminate(c));
            break;
        case 4:
            if (random_number(4) == 0) count(fmi2Reset(c));
            break;
        default: /* the legal way, so that steps happen */
            count(fmi2Reset(c));
            count(fmi2SetupExperiment(c, fmi2False, 0.0, 0.0, fmi2False, 0.0));
            for (int i = 0; i < MODEL.selectors; ++i) {
                const fmi2ValueReference selector = (unsigned)MODEL.selector[i];
                const int chosen = 1 + (int)random_number((unsigned)MODEL.selectable[i]);
                count(fmi2SetInteger(c, &selector, 1, &chosen));
            }
            count(fmi2EnterInitializationMode(c));
            count(fmi2ExitInitializationMode(c));
    }
    s->time = 0.0;
}

static void step(slot *s, fmi2Component c) {
    const double size = any_size();
    double time = s->time;
    if (random_number(20) == 0) time = any_value(NULL);
    else (void)fmi2GetRealStatus(c, fmi2LastSuccessfulTime, &time);
    const fmi2Status status = fmi2DoStep(c, time, size, random_number(2));
    count(status);
    steps += status <= fmi2Warning;
    if (status <= fmi2Discard) s->time = time + size;
    for (int i = 0; i < MODEL.variables; ++i) {
        const fmi2ValueReference vr = (unsigned)i;
        double value = 0.0;
        if (MODEL.variable[i].causality == CAUSALITY_OUTPUT && MODEL.variable[i].kind == KIND_REAL)
            check(fmi2GetReal(c, &vr, 1, &value), &value, 1);
    }
}

enum { MOST = 256 };

/* An integrator that does not know what it does: places from the sane to the absurd, arrays of any size. */
static void exchange(fmi2Component c) {
    double states[MOST] = {0}, slopes[MOST] = {0}, indicators[MOST] = {0}, time = any_value(NULL);
    const size_t right = (size_t)kernel_exchange_states(), size = random_number(20) ? right : random_number(MOST);
    const size_t zeros = random_number(20) ? (size_t)kernel_exchange_indicators() : random_number(MOST);
    int event, ended;
    fmi2EventInfo info;
    switch (random_number(8)) {
        case 0:
            count(random_number(4) ? fmi2EnterContinuousTimeMode(c) : fmi2EnterEventMode(c));
            break;
        case 1:
            count(fmi2NewDiscreteStates(c, random_number(20) ? &info : NULL));
            break;
        case 2:
            count(fmi2CompletedIntegratorStep(c, fmi2True, &event, random_number(20) ? &ended : NULL));
            break;
        case 3:
            count(fmi2SetTime(c, time));
            break;
        case 4:
            check(fmi2GetEventIndicators(c, indicators, zeros), indicators, zeros);
            break;
        case 5:
            check(fmi2GetNominalsOfContinuousStates(c, slopes, size), slopes, size);
            break;
        default: /* a step of Euler's method, or to anywhere */
            if (fmi2GetContinuousStates(c, states, size) != fmi2OK || fmi2GetDerivatives(c, slopes, size) != fmi2OK) return;
            check(fmi2OK, slopes, size);
            for (size_t i = 0; i < size; ++i) states[i] += fraction() * 1e-2 * slopes[i];
            if (size && random_number(10) == 0) states[random_number((unsigned)size)] = any_value(NULL);
            count(fmi2SetContinuousStates(c, random_number(50) ? states : NULL, size));
            places += fmi2GetDerivatives(c, slopes, size) <= fmi2Warning;
    }
}

static void ask(fmi2Component c) {
    fmi2Status status;
    double real;
    int integer;
    fmi2String text;
    const char *categories[] = {"events", "nonsense", NULL};
    count(fmi2GetStatus(c, (fmi2StatusKind)random_number(4), &status));
    count(fmi2GetRealStatus(c, (fmi2StatusKind)random_number(4), &real));
    count(fmi2GetIntegerStatus(c, (fmi2StatusKind)random_number(4), &integer));
    count(fmi2GetBooleanStatus(c, (fmi2StatusKind)random_number(4), &integer));
    count(fmi2GetStringStatus(c, (fmi2StatusKind)random_number(4), &text));
    count(fmi2CancelStep(c));
    count(fmi2SetDebugLogging(c, random_number(2), random_number(4), categories));
    count(fmi2GetString(c, NULL, 0, NULL));
}

int main(int argc, char **argv) {
    if (argc < 3) return 2;
    lines = argc - 3;
    line_files = argv + 3;
    random_state = strtoull(argv[1], NULL, 10) * 2654435761u + 88172645463325252ull;
    const long long calls = atoll(argv[2]);
    const fmi2CallbackFunctions callbacks = {log_message, calloc, free, NULL, NULL};
    slot slots[INSTANCES] = {{0}};
    for (long long call = 0; call < calls; ++call) {
        slot *s = &slots[random_number(INSTANCES)];
        if (!s->component || random_number(2000) == 0) {
            if (s->component) (void)fmi2FreeFMUstate(s->component, &s->saved);
            fmi2FreeInstance(s->component);
            const fmi2Type type = random_number(3) ? fmi2CoSimulation : fmi2ModelExchange;
            s->component = fmi2Instantiate("fuzz", type, MODEL.guid, "", &callbacks, fmi2False, fmi2True);
            s->exchange = type == fmi2ModelExchange;
            if (!s->component) return 2;
        }
        const unsigned choice = random_number(20);
        if (choice < 9) use_variables(s, s->component);
        else if (choice < 12) use_states(s, s->component);
        else if (choice < 14) change_phase(s, s->component);
        else if (choice < 19) s->exchange == (random_number(20) != 0) ? exchange(s->component) : step(s, s->component);
        else ask(s->component);
    }
    for (int i = 0; i < INSTANCES; ++i) {
        if (slots[i].component) (void)fmi2FreeFMUstate(slots[i].component, &slots[i].saved);
        fmi2FreeInstance(slots[i].component);
    }
    printf("%lld calls, %lld steps, %lld places, %lld refused, %lld not finite with OK\n", calls, steps, places, refused,
           not_finite);
    return not_finite ? 1 : 0;
}
