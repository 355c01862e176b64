/* The one text that a variable may hold: the path of a table file, which is read when it is set, before the start. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "instance.h"

static kernel_status check_text(kernel *self, int variable) {
    const kernel_status status = kernel_check_reference(self, variable);
    if (status != KERNEL_OK || (MODEL.table_file && variable == MODEL.table_file->variable)) return status;
    return kernel_fail(self, KERNEL_ERROR, "%s must be set and read as a number; got a call for a text.",
                       MODEL.variable[variable].name);
}

void kernel_leave_table(kernel *self) {
    table_free(self->table);
    free(self->table_path);
    self->table = NULL;
    self->table_path = NULL;
    self->run.now->table = 0;
}

kernel_status kernel_set_text(kernel *self, int variable, const char *text) {
    const kernel_status status = check_text(self, variable);
    if (status != KERNEL_OK) return status;
    const char *name = MODEL.variable[variable].name, *fixed = why_fixed(&MODEL.variable[variable], self->system != NULL);
    if (fixed) return kernel_fail(self, KERNEL_ERROR, "%s %s", name, fixed);
    if (!text)
        return kernel_fail(self, KERNEL_ERROR,
                           "%s must be the path of a file; got a null pointer. Set an empty text for no file.", name);
    if (!*text) {
        kernel_leave_table(self);
        return KERNEL_OK;
    }
    const char *noun = MODEL.table_file->noun;
    char problem[PROBLEM_SIZE];
    snprintf(problem, sizeof problem, "There is not enough memory for a %s.", noun);
    char *path = (char *)malloc(strlen(text) + 1);
    table_file *read = path ? table_read(text, problem) : NULL;
    if (!read) {
        free(path);
        return kernel_fail(self, KERNEL_ERROR, "%s The %s before it stays in force.", problem, noun);
    }
    kernel_leave_table(self);
    self->table = read;
    self->run.now->table = read->mark;
    self->table_path = strcpy(path, text);
    return KERNEL_OK;
}

kernel_status kernel_get_text(kernel *self, int variable, const char **text) {
    const kernel_status status = check_text(self, variable);
    if (status == KERNEL_OK) *text = self->table_path ? self->table_path : "";
    return status;
}
