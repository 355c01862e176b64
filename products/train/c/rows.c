/* Memory for rows. The first cell of each lies at a line of the cache. */
#include "rows.h"

#include <stdlib.h>

double *rows_lay(const rows_part *part, size_t parts, long long int stride) {
    long long int rows = 0;
    for (size_t n = 0; n < parts; ++n) rows += part[n].rows;
    double *memory = (double *)malloc((size_t)(rows * stride + ROWS_EDGE) * sizeof(double));
    if (!memory) return NULL;
    const size_t over = (uintptr_t)memory / sizeof(double) % ROWS_EDGE;
    double *row = memory + ROWS_EDGE + (over ? ROWS_EDGE - over : 0);
    for (size_t n = 0; n < parts; ++n) {
        *part[n].first = row;
        for (int k = 0; k < part[n].rows; ++k, row += stride) rows_fill(row, stride, part[n].value);
    }
    return memory;
}
