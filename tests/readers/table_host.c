/* Reads table files as an FMU does; each line of stdin is a path. For each file it writes the number of rows and, by row,
 * the values of the model's own columns, 0 for a missing one. For a refused file it writes -1, and the length and the
 * text of the message. */
#include <locale.h>
#include <stdio.h>
#include <string.h>

#include "given.h" /* TABLE_FILE */

const model_description MODEL = {.name = "host", .table_file = &TABLE_FILE};

int main(void) {
    setlocale(LC_ALL, "");
    char path[4096], problem[PROBLEM_SIZE];
    while (fgets(path, sizeof path, stdin)) {
        path[strcspn(path, "\n")] = '\0';
        memset(problem, 0, sizeof problem);
        table_file *found = table_read(path, problem);
        const int rows = found ? found->rows : -1, length = (int)strlen(problem);
        fwrite(&rows, sizeof rows, 1, stdout);
        if (!found) fwrite(&length, sizeof length, 1, stdout);
        if (!found) fwrite(problem, 1, (size_t)length, stdout);
        const double none = 0.0;
        for (int row = 0; row < rows; ++row)
            for (int i = 0; i < TABLE_FILE.columns; ++i)
                fwrite(found->column[i] ? &found->column[i][row] : &none, sizeof none, 1, stdout);
        table_free(found);
    }
    return 0;
}
