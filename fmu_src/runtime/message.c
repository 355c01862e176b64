/* Sentences, each with its status: the last one, and the journal of those that the face has not heard yet. What they quote
 * may come from anyone, so it is never a format, and a sentence is valid UTF-8 on one line, also where it was cut. */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "internal.h"

static const char CUT[] = "..."; /* at the end of a sentence that was too long */

/* Bytes of the letter that begins here; 0: it is none, or steers a terminal. Unicode 15, table 3-7. */
static size_t length_of_letter(const unsigned char *c) {
    if (c[0] < 0x80) return c[0] >= ' ' && c[0] != 0x7F;
    if (c[0] < 0xC2 || c[0] > 0xF4) return 0;
    const size_t length = c[0] < 0xE0 ? 2 : c[0] < 0xF0 ? 3 : 4;
    const unsigned char lowest = c[0] == 0xE0 ? 0xA0 : c[0] == 0xF0 ? 0x90 : 0x80;
    const unsigned char highest = c[0] == 0xED ? 0x9F : c[0] == 0xF4 ? 0x8F : 0xBF;
    if (c[1] < lowest || c[1] > highest) return 0;
    for (size_t i = 2; i < length; ++i)
        if (c[i] < 0x80 || c[i] > 0xBF) return 0;
    return length;
}

/* What is no letter becomes a question mark. */
void kernel_make_readable(char *text) {
    for (unsigned char *c = (unsigned char *)text; *c;) {
        const size_t length = length_of_letter(c);
        if (!length) *c = '?';
        c += length ? length : 1;
    }
}

/* Where a sentence is too long, its last whole letters give way. */
static void mark_cut(char text[MESSAGE_SIZE]) {
    char *end = text + MESSAGE_SIZE - sizeof CUT;
    for (int i = 0; i < 3 && ((unsigned char)*end & 0xC0) == 0x80; ++i) --end;
    memcpy(end, CUT, sizeof CUT);
}

static size_t behind_record(const kernel *self, size_t at) { return at + strlen(self->journal + at + 1) + 2; }

/* Drops what was heard, and then the oldest of what nobody heard, until there is room. */
static void make_room(kernel *self, size_t needed) {
    size_t dropped = self->heard;
    while (self->journal_length - dropped + needed > JOURNAL_SIZE) {
        dropped = behind_record(self, dropped);
        self->lost++;
    }
    memmove(self->journal, self->journal + dropped, self->journal_length - dropped);
    self->journal_length -= dropped;
    self->heard = 0;
}

static void note(kernel *self, int status, const char *sentence) {
    const size_t needed = strlen(sentence) + 2;
    if (self->journal_length + needed > JOURNAL_SIZE) make_room(self, needed);
    char *record = self->journal + self->journal_length;
    record[0] = (char)status;
    memcpy(record + 1, sentence, needed - 1);
    self->journal_length += needed;
    self->noted++;
}

static void write_sentence(char text[MESSAGE_SIZE], const char *format, va_list arguments) {
    if (vsnprintf(text, MESSAGE_SIZE, format, arguments) >= MESSAGE_SIZE) mark_cut(text);
    kernel_make_readable(text);
}

void kernel_note(kernel *self, int status, const char *format, ...) {
    char sentence[MESSAGE_SIZE];
    va_list arguments;
    va_start(arguments, format);
    write_sentence(sentence, format, arguments);
    va_end(arguments);
    note(self, status, sentence);
}

int kernel_fail(kernel *self, int status, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    write_sentence(self->message, format, arguments);
    va_end(arguments);
    note(self, status, self->message);
    return status;
}

int kernel_say_when(kernel *self, int status, const char *sentence, const char *when) {
    const char *place = strstr(sentence, "%s");
    if (!place) return kernel_fail(self, status, "%s", sentence);
    return kernel_fail(self, status, "%.*s%s%s", (int)(place - sentence), sentence, when, place + 2);
}

void kernel_take_back(kernel *self, unsigned long long noted) {
    unsigned long long newer = self->noted - noted, unheard = 0;
    for (size_t at = self->heard; at < self->journal_length; at = behind_record(self, at)) ++unheard;
    size_t end = self->heard;
    for (; unheard > newer; --unheard) end = behind_record(self, end);
    self->journal_length = end;
    self->noted = noted;
}

const char *kernel_hear(kernel *self, int *status) {
    if (self->lost) {
        snprintf(self->told_of_loss, sizeof self->told_of_loss, "%llu earlier sentences were lost: nobody heard them.",
                 self->lost);
        self->lost = 0;
        *status = KERNEL_WARNING;
        return self->told_of_loss;
    }
    if (self->heard == self->journal_length) {
        self->heard = self->journal_length = 0;
        return NULL;
    }
    const char *record = self->journal + self->heard;
    self->heard = behind_record(self, self->heard);
    *status = record[0];
    return record + 1;
}

/* Unix time has ten digits before the point: then three (of 6) or six (of 9) remain behind it. */
const char *kernel_clock(double time, int digits, char text[CLOCK_SIZE]) {
    const int before = fabs(time) >= 1e3 && fabs(time) < 1e18 ? 1 + (int)log10(fabs(time)) : 3;
    const int all = before + digits - 3;
    snprintf(text, CLOCK_SIZE, "%.*g", all < 24 ? all : 24, time);
    return text;
}
