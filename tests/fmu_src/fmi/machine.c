/* Test program for the state machines of the FMI standards. It makes random calls, allowed and forbidden, with valid and
 * invalid arguments, on several instances at once. It compares each result with the tables below. It is linked with any
 * object of object.h.
 *
 * Usage: machine FACE SEED CALLS RESOURCES WORD...
 * FACE: 0 and 1 are co-simulation and model exchange of FMI 2.0, 2 and 3 those of FMI 3.0.
 * RESOURCES: folder of the object's files, or an empty string. Each WORD is one of
 *   NAME=LEAST:MOST     range of the values that the variable is set to; other variables keep their start values;
 *   NAME>OUTPUT=SHARE   an input, an output with direct feedthrough of it, and the gain;
 *   off=NAME:VALUE      a value without equations if a line file is read;
 *   PATH                a line file; it is invalid if its name begins with "bad".
 * Exit status: 1 if a result is wrong. */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2Functions.h"
#include "fmi3Functions.h"
#include "object.h"

enum { COSIMULATION_2, EXCHANGE_2, COSIMULATION_3, EXCHANGE_3, FACES };
enum { OK, WARNING, DISCARD, ERROR };
/* Columns of the tables. FAILED: after a discarded step of FMI 2.0. ENDED: the FMU has requested termination. */
enum { INSTANTIATED, INITIALIZATION, EVENT, CONTINUOUS, STEP, FAILED, ENDED, TERMINATED };
enum { HOSTS = 4, SAVED = 6, SOME = 4, MOST = 256, LONGEST = 8, WIDE = SOME * LONGEST + 1, PATH = 600, MOST_BROKEN = 20 };
/* Optional features of an object. */
enum { NOTHING, EVENTS, RATES_IN, RATES_OUT, DIRECTIONAL, ABILITIES };

typedef struct host host;
typedef struct {
    const char *name;
    int (*act)(host *h);
    const char *rule[FACES];
    int needs;
} call;

/* An element of a variable and the range of the values that it is set to. */
typedef struct {
    const variable_description *about;
    unsigned variable, at;
    size_t length;
    double start, least, most;
    int played;
} element;

/* Expected state of an instance. A restore replaces all of it. */
typedef struct {
    int state, wild; /* wild: it received values far from its start values, with which a call may fail */
    int event_due;   /* the FMU has requested event mode */
    int rated;       /* inputs have rates and may leave their limits within the step */
    double time, start;
    double value[MOST]; /* last value that was set; NaN: unknown */
    char line[PATH];
} picture;

struct host {
    picture is;
    int face, events, early, quiet, calls_back;
    double stop; /* stop time of the instance; the standards do not specify whether a saved state includes it */
    void *instance;
    unsigned may_hear, must_hear; /* bits of categories */
    int heard[4], heard_inside[4], inside;
    int insane; /* whether the call has arguments that are refused */
    int excused; /* the call may fail for another reason */
    const call *now;
    char rule;
};

static element elements[MOST];
static int count, outputs[MOST], output_count, lines, able[ABILITIES];
static const char *line_files[8], *resources;
static struct {
    int input, output;
    double share;
} pair = {-1, -1, 0.0};
static struct {
    int place;
    double value;
} off = {-1, 0.0};
static long long made[3], broken, done_steps, restored, refused, ends, discarded, early_returns, places;
static const char *born = "machine"; /* name of new instances */
enum { ALLOWED, FORBIDDEN, INSANE };

/* ---- chance ---- */

static unsigned long long random_state;
static unsigned random_number(unsigned below) { /* xorshift64 */
    random_state ^= random_state << 13;
    random_state ^= random_state >> 7;
    random_state ^= random_state << 17;
    return (unsigned)(random_state >> 20) % below;
}
static double fraction(void) { return random_number(1000001) / 1e6; }
static int one_in(unsigned many) { return random_number(many) == 0; }

/* Return a number between the smallest and the largest double; hardly_number() may also return NaN or infinity. */
static double wild_number(void) {
    static const double wild[] = {0.0,   -0.0,   5e-324, -5e-324, 1e-310, 1e-300, -1e-300,
                                  1e300, -1e300, 1e-9,   1e9,     -1e9,   1.0,    -1.0};
    return random_number(5) ? wild[random_number(14)] : (fraction() - 0.5) * 2e5;
}
static double hardly_number(void) {
    const unsigned choice = random_number(12);
    return choice == 0 ? NAN : choice == 1 ? INFINITY : choice == 2 ? -INFINITY : wild_number();
}

static void expect(const host *h, int kept, const char *what) {
    static const char *const face[] = {"FMI 2.0 co-simulation", "FMI 2.0 model exchange", "FMI 3.0 co-simulation",
                                       "FMI 3.0 model exchange"};
    static const char *const state[] = {"instantiated", "initialization", "event", "continuous",
                                        "step",         "failed",         "ended", "terminated"};
    if (kept || ++broken > MOST_BROKEN) return;
    printf("broken: %s: %s in state %s%s: %s\n", face[h->face], h->now ? h->now->name : "-", state[h->is.state],
           h->insane ? ", insane" : "", what);
}

static int is_three(const host *h) { return h->face >= COSIMULATION_3; }
static int is_exchange(const host *h) { return h->face == EXCHANGE_2 || h->face == EXCHANGE_3; }

/* ---- the log ---- */

static const char *const CATEGORY[] = {"events", "logStatusWarning", "logStatusDiscard", "logStatusError"};

/* Check for valid UTF-8 (Unicode 15, table 3-7): shortest encodings, no surrogates. */
static int is_readable(const unsigned char *c) {
    while (*c) {
        const int length = *c < 0x80 ? 1 : *c >> 5 == 6 ? 2 : *c >> 4 == 14 ? 3 : *c >> 3 == 30 ? 4 : 0;
        if (!length) return 0;
        unsigned long point = length == 1 ? *c : *c & (0x7Fu >> length);
        for (int i = 1; i < length; ++i) {
            if (c[i] >> 6 != 2) return 0;
            point = point << 6 | (c[i] & 0x3F);
        }
        static const unsigned long least[] = {0, 0x20, 0x80, 0x800, 0x10000};
        if (point < least[length] || point == 0x7F || point > 0x10FFFF || (point >= 0xD800 && point < 0xE000)) return 0;
        c += length;
    }
    return 1;
}

static void hear(host *h, int status, const char *category, const char *sentence) {
    if (h->inside) { /* a message about the call below, or a late message of the call that logs */
        if (status >= OK && status <= ERROR) h->heard_inside[status]++;
        return;
    }
    expect(h, status >= OK && status <= ERROR, "what is told has a status from 0 to 3");
    if (status >= OK && status <= ERROR) h->heard[status]++;
    expect(h, sentence && strlen(sentence) >= 10 && is_readable((const unsigned char *)sentence), "what is told is a sentence");
    int known = -1;
    for (int i = 0; category && i < 4; ++i)
        if (strcmp(category, CATEGORY[i]) == 0) known = i;
    expect(h, known >= 0, "a category is one of modelDescription.xml");
    expect(h, known < 0 || (h->may_hear & 1u << known), "a category that was switched off is silent");
    if (!h->calls_back || !h->instance) return;
    const unsigned first = 0;
    double value = 0.0;
    h->inside = 1;
    (void)(is_three(h) ? (int)fmi3GetFloat64(h->instance, &first, 1, &value, 1)
                       : (int)fmi2GetReal(h->instance, &first, 1, &value));
    h->inside = 0;
}

/* The message is a format, as in hosts written in C. */
static void hear2(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                  fmi2String format, ...) {
    char sentence[4096];
    va_list arguments;
    va_start(arguments, format);
    const int length = vsnprintf(sentence, sizeof sentence, format, arguments);
    va_end(arguments);
    expect((host *)environment, length >= 0 && length < (int)sizeof sentence, "a message is a format");
    expect((host *)environment, name && strcmp(name, born) == 0, "an instance tells its name");
    hear((host *)environment, (int)status, category, sentence);
}

static void hear3(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String message) {
    hear((host *)environment, (int)status, category, message);
}

/* FMI 2.0, section 2.1.5, FMI 3.0, section 2.3.1 (logMessage): a failed call logs a message; a logged error is returned. */
static int told(host *h, int status) {
    expect(h, status >= OK && status <= ERROR, "a call is never fatal or pending");
    if (status < OK || status > ERROR || h->quiet) return status;
    if (status == ERROR || (is_three(h) && status > OK))
        expect(h, h->heard[status] || h->heard_inside[status] || !(h->must_hear & 1u << status),
               "what fails tells a sentence with its status");
    expect(h, status == ERROR || !h->heard[ERROR], "what succeeds tells of no error");
    return status;
}

static void *listening(host *h) {
    memset(h->heard, 0, sizeof h->heard);
    memset(h->heard_inside, 0, sizeof h->heard_inside);
    return h->instance;
}

/* Make one call of either standard; `c` is the instance. */
#define ASK(two, three) (c = listening(h), told(h, is_three(h) ? (int)(three) : (int)(two)))
#define ASK2(two) (c = listening(h), told(h, (int)(two)))
#define ASK3(three) (c = listening(h), told(h, (int)(three)))
static int is_fine(int status) { return status <= WARNING; }

/* ---- variables ---- */

/* Elements of one kind by their places, and how their request is spoilt: missing arrays, a wrong value reference, too many or
 * too few values. In FMI 3.0 each element represents its whole variable. */
typedef struct {
    int place[SOME], spoilt; /* spoilt: place whose reference is replaced by `stray`; -1: none */
    size_t n;
    unsigned stray;
    int null_references, null_values, excess;
} request;

static size_t width_of(const host *h, const request *r, size_t i) { return is_three(h) ? elements[r->place[i]].length : 1; }

/* Write the value references; return the number of values they have. */
static size_t references_of(const host *h, const request *r, unsigned *vr) {
    size_t due = 0;
    for (size_t i = 0; i < r->n; ++i) {
        const element *e = &elements[r->place[i]];
        vr[i] = is_three(h) ? e->variable : e->variable * OBJECT.stride() + e->at;
        if (r->spoilt == (int)i) vr[i] = r->stray;
        due += width_of(h, r, i);
    }
    return due + (size_t)r->excess;
}

static int get_numbers(host *h, int kind, const request *r, double *value) {
    void *c;
    unsigned references[SOME];
    double wide[WIDE] = {0};
    int integer[WIDE] = {0}, status;
    bool truth[WIDE] = {0};
    const size_t size = references_of(h, r, references), n = r->n;
    const unsigned *const vr = r->null_references ? NULL : references;
    double *const numbers = r->null_values ? NULL : wide;
    int *const whole = r->null_values ? NULL : integer;
    bool *const truths = r->null_values ? NULL : truth;
    if (kind == KIND_REAL) status = ASK(fmi2GetReal(c, vr, n, numbers), fmi3GetFloat64(c, vr, n, numbers, size));
    else if (kind == KIND_INTEGER) status = ASK(fmi2GetInteger(c, vr, n, whole), fmi3GetInt32(c, vr, n, whole, size));
    else status = ASK(fmi2GetBoolean(c, vr, n, whole), fmi3GetBoolean(c, vr, n, truths, size));
    for (size_t i = 0, first = 0; i < n; first += width_of(h, r, i), ++i) {
        const size_t at = first + (is_three(h) ? elements[r->place[i]].at : 0);
        value[i] = kind == KIND_REAL ? wide[at] : kind == KIND_BOOLEAN && is_three(h) ? truth[at] : integer[at];
    }
    return status;
}

static int set_numbers(host *h, int kind, const request *r, const double *value) {
    void *c;
    unsigned references[SOME];
    double wide[WIDE] = {0};
    int integer[WIDE] = {0};
    bool truth[WIDE] = {0};
    const size_t size = references_of(h, r, references), n = r->n;
    for (size_t i = 0, first = 0; i < n; first += width_of(h, r, i), ++i) {
        const int begin = r->place[i] - (is_three(h) ? (int)elements[r->place[i]].at : 0);
        for (size_t k = 0; k < width_of(h, r, i); ++k) {
            wide[first + k] = h->is.value[begin + (int)k];
            for (size_t j = 0; j <= i; ++j)
                if (r->place[j] == begin + (int)k) wide[first + k] = value[j];
            truth[first + k] = (integer[first + k] = kind == KIND_REAL ? 0 : (int)wide[first + k]) != 0;
        }
    }
    const unsigned *const vr = r->null_references ? NULL : references;
    const double *const numbers = r->null_values ? NULL : wide;
    const int *const whole = r->null_values ? NULL : integer;
    const bool *const truths = r->null_values ? NULL : truth;
    if (kind == KIND_REAL) return ASK(fmi2SetReal(c, vr, n, numbers), fmi3SetFloat64(c, vr, n, numbers, size));
    if (kind == KIND_INTEGER) return ASK(fmi2SetInteger(c, vr, n, whole), fmi3SetInt32(c, vr, n, whole, size));
    return ASK(fmi2SetBoolean(c, vr, n, whole), fmi3SetBoolean(c, vr, n, truths, size));
}

static request request_for(int place) {
    request r = {{place}, -1, 1, 0, 0, 0, 0};
    return r;
}

static int get_text(host *h, const unsigned *vr, size_t n, const char **text) {
    void *c;
    return ASK(fmi2GetString(c, vr, n, text), fmi3GetString(c, vr, n, text, n));
}

/* Read all outputs; return whether every read succeeded. */
static int read_outputs(host *h, double *value) {
    int fine = 1;
    for (int i = 0; i < output_count; ++i) {
        const request r = request_for(outputs[i]);
        value[i] = 0.0;
        fine &= is_fine(get_numbers(h, elements[outputs[i]].about->kind, &r, &value[i]));
    }
    return fine;
}

/* Return a random element of this causality and kind, or -1. */
static int any_variable(int causality, int kind) {
    const int first = (int)random_number((unsigned)count);
    for (int i = 0; i < count; ++i) {
        const int place = (first + i) % count;
        if (elements[place].about->causality == causality && elements[place].about->kind == kind) return place;
    }
    return -1;
}

static int any_kind(void) { return (int)random_number(3); }

static int named(const char *name) {
    for (int i = 0; i < count; ++i)
        if (strcmp(elements[i].about->name, name) == 0) return i;
    return -1;
}

static unsigned no_reference(const host *h, int kind) {
    static const unsigned far[] = {1u << 31, (1u << 31) - 1, 4294967295u, (1u << 31) + 7, 1000000000u};
    if (random_number(3)) return far[random_number(5)];
    for (;;) {
        const element *other = &elements[random_number((unsigned)count)];
        if (other->about->kind != kind) return is_three(h) ? other->variable : other->variable * OBJECT.stride() + other->at;
    }
}

static double within(const variable_description *of, double value) {
    return value < of->minimum ? of->minimum : value > of->maximum ? of->maximum : value;
}

/* Return a value with which a run continues. wild_value() returns one far from there, but within its limits. */
static double sane_value(const host *h, int place) {
    const element *of = &elements[place];
    if (!of->played) return of->start;
    if (of->about->kind == KIND_REAL) return of->least + (of->most - of->least) * fraction();
    if (is_exchange(h) && place == off.place) return of->start; /* exchange uses the states of the default model */
    return of->least + random_number((unsigned)(of->most - of->least) + 1);
}
/* Return a value far from the usual range; also NaN, if the signal may be lost. */
static double wild_value(const variable_description *of) {
    double value = wild_number();
    switch (random_number(6)) {
    case 0: value = isfinite(of->minimum) ? of->minimum : -1e300; break;
    case 1: value = isfinite(of->maximum) ? of->maximum : 1e300; break;
    case 2: value = of->start; break;
    case 3: value = (fraction() - 0.5) * 1e3 * (fabs(of->start) + 1.0); break;
    default: break;
    }
    if (of->kind == KIND_REAL) return !isnan(of->when_lost) && one_in(4) ? NAN : within(of, value);
    value = floor(within(of, value));
    return value < -2147483647.0 ? -2147483647.0 : value > 2147483647.0 ? 2147483647.0 : value;
}
/* Write a value that the variable forbids; return 0 if no such value was found. */
static int forbidden_value(int place, double *value) {
    const variable_description *of = &elements[place].about[0];
    const int real = of->kind == KIND_REAL, limited = isnan(of->when_lost) || isfinite(of->maximum);
    switch (random_number(4)) {
    case 0: return *value = NAN, real && isnan(of->when_lost);
    case 1: return *value = random_number(2) ? INFINITY : -INFINITY, real && limited;
    case 2: return *value = of->minimum - 1.0, of->kind != KIND_BOOLEAN && isfinite(of->minimum);
    default: return *value = one_in(3) ? 2147483647.0 : of->maximum + 1.0, of->kind != KIND_BOOLEAN && isfinite(of->maximum);
    }
}

/* Return whether equations exist for the present values. */
static int has_equations(const host *h) {
    if (off.place < 0) return 1;
    const double chosen = h->is.value[off.place];
    if (is_exchange(h) && chosen != elements[off.place].start) return 0;
    return !h->is.line[0] || chosen != off.value;
}

static int can_read(const host *h) {
    return h->is.state != INSTANTIATED && !h->is.wild && (h->is.state != INITIALIZATION || has_equations(h));
}

static void spoil(const host *h, request *r, int kind) {
    const unsigned choice = random_number(is_three(h) ? 4 : 3);
    if (choice == 0) r->null_values = 1;
    else if (choice == 1) r->null_references = 1;
    else if (choice == 2) r->spoilt = (int)random_number((unsigned)r->n), r->stray = no_reference(h, kind);
    else r->excess = random_number(3) ? (random_number(2) ? 1 : -1) : 2147483647;
}

static request request_of(int causality, int kind) {
    request r = request_for(any_variable(causality, kind));
    r.n = 1 + random_number(SOME - 1);
    for (size_t i = 1; i < r.n; ++i) r.place[i] = any_variable(causality, kind);
    return r;
}

static int set_some(host *h, int causality, int kind) {
    if (any_variable(causality, kind) < 0) return -1;
    request r = request_of(causality, kind);
    double value[SOME] = {0}, back[SOME];
    const int wild = one_in(60);
    for (size_t i = 0; i < r.n; ++i) {
        if (i && one_in(2)) r.place[i] = r.place[0];
        value[i] = wild ? wild_value(elements[r.place[i]].about) : sane_value(h, r.place[i]);
    }
    if (h->insane) {
        const unsigned bad = random_number((unsigned)r.n);
        if (random_number(2) || !forbidden_value(r.place[bad], &value[bad])) {
            for (size_t i = 0; i < r.n; ++i) value[i] = sane_value(h, r.place[i]);
            spoil(h, &r, kind);
        } else if (is_three(h)) { /* a later value of the same variable would replace it */
            r.n = bad + 1;
        }
    }
    const int status = set_numbers(h, kind, &r, value);
    if (!is_fine(status) || h->insane) return h->excused = wild, status;
    h->is.wild |= wild;
    for (size_t i = 0; i < r.n; ++i) h->is.value[r.place[i]] = value[i];
    if (h->is.state != INSTANTIATED && !can_read(h)) return status;
    expect(h, is_fine(get_numbers(h, kind, &r, back)), "what was set is read");
    for (size_t i = 0; i < r.n; ++i) {
        const double due = h->is.value[r.place[i]]; /* NaN if the signal is lost */
        expect(h, isnan(due) ? isnan(back[i]) : back[i] == due, "what was set is what is read");
    }
    return status;
}

/* Check that an output with direct feedthrough follows a change of its input at once. */
static int change_input(host *h) {
    double before = 0.0, after = 0.0, value = 0.0;
    const int ready = pair.input >= 0 && (h->is.state == STEP || h->is.state == EVENT || h->is.state == CONTINUOUS);
    if (!ready || h->is.wild) return set_some(h, CAUSALITY_INPUT, KIND_REAL);
    const request in = request_for(pair.input), out = request_for(pair.output);
    if (get_numbers(h, KIND_REAL, &in, &value) != OK || get_numbers(h, KIND_REAL, &out, &before) != OK)
        return set_some(h, CAUSALITY_INPUT, KIND_REAL);
    h->insane = 0;
    const double now = value > 0.0 ? value - 3.0 : value + 3.0;
    const int status = set_numbers(h, KIND_REAL, &in, &now);
    if (!is_fine(status)) return status;
    h->is.value[pair.input] = now;
    expect(h, is_fine(get_numbers(h, KIND_REAL, &out, &after)), "an output is read behind a set");
    expect(h, fabs(after - before - pair.share * (now - value)) < 1e-12, "an output follows an input by its share");
    return status;
}

static int set_input(host *h) { return one_in(4) ? change_input(h) : set_some(h, CAUSALITY_INPUT, KIND_REAL); }
static int set_discrete_input(host *h) { return set_some(h, CAUSALITY_INPUT, random_number(2) ? KIND_INTEGER : KIND_BOOLEAN); }
static int set_parameter(host *h) { return set_some(h, CAUSALITY_PARAMETER, one_in(3) ? KIND_INTEGER : KIND_REAL); }
static int set_output(host *h) { return set_some(h, random_number(2) ? CAUSALITY_OUTPUT : CAUSALITY_LOCAL, any_kind()); }

/* Read values twice: they are finite and bit-identical. */
static int get_some(host *h, int causality, int kind) {
    if (any_variable(causality, kind) < 0) return -1;
    request r = request_of(causality, kind);
    double value[SOME] = {0}, again[SOME] = {0};
    if (h->insane) spoil(h, &r, kind);
    const int status = get_numbers(h, kind, &r, value);
    if (!is_fine(status) || h->insane) return status;
    for (size_t i = 0; i < r.n; ++i) {
        const int lost = causality == CAUSALITY_INPUT && isnan(h->is.value[r.place[i]]);
        expect(h, lost || isfinite(value[i]), "a number that comes with OK is finite, but for a signal that may be lost");
    }
    expect(h, get_numbers(h, kind, &r, again) == status, "a second reading is as good");
    expect(h, memcmp(value, again, r.n * sizeof *value) == 0, "a second reading has the same bits");
    for (size_t i = 0; i < r.n; ++i) {
        const double known = h->is.value[r.place[i]];
        if (causality < CAUSALITY_OUTPUT && !isnan(known)) expect(h, value[i] == known, "a value is the one that was set last");
    }
    return status;
}

static int get_output(host *h) {
    h->excused = h->is.wild; /* outputs may overflow at such values */
    return get_some(h, random_number(3) ? CAUSALITY_OUTPUT : CAUSALITY_LOCAL, any_kind());
}

static int get_given(host *h) { return get_some(h, random_number(2) ? CAUSALITY_INPUT : CAUSALITY_PARAMETER, any_kind()); }

static int get_time(host *h) {
    const unsigned clock = OBJECT.variables();
    double time = NAN;
    void *c;
    h->insane = 0;
    const int status = ASK3(fmi3GetFloat64(c, &clock, 1, &time, 1));
    if (is_fine(status)) expect(h, time == h->is.time, "the time is the one reached");
    return status;
}

/* ---- strings ---- */

/* Return a string that is not the path of a line: a missing file, invalid UTF-8, control characters, conversions, or very
 * long. */
static const char *bad_text(void) {
    static char longest[5000];
    static const char *const bad[] = {"%s%n%d%s",
                                      "/nowhere/%s%s%s%s%n",
                                      "\xff\xfe\x80",
                                      "\x1b[31m\r\n\t\x01",
                                      "/\xed\xa0\x80",
                                      "\xf4\x90\x80\x80%",
                                      "/",
                                      ".",
                                      "\xc3",
                                      "no such file %1$s %999999d"};
    memset(longest, random_number(2) ? '%' : 0xC3, sizeof longest - 1);
    const unsigned choice = random_number(13);
    if (choice == 12 && lines)
        for (int i = 0; i < lines; ++i)
            if (strstr(line_files[i], "/bad") && random_number(2)) return line_files[i];
    return choice < 10 ? bad[choice] : longest;
}

static const char *good_text(const host *h) {
    if (!lines || one_in(4)) return "";
    if (one_in(4)) return h->is.line;
    for (;;) {
        const char *file = line_files[random_number((unsigned)lines)];
        if (!strstr(file, "/bad")) return file;
    }
}

/* Return the number of the path variable (a scalar), or -1 if the object has none. */
static int text_variable(void) {
    for (int i = 0; i < count; ++i)
        if (elements[i].about->kind == KIND_STRING) return (int)elements[i].variable;
    return -1;
}

static void look_at_line(host *h) {
    const unsigned vr = (unsigned)text_variable();
    const char *text = NULL;
    if (text_variable() < 0 || !h->instance) return;
    const int status = get_text(h, &vr, 1, &text);
    expect(h, is_fine(status) && text && strcmp(text, h->is.line) == 0, "the line is the one that was set last");
}

static int set_string(host *h) {
    if (text_variable() < 0 && !h->insane) return -1;
    const char *text[SOME] = {good_text(h), NULL};
    unsigned vr[SOME] = {(unsigned)text_variable()};
    size_t n = 1, values = 1; /* models have at most one string variable */
    int null_references = 0;
    if (h->insane) {
        const unsigned choice = random_number(is_three(h) ? 5 : 4);
        if (choice == 0 || text_variable() < 0)
            n = values = 2, vr[random_number(2)] = no_reference(h, KIND_STRING), text[1] = "";
        else if (choice == 1) null_references = 1;
        else if (choice == 2) text[n - 1] = NULL;
        else if (choice == 3) text[n - 1] = bad_text();
        else ++values;
    }
    char given[PATH];
    snprintf(given, sizeof given, "%s", text[n - 1] ? text[n - 1] : "");
    const unsigned *const references = null_references ? NULL : vr;
    void *c;
    const int status = ASK(fmi2SetString(c, references, n, text), fmi3SetString(c, references, n, text, values));
    if (is_fine(status) && !h->insane) memcpy(h->is.line, given, sizeof given);
    if (h->is.state == INSTANTIATED) look_at_line(h);
    return status;
}

static int get_string(host *h) {
    const char *text[SOME] = {NULL};
    unsigned vr = (unsigned)text_variable();
    if (text_variable() < 0 && !h->insane) return -1;
    const unsigned choice = random_number(text_variable() < 0 ? 1 : 3);
    if (!h->insane) {
        const int status = get_text(h, &vr, 1, text);
        if (is_fine(status)) expect(h, strcmp(text[0], h->is.line) == 0, "the line is the one that was set last");
        return status;
    }
    if (choice == 0) vr = no_reference(h, KIND_STRING);
    return get_text(h, choice == 1 ? NULL : &vr, 1, choice == 2 ? NULL : text);
}

/* ---- from state to state ---- */

static void be_new(host *h) {
    memset(&h->is, 0, sizeof h->is);
    h->stop = INFINITY;
    for (int i = 0; i < count; ++i) h->is.value[i] = elements[i].start;
}

static int step_into(host *h, int status, int state) {
    if (is_fine(status)) h->is.state = state;
    return status;
}

/* Start and stop times of an experiment. Insane: not finite, or a stop before the start. */
typedef struct {
    double start, stop, tolerance;
    int stops, tolerates, wild;
} plan;
static plan any_plan(const host *h) {
    static const double starts[] = {0.0, 0.0, 5.0, 1.7e9};
    plan p = {starts[random_number(4)], 0.0, random_number(2) ? 1e-4 : hardly_number(), (int)random_number(2), one_in(3), 0};
    if ((p.wild = !h->insane && one_in(60))) p.start = wild_number();
    p.stop = p.wild && one_in(2) ? INFINITY : p.start + 0.125 * random_number(30);
    if (!h->insane) return p;
    const unsigned choice = random_number(3);
    if (choice == 0) p.start = NAN;
    else if (choice == 1) p.start = random_number(2) ? INFINITY : -INFINITY;
    else p.stops = 1, p.stop = random_number(2) ? NAN : random_number(2) ? -1e300 : p.start - 1.0;
    return p;
}
static int take_plan(host *h, plan p, int status) {
    h->excused = p.wild; /* a wild start time may be out of range */
    if (!is_fine(status) || h->insane) return status;
    h->is.time = h->is.start = p.start;
    h->is.wild |= p.wild;
    h->stop = p.stops ? p.stop : INFINITY;
    if (p.tolerates && named("tolerance") >= 0) h->is.value[named("tolerance")] = NAN;
    return status;
}

static int setup_experiment(host *h) {
    const plan p = any_plan(h);
    void *c;
    return take_plan(h, p, ASK2(fmi2SetupExperiment(c, p.tolerates, p.tolerance, p.start, p.stops, p.stop)));
}

static int enter_initialization(host *h) {
    void *c;
    if (!is_three(h)) return h->insane = 0, step_into(h, ASK2(fmi2EnterInitializationMode(c)), INITIALIZATION);
    const plan p = any_plan(h);
    const int status = ASK3(fmi3EnterInitializationMode(c, p.tolerates, p.tolerance, p.start, p.stops, p.stop));
    return step_into(h, take_plan(h, p, status), INITIALIZATION);
}

static int exit_initialization(host *h) {
    void *c;
    h->insane = h->is.state == INITIALIZATION && !has_equations(h);
    h->excused = h->is.wild;
    const int status = ASK(fmi2ExitInitializationMode(c), fmi3ExitInitializationMode(c));
    return step_into(h, status, is_exchange(h) || h->events ? EVENT : STEP);
}

static int terminate(host *h) {
    void *c;
    h->insane = 0;
    return step_into(h, ASK(fmi2Terminate(c), fmi3Terminate(c)), TERMINATED);
}

static int reset(host *h) {
    void *c;
    h->insane = 0;
    const int status = ASK(fmi2Reset(c), fmi3Reset(c));
    if (is_fine(status)) be_new(h);
    return status;
}

static int enter_event(host *h) {
    void *c;
    h->insane = 0;
    const int status = step_into(h, ASK(fmi2EnterEventMode(c), fmi3EnterEventMode(c)), EVENT);
    if (is_fine(status)) h->is.event_due = 0;
    return status;
}

static int enter_continuous(host *h) {
    void *c;
    h->insane = 0;
    return step_into(h, ASK(fmi2EnterContinuousTimeMode(c), fmi3EnterContinuousTimeMode(c)), CONTINUOUS);
}

static int enter_step(host *h) {
    void *c;
    h->insane = 0;
    return step_into(h, ASK3(fmi3EnterStepMode(c)), STEP);
}

static int set_logging(host *h) {
    const char *names[2] = {CATEGORY[random_number(4)], CATEGORY[random_number(4)]};
    const int on = (int)random_number(3) > 0;
    const size_t n = h->insane || random_number(2) ? 2 : 0;
    if (h->insane) names[random_number(2)] = random_number(2) ? NULL : bad_text();
    const char *const *const given = (h->insane && random_number(2)) || !n ? NULL : names;
    void *c;
    const int status = ASK(fmi2SetDebugLogging(c, on, n, given), fmi3SetDebugLogging(c, on, n, given));
    if (!is_fine(status) || h->insane) return status;
    unsigned named = n ? 0 : 15;
    for (size_t i = 0; i < n; ++i)
        for (unsigned j = 0; j < 4; ++j) named |= strcmp(names[i], CATEGORY[j]) == 0 ? 1u << j : 0;
    h->must_hear = on ? named : n ? h->must_hear & ~named : 0;
    h->may_hear = !is_three(h) ? 15 : on ? h->may_hear | named : h->may_hear & ~named;
    return status;
}

/* ---- steps ---- */

static double any_size(const host *h) {
    static const double sane[] = {1e-4, 1e-3, 1e-3, 1e-2, 0.03125, 0.25};
    static const double none[] = {0.0, -1.0, -1e-300, NAN, INFINITY, -INFINITY, 86401.0, 1e300};
    static const double wild[] = {1e-12, 1e-9, 1e-6, 1e-4, 1e-4, 1e-4, 1e-3, 1.0};
    return h->insane ? none[random_number(8)] : h->is.wild ? wild[random_number(8)] : one_in(50) ? 3.0 : sane[random_number(6)];
}

/* Return the rounding error that is allowed in a sum of steps, so that the last one may pass the stop time: 1 % of a step. */
static double round_off(const host *h, double size) { return 1e-2 * size + 1e3 * 2.3e-16 * (1.0 + fabs(h->is.time)); }

/* Check a completed step; `early`: it returned early. */
static void look_at_step(host *h, double end, double reached, int early) {
    const unsigned clock = OBJECT.variables();
    double time = NAN, value[MOST];
    void *c;
    /* The spacing of doubles near Unix time is 2.4e-7 s: an event may come within it. */
    const int advances = reached > h->is.time || (reached == h->is.time && h->is.time > 1e9);
    expect(h, early ? advances && reached < end : reached == end, "a step ends where it was to end, or says so");
    expect(h, reached <= h->stop + round_off(h, end - h->is.time), "no step goes past the stop time");
    if (is_three(h))
        expect(h, ASK3(fmi3GetFloat64(c, &clock, 1, &time, 1)) == OK && time == reached, "the time is the one reached");
    expect(h, read_outputs(h, value), "outputs are read behind a step");
    for (int i = 0; i < output_count; ++i) expect(h, isfinite(value[i]), "outputs are finite behind a step");
    for (int i = 0; able[RATES_IN] && i < count; ++i) /* inputs with a rate have changed */
        if (elements[i].about->causality == CAUSALITY_INPUT && elements[i].about->kind == KIND_REAL) h->is.value[i] = NAN;
    h->is.time = reached;
    h->is.rated = 0;
    ++done_steps;
}

/* FMI 2.0, section 4.2.3: after a discarded step the host may request the time reached and whether the run has ended. */
static int do_step2(host *h, double point, double size) {
    double reached = NAN;
    int ended = -1;
    void *c;
    const int status = ASK2(fmi2DoStep(c, point, size, fmi2True));
    const int asked = status != ERROR ? (int)fmi2GetRealStatus(h->instance, fmi2LastSuccessfulTime, &reached) : ERROR;
    if (is_fine(status)) look_at_step(h, point + size, asked == OK ? reached : NAN, 0);
    if (status != DISCARD) return status;
    expect(h, fmi2GetBooleanStatus(h->instance, fmi2Terminated, &ended) == fmi2OK && ended, "a discarded step ends the run");
    expect(h, asked == OK && reached >= h->is.time && reached <= point + size, "a discarded step says how far it went");
    h->is.time = reached;
    h->is.state = FAILED;
    h->excused = 1;
    ++ends, ++discarded;
    return status;
}

static int do_step3(host *h, double point, double size) {
    bool event = 1, end = 1, early = 1;
    double reached = NAN;
    void *c;
    const unsigned spoilt = h->insane && one_in(3) ? random_number(4) : 4;
    if (spoilt < 4) size = 1e-3;
    const int status = ASK3(fmi3DoStep(c, point, size, true, spoilt == 0 ? NULL : &event, spoilt == 1 ? NULL : &end,
                                       spoilt == 2 ? NULL : &early, spoilt == 3 ? NULL : &reached));
    if (!is_fine(status) && spoilt == 4 && h->rule != '-')
        expect(h, !event && !end && !early && reached == h->is.time, "a step that fails asks for nothing");
    if (h->insane) return status;
    if (status == DISCARD) {
        expect(h, !h->early, "with leave to return early no step is discarded");
        return h->excused = 1, ++ends, ++discarded, status;
    }
    if (!is_fine(status)) return status;
    expect(h, !early || h->early || end, "a step returns early only with leave");
    expect(h, !event || h->events, "event mode is asked for of those that use it");
    look_at_step(h, point + size, reached, early);
    early_returns += early;
    h->is.event_due = event;
    if (end) h->is.state = ENDED, ++ends;
    return status;
}

static int do_step(host *h) {
    double point = h->is.time, size = any_size(h);
    if (h->insane && random_number(2))
        size = 1e-3, point = random_number(2) ? NAN : h->is.time + (random_number(2) ? 0.5 : -0.5);
    if (point + size > h->stop + round_off(h, size)) h->insane = 1;
    h->excused = h->is.wild || h->is.rated || h->is.event_due || point + size > h->stop;
    return is_three(h) ? do_step3(h, point, size) : do_step2(h, point, size);
}

/* References and values of real scalars, for calls that handle derivatives. */
typedef struct {
    request r;
    unsigned vr[SOME];
    size_t size;
    double value[SOME + 1];
} row;
static row row_of(host *h, int causality, int spoilt) {
    row one = {request_of(causality, KIND_REAL), {0}, 0, {0}};
    if (spoilt) spoil(h, &one.r, KIND_REAL);
    one.size = references_of(h, &one.r, one.vr);
    return one;
}
#define REFERENCES(one) ((one).r.null_references ? NULL : (one).vr)
#define VALUES(one) ((one).r.null_values ? NULL : (one).value)

static int set_rates(host *h) {
    int order[SOME] = {1, 1, 1, 1};
    const unsigned choice = h->insane ? random_number(4) : 4;
    row in = row_of(h, CAUSALITY_INPUT, choice > 1 && choice < 4);
    for (size_t i = 0; i < in.r.n; ++i) in.value[i] = one_in(3) ? 2.0 * fraction() - 1.0 : 0.0;
    if (choice == 0) order[0] = random_number(2) ? 0 : -1;
    else if (choice == 1) in.value[0] = random_number(2) ? NAN : INFINITY;
    const int wild = !h->insane && one_in(60);
    if (wild) in.value[0] = wild_number();
    void *c;
    const int status = ASK2(fmi2SetRealInputDerivatives(c, REFERENCES(in), in.r.n, order, VALUES(in)));
    h->is.rated |= is_fine(status) && !h->insane;
    h->is.wild |= is_fine(status) && wild;
    h->excused = wild;
    return status;
}

static int get_rates(host *h) {
    if (any_variable(CAUSALITY_OUTPUT, KIND_REAL) < 0) return -1;
    int order[SOME] = {1, 1, 1, 1};
    const int by_order = h->insane && one_in(3);
    row out = row_of(h, CAUSALITY_OUTPUT, h->insane && !by_order);
    if (by_order) order[0] = 0;
    void *c;
    const int status = ASK(fmi2GetRealOutputDerivatives(c, REFERENCES(out), out.r.n, order, VALUES(out)),
                           fmi3GetOutputDerivatives(c, REFERENCES(out), out.r.n, order, VALUES(out), out.size));
    h->excused = h->is.wild;
    for (size_t i = 0; is_fine(status) && !h->insane && i < out.r.n; ++i) expect(h, isfinite(out.value[i]), "a rate is finite");
    return status;
}

static int get_directional(host *h) {
    if (any_variable(CAUSALITY_OUTPUT, KIND_REAL) < 0) return -1;
    const int first = (int)random_number(2);
    row of = row_of(h, CAUSALITY_OUTPUT, h->insane && first), by = row_of(h, CAUSALITY_INPUT, h->insane && !first);
    by.value[0] = 1.0, by.value[2] = 0.5;
    const int wild = !h->insane && one_in(20);
    if (wild) by.value[0] = hardly_number();
    void *c;
    const int status =
        ASK(fmi2GetDirectionalDerivative(c, REFERENCES(of), of.r.n, REFERENCES(by), by.r.n, VALUES(by), VALUES(of)),
            fmi3GetDirectionalDerivative(c, REFERENCES(of), of.r.n, REFERENCES(by), by.r.n, VALUES(by), by.size, VALUES(of),
                                         of.size));
    h->excused = h->is.wild || wild;
    for (size_t i = 0; is_fine(status) && !h->insane && i < of.r.n; ++i)
        expect(h, isfinite(of.value[i]), "a directional derivative is finite");
    return status;
}

static int cancel_step(host *h) {
    void *c;
    return h->insane = 0, ASK2(fmi2CancelStep(c));
}

/* FMI 2.0, section 4.2.3: a status that is not available is a discard. Insane: no address for an available status. */
static int ask_status(host *h) {
    const fmi2StatusKind kind = (fmi2StatusKind)random_number(4);
    fmi2Status status = fmi2OK;
    double time = NAN;
    int truth = -1;
    const char *text = NULL;
    void *c;
    const unsigned choice = random_number(5);
    h->insane &= choice > 1;
    switch (choice) {
    case 0:
        c = listening(h);
        h->excused = 1;
        return (int)fmi2GetStringStatus(c, kind, &text);
    case 1:
        c = listening(h);
        h->excused = 1;
        return (int)fmi2GetIntegerStatus(c, kind, &truth);
    case 2: return ASK2(fmi2GetStatus(c, fmi2DoStepStatus, h->insane ? NULL : &status));
    case 3: {
        const int answer = ASK2(fmi2GetBooleanStatus(c, fmi2Terminated, h->insane ? NULL : &truth));
        if (is_fine(answer) && !h->insane)
            expect(h, truth == (h->is.state == FAILED) || h->is.state == TERMINATED, "a run that has ended says so");
        return answer;
    }
    default: {
        const int answer = ASK2(fmi2GetRealStatus(c, fmi2LastSuccessfulTime, h->insane ? NULL : &time));
        if (is_fine(answer) && !h->insane) expect(h, time == h->is.time, "the last successful time is the one reached");
        return answer;
    }
    }
}

/* FMI 3.0: functions without support are refused. To read or set zero values of an unused type succeeds. */
static int call_absent(host *h) {
    const unsigned vr = 0;
    size_t n = 0;
    double number = 0.0;
    fmi3IntervalQualifier qualifier;
    fmi3UInt64 long_number = 0;
    fmi3DependencyKind kind;
    fmi3Clock clock = 0;
    fmi3Int64 whole = 0;
    fmi3Binary binary = NULL;
    void *c;
    h->insane = 0;
    if (h->instance)
        expect(h, ASK3(fmi3GetInt64(c, &vr, 0, &whole, 0)) == OK && ASK3(fmi3SetClock(c, &vr, 0, &clock)) == OK,
               "to read or set none is no error");
    switch (random_number(17)) {
    case 0: return ASK3(fmi3EnterConfigurationMode(c));
    case 1: return ASK3(fmi3ExitConfigurationMode(c));
    case 2: return ASK3(fmi3EvaluateDiscreteStates(c));
    case 3: return ASK3(fmi3GetBinary(c, &vr, 1, &n, &binary, 1));
    case 4: return ASK3(fmi3SetBinary(c, &vr, 1, &n, &binary, 1));
    case 5: return ASK3(fmi3GetClock(c, &vr, 1, &clock));
    case 6: return ASK3(fmi3SetClock(c, &vr, 1, &clock));
    case 7: return ASK3(fmi3GetIntervalDecimal(c, &vr, 1, &number, &qualifier));
    case 8: return ASK3(fmi3GetIntervalFraction(c, &vr, 1, &long_number, &long_number, &qualifier));
    case 9: return ASK3(fmi3GetShiftDecimal(c, &vr, 1, &number));
    case 10: return ASK3(fmi3SetIntervalDecimal(c, &vr, 1, &number));
    case 11: return ASK3(fmi3SetShiftDecimal(c, &vr, 1, &number));
    case 12: return ASK3(fmi3ActivateModelPartition(c, vr, number));
    case 13: return ASK3(fmi3GetNumberOfVariableDependencies(c, vr, &n));
    case 14: return ASK3(fmi3GetVariableDependencies(c, vr, &n, NULL, &n, &kind, 1));
    case 15: return ASK3(fmi3GetAdjointDerivative(c, &vr, 1, &vr, 1, &number, 1, &number, 1));
    default: return ASK3(fmi3SetInt64(c, &vr, 1, &whole, 1));
    }
}

/* ---- model exchange ---- */

static size_t states_of(void) { return OBJECT.exchange ? (size_t)OBJECT.exchange->states() : 0; }
static size_t indicators_of(void) { return OBJECT.exchange ? (size_t)OBJECT.exchange->indicators() : 0; }
static size_t size_of(const host *h, size_t right) {
    if (!h->insane) return right;
    return random_number(3) ? right + 1 - 2 * (size_t)random_number(2) : random_number(2) ? right + (1u << 31) : ~(size_t)0;
}

enum { STATES, SLOPES, NOMINALS, INDICATORS };
static int read_array(host *h, int which, double *value, size_t n) {
    void *c;
    switch (which) {
    case STATES: return ASK(fmi2GetContinuousStates(c, value, n), fmi3GetContinuousStates(c, value, n));
    case SLOPES: return ASK(fmi2GetDerivatives(c, value, n), fmi3GetContinuousStateDerivatives(c, value, n));
    case NOMINALS: return ASK(fmi2GetNominalsOfContinuousStates(c, value, n), fmi3GetNominalsOfContinuousStates(c, value, n));
    default: return ASK(fmi2GetEventIndicators(c, value, n), fmi3GetEventIndicators(c, value, n));
    }
}
static int get_array(host *h, int which) {
    double value[MOST] = {0}, again[MOST] = {0};
    const size_t right = which == INDICATORS ? indicators_of() : states_of();
    const int missing = h->insane && right && one_in(3);
    const size_t n = missing ? right : size_of(h, right);
    const int status = read_array(h, which, missing ? NULL : value, n);
    h->excused = h->is.wild;
    if (!is_fine(status) || h->insane) return status;
    for (size_t i = 0; i < n; ++i) expect(h, isfinite(value[i]), "a number that comes with OK is finite");
    for (size_t i = 0; which == NOMINALS && i < n; ++i) expect(h, value[i] > 0.0, "a nominal is above zero");
    expect(h, read_array(h, which, again, n) == status && memcmp(value, again, n * sizeof *value) == 0,
           "a second reading has the same bits");
    return status;
}
static int get_states(host *h) { return get_array(h, STATES); }
static int get_slopes(host *h) { return get_array(h, SLOPES); }
static int get_nominals(host *h) { return get_array(h, NOMINALS); }
static int get_indicators(host *h) { return get_array(h, INDICATORS); }

static int get_sizes(host *h) {
    size_t n = 0;
    void *c;
    const int states = (int)random_number(2);
    const size_t right = states ? states_of() : indicators_of();
    size_t *const place = h->insane ? NULL : &n;
    const int status =
        states ? ASK3(fmi3GetNumberOfContinuousStates(c, place)) : ASK3(fmi3GetNumberOfEventIndicators(c, place));
    if (is_fine(status) && !h->insane) expect(h, n == right, "sizes are those of modelDescription.xml");
    return status;
}

static int set_time(host *h) {
    const int wild = !h->insane && one_in(100);
    const double time = h->insane ? (random_number(2) ? NAN : INFINITY) : wild ? wild_number() : h->is.time + 1e-3 * fraction();
    void *c;
    const int status = ASK(fmi2SetTime(c, time), fmi3SetTime(c, time));
    h->excused = wild;
    h->is.wild |= wild && is_fine(status);
    if (is_fine(status) && !h->insane) h->is.time = time;
    return status;
}

/* Make a stable step of Euler's method from the present states. Other states are invalid (insane) or wild. */
static int set_states(host *h) {
    double state[MOST] = {0}, slope[MOST] = {0}, back[MOST] = {0};
    const size_t right = states_of();
    const int ready =
        is_exchange(h) && is_fine(read_array(h, STATES, state, right)) && is_fine(read_array(h, SLOPES, slope, right));
    const double size = ready ? 1e-5 * fraction() : 0.0;
    for (size_t i = 0; i < right; ++i) state[i] += size * slope[i];
    const int missing = h->insane && right && one_in(3), far = !h->insane && right && one_in(200);
    const int no_number = h->insane && !missing && right && one_in(2);
    if (no_number) state[random_number((unsigned)right)] = random_number(2) ? NAN : INFINITY;
    if (far) state[random_number((unsigned)right)] = wild_number();
    const size_t n = missing || no_number ? right : size_of(h, right);
    const double *const given = missing ? NULL : state;
    void *c;
    const int status = ASK(fmi2SetContinuousStates(c, given, n), fmi3SetContinuousStates(c, given, n));
    h->excused = h->is.wild || far;
    if (!is_fine(status) || h->insane) return status;
    h->is.wild |= far;
    ++places;
    expect(h, is_fine(read_array(h, STATES, back, n)) && memcmp(back, state, n * sizeof *back) == 0,
           "states that were set are read, bit for bit");
    return status;
}

/* Results of an event iteration. */
typedef struct {
    int more, end, nominals, moved, timed;
    double next;
} event_result;

static int update_once(host *h, event_result *found) {
    bool three[5] = {1, 1, 1, 1, 1};
    double next = NAN;
    fmi2EventInfo info = {1, 1, 1, 1, 1, NAN};
    void *c;
    const unsigned spoilt = h->insane ? random_number(6) : 6;
    const int status = ASK(fmi2NewDiscreteStates(c, h->insane ? NULL : &info),
                           fmi3UpdateDiscreteStates(c, spoilt == 0 ? NULL : &three[0], spoilt == 1 ? NULL : &three[1],
                                                    spoilt == 2 ? NULL : &three[2], spoilt == 3 ? NULL : &three[3],
                                                    spoilt == 4 ? NULL : &three[4], spoilt == 5 ? NULL : &next));
    const event_result two = {
        info.newDiscreteStatesNeeded,         info.terminateSimulation,  info.nominalsOfContinuousStatesChanged,
        info.valuesOfContinuousStatesChanged, info.nextEventTimeDefined, info.nextEventTime};
    *found = is_three(h) ? (event_result){three[0], three[1], three[2], three[3], three[4], next} : two;
    return status;
}

/* FMI 2.0, section 3.2.2, FMI 3.0, section 2.3.5: an event reports changed states and changed nominals. No object has time
 * events. The iteration ends. */
static int update(host *h) {
    double before[MOST] = {0}, after[MOST] = {0}, nominal[MOST] = {0}, later[MOST] = {0};
    const size_t n = states_of();
    event_result found;
    int known = is_exchange(h) && is_fine(read_array(h, STATES, before, n));
    const int scaled = is_exchange(h) && is_fine(read_array(h, NOMINALS, nominal, n));
    int status = update_once(h, &found);
    h->excused = h->is.wild;
    if (!is_fine(status) || h->insane) return status;
    known &= is_exchange(h) && is_fine(read_array(h, STATES, after, n));
    if (known && memcmp(before, after, n * sizeof *before) != 0)
        expect(h, found.moved, "states that moved at an event are told");
    const int rescaled = scaled && is_fine(read_array(h, NOMINALS, later, n)) && memcmp(nominal, later, n * sizeof *later) != 0;
    expect(h, found.nominals == rescaled, "nominals that changed at an event are told, and no others");
    expect(h, !found.timed, "no event is due at a time");
    expect(h, is_exchange(h) || !found.moved, "behind a step of its own no state is left to move");
    for (int i = 0; i < 10 && found.more && !found.end; ++i) status = update_once(h, &found);
    expect(h, !found.more, "an event iteration ends");
    if (found.end) h->is.state = ENDED, ++ends;
    if (found.end || !is_exchange(h)) return status;
    expect(h, !is_fine(update_once(h, &found)) || !found.moved || h->is.wild, "nothing moves at an event that is over");
    if (found.end) h->is.state = ENDED;
    return status;
}

static int complete_step(host *h) {
    int two[2] = {-1, -1};
    bool three[2] = {0, 1}; /* objects request an end at events only */
    void *c;
    const unsigned spoilt = h->insane ? random_number(2) : 2;
    const int status = ASK(fmi2CompletedIntegratorStep(c, fmi2True, spoilt ? &two[0] : NULL, spoilt == 1 ? NULL : &two[1]),
                           fmi3CompletedIntegratorStep(c, true, spoilt ? &three[0] : NULL, spoilt == 1 ? NULL : &three[1]));
    h->excused = h->is.wild;
    if (!is_fine(status) || h->insane) return status;
    expect(h, is_three(h) || (two[0] >> 1 == 0 && two[1] >> 1 == 0), "a completed step says what follows");
    if (two[1] > 0 || three[1]) h->is.state = ENDED;
    return status;
}

/* ---- saved states ---- */

typedef struct {
    void *state;
    picture is;
    int face, readable;
    double output[MOST];
} saved;
static saved kept[SAVED];

static int take(host *h, void **state) {
    void *c;
    return ASK(fmi2GetFMUstate(c, state), fmi3GetFMUState(c, state));
}
static int let_go(host *h, void **state) {
    void *c;
    return ASK(fmi2FreeFMUstate(c, state), fmi3FreeFMUState(c, state));
}
static size_t serialised(host *h, void *state, unsigned char **bytes) {
    size_t size = 0;
    void *c;
    expect(h, ASK(fmi2SerializedFMUstateSize(c, state, &size), fmi3SerializedFMUStateSize(c, state, &size)) == OK,
           "a state has a size");
    *bytes = malloc(size ? size : 1);
    if (!*bytes) exit(2);
    expect(h, ASK(fmi2SerializeFMUstate(c, state, (char *)*bytes, size), fmi3SerializeFMUState(c, state, *bytes, size)) == OK,
           "a state is serialised");
    return size;
}
static int deserialised(host *h, const unsigned char *bytes, size_t size, void **state) {
    void *c;
    return ASK(fmi2DeSerializeFMUstate(c, (const char *)bytes, size, state), fmi3DeserializeFMUState(c, bytes, size, state));
}

/* Serialise the whole state. */
static size_t look(host *h, unsigned char **bytes) {
    void *state = NULL;
    expect(h, take(h, &state) == OK, "a state is taken");
    const size_t size = serialised(h, state, bytes);
    expect(h, let_go(h, &state) == OK && !state, "a state is let go");
    return size;
}

static int save(host *h) {
    saved *const s = &kept[random_number(SAVED)];
    if (h->insane) {
        void *c;
        return ASK(fmi2GetFMUstate(c, NULL), fmi3GetFMUState(c, NULL));
    }
    if (s->state && s->face != h->face) (void)let_go(h, &s->state);
    const int status = take(h, &s->state);
    s->face = h->face;
    s->is = h->is;
    s->readable = can_read(h);
    if (s->readable) expect(h, read_outputs(h, s->output), "outputs are read where a state is saved");
    if (random_number(2)) return status;
    unsigned char *bytes = NULL;
    void *copy = NULL;
    const size_t size = serialised(h, s->state, &bytes);
    expect(h, deserialised(h, bytes, size, &copy) == OK, "a serialised state is read");
    expect(h, let_go(h, &s->state) == OK, "a state is let go");
    s->state = copy;
    free(bytes);
    return status;
}

/* Return whether two paths lead to the same bytes: a moved line file is still the same line. */
static int is_same_file(const char *one, const char *other) {
    if (strcmp(one, other) == 0) return 1;
    FILE *const a = fopen(one, "rb"), *const b = fopen(other, "rb");
    int same = a && b, letter = 0;
    while (same && letter != EOF) same = (letter = getc(a)) == getc(b);
    if (a) fclose(a);
    if (b) fclose(b);
    return same;
}

/* Check the restored mode, time, values, line and outputs. */
static void look_at_restored(host *h, const saved *s) {
    double output[MOST];
    expect(h, h->events || h->face != COSIMULATION_3 || s->is.state != EVENT, "event mode is for hosts that use it");
    const char *line = "";
    const unsigned vr = (unsigned)text_variable();
    if (text_variable() >= 0)
        expect(h, is_fine(get_text(h, &vr, 1, &line)) && is_same_file(line, s->is.line), "the line is that of the saved state");
    h->is = s->is;
    snprintf(h->is.line, sizeof h->is.line, "%s", line);
    ++restored;
    if (!s->readable) return;
    expect(h, read_outputs(h, output), "outputs are read behind a restore");
    for (int i = 0; i < output_count; ++i)
        expect(h, memcmp(&output[i], &s->output[i], sizeof *output) == 0, "outputs are those of the saved state");
}

static int restore(host *h) {
    const saved *const s = &kept[random_number(SAVED)];
    if (!h->insane && !s->state) return -1;
    h->insane |= s->state && s->face != h->face;
    void *const state = h->insane && (!s->state || s->face == h->face) ? NULL : s->state;
    h->excused = s->state && (strcmp(s->is.line, h->is.line) != 0 || (s->is.state == EVENT && !h->events));
    void *c;
    const int status = ASK(fmi2SetFMUstate(c, state), fmi3SetFMUState(c, state));
    if (is_fine(status) && !h->insane) look_at_restored(h, s);
    else if (!is_fine(status)) look_at_line(h);
    return status;
}

/* Deserialise fewer bytes, or more, from an allocation of that size, so that the sanitizer reports a read past its end. */
static int cut_to(host *h, const unsigned char *bytes, size_t whole, size_t size, void **state) {
    unsigned char *own = malloc(size ? size : 1);
    if (!own) exit(2);
    for (size_t i = 0; i < size; ++i) own[i] = i < whole ? bytes[i] : (unsigned char)random_number(256);
    const int status = deserialised(h, own, size, state);
    free(own);
    return status;
}

/* Restore or read a state with changed, missing or additional bytes, or with missing arguments. */
static int spoil_state(host *h) {
    unsigned char *bytes = NULL;
    void *state = NULL, *other = NULL;
    void *c;
    size_t size = 0;
    h->insane = 1;
    if (take(h, &state) != OK) return -1;
    const size_t whole = serialised(h, state, &bytes);
    int status = ERROR;
    switch (random_number(9)) {
    case 0:
        bytes[random_number((unsigned)whole)] ^= (unsigned char)(1 + random_number(255));
        status = deserialised(h, bytes, whole, &other);
        break;
    case 1: status = cut_to(h, bytes, whole, random_number((unsigned)whole), &other); break;
    case 6: status = cut_to(h, bytes, whole, whole + 1 + random_number(64), &other); break;
    case 7:
        ((unsigned char *)state)[random_number((unsigned)whole)] ^= (unsigned char)(1u << random_number(8));
        status = ASK(fmi2SetFMUstate(c, state), fmi3SetFMUState(c, state));
        break;
    case 2: status = deserialised(h, random_number(2) ? NULL : bytes, 0, &other); break;
    case 8: status = deserialised(h, bytes, random_number(2) ? ~(size_t)0 : whole + (1u << 31), &other); break;
    case 3: status = ASK(fmi2SerializedFMUstateSize(c, NULL, &size), fmi3SerializedFMUStateSize(c, NULL, &size)); break;
    case 4:
        status =
            ASK(fmi2SerializeFMUstate(c, state, (char *)bytes, whole - 1), fmi3SerializeFMUState(c, state, bytes, whole - 1));
        break;
    default: status = ASK(fmi2SerializeFMUstate(c, NULL, (char *)bytes, whole), fmi3SerializeFMUState(c, state, NULL, whole));
    }
    free(bytes);
    expect(h, !is_fine(status) || other, "a state that was read is there");
    (void)let_go(h, &state);
    if (other) (void)let_go(h, &other);
    return status;
}

static int free_state(host *h) {
    saved *const s = &kept[random_number(SAVED)];
    void *nothing = NULL;
    h->insane = 0;
    if (random_number(2)) return let_go(h, random_number(2) ? &nothing : NULL);
    const int status = let_go(h, &s->state);
    expect(h, !s->state, "a state that was let go is gone");
    return status;
}

/* ---- the tables ---- */

/* Allowed calls by state: + succeeds with valid arguments, - is refused, o may do either, . marks a state that the interface
 * does not have. Columns: instantiated, initialization, event, continuous-time, step (FMI 2.0: stepComplete), failed (FMI
 * 2.0: stepFailed), ended (an event or step has requested termination), terminated. Source: tables of FMI 2.0.4, sections
 * 4.2.4 and 3.2.3, and allowed calls of the states of FMI 3.0.2, sections 2.3, 3.2 and 4.2. Reasons for an o:
 * - FMI 2.0 has no values before initialization. Within it, parameters and inputs are not listed. FMI 3.0 has both.
 * - Inputs have no `initial` in FMI 2.0. The table forbids to set them before initialization, but most hosts do.
 * - A fixed parameter, number or text, may be set again to its value.
 * - Time in event mode belongs to discrete FMUs (FMI 2.0.4, footnote 8).
 * - After a request to terminate, the standards describe only the call that terminates. */
static const call CALLS[] = {
    /*                              FMI 2.0 CS  FMI 2.0 ME  FMI 3.0 CS  FMI 3.0 ME
     *                              INECSFDT    INECSFDT    INECSFDT    INECSFDT */
    {"set logging", set_logging, {"++..++.+", "++++..++", "+++.+.++", "++++..++"}, NOTHING},
    {"setup experiment", setup_experiment, {"+-..--.-", "+---..--", NULL, NULL}, NOTHING},
    {"enter initialization", enter_initialization, {"+-..--.-", "+---..--", "+--.-.--", "+---..--"}, NOTHING},
    {"exit initialization", exit_initialization, {"-+..--.-", "-+--..--", "-+-.-.--", "-+--..--"}, NOTHING},
    {"terminate", terminate, {"--..++.-", "--++..+-", "--+.+.+-", "--++..+-"}, NOTHING},
    {"reset", reset, {"++..++.+", "++++..++", "+++.+.++", "++++..++"}, NOTHING},
    {"get outputs", get_output, {"-+..++.+", "-+++..++", "o++.+.++", "o+++..++"}, NOTHING},
    {"get inputs and parameters", get_given, {"oo..++.+", "oo++..++", "+++.+.++", "++++..++"}, NOTHING},
    {"get time", get_time, {NULL, NULL, "+++.+.++", "++++..++"}, NOTHING},
    {"get string", get_string, {"oo..++.+", "oo++..++", "+++.+.++", "++++..++"}, NOTHING},
    {"set parameters", set_parameter, {"++..oo.o", "++oo..oo", "++o.o.oo", "++oo..oo"}, NOTHING},
    {"set string", set_string, {"++..oo.o", "++oo..oo", "++o.o.oo", "++oo..oo"}, NOTHING},
    {"set inputs", set_input, {"o+..+-.-", "o+++..o-", "+++.+.o-", "++++..o-"}, NOTHING},
    {"set discrete inputs", set_discrete_input, {"o+..+-.-", "o++-..o-", "+++.+.o-", "+++-..o-"}, NOTHING},
    {"set outputs", set_output, {"--..--.-", "----..--", "---.-.--", "----..--"}, NOTHING},
    {"save", save, {"++..++.+", "++++..++", "+++.+.++", "++++..++"}, NOTHING},
    {"restore", restore, {"++..++.+", "++++..++", "+++.+.++", "++++..++"}, NOTHING},
    {"restore what was spoilt", spoil_state, {"++..++.+", "++++..++", "+++.+.++", "++++..++"}, NOTHING},
    {"free a state", free_state, {"++..++.+", "++++..++", "+++.+.++", "++++..++"}, NOTHING},
    {"get directional derivatives", get_directional, {"-+..++.+", "-+++..++", "-++.+.++", "-+++..++"}, DIRECTIONAL},
    {"set input derivatives", set_rates, {"++..+-.-", "----..--", NULL, NULL}, RATES_IN},
    {"get output derivatives", get_rates, {"--..++.+", "----..--", "--o.+.++", "----..--"}, RATES_OUT},
    {"do step", do_step, {"--..+-.-", "----..--", "---.+.--", "----..--"}, NOTHING},
    {"cancel step", cancel_step, {"--..--.-", "----..--", NULL, NULL}, NOTHING},
    {"get status", ask_status, {"--..++.+", "----..--", NULL, NULL}, NOTHING},
    {"enter event mode", enter_event, {"--..--.-", "--++..o-", "---.+.o-", "---+..o-"}, NOTHING},
    {"enter continuous-time mode", enter_continuous, {"--..--.-", "--+-..o-", "---.-.--", "--+-..o-"}, NOTHING},
    {"enter step mode", enter_step, {NULL, NULL, "--+.-.o-", "----..--"}, NOTHING},
    {"update discrete states", update, {"--..--.-", "--+-..o-", "--+.-.o-", "--+-..o-"}, NOTHING},
    {"completed integrator step", complete_step, {"--..--.-", "---+..o-", "---.-.--", "---+..o-"}, NOTHING},
    {"set time", set_time, {"--..--.-", "--o+..o-", "---.-.--", "--o+..o-"}, NOTHING},
    {"set continuous states", set_states, {"--..--.-", "---+..o-", "---.-.--", "---+..o-"}, NOTHING},
    {"get continuous states", get_states, {"--..--.-", "-+++..++", "---.-.--", "-+++..++"}, NOTHING},
    {"get derivatives", get_slopes, {"--..--.-", "-+++..++", "---.-.--", "-+++..++"}, NOTHING},
    {"get event indicators", get_indicators, {"--..--.-", "-+++..++", "---.-.--", "-+++..++"}, NOTHING},
    {"get nominals", get_nominals, {"--..--.-", "++++..++", "---.-.--", "o+++..++"}, NOTHING},
    {"what no object has", call_absent, {NULL, NULL, "---.-.--", "----..--"}, NOTHING},
    {"get numbers of states and indicators", get_sizes, {NULL, NULL, "---.-.--", "+o+o..oo"}, NOTHING},
};
enum { CALL_COUNT = sizeof CALLS / sizeof *CALLS };

static char rule_of(const host *h, const call *what) {
    if (!able[what->needs] || (what->act == enter_event && h->face == COSIMULATION_3 && !h->events)) return '-';
    return what->rule[h->face][h->is.state];
}

/* Compare the status of a call with its rule. */
static void judge(host *h, int status) {
    if (h->rule == '-') expect(h, status == ERROR, "a forbidden call is an error");
    else if (h->insane) expect(h, status > WARNING, "insane arguments are refused");
    else if (h->rule == '+' && !h->excused) expect(h, is_fine(status), "an allowed call succeeds");
    refused += status == ERROR;
    made[h->rule == '-' ? FORBIDDEN : h->insane ? INSANE : ALLOWED]++;
}

/* Make one call. In a tenth of the calls, check that a refused call leaves the whole state unchanged. */
static void make(host *h, const call *what) {
    unsigned char *before = NULL, *behind = NULL;
    double settled[MOST]; /* outputs are read first, since reading may finish postponed evaluations */
    const int watched = one_in(10) && !(h->calls_back && h->is.state == INITIALIZATION);
    h->now = what;
    h->rule = rule_of(h, what);
    h->insane = h->excused = 0;
    if (watched && h->is.state != INSTANTIATED) (void)read_outputs(h, settled);
    const size_t size = watched ? look(h, &before) : 0;
    h->insane = one_in(6);
    const int no_start = h->is.state == INITIALIZATION && !can_read(h); /* the call may solve for the start first, and fail */
    const int status = what->act(h);
    h->excused |= no_start;
    if (status >= 0) judge(h, status);
    if (watched && status > WARNING && h->is.state == INITIALIZATION) (void)read_outputs(h, settled);
    if (watched && status > WARNING && h->is.state != FAILED)
        expect(h, look(h, &behind) == size && memcmp(before, behind, size) == 0, "what is refused leaves the state");
    free(before);
    free(behind);
}

/* ---- instances ---- */

static void instantiate(host *h, int face) {
    memset(h, 0, sizeof *h);
    be_new(h);
    h->face = face;
    const int events = (int)random_number(2), early = (int)random_number(2);
    h->events = face == COSIMULATION_3 && events && able[EVENTS];
    h->early = face == COSIMULATION_3 && early && able[EVENTS];
    h->quiet = one_in(5);
    h->calls_back = !h->quiet && one_in(5);
    const int logging = random_number(3) > 0;
    h->must_hear = logging ? 15 : 0;
    h->may_hear = logging || face <= EXCHANGE_2 ? 15 : 0; /* FMI 2.0, section 2.1.3: errors are logged in any case */
    const fmi2CallbackFunctions callbacks = {h->quiet ? NULL : hear2, calloc, free, NULL, h};
    const fmi3LogMessageCallback listener = h->quiet ? NULL : hear3;
    if (face <= EXCHANGE_2)
        h->instance = fmi2Instantiate("machine", face == EXCHANGE_2 ? fmi2ModelExchange : fmi2CoSimulation, OBJECT.token(),
                                      resources, &callbacks, fmi2False, logging);
    else if (face == EXCHANGE_3)
        h->instance = fmi3InstantiateModelExchange("machine", OBJECT.token(), resources, false, logging, h, listener);
    else
        h->instance = fmi3InstantiateCoSimulation("machine", OBJECT.token(), resources, false, logging, events, early, NULL, 0,
                                                  h, listener, NULL);
}

static void free_instance(host *h) {
    if (is_three(h)) fmi3FreeInstance(h->instance);
    else fmi2FreeInstance(h->instance);
    h->instance = NULL;
}

/* Return a call that leads to the next state, since random calls alone rarely get there. */
static const call *way_on(const host *h) {
    static int (*const on[8][4])(host *) = {{enter_initialization, enter_initialization, set_string, set_parameter},
                                            {exit_initialization, exit_initialization, exit_initialization, set_input},
                                            {update, enter_continuous, enter_step, enter_step},
                                            {set_time, set_states, complete_step, enter_event},
                                            {do_step, do_step, do_step, set_input},
                                            {reset, restore, terminate, reset},
                                            {reset, restore, terminate, reset},
                                            {reset, restore, reset, reset}};
    int (*const act)(host *) = on[h->is.state][random_number(4)];
    for (int i = 0; i < CALL_COUNT; ++i)
        if (CALLS[i].act == act) return &CALLS[i];
    return NULL;
}

static void play(host *h) {
    const call *what = random_number(3) ? &CALLS[random_number(CALL_COUNT)] : way_on(h);
    if (!what->rule[h->face]) return;
    const int ends_life = what->act == reset || what->act == terminate;
    if (ends_life && h->is.state < FAILED && rule_of(h, what) == '+' && random_number(15)) return;
    make(h, what);
}

/* Find the elements and the features of an object. */
static void look_at_object(const char *folder) {
    char problem[MESSAGE_SIZE];
    fmu_object *const one = OBJECT.make(*folder ? folder : NULL, 0, problem);
    if (!one || OBJECT.reset(one) > KERNEL_WARNING) exit(2);
    for (unsigned v = 0; v < OBJECT.variables(); ++v) {
        const size_t length = OBJECT.length(one, v);
        if (length > LONGEST) exit(2);
        for (size_t k = 0; k < length && count < MOST; ++k) {
            element *const e = &elements[count++];
            *e = (element){OBJECT.variable(v), v, (unsigned)k, length, 0.0, 0.0, 0.0, 0};
            if (e->about->causality < CAUSALITY_OUTPUT && e->about->kind != KIND_STRING)
                (void)OBJECT.get(one, v, k, 1, &e->start);
        }
    }
    OBJECT.dispose(one);
    for (int i = 0; i < count; ++i)
        if (elements[i].about->causality == CAUSALITY_OUTPUT) outputs[output_count++] = i;
    const int found[ABILITIES] = {1, OBJECT.stop_at_events != NULL, OBJECT.set_rates != NULL, OBJECT.get_rates != NULL,
                                  OBJECT.get_directional != NULL};
    memcpy(able, found, sizeof able);
}

static void read_word(char *word) {
    char *value = strrchr(word, '='), *other = strchr(word, '>');
    if (!value || strchr(word, '/')) {
        line_files[lines++] = word;
        return;
    }
    *value++ = '\0';
    char *end = strchr(value, ':');
    if (other) {
        *other++ = '\0';
        pair.input = named(word), pair.output = named(other), pair.share = atof(value);
    } else if (strcmp(word, "off") == 0) {
        *end++ = '\0';
        off.place = named(value), off.value = atof(end);
    } else {
        for (int i = 0; i < count; ++i)
            if (strcmp(elements[i].about->name, word) == 0)
                elements[i].played = 1, elements[i].least = atof(value), elements[i].most = atof(end + 1);
    }
}

static void *birth(host *h, int face, const char *name, const char *token, const char *folder) {
    memset(h, 0, sizeof *h);
    be_new(h);
    born = name ? name : "";
    h->face = face, h->may_hear = 15;
    const fmi2CallbackFunctions callbacks = {hear2, calloc, free, NULL, h};
    if (face <= EXCHANGE_2)
        return fmi2Instantiate(name, face == EXCHANGE_2 ? fmi2ModelExchange : fmi2CoSimulation, token, folder, &callbacks, 0,
                               0);
    if (face == EXCHANGE_3) return fmi3InstantiateModelExchange(name, token, folder, false, true, h, hear3);
    return fmi3InstantiateCoSimulation(name, token, folder, false, true, false, false, NULL, 0, h, hear3, NULL);
}

/* Wrong arguments of an instantiation give no instance and one error message. */
static void expect_no_birth(int face, const char *name, const char *token, const char *folder, const char *what) {
    host h;
    void *const wrong = birth(&h, face, name, token, folder);
    expect(&h, !wrong && h.heard[ERROR] == 1, what);
    born = "machine";
}

static void look_at_births(int face) {
    host h;
    expect_no_birth(face, "machine", "another", resources, "another's token gives no instance");
    expect_no_birth(face, "machine", NULL, resources, "no token gives no instance");
    expect_no_birth(face, "", OBJECT.token(), resources, "an empty name gives no instance");
    expect_no_birth(face, NULL, OBJECT.token(), resources, "no name gives no instance");
    if (!states_of())
        expect_no_birth(face ^ 1, "machine", OBJECT.token(), resources,
                        "what has no states gives no instance of model exchange");
    if (*resources) {
        expect_no_birth(face, "machine", OBJECT.token(), NULL, "no folder gives no instance of what is made of files");
        expect_no_birth(face, "machine", OBJECT.token(), face <= EXCHANGE_2 ? "file:///nowhere" : "/nowhere",
                        "nor does a wrong one");
    } else {
        expect(&h, (h.instance = birth(&h, face, "machine", OBJECT.token(), NULL)) != NULL,
               "what has no files needs no folder");
        free_instance(&h);
    }
    memset(&h, 0, sizeof h);
    expect(&h, !fmi2Instantiate("machine", fmi2CoSimulation, OBJECT.token(), "", NULL, 0, 0), "no callbacks");
    expect(&h,
           !fmi3InstantiateScheduledExecution("machine", OBJECT.token(), resources, false, false, NULL, NULL, NULL, NULL, NULL),
           "no object has scheduled execution");
}

/* Without an instance every call fails and none crashes. */
static void look_at_nothing(int face) {
    for (int i = 0; i < CALL_COUNT; ++i)
        for (int times = 0; times < 20 && CALLS[i].rule[face]; ++times) {
            host h;
            memset(&h, 0, sizeof h);
            be_new(&h);
            h.face = face, h.quiet = 1, h.insane = times & 1;
            h.now = &CALLS[i], h.rule = '-';
            if (CALLS[i].act == spoil_state || CALLS[i].act == save || CALLS[i].act == call_absent) h.insane = 1;
            const int status = CALLS[i].act(&h);
            expect(&h, status == ERROR || status < 0, "without an instance a call is an error");
        }
    fmi2FreeInstance(NULL);
    fmi3FreeInstance(NULL);
}

int main(int argc, char **argv) {
    if (argc < 5) return 2;
    const int face = atoi(argv[1]);
    char uri[4096] = "";
    random_state = strtoull(argv[2], NULL, 10) * 2654435761u + 88172645463325252ull;
    const long long calls = atoll(argv[3]);
    if (*argv[4]) snprintf(uri, sizeof uri, "%s%s", face <= EXCHANGE_2 ? "file://" : "", argv[4]);
    resources = uri;
    look_at_object(argv[4]);
    for (int i = 5; i < argc; ++i) read_word(argv[i]);
    look_at_births(face);
    look_at_nothing(face);
    static host hosts[HOSTS];
    while (made[ALLOWED] + made[FORBIDDEN] + made[INSANE] < calls) {
        const unsigned which = random_number(HOSTS);
        host *const h = &hosts[which];
        /* The last instance may have the other interface; it refuses the saved states of the first. */
        const int other = which == HOSTS - 1 && one_in(4) && states_of();
        if (h->instance && one_in(800)) free_instance(h);
        if (!h->instance) instantiate(h, other ? face ^ 1 : face);
        if (!h->instance) return 2;
        play(h);
    }
    for (int i = 0; i < SAVED; ++i) (void)let_go(&hosts[0], &kept[i].state);
    for (int i = 0; i < HOSTS; ++i) free_instance(&hosts[i]);
    printf("%lld allowed, %lld forbidden, %lld insane, %lld steps, %lld restored, ", made[ALLOWED], made[FORBIDDEN],
           made[INSANE], done_steps, restored);
    printf("%lld refused, %lld ends, %lld discarded, %lld early, %lld places, %lld broken\n", refused, ends, discarded,
           early_returns, places, broken);
    return broken != 0;
}
