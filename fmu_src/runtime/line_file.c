/* A line from a file: rows of numbers under a row of names, separated by commas. */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#if defined(__unix__) || defined(__APPLE__) || defined(_WIN32)
#include <sys/types.h>

#include <sys/stat.h>
#endif

#include "line.h"

enum { LONGEST_ROW = 2048, MOST_ROWS = 4000000, FIRST_ROOM = 1024 };
static const double GAUGE = 1.5;      /* m, between the rails' heads, over which cant is measured: EN 13803 */
static const double LARGEST_TURN = 0.05; /* rad between two rows, between which the plan is a polynomial */

/* Columns of the file with their limits. The tightest curve is that of a depot, 50 m; EN 13803 knows no cant above
 * 0.18 m; the steepest railway on racks rises by 0.48. */
enum { AT, CURVATURE, CANT, GRADIENT, WIDENING, LEFT_LATERAL, LEFT_VERTICAL, RIGHT_LATERAL, RIGHT_VERTICAL,
       LEFT_FRICTION, RIGHT_FRICTION, COLUMNS };
static const struct {
    const char *name, *unit;
    double low, high;
} COLUMN[COLUMNS] = {
    {"distance", "m", -1e7, 1e7},        {"curvature", "1/m", -0.02, 0.02},
    {"cant", "m", -0.3, 0.3},            {"gradient", "", -0.5, 0.5},
    {"gauge_widening", "m", -0.02, 0.1}, {"left_lateral", "m", -0.1, 0.1},
    {"left_vertical", "m", -0.1, 0.1},   {"right_lateral", "m", -0.1, 0.1},
    {"right_vertical", "m", -0.1, 0.1},  {"left_friction", "", 0.0, 10.0},
    {"right_friction", "", 0.0, 10.0},
};

static const char MARK_OF_UTF8[] = "\xEF\xBB\xBF"; /* which some spreadsheets write in front */

typedef struct {
    FILE *file;
    const char *path;
    char *problem;
    int place[COLUMNS]; /* of each column among the cells of a row; -1: missing */
    int column[COLUMNS]; /* of each cell */
    int cells, rows, room, number; /* the number of the row that was read last, from 1 */
    double *value[COLUMNS];
} reader;

/* 0, once the sentence tells the file and, where one was read, the row. */
static int refuse_file(reader *self, const char *format, ...) LIKE_PRINTF(2);
static int refuse_file(reader *self, const char *format, ...) {
    const int room = PROBLEM_SIZE - 2;
    int used = snprintf(self->problem, (size_t)room, "Line %.150s", self->path);
    if (self->number) used += snprintf(self->problem + used, (size_t)(room - used), ", row %d", self->number);
    used += snprintf(self->problem + used, (size_t)(room - used), ": ");
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(self->problem + used, (size_t)(room - used), format, arguments);
    va_end(arguments);
    strcat(self->problem, ".");
    return 0;
}

/* 1: a row; 0: the end; -1: refused. Blank rows are passed over. */
static int next_row(reader *self, char text[LONGEST_ROW]) {
    while (fgets(text, LONGEST_ROW, self->file)) {
        ++self->number;
        const size_t length = strcspn(text, "\r\n");
        if (text[length] == '\0' && !feof(self->file)) {
            (void)refuse_file(self, "it is longer than 2000 characters, or no text; give a table of numbers");
            return -1;
        }
        text[length] = '\0';
        for (const char *c = text + 3 * !strncmp(text, MARK_OF_UTF8, 3); *c; ++c)
            if ((unsigned char)*c > '~' || ((unsigned char)*c < ' ' && *c != '\t')) {
                (void)refuse_file(self, "it holds the byte %d, which is no plain text; give a table of numbers",
                                  (unsigned char)*c);
                return -1;
            }
        if (text[strspn(text, " \t")] != '\0') return 1;
    }
    return 0;
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

static int read_names(reader *self) {
    char text[LONGEST_ROW];
    const int found = next_row(self, text);
    if (found < 0) return 0;
    if (!found) return refuse_file(self, "it is empty; give a row of names and rows of numbers");
    for (int i = 0; i < COLUMNS; ++i) self->place[i] = -1;
    char *rest = text + 3 * !strncmp(text, MARK_OF_UTF8, 3);
    for (const char *name; (name = cell(&rest)); ++self->cells) {
        int which = 0;
        while (which < COLUMNS && strcmp(name, COLUMN[which].name) != 0) ++which;
        if (which == COLUMNS || self->place[which] >= 0) {
            return refuse_file(self, "the column \"%.40s\" is %s; give distance, curvature, cant, gradient, and where known "
                     "gauge_widening and, behind left_ and right_, lateral, vertical, friction",
                     name, which == COLUMNS ? "not known" : "there twice");
        }
        self->place[which] = self->cells;
        self->column[self->cells] = which;
    }
    for (int i = AT; i <= GRADIENT; ++i)
        if (self->place[i] < 0) {
            return refuse_file(self, "the column %s is missing", COLUMN[i].name);
        }
    return 1;
}

int line_read_number(const char *text, double *value) {
    static const double power[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                   1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    const int negative = *text == '-';
    unsigned long long digits = 0;
    int exponent = 0, seen = 0, behind = 0, kept = 0;
    if (*text == '-' || *text == '+') ++text;
    for (; (*text >= '0' && *text <= '9') || (*text == '.' && !behind); ++text) {
        if (*text == '.') {
            behind = 1;
            continue;
        }
        seen = 1;
        exponent -= behind;
        if (kept < 18) {
            digits = 10 * digits + (unsigned long long)(*text - '0');
            kept += digits > 0;
        } else {
            ++exponent;
        }
    }
    if (seen && (*text == 'e' || *text == 'E')) {
        const int down = text[1] == '-';
        int own = 0;
        text += text[1] == '-' || text[1] == '+' ? 2 : 1;
        if (!*text) return 0;
        for (; *text >= '0' && *text <= '9'; ++text)
            if (own < 1000) own = 10 * own + *text - '0';
        exponent += down ? -own : own;
    }
    if (!seen || *text) return 0;
    double size = (double)digits;
    for (; exponent > 0 && size > 0.0 && size < 1e300; exponent -= exponent < 22 ? exponent : 22)
        size *= power[exponent < 22 ? exponent : 22];
    for (; exponent < 0 && size > 0.0; exponent += exponent > -22 ? -exponent : 22)
        size /= power[exponent > -22 ? -exponent : 22];
    *value = negative ? -size : size;
    return 1;
}

static int grow(reader *self) {
    if (self->rows == MOST_ROWS) return refuse_file(self, "there are more than 4 000 000 rows; cut the line into several");
    if (self->rows < self->room) return 1;
    self->room = self->room ? 2 * self->room : FIRST_ROOM;
    for (int i = 0; i < COLUMNS; ++i) {
        if (self->place[i] < 0) continue;
        double *more = (double *)realloc(self->value[i], (size_t)self->room * sizeof(double));
        if (!more) return refuse_file(self, "there is not enough memory for it");
        self->value[i] = more;
    }
    return 1;
}

static int check_value(reader *self, int column, const char *text, double value) {
    const char *name = COLUMN[column].name, *unit = COLUMN[column].unit;
    const char *blank = *unit ? " " : "";
    if (value >= COLUMN[column].low && value <= COLUMN[column].high) return 1;
    return refuse_file(self, "%s is %.40s%s%s; give a value from %g to %g%s%s", name, text, blank, unit,
             COLUMN[column].low, COLUMN[column].high, blank, unit);
}

static int read_row(reader *self, char *text) {
    int count = 0;
    for (const char *one; (one = cell(&text)); ++count) {
        if (count == self->cells) {
            count = -1;
            break;
        }
        const int column = self->column[count];
        double value = 0.0;
        if (!line_read_number(one, &value)) {
            return refuse_file(self, "%s is \"%.40s\"; give a finite number", COLUMN[column].name, one);
        }
        if (!check_value(self, column, one, value)) return 0;
        self->value[column][self->rows] = value;
    }
    if (count == self->cells) return 1;
    return refuse_file(self, "it does not have the %d values that the names ask for", self->cells);
}

/* A row must lie behind the one before it, and not so far that the plan between them is no polynomial. */
static int check_way(reader *self) {
    const int row = self->rows;
    if (row == 0) return 1;
    const double before = self->value[AT][row - 1], at = self->value[AT][row];
    if (!(at - before >= 1e-3)) {
        return refuse_file(self, "distance is %.12g m behind %.12g m; let it grow by 1 mm at least", at, before);
    }
    const double *curvature = self->value[CURVATURE];
    const double turn = fmax(fabs(curvature[row]), fabs(curvature[row - 1])) * (at - before);
    if (turn <= LARGEST_TURN) return 1;
    return refuse_file(self,
                       "the line turns by %.3g rad over the %.6g m from the row before; give rows between, for %g rad "
                       "at most",
                       turn, at - before, LARGEST_TURN);
}

static int read_rows(reader *self) {
    char text[LONGEST_ROW];
    int found;
    while ((found = next_row(self, text)) > 0) {
        if (!grow(self) || !read_row(self, text) || !check_way(self)) return 0;
        ++self->rows;
    }
    if (found == 0 && self->rows < 2) return refuse_file(self, "there are fewer than two rows of numbers");
    return found == 0;
}

static void mark(line_data *self) {
    unsigned long long hash = 14695981039346656037ull; /* FNV-1a by words, 64 bits */
    for (int row = LINE_CANT; row < LINE_ROWS; ++row)
        for (int i = 0; self->row[row] && i < self->nodes; ++i) {
            unsigned long long bits;
            memcpy(&bits, &self->row[row][i], sizeof bits);
            hash = (hash ^ bits) * 1099511628211ull;
        }
    self->mark = hash;
}

/* Position of both rails, the mean of each row, and half of what they stand too far apart. */
static void part_rails(const reader *self, double *lateral, double *spread) {
    const double *left = self->value[LEFT_LATERAL], *right = self->value[RIGHT_LATERAL];
    const double *wide = self->value[WIDENING];
    for (int i = 0; i < self->rows; ++i) {
        const double at_left = left ? left[i] : 0.0, at_right = right ? right[i] : 0.0;
        lateral[i] = (at_left + at_right) / 2.0;
        spread[i] = (at_left - at_right + (wide ? wide[i] : 0.0)) / 2.0;
    }
}

/* The rows of a line, those of the file and room for what follows from them. 0: not enough memory. */
static int make_rows(reader *self, line_data *made) {
    static const int taken[][2] = {{AT, LINE_DISTANCE},        {CURVATURE, LINE_CURVATURE},
                                   {CANT, LINE_CANT},          {GRADIENT, LINE_GRADIENT},
                                   {LEFT_VERTICAL, LINE_LEFT}, {RIGHT_VERTICAL, LINE_RIGHT},
                                   {LEFT_FRICTION, LINE_LEFT_FRICTION}, {RIGHT_FRICTION, LINE_RIGHT_FRICTION}};
    static const int added[] = {LINE_HEADING,   LINE_RISE,  LINE_AHEAD,     LINE_AHEAD_FAR, LINE_ASIDE,
                                LINE_ASIDE_FAR, LINE_LEVEL, LINE_LEVEL_FAR, LINE_LATERAL,   LINE_SPREAD};
    const int apart = self->value[LEFT_LATERAL] || self->value[RIGHT_LATERAL] || self->value[WIDENING];
    made->nodes = self->rows;
    for (size_t i = 0; i < sizeof taken / sizeof taken[0]; ++i) {
        made->row[taken[i][1]] = self->value[taken[i][0]];
        self->value[taken[i][0]] = NULL;
    }
    for (size_t i = 0; i < sizeof added / sizeof added[0] - (apart ? 0 : 2); ++i)
        if (!(made->row[added[i]] = (double *)malloc((size_t)self->rows * sizeof(double)))) return 0;
    if (apart) part_rails(self, made->row[LINE_LATERAL], made->row[LINE_SPREAD]);
    for (int i = 0; i < self->rows; ++i) made->row[LINE_CANT][i] = -made->row[LINE_CANT][i] / GAUGE;
    return 1;
}

/* Whether a file that ends: a pipe would be waited for, perhaps for ever. Where nobody can tell, it is believed. */
static int is_plain_file(const char *path) {
#if defined(_WIN32)
    struct _stat about;
    return _stat(path, &about) != 0 || (about.st_mode & _S_IFMT) == _S_IFREG;
#elif defined(__unix__) || defined(__APPLE__)
    struct stat about;
    return stat(path, &about) != 0 || S_ISREG(about.st_mode);
#else
    (void)path;
    return 1;
#endif
}

line_data *line_read(const char *path, char problem[PROBLEM_SIZE]) {
    reader self;
    memset(&self, 0, sizeof self);
    self.path = path;
    self.problem = problem;
    if (!is_plain_file(path)) {
        (void)refuse_file(&self, "it is a folder, a pipe or a device; give the path of a file");
        return NULL;
    }
    self.file = fopen(path, "rb");
    line_data *made = NULL;
    if (!self.file) {
        (void)refuse_file(&self, "it cannot be opened; give the path of a file that can be read");
        return NULL;
    }
    if (read_names(&self) && read_rows(&self)) {
        made = (line_data *)calloc(1, sizeof *made);
        if (made && make_rows(&self, made)) {
            line_integrate(made);
            mark(made);
        } else {
            (void)refuse_file(&self, "there is not enough memory for it");
            line_free(made);
            made = NULL;
        }
    }
    for (int i = 0; i < COLUMNS; ++i) free(self.value[i]);
    fclose(self.file);
    return made;
}
