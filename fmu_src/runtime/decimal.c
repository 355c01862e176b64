/* Read numbers as files write them, with a point or a comma, in any locale of the host. Correctly rounded, as Python's
 * float. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "table_file.h"

enum {
    MOST_DIGITS = 780,        /* more cannot decide where a number is rounded: 767 significant ones are the most */
    LARGEST_EXPONENT = 100000 /* of a file; beyond it a number of a row's length is infinite or 0 */
};

static const double POWER_OF_TEN[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                      1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

/* A number in decimal writing: digits times ten to an exponent. */
typedef struct {
    unsigned long long whole; /* of the first 19 digits */
    int count, exponent;      /* of all digits after leading zeros; of ten */
    char mark;                /* the decimal mark; 0: none */
    const char *first, *end;  /* of those digits, the mark may be among them */
} decimal;

/* A sign: also the minus of typographers, U+2212. */
static const char *read_sign(const char *text, bool *negative) {
    *negative = *text == '-';
    if (*text == '-' || *text == '+') return text + 1;
    if (strncmp(text, "\xE2\x88\x92", 3) != 0) return text;
    *negative = true;
    return text + 3;
}

/* Read digits on one side of the mark; return the place after them. */
static const char *digits_of_part(const char *text, decimal *found) {
    unsigned long long whole = found->whole;
    int count = found->count;
    if (!count) {
        while (*text == '0') ++text;
        found->first = text;
    }
    for (unsigned digit; (digit = (unsigned)(*text - '0')) < 10; ++text)
        if (count++ < 19) whole = 10 * whole + digit;
    found->whole = whole;
    found->count = count;
    return text;
}

static const char *read_digits(const char *text, decimal *found) {
    const char *end = digits_of_part(text, found);
    bool any = end > text;
    if (*end == '.' || *end == ',') {
        found->mark = *end;
        text = end + 1;
        end = digits_of_part(text, found);
        found->exponent = (int)(text - end);
        any |= end > text;
    }
    found->end = end;
    return any ? end : NULL;
}

static const char *read_exponent(const char *text, decimal *found) {
    if (*text != 'e' && *text != 'E') return text;
    bool down;
    int own = 0;
    text = read_sign(text + 1, &down);
    if (*text < '0' || *text > '9') return NULL;
    for (; *text >= '0' && *text <= '9'; ++text)
        if (own < LARGEST_EXPONENT) own = 10 * own + *text - '0';
    found->exponent += down ? -own : own;
    return text;
}

/* Compute whole / 10^-exponent as a sum of two doubles, Dekker (1971); return whether its error cannot change the rounding. */
static bool quotient(const decimal *found, double *size) {
    const double divisor = POWER_OF_TEN[-found->exponent], split = 134217729.0; /* 2^27 + 1 */
    const double high = (double)found->whole;
    const long long below = (long long)(found->whole - (unsigned long long)high);
    const double first = high / divisor, product = first * divisor;
    const double first_up = split * first - (split * first - first), first_down = first - first_up;
    const double divisor_up = split * divisor - (split * divisor - divisor), divisor_down = divisor - divisor_up;
    const double lost =
        ((first_up * divisor_up - product) + first_up * divisor_down + first_down * divisor_up) + first_down * divisor_down;
    const double second = (((high - product) - lost) + (double)below) / divisor, error = first * 0x1p-98;
    *size = first + second;
    return first + (second - error) == first + (second + error);
}

/* Convert with the C library; all digits are before the decimal mark, so the locale does not matter. */
static double by_library(const decimal *found) {
    char text[MOST_DIGITS + 16];
    int used = 0, left = found->count;
    bool more = false;
    for (const char *c = found->first; c < found->end; ++c) {
        if (*c < '0' || *c > '9') continue;
        if (used < MOST_DIGITS) {
            text[used++] = *c;
            --left;
        }
        more |= left && used == MOST_DIGITS && *c != '0';
    }
    if (!used) return 0.0;
    if (more && text[used - 1] == '0') text[used - 1] = '1'; /* the number is larger than its first digits */
    snprintf(text + used, sizeof text - (size_t)used, "e%d", found->exponent + left);
    return strtod(text, NULL);
}

bool table_read_number(const char *text, double *value, char *mark) {
    decimal found;
    bool negative;
    memset(&found, 0, sizeof found);
    text = read_digits(read_sign(text, &negative), &found);
    if (text) text = read_exponent(text, &found);
    if (!text || *text) return false;
    const bool whole = found.count <= 19, few = whole && found.whole <= 1ull << 53;
    double size = 0.0;
    if (few && found.exponent >= -22 && found.exponent < 0) /* Clinger (1990): of two exact numbers */
        size = (double)found.whole / POWER_OF_TEN[-found.exponent];
    else if (few && found.exponent >= 0 && found.exponent <= 22) size = (double)found.whole * POWER_OF_TEN[found.exponent];
    else if (!whole || found.exponent < -22 || found.exponent >= 0 || !quotient(&found, &size)) size = by_library(&found);
    *value = negative ? -size : size;
    *mark = found.mark;
    return true;
}
