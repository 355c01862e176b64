/* Messages, each with its status: the last one, and the log of those that the interface has not read yet. Text that they quote
 * may come from anyone, so it is never used as a format. A message is valid UTF-8 on one line, also if it was cut. */
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "instance.h"
#include "readable.h"

static const char CUT[] = "..."; /* at the end of a message that was too long */

/* Replace the last whole letters of a message that is too long. */
static void mark_cut(char text[MESSAGE_SIZE]) {
    char *end = text + MESSAGE_SIZE - sizeof CUT;
    for (int i = 0; i < 3 && ((unsigned char)*end & 0xC0) == 0x80; ++i) --end;
    memcpy(end, CUT, sizeof CUT);
}

static size_t behind_record(const message_log *kept, size_t at) { return at + strlen(kept->record + at + 1) + 2; }

/* Drop messages that were read, and then the oldest unread ones, until there is room. */
static void make_room(message_log *kept, size_t needed) {
    size_t dropped = kept->heard;
    while (kept->length - dropped + needed > MESSAGE_LOG_SIZE) {
        dropped = behind_record(kept, dropped);
        kept->lost++;
    }
    memmove(kept->record, kept->record + dropped, kept->length - dropped);
    kept->length -= dropped;
    kept->heard = 0;
}

static void note(message_log *kept, kernel_status status, const char *sentence) {
    const size_t needed = strlen(sentence) + 2;
    if (kept->length + needed > MESSAGE_LOG_SIZE) make_room(kept, needed);
    char *record = kept->record + kept->length;
    record[0] = (char)status;
    memcpy(record + 1, sentence, needed - 1);
    kept->length += needed;
    kept->noted++;
}

static void write_sentence(char text[MESSAGE_SIZE], const char *format, va_list arguments) {
    if (print_list(text, MESSAGE_SIZE, format, arguments) >= MESSAGE_SIZE) mark_cut(text);
    make_readable(text);
}

void kernel_listen(kernel *self, unsigned statuses) { self->requested.unheard = ~statuses; }

bool kernel_is_heard(const kernel *self, kernel_status status) { return !(self->requested.unheard >> (unsigned)status & 1u); }

void kernel_note(kernel *self, kernel_status status, const char *format, ...) {
    if (!kernel_is_heard(self, status)) return;
    char sentence[MESSAGE_SIZE];
    va_list arguments;
    va_start(arguments, format);
    write_sentence(sentence, format, arguments);
    va_end(arguments);
    note(&self->messages, status, sentence);
}

kernel_status kernel_fail(kernel *self, kernel_status status, const char *format, ...) {
    if (!kernel_is_heard(self, status)) return status;
    va_list arguments;
    va_start(arguments, format);
    write_sentence(self->messages.message, format, arguments);
    va_end(arguments);
    note(&self->messages, status, self->messages.message);
    return status;
}

kernel_status kernel_say_when(kernel *self, kernel_status status, const char *sentence, const char *when) {
    const char *place = strstr(sentence, "%s");
    if (!place) return kernel_fail(self, status, "%s", sentence);
    return kernel_fail(self, status, "%.*s%s%s", (int)(place - sentence), sentence, when, place + 2);
}

void kernel_take_back(kernel *self, unsigned long long noted) {
    message_log *kept = &self->messages;
    unsigned long long newer = kept->noted - noted, unheard = 0;
    for (size_t at = kept->heard; at < kept->length; at = behind_record(kept, at)) ++unheard;
    size_t end = kept->heard;
    for (; unheard > newer; --unheard) end = behind_record(kept, end);
    kept->length = end;
    kept->noted = noted;
}

bool kernel_hear(kernel *self, kernel_sentence *heard) {
    message_log *kept = &self->messages;
    if (kept->lost) {
        print_text(kept->loss, sizeof kept->loss, "%llu earlier messages were lost: they were not read.", kept->lost);
        kept->lost = 0;
        heard->status = KERNEL_WARNING;
        heard->text = kept->loss;
        return true;
    }
    if (kept->heard == kept->length) {
        kept->heard = kept->length = 0;
        return false;
    }
    const char *record = kept->record + kept->heard;
    kept->heard = behind_record(kept, kept->heard);
    heard->status = (kernel_status)record[0];
    heard->text = record + 1;
    return true;
}
