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

static size_t behind_record(const sentence_journal *journal, size_t at) { return at + strlen(journal->record + at + 1) + 2; }

/* Drop messages that were read, and then the oldest unread ones, until there is room. */
static void make_room(sentence_journal *journal, size_t needed) {
    size_t dropped = journal->heard;
    while (journal->length - dropped + needed > JOURNAL_SIZE) {
        dropped = behind_record(journal, dropped);
        journal->lost++;
    }
    memmove(journal->record, journal->record + dropped, journal->length - dropped);
    journal->length -= dropped;
    journal->heard = 0;
}

static void note(sentence_journal *journal, kernel_status status, const char *sentence) {
    const size_t needed = strlen(sentence) + 2;
    if (journal->length + needed > JOURNAL_SIZE) make_room(journal, needed);
    char *record = journal->record + journal->length;
    record[0] = (char)status;
    memcpy(record + 1, sentence, needed - 1);
    journal->length += needed;
    journal->noted++;
}

static void write_sentence(char text[MESSAGE_SIZE], const char *format, va_list arguments) {
    if (vsnprintf(text, MESSAGE_SIZE, format, arguments) >= MESSAGE_SIZE) mark_cut(text);
    make_readable(text);
}

void kernel_listen(kernel *self, unsigned statuses) { self->asked.unheard = ~statuses; }

bool kernel_is_heard(const kernel *self, kernel_status status) { return !(self->asked.unheard >> (unsigned)status & 1u); }

void kernel_note(kernel *self, kernel_status status, const char *format, ...) {
    if (!kernel_is_heard(self, status)) return;
    char sentence[MESSAGE_SIZE];
    va_list arguments;
    va_start(arguments, format);
    write_sentence(sentence, format, arguments);
    va_end(arguments);
    note(&self->journal, status, sentence);
}

kernel_status kernel_fail(kernel *self, kernel_status status, const char *format, ...) {
    if (!kernel_is_heard(self, status)) return status;
    va_list arguments;
    va_start(arguments, format);
    write_sentence(self->journal.message, format, arguments);
    va_end(arguments);
    note(&self->journal, status, self->journal.message);
    return status;
}

kernel_status kernel_say_when(kernel *self, kernel_status status, const char *sentence, const char *when) {
    const char *place = strstr(sentence, "%s");
    if (!place) return kernel_fail(self, status, "%s", sentence);
    return kernel_fail(self, status, "%.*s%s%s", (int)(place - sentence), sentence, when, place + 2);
}

void kernel_take_back(kernel *self, unsigned long long noted) {
    sentence_journal *journal = &self->journal;
    unsigned long long newer = journal->noted - noted, unheard = 0;
    for (size_t at = journal->heard; at < journal->length; at = behind_record(journal, at)) ++unheard;
    size_t end = journal->heard;
    for (; unheard > newer; --unheard) end = behind_record(journal, end);
    journal->length = end;
    journal->noted = noted;
}

bool kernel_hear(kernel *self, kernel_sentence *heard) {
    sentence_journal *journal = &self->journal;
    if (journal->lost) {
        snprintf(journal->told_of_loss, sizeof journal->told_of_loss, "%llu earlier sentences were lost: nobody heard them.",
                 journal->lost);
        journal->lost = 0;
        heard->status = KERNEL_WARNING;
        heard->text = journal->told_of_loss;
        return true;
    }
    if (journal->heard == journal->length) {
        journal->heard = journal->length = 0;
        return false;
    }
    const char *record = journal->record + journal->heard;
    journal->heard = behind_record(journal, journal->heard);
    heard->status = (kernel_status)record[0];
    heard->text = record + 1;
    return true;
}
