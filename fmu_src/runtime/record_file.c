/* Records from users' files, as FMUs and kernels read them. Each row is a number with its name, the head of a table or of a
 * list, or a row of a table, in the order of the kinds. The last one is the checksum of all numbers; another root record may
 * follow. rbd_model/contact/pair_file.py writes and reads the same files. */
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "record_file.h"
#include "resources.h"
#include "sealed.h"
#include "text_rows.h"

enum { MOST_PIECES = 20000, MOST_CELLS = 48, QUOTED_CELL = 40 };

static const double LARGEST_COEFFICIENT = 1e100, EQUAL_PIECES = 1e-9;

struct record_memory {
    record_memory *before;
    double first; /* of the content */
};

typedef struct {
    text_rows rows;
    const char *path;
    char *problem;
    const char *cell[MOST_CELLS]; /* of the row that was read last */
    int cells;
    unsigned long long mark; /* of the root record that is read */
    record_file *made;
} record_reader;

static bool refuse_record(record_reader *self, const char *format, ...) LIKE_PRINTF(2);
static bool refuse_record(record_reader *self, const char *format, ...) {
    const record_file_description *about = MODEL.record_file;
    const int room = PROBLEM_SIZE - 2;
    int used = text_name_row(self->problem, PROBLEM_SIZE, about->noun, self->path, self->rows.number);
    used += print_text(self->problem + used, (size_t)(room - used), ": ");
    va_list arguments;
    va_start(arguments, format);
    used += print_list(self->problem + used, (size_t)(room - used), format, arguments);
    va_end(arguments);
    if (used < room) print_text(self->problem + used, (size_t)(room - used), ". %s.", about->remedy);
    return false;
}

/* Return cleared memory that is freed with the file; NULL, with a message, if there is none. */
static void *keep(record_reader *self, int count, size_t size) {
    record_memory *block = (record_memory *)calloc(1, sizeof *block + (size_t)count * size);
    if (!block) {
        (void)refuse_record(self, "there is not enough memory for it");
        return NULL;
    }
    block->before = self->made->memory;
    self->made->memory = block;
    return &block->first;
}

/* Find the cells of a row. */
static bool split_row(record_reader *self) {
    char *rest = self->rows.text, *cell;
    cell_reading next;
    for (self->cells = 0; (next = text_next_cell(&rest, ',', &cell)) == CELL_READ; ++self->cells) {
        if (self->cells == MOST_CELLS) return refuse_record(self, "a row must have at most %d values; it has more", MOST_CELLS);
        self->cell[self->cells] = cell;
    }
    return next != CELL_REFUSED || refuse_record(self, "quotes must close within the row");
}

/* Read the next row and its cells. wanted: the row that must be there. */
static bool next_cells(record_reader *self, const char *wanted) {
    const reading found = text_rows_next(&self->rows);
    if (found == ROW_REFUSED) return refuse_record(self, "%s", self->rows.problem);
    if (found == NO_MORE_ROWS) return refuse_record(self, "the row must be %s; the file ends", wanted);
    return split_row(self);
}

/* Check that the row has a name and `count` more cells. */
static bool is_named(record_reader *self, const char *name, int count) {
    if (self->cells == 1 + count && strcmp(self->cell[0], name) == 0) return true;
    return refuse_record(self, "the row must be '%s' with %d more cells; got '%.*s' with %d", name, count, QUOTED_CELL,
                         self->cell[0], self->cells - 1);
}

/* Read the row with a name and `count` more cells. */
static bool named_cells(record_reader *self, const char *name, int count) {
    return next_cells(self, name) && is_named(self, name, count);
}

static bool read_number(record_reader *self, const char *name, const char *cell, double minimum, double maximum,
                        double *value) {
    char mark;
    if (!table_read_number(cell, value, &mark) || !(*value >= minimum && *value <= maximum))
        return refuse_record(self, "%s must be a number from %g to %g; got '%.*s'", name, minimum, maximum, QUOTED_CELL, cell);
    self->mark = seal_hash(self->mark, value, sizeof *value);
    return true;
}

/* Read the head of a table or a list, and its length. */
static bool read_count(record_reader *self, const char *word, const char *name, int least, int most, int *count) {
    double length = 0.0;
    if (!named_cells(self, word, 2)) return false;
    if (strcmp(self->cell[1], name) != 0)
        return refuse_record(self, "the %s must be %s; got '%.*s'", word, name, QUOTED_CELL, self->cell[1]);
    if (!read_number(self, name, self->cell[2], least, most, &length)) return false;
    if (length != floor(length)) return refuse_record(self, "the length of %s must be a whole number; got %g", name, length);
    *count = (int)length;
    return true;
}

/* The constant rows before and behind the pieces, and how the pieces are found: as fmu_src/piecewise.py. */
static void complete_table(piecewise *table, double *row) {
    const int terms = table->terms, pieces = table->pieces;
    double *last = row + pieces * terms, *end = last + terms;
    const double width = end[0] - last[0], mean = (end[0] - row[terms]) / pieces;
    row[0] = row[terms];
    row[1] = row[terms + 1];
    end[1] = last[terms - 1];
    for (int i = terms - 2; i > 0; --i) end[1] = last[i] + end[1] * width;
    table->per_unit = pieces / (end[0] - row[0]);
    table->equal = 1;
    for (int piece = 1; piece <= pieces; ++piece) {
        const double own = row[(piece + 1) * terms] - row[piece * terms];
        if (!(fabs(own - mean) <= EQUAL_PIECES * fabs(mean))) table->equal = 0;
    }
    table->row = row;
}

/* Read a row of a table; the last one has its end alone. */
static bool read_row_of(record_reader *self, const table_of_record *about, bool last, double *row, double before) {
    const int terms = last ? 1 : about->terms;
    if (!next_cells(self, about->name)) return false;
    if (self->cells != terms)
        return refuse_record(self, "a row of %s must have %d numbers here; got %d", about->name, terms, self->cells);
    if (!read_number(self, "a breakpoint", self->cell[0], about->minimum, about->maximum, row)) return false;
    if (!(row[0] > before))
        return refuse_record(self, "breakpoints of %s must grow; got %.17g after %.17g", about->name, row[0], before);
    for (int i = 1; i < terms; ++i)
        if (!read_number(self, "a coefficient", self->cell[i], -LARGEST_COEFFICIENT, LARGEST_COEFFICIENT, &row[i]))
            return false;
    return true;
}

static bool read_table_of(record_reader *self, const table_of_record *about, piecewise *table) {
    if (!read_count(self, "table", about->name, 1, MOST_PIECES, &table->pieces)) return false;
    const int terms = table->terms = about->terms;
    double *row = (double *)keep(self, (table->pieces + 2) * terms, sizeof(double)), before = -INFINITY;
    if (!row) return false;
    for (int i = 1; i <= table->pieces + 1; ++i) {
        if (!read_row_of(self, about, i > table->pieces, row + i * terms, before)) return false;
        before = row[i * terms];
    }
    complete_table(table, row);
    return true;
}

static bool read_record(record_reader *self, int kind, record *made);

static bool read_list_of(record_reader *self, const list_of_record *about, record_list *list) {
    if (!read_count(self, "list", about->name, about->least, about->most, &list->count)) return false;
    record *each = (record *)keep(self, list->count, sizeof(record));
    if (!each) return false;
    list->first = each;
    for (int i = 0; i < list->count; ++i)
        if (!read_record(self, about->kind, each + i)) return false;
    return true;
}

static bool read_record(record_reader *self, int kind, record *made) {
    const record_kind *about = &MODEL.record_file->kind[kind];
    double *number = (double *)keep(self, about->numbers, sizeof(double));
    piecewise *table = number ? (piecewise *)keep(self, about->tables, sizeof(piecewise)) : NULL;
    record_list *list = table ? (record_list *)keep(self, about->lists, sizeof(record_list)) : NULL;
    if (!list) return false;
    made->number = number;
    made->table = table;
    made->list = list;
    for (int i = 0; i < about->numbers; ++i) {
        const number_of_record *one = &about->number[i];
        if (!named_cells(self, one->name, 1)) return false;
        if (!read_number(self, one->name, self->cell[1], one->minimum, one->maximum, &number[i])) return false;
    }
    for (int i = 0; i < about->tables; ++i)
        if (!read_table_of(self, &about->table[i], &table[i])) return false;
    char problem[PROBLEM_SIZE / 2] = "";
    if (!MODEL.record_file->check(kind, number, problem, sizeof problem)) return refuse_record(self, "%s", problem);
    for (int i = 0; i < about->lists; ++i)
        if (!read_list_of(self, &about->list[i], &list[i])) return false;
    return true;
}

/* Return the root record that was read before with this mark, or `own`: lanes with one record take less time. */
static const record *same_root(const record_file *made, unsigned long long mark, const record *own) {
    for (int i = 0; i < made->roots; ++i)
        if (made->mark_of_root[i] == mark) return made->root[i];
    return own;
}

/* Read a root record, of which the first row has been read. */
static bool read_root(record_reader *self) {
    const record_file_description *about = MODEL.record_file;
    record_file *made = self->made;
    double version = 0.0;
    char mark;
    if (!is_named(self, about->name, 1)) return false;
    if (made->roots == MOST_ROOTS) return refuse_record(self, "there must be at most %d of them; there are more", MOST_ROOTS);
    if (!table_read_number(self->cell[1], &version, &mark) || version != about->version)
        return refuse_record(self, "the format must be %d; got '%.*s'", about->version, QUOTED_CELL, self->cell[1]);
    self->mark = SEAL_BEGIN;
    record *root = (record *)keep(self, 1, sizeof *root);
    if (!root || !read_record(self, 0, root)) return false;
    char sum[20];
    print_text(sum, sizeof sum, "%016llx", self->mark);
    if (!named_cells(self, "checksum", 1)) return false;
    if (strcmp(self->cell[1], sum) != 0)
        return refuse_record(self, "the checksum must be %s, that of the numbers above; got '%.*s'", sum, QUOTED_CELL,
                             self->cell[1]);
    made->root[made->roots] = same_root(made, self->mark, root);
    made->mark_of_root[made->roots++] = self->mark;
    made->mark = made->roots == 1 ? self->mark : seal_hash(made->mark, &self->mark, sizeof self->mark);
    return true;
}

/* Read all root records of a file. */
static bool read_all(record_reader *self) {
    bool done = next_cells(self, MODEL.record_file->name) && read_root(self);
    reading found = NO_MORE_ROWS;
    while (done && (found = text_rows_next(&self->rows)) == ROW_READ) done = split_row(self) && read_root(self);
    return done && (found != ROW_REFUSED || refuse_record(self, "%s", self->rows.problem));
}

static bool refuse_path(record_reader *self, const char *why) {
    const int used = text_name_row(self->problem, PROBLEM_SIZE, MODEL.record_file->noun, self->path, 0);
    print_text(self->problem + used, (size_t)(PROBLEM_SIZE - used), ": %s. Give the path of a file that can be read.", why);
    return false;
}

static bool read_file_of_records(record_reader *self) {
    if (!is_plain_file(self->path)) return refuse_path(self, "it is a folder, a pipe or a device");
    FILE *file = fopen(self->path, "rb");
    if (!file) return refuse_path(self, "it cannot be opened");
    text_rows_begin(&self->rows, file);
    const bool done = read_all(self);
    fclose(file);
    return done;
}

/* Check that there is a root record for all owners, or one for each. */
static bool check_roots(const record_reader *self) {
    const record_file_description *about = MODEL.record_file;
    const int roots = self->made->roots;
    if (roots == 1 || roots == about->roots || about->roots == 0) return true;
    print_text(self->problem, PROBLEM_SIZE, "%s must name one %s for all %ss or one for each, %d; got %d. Correct it.",
               MODEL.variable[about->variable].name, about->noun, about->owner, about->roots, roots);
    return false;
}

/* Return whether a text is the path of one file: it has no semicolon, or a file has this name. */
static bool is_one_path(const char *text) {
    FILE *file = strchr(text, ';') && is_plain_file(text) ? fopen(text, "rb") : NULL;
    if (file) fclose(file);
    return file || !strchr(text, ';');
}

/* Read one file, or several whose paths semicolons separate. */
static bool read_files(record_reader *self, const char *paths) {
    self->path = paths;
    if (is_one_path(paths)) return read_file_of_records(self) && check_roots(self);
    char *rest = (char *)keep(self, (int)strlen(paths) + 1, 1), *path;
    if (!rest) return false;
    strcpy(rest, paths);
    cell_reading next;
    while ((next = text_next_cell(&rest, ';', &path)) == CELL_READ) {
        self->path = path;
        if (!read_file_of_records(self)) return false;
    }
    return next != CELL_REFUSED ? check_roots(self) : refuse_path(self, "its quotes must close");
}

record_file *records_read(const char *paths, char problem[PROBLEM_SIZE]) {
    record_reader *self = (record_reader *)calloc(1, sizeof *self);
    record_file *made = (record_file *)calloc(1, sizeof *made);
    if (self && made) {
        self->problem = problem;
        self->made = made;
    }
    if (!self || !made || !read_files(self, paths)) {
        records_free(made);
        made = NULL;
    }
    free(self);
    return made;
}

void records_free(record_file *self) {
    if (!self) return;
    for (record_memory *one = self->memory, *before; one; one = before) {
        before = one->before;
        free(one);
    }
    free(self);
}

double records_value(const value_of_record *value, const record_file *file) {
    const record *one = value->own;
    if (file) one = file->root[value->root < file->roots ? value->root : 0];
    for (int i = 0; i < value->steps; ++i) {
        const record_list *list = &one->list[value->step[i].list];
        const int entry = value->step[i].shared && list->count == 1 ? 0 : value->step[i].entry;
        if (entry >= list->count) return value->number < 0 ? 0.0 : NAN;
        one = list->first + entry;
    }
    return value->number < 0 ? record_as_number(one) : one->number[value->number];
}

bool records_are_exact(const record *root) {
    const double number = record_as_number(root);
    return number < 9007199254740992.0 && record_of_number(number) == root;
}
