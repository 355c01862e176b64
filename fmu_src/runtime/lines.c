/* The line that an instance runs on, chosen by the path of its file before the start. */
#include <stdlib.h>
#include <string.h>

#include "internal.h"

static int check_text(kernel *self, int variable) {
    const int status = kernel_check_reference(self, variable);
    if (status != KERNEL_OK || variable == MODEL.line_file) return status;
    return kernel_fail(self, KERNEL_ERROR, "%s is a number, no text.", MODEL.variable[variable].name);
}

void kernel_leave_line(kernel *self) {
    line_free(self->line);
    free(self->line_path);
    self->line = NULL;
    self->line_path = NULL;
    self->now.line = 0;
}

int kernel_set_text(kernel *self, int variable, const char *text) {
    const int status = check_text(self, variable);
    if (status != KERNEL_OK) return status;
    const char *name = MODEL.variable[variable].name;
    if (self->system)
        return kernel_fail(self, KERNEL_ERROR, "%s is a parameter and fixed once the run has begun; reset first.", name);
    if (!text) return kernel_fail(self, KERNEL_ERROR, "Set %s to the path of a file, or to no text for none.", name);
    if (!*text) {
        kernel_leave_line(self);
        return KERNEL_OK;
    }
    char problem[PROBLEM_SIZE] = "There is not enough memory for a line.";
    char *path = (char *)malloc(strlen(text) + 1);
    line_data *read = path ? line_read(text, problem) : NULL;
    if (!read) {
        free(path);
        return kernel_fail(self, KERNEL_ERROR, "%s The line before it stays in force.", problem);
    }
    kernel_leave_line(self);
    self->line = read;
    self->now.line = read->mark;
    self->line_path = strcpy(path, text);
    return KERNEL_OK;
}

int kernel_get_text(kernel *self, int variable, const char **text) {
    const int status = check_text(self, variable);
    if (status == KERNEL_OK) *text = self->line_path ? self->line_path : "";
    return status;
}
