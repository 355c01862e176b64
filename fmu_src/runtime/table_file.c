/* A table from a user's file, as FMUs and kernels read it: the C twin of readers/tables.py inside FMUs, which defines its
 * rules. Tests give the same files to both. */
#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "resources.h"
#include "sealed.h"
#include "table_file.h"
#include "text_rows.h"

enum { MOST_ROWS = 4000000, FIRST_ROOM = 1024, LONGEST_NAME = 60, QUOTED = 40 };

/* A cell of each row: its place, and the column that it belongs to. */
typedef struct {
    int at, column;
    double numerator, denominator; /* of the factor to the column's unit */
} cell_place;

typedef struct {
    text_rows rows;
    const char *path;
    char *problem;
    const char *in; /* the column that is read, NULL: none */
    char separator, mark; /* of columns; the decimal mark, 0: none was read */
    bool decimal; /* a number has shown that the mark is none of thousands */
    cell_place place[MOST_COLUMNS]; /* in their order */
    int places, room; /* capacity in rows */
    table_file *made;
} reader;

/* Write a message with the file and, once one was read, the row and the column; return false. */
static bool refuse_file(reader *self, const char *format, ...) LIKE_PRINTF(2);
static bool refuse_file(reader *self, const char *format, ...) {
    const int room = PROBLEM_SIZE - 2;
    int used = text_name_row(self->problem, PROBLEM_SIZE, MODEL.table_file->noun, self->path, self->rows.number);
    if (self->in) used += print_text(self->problem + used, (size_t)(room - used), ", column %s", self->in);
    used += print_text(self->problem + used, (size_t)(room - used), ": ");
    va_list arguments;
    va_start(arguments, format);
    print_list(self->problem + used, (size_t)(room - used), format, arguments);
    va_end(arguments);
    strcat(self->problem, ".");
    return false;
}

static reading next_row(reader *self) {
    const reading found = text_rows_next(&self->rows);
    if (found == ROW_REFUSED) (void)refuse_file(self, "%s", self->rows.problem);
    return found;
}

static cell_reading next_cell(reader *self, char **rest, char **cell) {
    const cell_reading found = text_next_cell(rest, self->separator, cell);
    if (found == CELL_REFUSED) {
        self->in = NULL; /* the column of a value before it */
        (void)refuse_file(self, "quotes must close within the row. Remove the quotes");
    }
    return found;
}

/* The separator in a row "sep=;", with which some spreadsheets begin; 0: it is no such row. */
static char declared_separator(const char *text) {
    static const char WORD[] = "sep=";
    for (int i = 0; i < 4; ++i)
        if (tolower((unsigned char)text[i]) != WORD[i]) return '\0';
    const char found = text[4];
    if (!found || !strchr(",;\t|:", found)) return '\0';
    for (text += 5; text_blank(text);) text += text_blank(text);
    return *text ? '\0' : found;
}

/* A name in small letters, with one underscore for blanks, hyphens and underscores side by side. */
static void tidy(const char *name, const char *end, char found[LONGEST_NAME]) {
    int length = 0;
    while (name < end && length < LONGEST_NAME - 1) {
        const size_t blank = text_blank(name);
        const bool gap = blank || *name == '-' || *name == '_';
        if (!gap) found[length++] = (char)(*name >= 'A' && *name <= 'Z' ? *name - 'A' + 'a' : *name);
        if (gap && (!length || found[length - 1] != '_')) found[length++] = '_';
        name += blank ? blank : 1;
    }
    found[length] = '\0';
}

/* A name in small ASCII letters and digits, with an underscore for all between them: umlauts as two letters, other letters of
 * Latin-1 without their marks. `plain` of readers/column_words.py is its twin. */
static void plain_name(const char *name, const char *end, char found[LONGEST_NAME]) {
    static const char BARE[] = "aaaaaa_ceeeeiiii_nooooo__uuuuy_s";
    enum { A_UMLAUT = 4, O_UMLAUT = 22, U_UMLAUT = 28, SHARP_S = 31, Y_UMLAUT = 63 };
    int length = 0;
    bool gap = false;
    for (const unsigned char *c = (const unsigned char *)name; c < (const unsigned char *)end && length < LONGEST_NAME - 3;
         ++c) {
        const bool is_letter = (*c | 0x20) >= 'a' && (*c | 0x20) <= 'z'; /* in any locale of the host */
        char letter = (char)(is_letter ? *c | 0x20 : *c >= '0' && *c <= '9' ? *c : '_'), behind = '\0';
        if (*c == 0xC3 && c[1] >= 0x80 && c[1] <= 0xBF) { /* U+00C0 to U+00FF */
            const int place = *++c - 0x80;
            letter = place == Y_UMLAUT ? 'y' : BARE[place % 32];
            behind = (char)(place % 32 == A_UMLAUT || place % 32 == O_UMLAUT || place % 32 == U_UMLAUT ? 'e' : '\0');
            if (place == SHARP_S) behind = 's';
        } else if (*c == 0xCC && c[1] >= 0x80) { /* a mark that combines with the letter before */
            const bool umlaut = *++c == 0x88 && length && strchr("aou", found[length - 1]) && !gap;
            if (!umlaut) continue;
            letter = 'e';
        }
        if (letter == '_') {
            gap = true;
            continue;
        }
        if (gap && length) found[length++] = '_';
        gap = false;
        found[length++] = letter;
        if (behind) found[length++] = behind;
    }
    found[length] = '\0';
}

/* The column that a German or French name means; the number of columns: none. */
static int column_meant(const char *name, const char *end) {
    const table_file_description *about = MODEL.table_file;
    char bare[LONGEST_NAME];
    plain_name(name, end, bare);
    for (int i = 0; i < about->columns; ++i)
        for (int j = 0; j < about->column[i].words; ++j)
            if (strcmp(bare, about->column[i].word[j]) == 0) return i;
    return about->columns;
}

/* How many letters must change, come or go to make one name of the other: Levenshtein (1966). */
static int distance_of_names(const char *one, const char *other) {
    int row[LONGEST_NAME + 1];
    const int length = (int)strlen(other);
    for (int j = 0; j <= length; ++j) row[j] = j;
    for (int i = 1; one[i - 1]; ++i) {
        int before = row[0]++;
        for (int j = 1; j <= length; ++j) {
            const int changed = before + (one[i - 1] != other[j - 1]);
            before = row[j];
            const int least = row[j] < row[j - 1] ? row[j] : row[j - 1];
            row[j] = changed < least + 1 ? changed : least + 1;
        }
    }
    return row[length];
}

static bool refuse_name(reader *self, const char *cell, int length, const char *name) {
    const table_file_description *about = MODEL.table_file;
    const char *near = NULL;
    for (int i = 0, least = LONGEST_NAME; i < about->columns; ++i) {
        const int distance = distance_of_names(name, about->column[i].name);
        if (distance >= least || distance > 1 + (int)strlen(about->column[i].name) / 4) continue;
        near = about->column[i].name;
        least = distance;
    }
    if (length > QUOTED) length = QUOTED;
    if (near) return refuse_file(self, "the column '%.*s' is unknown. Did you mean %s?", length, cell, near);
    return refuse_file(self, "the column '%.*s' is unknown. Columns are %s", length, cell, about->known);
}

/* Parts a cell "name [unit]" or "name (unit)": the end of its name and its unit. False where it is no such cell. */
static bool part_name(char *cell, char **end, char **unit) {
    const size_t length = strlen(cell);
    char *open = cell[length - 1] == ']' ? strchr(cell, '[') : cell[length - 1] == ')' ? strchr(cell, '(') : NULL;
    const char *odd = open && *open == '[' ? "[]" : "[]()";
    *end = open ? open : cell + length;
    if (strcspn(cell, odd) < (size_t)(*end - cell)) return false;
    *unit = cell + length;
    if (open) {
        *text_before_blanks(open + 1, cell + length - 1) = '\0';
        for (*unit = open + 1; text_blank(*unit);) *unit += text_blank(*unit);
    }
    *end = text_before_blanks(cell, *end);
    return *end > cell && (*unit)[strcspn(*unit, odd)] == '\0';
}

/* Find the factor from the unit of the file to that of the column. */
static bool find_factor(reader *self, const char *unit, cell_place *place) {
    const column_description *column = &MODEL.table_file->column[place->column];
    char known[PROBLEM_SIZE / 2] = "";
    place->numerator = place->denominator = 1.0;
    if (!*unit) return true;
    for (int i = 0; i < column->units; ++i) {
        const unit_description *one = &column->unit_of_file[i];
        place->numerator = one->numerator;
        place->denominator = one->denominator;
        if (strcmp(unit, one->name) == 0) return true;
        const size_t used = strlen(known);
        print_text(known + used, sizeof known - used, "%s%s", i ? ", " : "", one->name);
    }
    return refuse_file(self, "the unit '%.*s' of %s is unknown. Use %s; none means %s", QUOTED, unit, column->name, known,
                       *column->unit ? column->unit : "1");
}

static bool read_name(reader *self, char *cell, int at) {
    const table_file_description *about = MODEL.table_file;
    char *end, *unit, name[LONGEST_NAME];
    if (!part_name(cell, &end, &unit))
        return refuse_file(self, "a column must have a name, and its unit in brackets; got '%.*s'. Write speed [m/s]", QUOTED,
                           cell);
    tidy(cell, end, name);
    int which = 0;
    while (which < about->columns && strcmp(name, about->column[which].name) != 0) ++which;
    if (which == about->columns) which = column_meant(cell, end);
    if (which == about->columns) return refuse_name(self, cell, (int)(end - cell), name);
    for (int i = 0; i < self->places; ++i)
        if (self->place[i].column == which)
            return refuse_file(self, "the column %s must be there once; it is there twice. Remove one",
                               about->column[which].name);
    cell_place *place = &self->place[self->places++];
    place->at = at;
    place->column = which;
    return find_factor(self, unit, place);
}

static bool check_names(reader *self) {
    const table_file_description *about = MODEL.table_file;
    for (int i = 0; i < about->columns; ++i) {
        bool there = !about->column[i].required;
        for (int j = 0; j < self->places; ++j) there |= self->place[j].column == i;
        if (!there) return refuse_file(self, "the column %s is missing. Add it", about->column[i].name);
    }
    return true;
}

/* Read the first row with content, after one that declares the separator. */
static reading row_of_names(reader *self) {
    reading found = next_row(self);
    if (found != ROW_READ) return found;
    self->separator = declared_separator(self->rows.text);
    if (!self->separator) {
        self->separator = text_separator(self->rows.text);
        return found;
    }
    return next_row(self);
}

static bool read_names(reader *self) {
    reading found = row_of_names(self);
    for (bool any = false; found == ROW_READ && !any;) {
        char *rest = self->rows.text, *cell;
        double number;
        char mark;
        cell_reading next;
        for (int at = 0; (next = next_cell(self, &rest, &cell)) == CELL_READ; ++at) {
            if (!*cell) continue;
            if (!any && table_read_number(cell, &number, &mark))
                return refuse_file(self, "the first row must have names; got '%.*s'. Add them, as in %s", QUOTED, cell,
                                   MODEL.table_file->known);
            any = true;
            if (!read_name(self, cell, at)) return false;
        }
        if (next == CELL_REFUSED) return false;
        if (!any) found = next_row(self); /* it has nothing but separators */
    }
    if (found == NO_MORE_ROWS)
        return refuse_file(self, "the file must have a row of names and rows of values; it is empty. Give a table");
    return found == ROW_READ && check_names(self);
}

static bool has_room(reader *self) {
    if (self->made->rows == MOST_ROWS)
        return refuse_file(self, "the file must have at most %d rows. Split it, or drop rows", MOST_ROWS);
    if (self->made->rows < self->room) return true;
    self->room = self->room ? 2 * self->room : FIRST_ROOM;
    for (int i = 0; i < self->places; ++i) {
        double **column = &self->made->column[self->place[i].column];
        double *more = (double *)realloc(*column, (size_t)self->room * sizeof(double));
        if (!more) return refuse_file(self, "there is not enough memory for it");
        *column = more;
    }
    return true;
}

/* Return whether a cell may be a number of thousands, with a separator between groups of three digits. */
static bool may_be_thousands(const char *cell) {
    int digits = 0, behind = 0;
    if (*cell == '+' || *cell == '-') ++cell;
    if (strncmp(cell, "\xE2\x88\x92", 3) == 0) cell += 3; /* a typographer's minus */
    if (*cell == '0') return false;
    while (isdigit((unsigned char)*cell)) ++cell, ++digits;
    if (*cell != '.' && *cell != ',') return false;
    ++cell;
    while (isdigit((unsigned char)*cell)) ++cell, ++behind;
    return digits >= 1 && digits <= 3 && behind == 3 && !*cell;
}

/* Check that all numbers of the file have one decimal mark, and note whether one shows that it is none of thousands. */
static bool check_mark(reader *self, const char *cell, char mark) {
    if (mark) self->decimal = self->decimal || !may_be_thousands(cell);
    if (!mark || mark == self->mark) return true;
    if (self->mark)
        return refuse_file(self,
                           "numbers must have one decimal mark; got '%.*s' after one with '%c'. Use one, and no "
                           "separators of thousands",
                           QUOTED, cell, self->mark);
    self->mark = mark;
    return true;
}

static bool read_value(reader *self, const cell_place *place, const char *cell) {
    const column_description *column = &MODEL.table_file->column[place->column];
    const char *unit = column->unit, *blank = *unit ? " " : "";
    double value = 0.0;
    char mark = '\0';
    self->in = column->name;
    if (!table_read_number(cell, &value, &mark))
        return refuse_file(self, "the value must be a number; %s%.*s%s. Write it as 0.015 or 1.5e-2",
                           *cell ? "got '" : "the cell is empty", QUOTED, cell, *cell ? "'" : "");
    if (!check_mark(self, cell, mark)) return false;
    const bool converted = place->numerator != 1.0 || place->denominator != 1.0;
    if (converted) value = value * place->numerator / place->denominator;
    self->made->column[place->column][self->made->rows] = value;
    if (value >= column->minimum && value <= column->maximum) {
        self->in = NULL;
        return true;
    }
    if (converted)
        return refuse_file(self,
                           "the value must be from %g to %g%s%s; got '%.*s', in the file's unit, 1 of which is %g%s%s. "
                           "Check value and unit",
                           column->minimum, column->maximum, blank, unit, QUOTED, cell, place->numerator / place->denominator,
                           blank, unit);
    return refuse_file(self, "the value must be from %g to %g%s%s; got '%.*s'%s%s. Check value and unit", column->minimum,
                       column->maximum, blank, unit, QUOTED, cell, blank, unit);
}

/* The first column grows from row to row, and the model may have a rule of its own for two rows. Return the number of parts
 * from the row before, 0 if the row is refused. */
static int parts_before(reader *self) {
    const table_file_description *about = MODEL.table_file;
    const int row = self->made->rows;
    if (row == 0) return 1;
    const double before = self->made->column[0][row - 1], at = self->made->column[0][row];
    const char *unit = about->column[0].unit, *blank = *unit ? " " : "";
    if (!(at - before >= about->least_growth)) {
        self->in = about->column[0].name;
        return refuse_file(self,
                           "values must grow by at least %g%s%s; got %.12g%s%s after %.12g%s%s. Sort the rows, or remove "
                           "this one",
                           about->least_growth, blank, unit, at, blank, unit, before, blank, unit);
    }
    char problem[PROBLEM_SIZE] = "";
    const int parts = about->parts_before(self->made, row, problem, sizeof problem);
    if (parts == 0) (void)refuse_file(self, "%s", problem);
    return parts;
}

/* Add the row that was read, behind rows in which the values change linearly from the row before. */
static bool add_rows(reader *self, int parts) {
    double first[MOST_COLUMNS], last[MOST_COLUMNS];
    for (int i = 0; i < self->places; ++i) {
        const double *column = self->made->column[self->place[i].column];
        first[i] = parts > 1 ? column[self->made->rows - 1] : 0.0;
        last[i] = column[self->made->rows];
    }
    for (int part = 1; part <= parts; ++part, ++self->made->rows) {
        if (!has_room(self)) return false;
        const double share = (double)part / parts;
        for (int i = 0; i < self->places; ++i)
            self->made->column[self->place[i].column][self->made->rows] =
                part == parts ? last[i] : first[i] + share * (last[i] - first[i]);
    }
    return true;
}

static bool refuse_nameless(reader *self, int at, const char *cell) {
    self->in = NULL;
    return refuse_file(self,
                       "a row must have at most %d values; got %d: '%.*s' has no name. Name each column in the first row%s",
                       self->places, at + 1, QUOTED, cell,
                       self->separator == ',' ? ". With decimal commas, separate columns by semicolons" : "");
}

/* Read the values of a row. One of separators alone is left out. */
static bool read_row(reader *self) {
    char *rest = self->rows.text, *cell;
    cell_reading found;
    const cell_place *place = self->place, *behind = place + self->places, *empty = NULL;
    bool any = false, wrong = false; /* a wrong value may come of a wrong number of values, which is reported first */
    for (int at = 0; (found = next_cell(self, &rest, &cell)) == CELL_READ; ++at) {
        const bool named = place < behind && place->at == at;
        any |= *cell != '\0';
        if (*cell && !named) return refuse_nameless(self, at, cell);
        if (*cell && !wrong) wrong = !read_value(self, place, cell);
        if (named && !*cell && !empty) empty = place;
        place += named;
    }
    if (found == CELL_REFUSED || wrong) return false;
    if (!any) return true;
    if (!empty && place < behind) empty = place;
    if (empty) return read_value(self, empty, "");
    const int parts = parts_before(self);
    return parts > 0 && add_rows(self, parts);
}

static bool read_rows(reader *self) {
    reading found;
    while ((found = next_row(self)) == ROW_READ)
        if (!has_room(self) || !read_row(self)) return false;
    if (found == ROW_REFUSED) return false;
    if (self->mark && !self->decimal && (self->mark == ',' || self->separator == ';')) {
        self->rows.number = 0;
        return refuse_file(self,
                           "numbers must have one reading; all with '%c' can be thousands, as 1%c000. Write "
                           "1000, or 1.0 with a decimal point in a file with commas or tabs",
                           self->mark, self->mark);
    }
    if (self->made->rows >= 2) return true;
    self->rows.number = 0;
    return refuse_file(self, "the file must have at least 2 rows of values; it has %d. Add rows", self->made->rows);
}

/* Set the mark to a hash of each present column and its index. */
static void mark(table_file *self) {
    self->mark = SEAL_BEGIN;
    for (int column = 0; column < MODEL.table_file->columns; ++column)
        if (self->column[column]) {
            self->mark = seal_hash(self->mark, &column, sizeof column);
            self->mark = seal_hash(self->mark, self->column[column], (size_t)self->rows * sizeof(double));
        }
}

/* The columns that the model adds. */
static bool complete(reader *self) {
    const table_file_description *about = MODEL.table_file;
    for (int i = about->columns; i < about->columns + about->added; ++i)
        if (!(self->made->column[i] = (double *)malloc((size_t)self->made->rows * sizeof(double))))
            return refuse_file(self, "there is not enough memory for it");
    mark(self->made);
    about->complete(self->made);
    return true;
}

static bool read_file(reader *self) {
    if (!is_plain_file(self->path)) return refuse_file(self, "it is a folder, a pipe or a device. Give the path of a file");
    FILE *file = fopen(self->path, "rb");
    if (!file) return refuse_file(self, "it cannot be opened. Give the path of a file that can be read");
    text_rows_begin(&self->rows, file);
    const bool done = read_names(self) && read_rows(self) && complete(self);
    fclose(file);
    return done;
}

table_file *table_read(const char *path, char problem[PROBLEM_SIZE]) {
    reader *self = (reader *)calloc(1, sizeof *self);
    table_file *made = (table_file *)calloc(1, sizeof *made);
    if (self && made) {
        self->path = path;
        self->problem = problem;
        self->made = made;
    }
    if (!self || !made || !read_file(self)) {
        table_free(made);
        made = NULL;
    }
    free(self);
    return made;
}

void table_free(table_file *self) {
    if (!self) return;
    for (int i = 0; i < MOST_COLUMNS; ++i) free(self->column[i]);
    free(self);
}
