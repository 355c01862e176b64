/* Rows of numbers for functions of cells. A row contains one number of each cell, after ROWS_EDGE numbers that do not belong to
 * cells. As many follow the last cell; the next row begins a stride further. */
#ifndef ROWS_H
#define ROWS_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "lanes_widest.h"

enum { ROWS_EDGE = 8 };

static inline long long int rows_stride(long long int count) { return (count + 7) / 8 * 8 + 3 * ROWS_EDGE; }

/* Sets a row, from its first cell on, with its edges. */
static inline void rows_fill(double *row, long long int stride, double value) {
    for (long long int i = -ROWS_EDGE; i < stride - ROWS_EDGE; ++i) row[i] = value;
}

/* Copies the numbers of all cells of a row. */
static inline void rows_copy(double *to, const double *from, long long int count) {
    memcpy(to, from, (size_t)count * sizeof(double));
}

/* Copies numbers without edges, `count` of each row, into rows; and back. */
static inline void rows_put(double *row, long long int stride, const double *numbers, int rows, long long int count) {
    for (int n = 0; n < rows; ++n) rows_copy(row + n * stride, numbers + n * count, count);
}
static inline void rows_get(double *numbers, const double *row, long long int stride, int rows, long long int count) {
    for (int n = 0; n < rows; ++n) rows_copy(numbers + n * count, row + n * stride, count);
}

/* True if a number is above 0. */
static inline int rows_any(const double *numbers, long long int count) {
    for (long long int i = 0; i < count; ++i)
        if (numbers[i] > 0.0) return 1;
    return 0;
}

/* Some rows: where the place of their first cell is written, how many, and their first value. */
typedef struct {
    double **first;
    int rows;
    double value;
} rows_part;
/* Allocates memory for all parts; returns NULL if out of memory. */
double *rows_lay(const rows_part *part, size_t parts, long long int stride);
#define ROWS_LAY(parts, stride) rows_lay(parts, sizeof(parts) / sizeof *(parts), stride)

/* A function of rows for the lanes of this processor, from its variants for one, two, four and eight. */
#define ROWS_CALL(lanes, self, one, two, four, eight)                                                                          \
    ((lanes) >= 8 ? (eight) : (lanes) >= 4 ? (four) : (lanes) >= 2 ? (two) : (one))(self)
#if LANES_WIDEST >= 8
#define IN_LANES(what) ROWS_CALL(self->lanes, self, what##_1, what##_2, what##_4, what##_8)
#elif LANES_WIDEST >= 2
#define IN_LANES(what) ROWS_CALL(self->lanes, self, what##_1, what##_2, what##_2, what##_2)
#else
#define IN_LANES(what) what##_1(self)
#endif

/* Defines a function that calls one of cells for `count` cells, LANES at a time; `i` is the first of them. Stands between
 * lanes.h and lanes_end.h. */
#define ROWS_FUNCTION(name, type, count, cells, ...)                                                                           \
    void LANES_NAME(name)(type * self) {                                                                                       \
        for (long long int i = 0; i < (count); i += LANES) LANES_NAME(cells)(__VA_ARGS__, self->stride);                       \
        LANES_LEAVE;                                                                                                           \
    }

#endif
