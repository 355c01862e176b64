/* A table from a file: rows of numbers under a row of names, separated by commas. */
#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "resources.h"
#include "table_file.h"

enum { LONGEST_ROW = 2048, MOST_ROWS = 4000000, FIRST_ROOM = 1024 };

static const char MARK_OF_UTF8[] = "\xEF\xBB\xBF"; /* which some spreadsheets write in front */

typedef struct {
    FILE *file;
    const char *path;
    char *problem;
    int cell[MOST_COLUMNS]; /* by column, its place among the cells of a row; -1: missing */
    int column[MOST_COLUMNS]; /* by cell */
    int cells, room, number; /* cells of a row; rows that there is room for; the row that was read last, from 1 */
    table_file *made;
} reader;

/* false, once the sentence tells the file and, where one was read, the row. */
static bool refuse_file(reader *self, const char *format, ...) LIKE_PRINTF(2);
static bool refuse_file(reader *self, const char *format, ...) {
    const int room = PROBLEM_SIZE - 2;
    const char *noun = MODEL.table_file->noun;
    int used = snprintf(self->problem, (size_t)room, "%c%s %.150s", toupper(*noun), noun + 1, self->path);
    if (self->number) used += snprintf(self->problem + used, (size_t)(room - used), ", row %d", self->number);
    used += snprintf(self->problem + used, (size_t)(room - used), ": ");
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(self->problem + used, (size_t)(room - used), format, arguments);
    va_end(arguments);
    strcat(self->problem, ".");
    return false;
}

typedef enum { ROW_READ, NO_MORE_ROWS, ROW_REFUSED } reading;

/* Blank rows are passed over. */
static reading next_row(reader *self, char text[LONGEST_ROW]) {
    while (fgets(text, LONGEST_ROW, self->file)) {
        ++self->number;
        const size_t length = strcspn(text, "\r\n");
        if (text[length] == '\0' && !feof(self->file)) {
            (void)refuse_file(self, "it is longer than 2000 characters, or no text; give a table of numbers");
            return ROW_REFUSED;
        }
        text[length] = '\0';
        for (const char *c = text + 3 * !strncmp(text, MARK_OF_UTF8, 3); *c; ++c)
            if ((unsigned char)*c > '~' || ((unsigned char)*c < ' ' && *c != '\t')) {
                (void)refuse_file(self, "it holds the byte %d, which is no plain text; give a table of numbers",
                                  (unsigned char)*c);
                return ROW_REFUSED;
            }
        if (text[strspn(text, " \t")] != '\0') return ROW_READ;
    }
    return NO_MORE_ROWS;
}

/* The cell that begins at `text`, without blanks around it, and what comes behind its comma; null: there is none. */
static char *cell(char **text) {
    char *start = *text;
    if (!start) return NULL;
    char *end = strchr(start, ',');
    *text = end ? end + 1 : NULL;
    if (!end) end = start + strlen(start);
    while (*start == ' ' || *start == '\t') ++start;
    while (end > start && (end[-1] == ' ' || end[-1] == '\t')) --end;
    *end = '\0';
    return start;
}

static bool read_names(reader *self) {
    const table_file_description *about = MODEL.table_file;
    char text[LONGEST_ROW];
    const reading found = next_row(self, text);
    if (found == ROW_REFUSED) return false;
    if (found == NO_MORE_ROWS) return refuse_file(self, "it is empty; give a row of names and rows of numbers");
    for (int i = 0; i < about->columns; ++i) self->cell[i] = -1;
    char *rest = text + 3 * !strncmp(text, MARK_OF_UTF8, 3);
    for (const char *name; (name = cell(&rest)); ++self->cells) {
        int which = 0;
        while (which < about->columns && strcmp(name, about->column[which].name) != 0) ++which;
        if (which == about->columns || self->cell[which] >= 0)
            return refuse_file(self, "the column \"%.40s\" is %s; give %s", name,
                               which == about->columns ? "not known" : "there twice", about->known);
        self->cell[which] = self->cells;
        self->column[self->cells] = which;
    }
    for (int i = 0; i < about->columns; ++i)
        if (about->column[i].required && self->cell[i] < 0)
            return refuse_file(self, "the column %s is missing", about->column[i].name);
    return true;
}

static bool has_room(reader *self) {
    if (self->made->rows == MOST_ROWS)
        return refuse_file(self, "there are more than 4 000 000 rows; cut the %s into several", MODEL.table_file->noun);
    if (self->made->rows < self->room) return true;
    self->room = self->room ? 2 * self->room : FIRST_ROOM;
    for (int i = 0; i < MODEL.table_file->columns; ++i) {
        if (self->cell[i] < 0) continue;
        double *more = (double *)realloc(self->made->column[i], (size_t)self->room * sizeof(double));
        if (!more) return refuse_file(self, "there is not enough memory for it");
        self->made->column[i] = more;
    }
    return true;
}

static bool check_value(reader *self, const column_description *column, const char *text, double value) {
    const char *unit = column->unit, *blank = *unit ? " " : "";
    if (value >= column->minimum && value <= column->maximum) return true;
    return refuse_file(self, "%s is %.40s%s%s; give a value from %g to %g%s%s", column->name, text, blank, unit,
                       column->minimum, column->maximum, blank, unit);
}

static bool read_row(reader *self, char *text) {
    int count = 0;
    for (const char *one; (one = cell(&text)); ++count) {
        if (count == self->cells) {
            count = -1;
            break;
        }
        const column_description *column = &MODEL.table_file->column[self->column[count]];
        double value = 0.0;
        if (!table_read_number(one, &value))
            return refuse_file(self, "%s is \"%.40s\"; give a finite number", column->name, one);
        if (!check_value(self, column, one, value)) return false;
        self->made->column[self->column[count]][self->made->rows] = value;
    }
    if (count == self->cells) return true;
    return refuse_file(self, "it does not have the %d values that the names ask for", self->cells);
}

/* A row must lie behind the one before it, and the model may have rules of its own for the two. */
static bool check_growth(reader *self) {
    const table_file_description *about = MODEL.table_file;
    const int row = self->made->rows;
    if (row == 0) return true;
    const double before = self->made->column[0][row - 1], at = self->made->column[0][row];
    const char *name = about->column[0].name, *unit = about->column[0].unit, *blank = *unit ? " " : "";
    if (!(at - before >= about->least_growth))
        return refuse_file(self, "%s is %.12g%s%s behind %.12g%s%s; let it grow by %s at least", name, at, blank, unit,
                           before, blank, unit, about->growth_text);
    char problem[PROBLEM_SIZE] = "";
    return about->check_row(self->made, row, problem, sizeof problem) || refuse_file(self, "%s", problem);
}

static bool read_rows(reader *self) {
    char text[LONGEST_ROW];
    reading found;
    while ((found = next_row(self, text)) == ROW_READ) {
        if (!has_room(self) || !read_row(self, text) || !check_growth(self)) return false;
        ++self->made->rows;
    }
    if (found == NO_MORE_ROWS && self->made->rows < 2) return refuse_file(self, "there are fewer than two rows of numbers");
    return found == NO_MORE_ROWS;
}

/* FNV-1a by words, 64 bits: of each column that is there, and which it is. */
static void mark(table_file *self) {
    unsigned long long hash = 14695981039346656037ull;
    for (int column = 0; column < MODEL.table_file->columns; ++column)
        for (int row = 0; self->column[column] && row < self->rows; ++row) {
            unsigned long long bits;
            memcpy(&bits, &self->column[column][row], sizeof bits);
            hash = (hash ^ bits ^ (unsigned long long)column) * 1099511628211ull;
        }
    self->mark = hash;
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

table_file *table_read(const char *path, char problem[PROBLEM_SIZE]) {
    reader self;
    memset(&self, 0, sizeof self);
    self.path = path;
    self.problem = problem;
    if (!is_plain_file(path)) {
        (void)refuse_file(&self, "it is a folder, a pipe or a device; give the path of a file");
        return NULL;
    }
    self.file = fopen(path, "rb");
    if (!self.file) {
        (void)refuse_file(&self, "it cannot be opened; give the path of a file that can be read");
        return NULL;
    }
    self.made = (table_file *)calloc(1, sizeof *self.made);
    if (!self.made)
        (void)refuse_file(&self, "there is not enough memory for it");
    else if (!read_names(&self) || !read_rows(&self) || !complete(&self)) {
        table_free(self.made);
        self.made = NULL;
    }
    fclose(self.file);
    return self.made;
}

void table_free(table_file *self) {
    if (!self) return;
    for (int i = 0; i < MOST_COLUMNS; ++i) free(self->column[i]);
    free(self);
}
