/* Sentences: the last one, and the journal of all of them until a face drains it. */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "internal.h"

void kernel_note(kernel *self, int status, const char *format, ...) {
    char line[MESSAGE_SIZE];
    va_list arguments;
    va_start(arguments, format);
    int length = snprintf(line, sizeof line, "%d ", status);
    vsnprintf(line + length, sizeof line - (size_t)length, format, arguments);
    va_end(arguments);
    const size_t needed = strlen(line) + 1;
    if (self->journal_length + needed >= JOURNAL_SIZE) return; /* nobody drains it: the oldest lines are kept */
    memcpy(self->journal + self->journal_length, line, needed - 1);
    self->journal[self->journal_length + needed - 1] = '\n';
    self->journal_length += needed;
    self->journal[self->journal_length] = '\0';
}

int kernel_fail(kernel *self, int status, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(self->message, sizeof self->message, format, arguments);
    va_end(arguments);
    kernel_note(self, status, "%s", self->message);
    return status;
}

/* Unix time has ten digits before the point: then three (of 6) or six (of 9) remain behind it. */
const char *kernel_clock(double time, int digits, char text[CLOCK_SIZE]) {
    const int before = fabs(time) >= 1e3 && fabs(time) < 1e18 ? 1 + (int)log10(fabs(time)) : 3;
    const int all = before + digits - 3;
    snprintf(text, CLOCK_SIZE, "%.*g", all < 24 ? all : 24, time);
    return text;
}

const char *kernel_journal(kernel *self) {
    if (self->journal_length == 0) return "";
    self->journal_length = 0; /* the text stays until the next note */
    return self->journal;
}
