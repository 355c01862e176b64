/* Run a kernel and print its outputs in hexadecimal: stop LANES STEP ROWS STEPS_OF_A_ROW NAME=VALUE ...
 * The first line is the number of lanes. A VALUE that is not a number is passed as a string. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "kernel.h"
#include "model.h"
#include "studies.h"

static int give(kernel *self, char *assignment) {
    char *value = strchr(assignment, '='), *end;
    *value++ = '\0';
    const double number = strtod(value, &end);
    for (int i = 0; i < MODEL.variables; ++i)
        if (strcmp(MODEL.variable[i].name, assignment) == 0)
            return *end ? kernel_set_text(self, i, value) : kernel_set(self, i, number);
    return KERNEL_ERROR;
}

static int fail(kernel *self, const char *what) {
    fprintf(stderr, "%s: %s\n", what, kernel_message(self));
    kernel_free(self);
    return 1;
}

int main(int count, char **word) {
    kernel *self = kernel_create();
    if (count < 5 || !self) return 2;
    printf("%d\n", kernel_use_lanes(self, atoi(word[1])));
    const double step = atof(word[2]);
    for (int n = 5; n < count; ++n)
        if (give(self, word[n]) > KERNEL_WARNING) return fail(self, word[n]);
    if (kernel_initialise(self, 0.0) > KERNEL_WARNING) return fail(self, "start");
    const int steps = atoi(word[4]);
    for (int row = 0; row < atoi(word[3]); ++row) {
        for (int n = row * steps; n < (row + 1) * steps; ++n)
            if (kernel_step(self, n * step, step) > KERNEL_WARNING) return fail(self, "step");
        for (int i = 0; i < MODEL.variables; ++i) {
            double value = 0.0;
            if (MODEL.variable[i].causality != CAUSALITY_OUTPUT) continue;
            if (kernel_get(self, i, &value) > KERNEL_WARNING) return fail(self, MODEL.variable[i].name);
            printf("%s %a ", MODEL.variable[i].name, value);
        }
        printf("\n");
    }
    kernel_free(self);
    return 0;
}
