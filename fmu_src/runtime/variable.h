/* A variable as faces and objects describe it. */
#ifndef VARIABLE_H
#define VARIABLE_H

#include <stdbool.h>
#include <stddef.h>

/* Names that files share: local to the one unit that all.c makes of them, and otherwise between them. */
#ifdef ONE_UNIT
#define RUNTIME_LOCAL static
#else
#define RUNTIME_LOCAL
#endif

/* For a function whose nth argument is a format, with values after it: compilers check that they fit. */
#if defined(__GNUC__) && !defined(_WIN32)
#define LIKE_PRINTF(nth) __attribute__((format(printf, nth, nth + 1)))
#else
#define LIKE_PRINTF(nth)
#endif

enum { KIND_REAL, KIND_INTEGER, KIND_BOOLEAN, KIND_STRING }; /* the last: a path, see kernel_set_text */
enum { CAUSALITY_PARAMETER, CAUSALITY_INPUT, CAUSALITY_OUTPUT, CAUSALITY_LOCAL }; /* the last: a state */

typedef struct {
    const char *name;
    const char *unit;
    int kind, causality;
    double start, minimum, maximum;
    double when_lost; /* value for the equations when a NaN arrives; NaN: a NaN is refused */
} variable_description;

/* Return the reason why a variable cannot be set, to follow its name in a message; NULL if it can. */
static inline const char *why_fixed(const variable_description *variable, bool begun) {
    if (variable->causality == CAUSALITY_OUTPUT) return "is an output and cannot be set; read it instead.";
    if (variable->causality == CAUSALITY_LOCAL) return "is a state and cannot be set; read it instead.";
    const bool fixed = begun && variable->causality == CAUSALITY_PARAMETER;
    return fixed ? "is a parameter and fixed once the run has begun; reset first." : NULL;
}

#endif
