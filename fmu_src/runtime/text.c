/* The texts that variables may hold: paths of a table file and of a file of records, which are read when they are set, before
 * the start. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "instance.h"

/* Return whether a variable names the table file or the file of records. */
static bool names_table(int variable) { return MODEL.table_file && variable == MODEL.table_file->variable; }
static bool names_records(int variable) { return MODEL.record_file && variable == MODEL.record_file->variable; }

static kernel_status check_text(kernel *self, int variable) {
    const kernel_status status = kernel_check_reference(self, variable);
    if (status != KERNEL_OK || names_table(variable) || names_records(variable)) return status;
    return kernel_fail(self, KERNEL_ERROR, "%s must be set and read as a number; got a call for a text.",
                       MODEL.variable[variable].name);
}

void kernel_leave_table(kernel *self) {
    table_free(self->table);
    free(self->table_path);
    self->table = NULL;
    self->table_path = NULL;
    self->own_table = false;
    self->run.now->table = 0;
}

void kernel_leave_records(kernel *self) {
    records_free(self->records);
    free(self->records_path);
    self->records = NULL;
    self->records_path = NULL;
    self->run.now->records = 0;
}

/* Read a file in the place of the one before; return whether it could be read, with a message if not. */
static bool take_table(kernel *self, const char *text, char *path, char problem[PROBLEM_SIZE]) {
    table_file *read = table_read(text, problem);
    if (!read) return false;
    kernel_leave_table(self);
    self->table = read;
    self->run.now->table = read->mark;
    self->table_path = strcpy(path, text);
    return true;
}

static bool take_records(kernel *self, const char *text, char *path, char problem[PROBLEM_SIZE]) {
    record_file *read = records_read(text, problem);
    if (!read) return false;
    kernel_leave_records(self);
    self->records = read;
    self->run.now->records = read->mark;
    self->records_path = strcpy(path, text);
    return true;
}

kernel_status kernel_set_text(kernel *self, int variable, const char *text) {
    const kernel_status status = check_text(self, variable);
    if (status != KERNEL_OK) return status;
    const char *name = MODEL.variable[variable].name, *fixed = why_fixed(&MODEL.variable[variable], self->system != NULL);
    const bool table = names_table(variable);
    if (fixed) return kernel_fail(self, KERNEL_ERROR, "%s %s", name, fixed);
    if (!text)
        return kernel_fail(self, KERNEL_ERROR,
                           "%s must be the path of a file; got a null pointer. Set an empty text for the default.", name);
    if (!*text) {
        (table ? kernel_leave_table : kernel_leave_records)(self);
        return KERNEL_OK;
    }
    self->warned[variable] = 0;
    const char *noun = table ? MODEL.table_file->noun : MODEL.record_file->noun;
    char problem[PROBLEM_SIZE];
    snprintf(problem, sizeof problem, "There is not enough memory for a %s.", noun);
    char *path = (char *)malloc(strlen(text) + 1);
    if (path && (table ? take_table : take_records)(self, text, path, problem)) return KERNEL_OK;
    free(path);
    return kernel_fail(self, KERNEL_ERROR, "%s The %s before it stays in force.", problem, noun);
}

kernel_status kernel_get_text(kernel *self, int variable, const char **text) {
    const kernel_status status = check_text(self, variable);
    if (status != KERNEL_OK) return status;
    const char *path = names_table(variable) ? self->table_path : self->records_path;
    *text = path ? path : "";
    return status;
}
