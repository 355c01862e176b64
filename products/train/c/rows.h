/* Rows of numbers for functions of cells. A row contains one number of each cell, after ROWS_EDGE numbers that do not belong to
 * cells. As many follow the last cell; the next row begins a stride further. */
#ifndef ROWS_H
#define ROWS_H

#include <stddef.h>
#include <stdint.h>

#include "lanes_widest.h"

enum { ROWS_EDGE = 8 };

static inline long long int rows_stride(long long int count) { return (count + 7) / 8 * 8 + 3 * ROWS_EDGE; }

/* Place of the first cell of the first row in memory with ROWS_SPARE spare numbers: at a line of the cache, as then in all
 * other rows. */
enum { ROWS_SPARE = ROWS_EDGE };
static inline double *rows_first(double *memory) {
    const size_t over = (uintptr_t)memory / sizeof(double) % ROWS_EDGE;
    return memory + ROWS_EDGE + (over ? ROWS_EDGE - over : 0);
}

/* Sets a row, from its first cell on, with its edges. */
static inline void rows_fill(double *row, long long int stride, double value) {
    for (long long int i = -ROWS_EDGE; i < stride - ROWS_EDGE; ++i) row[i] = value;
}

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

#endif
