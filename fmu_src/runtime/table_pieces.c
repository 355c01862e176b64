/* Between the rows of a table: polynomials for the generated functions. */
#include <math.h>
#include <string.h>

#include "table_file.h"

/* Slope and bend at a row by the parabola through it and its neighbours; none at the ends, beyond which nothing changes. */
static void differences(const table_file *self, const double *value, int row, double *slope, double *bend) {
    const double *s = self->column[0];
    *slope = *bend = 0.0;
    if (row == 0 || row == self->rows - 1) return;
    const double before = s[row] - s[row - 1], behind = s[row + 1] - s[row];
    const double rise = (value[row] - value[row - 1]) / before, next = (value[row + 1] - value[row]) / behind;
    *slope = (rise * behind + next * before) / (before + behind);
    *bend = 2.0 * (next - rise) / (before + behind);
}

void table_quintic(const double first[3], const double second[3], double gain, double distance, double *c) {
    const double h = distance, square = h * h;
    c[0] = first[0];
    c[1] = first[1];
    c[2] = first[2] / 2.0;
    c[3] = (20.0 * gain - (8.0 * second[1] + 12.0 * first[1]) * h - (3.0 * first[2] - second[2]) * square) /
           (2.0 * square * h);
    c[4] = (-30.0 * gain + (14.0 * second[1] + 16.0 * first[1]) * h + (3.0 * first[2] - 2.0 * second[2]) * square) /
           (2.0 * square * square);
    c[5] = (12.0 * gain - 6.0 * (second[1] + first[1]) * h - (first[2] - second[2]) * square) / (2.0 * square * square * h);
}

void table_straight(const table_file *self, int column, int row, double *c) {
    const double *s = self->column[0], *value = self->column[column];
    memset(c, 0, MOST_TERMS * sizeof *c);
    c[0] = value[row];
    c[1] = (value[row + 1] - value[row]) / (s[row + 1] - s[row]);
}

void table_smooth(const table_file *self, int column, int row, double *c) {
    const double *s = self->column[0], *value = self->column[column];
    double end[2][3];
    for (int i = 0; i < 2; ++i) {
        end[i][0] = value[row + i];
        differences(self, value, row + i, &end[i][1], &end[i][2]);
    }
    table_quintic(end[0], end[1], end[1][0] - end[0][0], s[row + 1] - s[row], c);
}

void table_integral(const table_file *self, int column, int row, double start, double *c) {
    const double *s = self->column[0], *value = self->column[column];
    const double h = s[row + 1] - s[row], gain = (value[row + 1] - value[row]) / h;
    double slope[2], bend;
    for (int i = 0; i < 2; ++i) differences(self, value, row + i, &slope[i], &bend);
    c[0] = start;
    c[1] = value[row];
    c[2] = slope[0] / 2.0;
    c[3] = (3.0 * gain - 2.0 * slope[0] - slope[1]) / (3.0 * h);
    c[4] = (slope[0] + slope[1] - 2.0 * gain) / (4.0 * h * h);
    c[5] = 0.0;
}

double table_value(const double *c, double x) {
    return c[0] + x * (c[1] + x * (c[2] + x * (c[3] + x * (c[4] + x * c[5]))));
}

double table_slope(const double *c, double x) {
    return c[1] + x * (2.0 * c[2] + x * (3.0 * c[3] + x * (4.0 * c[4] + x * 5.0 * c[5])));
}

/* The row at or before a place, the first or the last but one beyond the ends. */
static int row_before(const table_file *self, double at, int guess) {
    const double *s = self->column[0];
    int low = 0, high = self->rows - 2;
    if (guess >= 0 && guess <= high) {
        if (at >= s[guess]) {
            if (guess == high || at < s[guess + 1]) return guess;
            low = guess + 1;
            if (at < s[low + 1]) return low;
        } else {
            high = guess > 0 ? guess - 1 : 0;
        }
    }
    while (low < high) {
        const int middle = (low + high + 1) / 2;
        if (at >= s[middle])
            low = middle;
        else
            high = middle - 1;
    }
    return low;
}

/* Beyond the ends a piece keeps its value there, or goes on straight with its slope. width: to the end. */
static void leave(bool goes_on, double width, double *c) {
    const double slope = goes_on ? table_slope(c, width) : 0.0;
    c[0] = table_value(c, width);
    c[1] = slope;
    memset(c + 2, 0, (MOST_TERMS - 2) * sizeof *c);
}

void table_look_up(const table_file *self, const table_description *table, double at, int *guess, double held[2],
                   double *coefficient) {
    const double *s = self->column[0];
    const int last = self->rows - 1;
    const bool before = at < s[0], behind = at >= s[last];
    const int row = *guess = row_before(self, at, *guess);
    const double origin = *coefficient++ = behind ? s[last] : s[row];
    held[0] = before ? -INFINITY : origin;
    held[1] = before ? s[0] : behind ? INFINITY : s[row + 1];
    for (int i = 0; i < table->pieces; ++i) {
        const piece_description *piece = &MODEL.table_file->piece[table->piece[i]];
        double c[MOST_TERMS] = {0};
        MODEL.table_file->piece_between(self, table->piece[i], row, c);
        if (before || behind) leave(piece->goes_on, behind ? s[last] - s[row] : 0.0, c);
        for (int power = 0; power <= piece->degree; ++power) *coefficient++ = c[power];
    }
}
