/* Formatted text with a decimal point in every locale of the host: the C library's functions write the point of the locale. */
#ifndef PRINT_TEXT_H
#define PRINT_TEXT_H

#include "variable.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

enum { LONGEST_CONVERSION = 32, LONGEST_NUMBER = 400 };

/* Replace the locale's decimal point, of one or several bytes, in a number. */
static inline void print_point(char *number) {
    char *to = number;
    for (const char *from = number; *from; ++from) {
        if (strchr("+-. ", *from) || (*from >= '0' && *from <= '9') || (*from >= 'A' && *from <= 'z')) *to++ = *from;
        else if (to == number || to[-1] != '.') *to++ = '.';
    }
    *to = '\0';
}

/* Copy the flags, width and precision of a conversion, with * replaced by its argument; return the place of its length. */
static inline const char *print_flags(const char *format, char *conversion, size_t *length, va_list *arguments) {
    for (; *format && strchr("-+ #0123456789.*", *format); ++format) {
        if (*format != '*') conversion[(*length)++] = *format;
        else *length += (size_t)snprintf(conversion + *length, 12, "%d", va_arg(*arguments, int));
        if (*length > LONGEST_CONVERSION - 16) break;
    }
    return format;
}

/* Kind and length of a conversion, such as d and 2 for lld; z has the length -1. */
typedef struct {
    char kind;
    int length;
} print_kind;

static inline const char *print_kind_of(const char *format, print_kind *found) {
    found->length = 0;
    for (; *format == 'l'; ++format) found->length++;
    if (*format == 'z') found->length = -1, ++format;
    found->kind = *format ? *format++ : 's';
    return format;
}

static inline long long print_signed(int length, va_list *arguments) {
    return length > 1 ? va_arg(*arguments, long long) : length == 1 ? va_arg(*arguments, long) : va_arg(*arguments, int);
}

static inline unsigned long long print_unsigned(int length, va_list *arguments) {
    if (length < 0) return va_arg(*arguments, size_t);
    return length > 1    ? va_arg(*arguments, unsigned long long)
           : length == 1 ? va_arg(*arguments, unsigned long)
                         : va_arg(*arguments, unsigned);
}

/* Write one conversion, `behind` characters of which are known; return the length of its text. */
static inline int print_one(char *end, size_t left, char *conversion, size_t behind, print_kind is, va_list *arguments) {
    char number[LONGEST_NUMBER];
    if (strchr("dux", is.kind)) conversion[behind] = conversion[behind + 1] = 'l', behind += 2;
    conversion[behind] = is.kind;
    if (is.kind == 'd') return snprintf(end, left, conversion, print_signed(is.length, arguments));
    if (is.kind == 'u' || is.kind == 'x') return snprintf(end, left, conversion, print_unsigned(is.length, arguments));
    if (is.kind == 'c') return snprintf(end, left, conversion, va_arg(*arguments, int));
    if (is.kind == 's') return snprintf(end, left, conversion, va_arg(*arguments, const char *));
    snprintf(number, sizeof number, conversion, va_arg(*arguments, double));
    print_point(number);
    return snprintf(end, left, "%s", number);
}

/* This is vsnprintf for the conversions d, u, x, s, c, g, e and f, with the lengths l, ll and z. */
static inline int print_list(char *text, size_t size, const char *format, va_list given) {
    size_t used = 0;
    va_list arguments;
    va_copy(arguments, given);
    if (size) *text = '\0';
    while (*format) {
        char conversion[LONGEST_CONVERSION] = "%";
        const size_t left = used < size ? size - used : 0, plain = strcspn(format, "%");
        char *const end = left ? text + used : NULL;
        if (plain || format[1] == '%') {
            used += (size_t)snprintf(end, left, "%.*s", (int)(plain ? plain : 1), format);
            format += plain ? plain : 2;
            continue;
        }
        size_t behind = 1;
        print_kind is;
        format = print_flags(format + 1, conversion, &behind, &arguments);
        format = print_kind_of(format, &is);
        used += (size_t)print_one(end, left, conversion, behind, is, &arguments);
    }
    va_end(arguments);
    return (int)used;
}

/* This is snprintf for the same conversions. */
static inline int print_text(char *text, size_t size, const char *format, ...) LIKE_PRINTF(3);
static inline int print_text(char *text, size_t size, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    const int length = print_list(text, size, format, arguments);
    va_end(arguments);
    return length;
}

#endif
