/* Start values of an FMU's own among its resources: start_values.h. */
#include <stdlib.h>
#include <string.h>

#include "start_values.h"
#include "table_file.h"
#include "text_rows.h"

static bool refuse_start(const text_rows *row, const char *why, char problem[MESSAGE_SIZE]) {
    print_text(problem, MESSAGE_SIZE, "resources/%s, row %d: %s.", START_VALUES, row->number, why);
    return false;
}

/* The cells NAME and VALUE of a row, and how many cells are filled; 3: more than these, or quotes do not close. */
static int cells_of_start(char *text, const char *pair[2]) {
    const char separator = text_separator(text);
    char *cell;
    int filled = 0;
    cell_reading found;
    for (int at = 0; (found = text_next_cell(&text, separator, &cell)) == CELL_READ; ++at) {
        filled += *cell != '\0';
        if (*cell && at > 1) return 3;
        if (at < 2) pair[at] = cell;
    }
    return found == CELL_REFUSED ? 3 : filled;
}

/* Set the variable of a row NAME,VALUE. */
static bool take_row(text_rows *row, const char *model, fmu_object *self, start_take *take, char problem[MESSAGE_SIZE]) {
    char why[MESSAGE_SIZE / 2], mark;
    const char *pair[2] = {"", ""};
    const int filled = cells_of_start(row->text, pair);
    double number;
    if (filled == 0) return true;
    const bool is_pair = filled == 2 && table_read_number(pair[1], &number, &mark);
    const start_taken taken = is_pair ? take(self, pair[0], number) : START_UNKNOWN;
    if (taken != START_UNKNOWN) return taken == START_TAKEN;
    print_text(why, sizeof why, "a row must have the name of a variable of %.40s and its number; got '%.60s'. Write NAME,VALUE",
               model, pair[0]);
    return refuse_start(row, why, problem);
}

bool start_values_read(FILE *file, const char *model, fmu_object *self, start_take *take, char problem[MESSAGE_SIZE]) {
    text_rows *rows = (text_rows *)malloc(sizeof *rows);
    bool good = rows != NULL;
    reading found = NO_MORE_ROWS;
    *problem = '\0';
    if (rows) text_rows_begin(rows, file);
    else strcpy(problem, "There is not enough memory for start values.");
    while (good && (found = text_rows_next(rows)) == ROW_READ) good = take_row(rows, model, self, take, problem);
    if (found == ROW_REFUSED) good = refuse_start(rows, rows->problem, problem);
    fclose(file);
    free(rows);
    return good;
}
