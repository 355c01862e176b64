/* Rows of a user's text file and cells of a row: the C twin of readers/text.py and of `cells_of` in readers/tables.py. */
#include <ctype.h>
#include <string.h>

#include "readable.h"
#include "text_rows.h"

enum {
    TEXT_ENDS = -1, /* instead of a character */
    TEXT_REFUSED = -2,
    SHOWN_PATH = 120 /* bytes of a path that a message shows, the last ones */
};

static const unsigned long long LARGEST_TEXT = 1000000000ull; /* bytes */
static const char MARK_OF_UTF8[] = "\xEF\xBB\xBF", NO_BREAK[] = "\xC2\xA0", NARROW_NO_BREAK[] = "\xE2\x80\xAF";

int text_name_row(char *problem, size_t size, const char *noun, const char *path, int row) {
    const size_t length = strlen(path), hidden = length > SHOWN_PATH ? length - SHOWN_PATH : 0;
    const int used = print_text(problem, size, "%c%s %s%s", toupper(*noun), noun + 1, hidden ? "..." : "", path + hidden);
    return row ? used + print_text(problem + used, size - (size_t)used, ", row %d", row) : used;
}

static int refuse_text(text_rows *self, const char *problem) {
    snprintf(self->problem, sizeof self->problem, "%s", problem);
    return TEXT_REFUSED;
}

static int next_byte(text_rows *self) {
    if (self->at == self->end) {
        self->at = 0;
        self->end = fread(self->chunk, 1, CHUNK_SIZE, self->file);
        self->size += self->end;
        if (self->size > LARGEST_TEXT) return refuse_text(self, "the file must have at most 1000000000 bytes. Split it");
        if (self->end == 0) return ferror(self->file) ? refuse_text(self, "the file cannot be read. Check it") : TEXT_ENDS;
    }
    return self->chunk[self->at++];
}

void text_rows_begin(text_rows *self, FILE *file) {
    memset(self, 0, sizeof *self);
    self->file = file;
    if (next_byte(self) < 0) return;
    const unsigned char *c = self->chunk;
    self->at = 0;
    if (self->end >= 3 && memcmp(c, MARK_OF_UTF8, 3) == 0) self->at = 3;
    if (self->end >= 2 && c[0] == 0xFF && c[1] == 0xFE) self->encoding = TEXT_UTF16_LE;
    if (self->end >= 2 && c[0] == 0xFE && c[1] == 0xFF) self->encoding = TEXT_UTF16_BE;
    if (self->encoding != TEXT_OF_BYTES) self->at = 2;
}

static int next_unit(text_rows *self) {
    const int one = next_byte(self);
    if (one < 0) return one;
    const int other = next_byte(self);
    if (other == TEXT_ENDS) return refuse_text(self, "the file ends within a character. Save it as text in UTF-8");
    if (other < 0) return other;
    return self->encoding == TEXT_UTF16_LE ? one | other << 8 : one << 8 | other;
}

static int next_of_utf16(text_rows *self) {
    const int first = next_unit(self);
    if (first < 0xD800 || first > 0xDFFF) return first;
    const int second = first < 0xDC00 ? next_unit(self) : 0;
    if (second == TEXT_REFUSED) return second;
    if (second < 0xDC00 || second > 0xDFFF)
        return refuse_text(self, "half a character stands alone. Save the file as text in UTF-8");
    return 0x10000 + (first - 0xD800) * 0x400 + (second - 0xDC00);
}

static int next_letter(text_rows *self) { return self->encoding == TEXT_OF_BYTES ? next_byte(self) : next_of_utf16(self); }

/* The next byte of text, or character of UTF-16; a line feed where a row ends, however the file writes it. */
static int next_in_row(text_rows *self) {
    int letter = next_letter(self);
    if (letter == '\n' && self->behind_return) letter = next_letter(self);
    self->behind_return = letter == '\r';
    return letter == '\r' ? '\n' : letter;
}

static size_t write_letter(int letter, char *to) {
    const size_t length = letter < 0x80 ? 1 : letter < 0x800 ? 2 : letter < 0x10000 ? 3 : 4;
    static const int FIRST[] = {0, 0, 0xC0, 0xE0, 0xF0};
    for (size_t i = length - 1; i > 0; --i, letter >>= 6) to[i] = (char)(0x80 | (letter & 0x3F));
    to[0] = (char)(FIRST[length] | letter);
    return length;
}

/* Return the number of letters in a row; -1 if it is not UTF-8. */
static int letters_in(const char *text, size_t length) {
    int count = 0;
    for (const unsigned char *c = (const unsigned char *)text, *end = c + length; c < end; ++count) {
        const size_t bytes = *c < 0x80 ? 1 : length_of_letter(c); /* a zero follows the text */
        if (!bytes) return -1;
        c += bytes;
    }
    return count;
}

/* Read a row of bytes as Windows-1252: per mille, the characters of Latin-1, and a sign for all others. */
static size_t from_windows(char *text, size_t length) {
    size_t longer = 0;
    for (size_t i = 0; i < length; ++i) {
        const unsigned char c = (unsigned char)text[i];
        longer += c < 0x80 ? 1 : c < 0xA0 ? 3 : 2;
    }
    text[longer] = '\0';
    for (size_t i = length, to = longer; i-- > 0;) {
        const unsigned char c = (unsigned char)text[i];
        to -= c < 0x80 ? 1 : c < 0xA0 ? 3 : 2;
        (void)write_letter(c == 0x89 ? 0x2030 : c < 0x80 || c >= 0xA0 ? c : 0xFFFD, text + to);
    }
    return longer;
}

static reading refuse_row(text_rows *self, const char *format, int value) {
    snprintf(self->problem, sizeof self->problem, format, value);
    return ROW_REFUSED;
}

static reading refuse_length(text_rows *self) {
    return refuse_row(self, "a row must have at most %d characters. Check that this is a table", LONGEST_ROW);
}

/* Finish the text of a row that was read: in UTF-8, without marks, and not too long. */
static reading complete_row(text_rows *self, size_t length, bool plain, bool ends) {
    while (ends && length && self->text[length - 1] == '\x1A') --length; /* the end of files of DOS */
    self->text[length] = '\0';
    int count = plain ? (int)length : letters_in(self->text, length);
    if (count < 0 && (count = (int)length) <= LONGEST_ROW) length = from_windows(self->text, length);
    if (count > LONGEST_ROW) return refuse_length(self);
    if (self->number == 1 && strncmp(self->text, MARK_OF_UTF8, 3) == 0) memmove(self->text, self->text + 3, length - 2);
    return ROW_READ;
}

/* Copy bytes up to the next control character or the end of the chunk or row; return whether they are ASCII. */
static bool copy_run(text_rows *self, size_t *length) {
    unsigned char all = 0;
    size_t at = self->at, to = *length;
    for (; at < self->end && to < ROW_SIZE && (self->chunk[at] >= ' ' || self->chunk[at] == '\t'); ++at) {
        all |= self->chunk[at];
        self->text[to++] = (char)self->chunk[at];
    }
    if (at > self->at) self->behind_return = false;
    self->at = at;
    *length = to;
    return all < 0x80;
}

static reading next_row_of_any(text_rows *self) {
    size_t length = 0;
    bool plain = true;
    for (++self->number;;) {
        if (self->encoding == TEXT_OF_BYTES) plain &= copy_run(self, &length);
        const int letter = next_in_row(self);
        if (letter == TEXT_REFUSED) return ROW_REFUSED;
        if (letter == TEXT_ENDS && length == 0) return NO_MORE_ROWS;
        if (letter == TEXT_ENDS || letter == '\n') return complete_row(self, length, plain, letter == TEXT_ENDS);
        if (letter < ' ' && !memchr("\t\f\x1A", letter, 3))
            return refuse_row(self, "the character %d is not text. Save the file as text in UTF-8", letter);
        if (length >= ROW_SIZE) return refuse_length(self);
        plain &= letter < 0x80;
        if (self->encoding == TEXT_OF_BYTES) self->text[length++] = (char)letter;
        else length += write_letter(letter, self->text + length);
    }
}

size_t text_blank(const char *text) {
    if (*text > ' ' && *text <= '~') return 0; /* nearly all */
    if (*text == ' ' || *text == '\t' || *text == '\f') return 1;
    if (strncmp(text, NO_BREAK, 2) == 0) return 2;
    return strncmp(text, NARROW_NO_BREAK, 3) == 0 ? 3 : 0;
}

reading text_rows_next(text_rows *self) {
    for (;;) {
        const reading found = next_row_of_any(self);
        if (found != ROW_READ) return found;
        const char *c = self->text;
        while (text_blank(c)) c += text_blank(c);
        if (*c && *c != '#' && *c != '%' && *c != '!' && strncmp(c, "//", 2) != 0) return ROW_READ;
    }
}

static char *behind_blanks(char *text, char separator) {
    while (*text != separator && text_blank(text)) text += text_blank(text);
    return text;
}

char *text_before_blanks(char *start, char *end) {
    while (end > start && !(end[-1] > ' ' && end[-1] <= '~')) {
        if (end > start && text_blank(end - 1) == 1) --end;
        else if (end - start >= 2 && strncmp(end - 2, NO_BREAK, 2) == 0) end -= 2;
        else if (end - start >= 3 && strncmp(end - 3, NARROW_NO_BREAK, 3) == 0) end -= 3;
        else break;
    }
    return end;
}

char text_separator(const char *text) {
    bool tab = false, semicolon = false;
    for (; *text; ++text) {
        const char *close = *text == '"' ? strchr(text + 1, '"') : NULL;
        if (close) text = close;
        tab |= *text == '\t';
        semicolon |= *text == ';';
    }
    return tab ? '\t' : semicolon ? ';' : ',';
}

/* Read a cell that begins with quotes: two of them mean one. */
static cell_reading next_in_quotes(char *start, char **rest, char separator, char **cell) {
    char *from = start + 1, *to = start;
    for (; *from && (from[0] != '"' || from[1] == '"'); *to++ = *from++) from += *from == '"';
    if (!*from) return CELL_REFUSED;
    from = behind_blanks(from + 1, separator);
    if (*from && *from != separator) return CELL_REFUSED;
    *rest = *from ? from + 1 : NULL;
    *to = '\0';
    *cell = behind_blanks(start, '\0');
    *text_before_blanks(*cell, to) = '\0';
    return CELL_READ;
}

cell_reading text_next_cell(char **rest, char separator, char **cell) {
    if (!*rest) return NO_MORE_CELLS;
    char *start = behind_blanks(*rest, separator);
    if (*start == '"') return next_in_quotes(start, rest, separator, cell);
    char *end = strchr(start, separator);
    if (!end) end = start + strlen(start);
    *rest = *end ? end + 1 : NULL;
    *text_before_blanks(start, end) = '\0';
    *cell = start;
    return CELL_READ;
}
