/* Hosts of FMI 3.0 that step at random, some with leave to return early, some silent, and integrators of model exchange
 * that do not know what they do: what a call promises is looked at after each. Usage: fuzz3 SEED STEPS
 * CALLS, the last of model exchange. Exit status 1 when a promise is broken. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi3Functions.h"
#include "kernel.h"

enum { INSTANCES = 8, INTEGRATORS = 2, MOST = 64 };

static unsigned long long random_state;
static unsigned random_number(unsigned below) { /* xorshift64 */
    random_state ^= random_state << 13;
    random_state ^= random_state >> 7;
    random_state ^= random_state << 17;
    return (unsigned)(random_state >> 20) % below;
}

typedef struct {
    fmi3Instance instance;
    int early, logging, events, ended;
    double time, stop;
    unsigned char *bytes[2];
} host;

static long long outcome[4], early_returns = 0, ends = 0, places = 0;
static int broken = 0;

static void promise(int kept, const char *what) {
    if (kept) return;
    if (++broken < 20) printf("broken: %s\n", what);
}

static void listen(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String message) {
    (void)status;
    promise(((host *)environment)->logging, "nothing is logged when logging is off");
    promise(category && strlen(message) > 10, "what is logged is a sentence");
}

/* The whole state, bit for bit. */
static size_t look(host *h, int which) {
    fmi3FMUState state = NULL;
    size_t size = 0;
    if (fmi3GetFMUState(h->instance, &state) != fmi3OK) exit(2);
    if (fmi3SerializedFMUStateSize(h->instance, state, &size) != fmi3OK) exit(2);
    if (!h->bytes[which]) h->bytes[which] = (unsigned char *)malloc(size);
    if (!h->bytes[which] || fmi3SerializeFMUState(h->instance, state, h->bytes[which], size) != fmi3OK) exit(2);
    (void)fmi3FreeFMUState(h->instance, &state);
    return size;
}

/* What is to be done at an event: nothing. */
static void handle(host *h) {
    fmi3Boolean more, ended, nominals, values, timed;
    double next;
    promise(fmi3UpdateDiscreteStates(h->instance, &more, &ended, &nominals, &values, &timed, &next) == fmi3OK, "an update");
    promise(!more && !ended && !nominals && !values && !timed, "there is nothing left to update");
    promise(fmi3EnterStepMode(h->instance) == fmi3OK, "steps go on behind an event");
}

static void begin(host *h) {
    static const double starts[] = {0.0, 0.0, 5.0, 1.7e9};
    h->time = starts[random_number(4)];
    h->stop = random_number(2) ? h->time + 0.1 * random_number(40) : INFINITY;
    h->ended = 0;
    (void)fmi3Reset(h->instance);
    const fmi3Status status = fmi3EnterInitializationMode(h->instance, random_number(2), random_number(2) ? 1e-4 : 2.0,
                                                          h->time, isfinite(h->stop), h->stop);
    promise(status <= fmi3Warning, "an experiment that is possible is taken");
    promise(fmi3ExitInitializationMode(h->instance) == fmi3OK, "the initialisation succeeds");
    if (h->events) handle(h);
}

static void set_inputs(const host *h) {
    for (int i = 0; i < MODEL.variables; ++i) {
        const fmi3ValueReference vr = (unsigned)i;
        const double value = (random_number(2001) - 500.0) / 20.0;
        if (MODEL.variable[i].causality == CAUSALITY_INPUT && random_number(2))
            (void)fmi3SetFloat64(h->instance, &vr, 1, &value, 1);
    }
}

static double any_size(void) {
    static const double sizes[] = {0.0, -1.0, 1e-9, 1e-4, 1e-3, 1e-2, 0.1, 0.5, 3.0, 1e3};
    const unsigned choice = random_number(12);
    return choice < 10 ? sizes[choice] : choice == 10 ? NAN : INFINITY;
}

static double any_point(const host *h) {
    switch (random_number(12)) {
        case 0: return NAN;
        case 1: return INFINITY;
        case 2: return h->time + 0.1;
        default: return h->time;
    }
}

static void look_at_success(host *h, double end, fmi3Boolean ended, fmi3Boolean early, double reached) {
    const fmi3ValueReference clock = (unsigned)MODEL.variables;
    double time = NAN;
    promise(fmi3GetFloat64(h->instance, &clock, 1, &time, 1) == fmi3OK && time == reached, "the time is the one reached");
    promise(!early || h->early, "early return only with leave");
    promise(early ? reached < end : reached == end, "a step that is not cut short reaches its end");
    promise(reached <= h->stop + 1e-2 * (end - h->time), "no step goes past the stop time");
    promise(reached > h->time, "time advances");
    for (int i = 0; i < MODEL.variables; ++i) {
        const fmi3ValueReference vr = (unsigned)i;
        double value = 0.0;
        if (MODEL.variable[i].causality == CAUSALITY_OUTPUT && MODEL.variable[i].kind == KIND_REAL)
            promise(fmi3GetFloat64(h->instance, &vr, 1, &value, 1) == fmi3OK && isfinite(value), "outputs are finite");
    }
    h->time = reached;
    h->ended = ended;
    early_returns += early;
    ends += ended;
}

static void step(host *h) {
    const double size = any_size(), point = any_point(h);
    fmi3Boolean events = fmi3True, ended = fmi3True, early = fmi3True;
    double reached = NAN;
    const size_t bytes = look(h, 0);
    const fmi3Status status = fmi3DoStep(h->instance, point, size, fmi3True, &events, &ended, &early, &reached);
    outcome[status]++;
    promise(!events || (h->events && early && !ended), "events are told to who asked, where a step ended early");
    promise(!h->ended || status == fmi3Error, "beyond the end nothing goes on");
    if (status <= fmi3Warning) {
        look_at_success(h, point + size, ended, early, reached);
        if (events && random_number(2)) promise(fmi3EnterEventMode(h->instance) == fmi3OK, "event mode"), handle(h);
    } else {
        promise(look(h, 1) == bytes && memcmp(h->bytes[0], h->bytes[1], bytes) == 0, "what fails leaves the state");
        promise(!ended && !early && reached == h->time, "what fails asks for nothing");
    }
}

/* ---- model exchange ---- */

static double any_number(double sane) {
    static const double wild[] = {0.0, -0.0, 1e-300, 1e300, -1e9, NAN, INFINITY, -INFINITY};
    return random_number(10) ? sane : wild[random_number(8)];
}

typedef fmi3Status (*reading)(fmi3Instance, fmi3Float64[], size_t);

/* An array of the right size is filled with finite numbers where that is OK; of any other it is refused. */
static int read_array(fmi3Instance c, reading read, size_t right, double *values) {
    const size_t size = random_number(20) ? right : random_number(MOST);
    const fmi3Status status = read(c, random_number(50) ? values : NULL, size);
    promise(status > fmi3Warning || size == right, "an array of another size is refused");
    for (size_t i = 0; status <= fmi3Warning && i < size; ++i)
        promise(isfinite(values[i]), "a number that is not finite never comes with OK");
    return status <= fmi3Warning && size == right;
}

/* A step of Euler's method, or to anywhere: what is taken is what is given back. */
static void move(fmi3Instance c, size_t size) {
    double states[MOST] = {0}, slopes[MOST] = {0}, back[MOST];
    if (!read_array(c, fmi3GetContinuousStates, size, states)) return;
    if (!read_array(c, fmi3GetContinuousStateDerivatives, size, slopes)) return;
    for (size_t i = 0; i < size; ++i) states[i] = any_number(states[i] + random_number(1000) * 1e-5 * slopes[i]);
    if (fmi3SetContinuousStates(c, states, size) > fmi3Warning) return;
    promise(fmi3GetContinuousStates(c, back, size) == fmi3OK && memcmp(states, back, size * sizeof *back) == 0,
            "states that are taken are given back");
    places += read_array(c, fmi3GetContinuousStateDerivatives, size, slopes);
}

static void restart(host *h) {
    (void)fmi3Reset(h->instance);
    set_inputs(h);
    (void)fmi3EnterInitializationMode(h->instance, 0, 0.0, any_number(0.0), 0, 0.0);
    if (random_number(10)) (void)fmi3ExitInitializationMode(h->instance);
}

static void update(fmi3Instance c) {
    fmi3Boolean more = 1, ended = 1, nominals = 1, values = 1, timed = 1;
    double next = NAN;
    const fmi3Status status =
        fmi3UpdateDiscreteStates(c, &more, &ended, &nominals, random_number(20) ? &values : NULL, &timed, &next);
    promise(status > fmi3Warning || (!more && !nominals && !timed), "one update is enough");
}

/* Any call of model exchange in any order; those of steps are refused. */
static void integrate(host *h) {
    fmi3Instance c = h->instance;
    double values[MOST], reached;
    fmi3Boolean one = 0, two = 0, three = 0;
    switch (random_number(12)) {
        case 0: restart(h); break;
        case 1: (void)fmi3EnterEventMode(c); break;
        case 2: (void)fmi3EnterContinuousTimeMode(c); break;
        case 3: update(c); break;
        case 4: (void)fmi3SetTime(c, any_number(random_number(1000) * 1e-2)); break;
        case 5: (void)fmi3CompletedIntegratorStep(c, 1, &one, random_number(20) ? &two : NULL); break;
        case 6: (void)read_array(c, fmi3GetEventIndicators, (size_t)kernel_exchange_indicators(), values); break;
        case 7: (void)read_array(c, fmi3GetNominalsOfContinuousStates, (size_t)kernel_exchange_states(), values); break;
        case 8:
            promise(fmi3DoStep(c, 0.0, 1e-3, 1, &one, &two, &three, &reached) == fmi3Error &&
                        fmi3EnterStepMode(c) == fmi3Error,
                    "an instance of model exchange makes no steps");
            break;
        case 9: set_inputs(h); break;
        default: move(c, (size_t)kernel_exchange_states());
    }
}

static void exchange(long long calls) {
    static host hosts[INTEGRATORS];
    for (int i = 0; i < INTEGRATORS; ++i) {
        hosts[i].logging = i;
        hosts[i].instance = fmi3InstantiateModelExchange("fuzz", MODEL.guid, NULL, 0, i, &hosts[i], listen);
        if (!hosts[i].instance) exit(2);
    }
    for (long long i = 0; i < calls; ++i) integrate(&hosts[random_number(INTEGRATORS)]);
    for (int i = 0; i < INTEGRATORS; ++i) fmi3FreeInstance(hosts[i].instance);
}

int main(int argc, char **argv) {
    if (argc != 4) return 2;
    random_state = strtoull(argv[1], NULL, 10) * 2654435761u + 88172645463325252ull;
    static host hosts[INSTANCES];
    for (int i = 0; i < INSTANCES; ++i) {
        hosts[i].early = i & 1, hosts[i].logging = i & 2, hosts[i].events = i & 4;
        hosts[i].instance = fmi3InstantiateCoSimulation("fuzz", MODEL.guid, NULL, fmi3False, i & 2, i & 4, i & 1, NULL,
                                                        0, &hosts[i], listen, NULL);
        if (!hosts[i].instance) return 2;
        begin(&hosts[i]);
    }
    const long long steps = atoll(argv[2]);
    for (long long i = 0; i < steps; ++i) {
        host *h = &hosts[random_number(INSTANCES)];
        if (random_number(h->ended ? 3 : 30) == 0) begin(h);
        set_inputs(h);
        step(h);
    }
    for (int i = 0; i < INSTANCES; ++i) {
        fmi3FreeInstance(hosts[i].instance);
        free(hosts[i].bytes[0]), free(hosts[i].bytes[1]);
    }
    const long long calls = atoll(argv[3]);
    if (calls) exchange(calls);
    printf("%lld good, %lld discarded, %lld refused, %lld early, %lld ends, %lld places, %d promises broken\n",
           outcome[0] + outcome[1], outcome[2], outcome[3], early_returns, ends, places, broken);
    return broken != 0;
}
