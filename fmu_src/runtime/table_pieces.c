/* Between the rows of a table: straight lines with rounded corners, as polynomials for the generated functions. */
#include <math.h>
#include <string.h>

#include "table_file.h"

/* A bend that changes a value by less than this share of its column's limits is rounding of the file's numbers. */
static const double STRAIGHT = 1e-12;

static double width_of(const table_file *self, int row) { return self->column[0][row + 1] - self->column[0][row]; }

/* Return the slope from a row to the next; 0 beyond the ends. */
static double secant(const table_file *self, const double *value, int row) {
    return row < 0 || row > self->rows - 2 ? 0.0 : (value[row + 1] - value[row]) / width_of(self, row);
}

/* Return whether the corners at both ends of an interval meet: then one curve joins them. */
static bool meets(const table_file *self, int row) {
    return row >= 0 && row <= self->rows - 2 && width_of(self, row) <= 2.0 * MODEL.table_file->rounding;
}

/* Return the distance over which a corner is rounded between a row and the next. */
static double reach(const table_file *self, int row) {
    return meets(self, row) ? width_of(self, row) : MODEL.table_file->rounding;
}

/* Return the slope at a row between two straight lines, each rounded over `left` or `right`. It is that of the parabola through
 * the row and a place on each line. It is 0 if the row is the highest or lowest of three: values must stay within those of the
 * rows. */
static double slope_between(double before, double behind, double left, double right) {
    return before * behind > 0.0 ? (before * right + behind * left) / (left + right) : 0.0;
}

/* The same for cubics, which rise between two rows where no slope is above three times that of the straight line (F. N.
 * Fritsch and R. E. Carlson (1980), Monotone piecewise cubic interpolation, SIAM Journal on Numerical Analysis 17). */
static double cubic_slope(const table_file *self, const double *value, int row) {
    const double before = secant(self, value, row - 1), behind = secant(self, value, row);
    const double slope = slope_between(before, behind, reach(self, row - 1), reach(self, row));
    return copysign(fmin(fabs(slope), 3.0 * fmin(fabs(before), fabs(behind))), slope);
}

/* Return the bend at a row between two straight lines: the mean of those of cubics to both sides, so that the third derivative
 * jumps little. slope: a reach before the row, at it, and after. The bend is at most twice that of the parabola, so that a
 * straight continuation has none. It must not turn a curve back at once, for which n in the next comment would change its
 * sign. */
static double bend_between(const double straight[2], const double width[2], const double slope[3]) {
    const double before = straight[0], behind = straight[1], left = width[0], right = width[1];
    if (before == 0.0 || behind == 0.0) return 0.0;
    const double ahead = (6.0 * behind - 4.0 * slope[1] - 2.0 * slope[2]) / right;
    const double back = (2.0 * slope[0] + 4.0 * slope[1] - 6.0 * before) / left;
    const double most = 4.0 * fabs(behind - before) / (left + right), turn = 4.0 * fabs(slope[1]);
    const double low = fmax(behind > 0.0 ? -turn / right : -most, before < 0.0 ? -turn / left : -most);
    const double high = fmin(behind < 0.0 ? turn / right : most, before > 0.0 ? turn / left : most);
    return fmin(fmax((back * right + ahead * left) / (left + right), fmax(low, -most)), fmin(high, most));
}

/* Which share of slope and bend the end of a quintic may have. It rises over its width h where no coefficient of its slope in
 * Bernstein's form is below 0 (after R. L. Dougherty, A. Edelman and J. M. Hyman (1989), Nonnegativity-, monotonicity-, or
 * convexity-preserving cubic and quintic Hermite interpolation, Mathematics of Computation 52). These are m and n = m + b h / 4
 * at one end, likewise at the other, and in the middle five times the straight line's slope s less all four. The coefficients
 * of both halves require m + n <= 5 s at each end. They also require 2 m + (3 m + 2 n) <= 15 s and (5 m + 2 n) + (5 m + 2 n) <=
 * 30 s, with one term from each end. Here every term has its part of them. */
static double share_of_end(double straight, double slope, double bend, double reach) {
    const double sign = copysign(1.0, straight), m = sign * slope, n = m + sign * bend * reach / 4.0;
    const double need = fmax(fmax((m + n) / 5.0, m / 2.5), fmax((3.0 * m + 2.0 * n) / 10.0, (5.0 * m + 2.0 * n) / 15.0));
    return need > fabs(straight) ? fabs(straight) / need : 1.0;
}

/* Value, slope and bend at a row, for quintics that do not leave the values of two rows. */
static void quintic_end(const table_file *self, const double *value, int row, double end[3]) {
    enum { WAYS = 4 }; /* intervals, two before this row and two after */
    double straight[WAYS], width[WAYS], slope[WAYS - 1];
    for (int way = 0; way < WAYS; ++way) {
        straight[way] = secant(self, value, row - 2 + way);
        width[way] = reach(self, row - 2 + way);
    }
    for (int i = 0; i < WAYS - 1; ++i) slope[i] = slope_between(straight[i], straight[i + 1], width[i], width[i + 1]);
    if (!meets(self, row - 1)) slope[0] = straight[1];
    if (!meets(self, row)) slope[2] = straight[2];
    const double bend = bend_between(straight + 1, width + 1, slope),
                 before = share_of_end(straight[1], slope[1], -bend, width[1]);
    const double share = fmin(before, share_of_end(straight[2], slope[1], bend, width[2]));
    end[0] = value[row];
    end[1] = share * slope[1];
    end[2] = share * bend;
}

/* Return whether such a change of slope is a corner in a column. */
static bool is_corner(int column, double change) {
    const column_description *about = &MODEL.table_file->column[column];
    return fabs(change) * MODEL.table_file->rounding > STRAIGHT * (about->maximum - about->minimum);
}

/* Return whether any column has a corner at a row. */
static bool any_corner(const table_file *self, int row) {
    for (int column = 1; column < MODEL.table_file->columns; ++column) {
        const double *value = self->column[column];
        if (value && is_corner(column, secant(self, value, row) - secant(self, value, row - 1))) return true;
    }
    return false;
}

static void lay(table_part *part, int row, double from, double to, double rounded, bool straight) {
    part->row = row;
    part->from = from;
    part->to = to;
    part->rounded = rounded;
    part->straight = straight;
}

int table_parts(const table_file *self, int row, table_part part[MOST_PARTS]) {
    const double rounding = MODEL.table_file->rounding, width = width_of(self, row);
    if (width <= 2.0 * rounding) {
        lay(part, row, 0.0, width, width, false);
        return 1;
    }
    const double first = any_corner(self, row) ? rounding : 0.0, last = any_corner(self, row + 1) ? width - rounding : width;
    int parts = 0;
    if (first > 0.0) lay(&part[parts++], row, 0.0, first, first, false);
    lay(&part[parts++], row, first, last, first, true);
    if (last < width) lay(&part[parts++], row, last, width, first, false);
    return parts;
}

void table_quintic(const double first[3], const double second[3], double gain, double distance, double *c) {
    const double h = distance, square = h * h;
    c[0] = first[0];
    c[1] = first[1];
    c[2] = first[2] / 2.0;
    c[3] = (20.0 * gain - (8.0 * second[1] + 12.0 * first[1]) * h - (3.0 * first[2] - second[2]) * square) / (2.0 * square * h);
    c[4] = (-30.0 * gain + (14.0 * second[1] + 16.0 * first[1]) * h + (3.0 * first[2] - 2.0 * second[2]) * square) /
           (2.0 * square * square);
    c[5] = (12.0 * gain - 6.0 * (second[1] + first[1]) * h - (first[2] - second[2]) * square) / (2.0 * square * square * h);
}

void table_straight(const table_file *self, int column, const table_part *part, double *c) {
    const double *value = self->column[column];
    memset(c, 0, MOST_TERMS * sizeof *c);
    c[1] = secant(self, value, part->row);
    c[0] = value[part->row] + part->from * c[1];
}

void table_smooth(const table_file *self, int column, const table_part *part, double *c) {
    const double *value = self->column[column], width = part->to - part->from;
    table_straight(self, column, part, c);
    if (part->straight) return;
    double end[2][3] = {{c[0], c[1], 0.0}, {c[0] + c[1] * width, c[1], 0.0}};
    if (part->from == 0.0) quintic_end(self, value, part->row, end[0]);
    if (part->to == width_of(self, part->row)) quintic_end(self, value, part->row + 1, end[1]);
    table_quintic(end[0], end[1], end[1][0] - end[0][0], width, c);
}

void table_integral(const table_file *self, int column, const table_part *part, double start, double *c) {
    const double *value = self->column[column], h = part->to - part->from, slope = secant(self, value, part->row);
    const bool begins = !part->straight && part->from == 0.0, ends = !part->straight && part->to == width_of(self, part->row);
    const double first = begins ? cubic_slope(self, value, part->row) : slope;
    const double last = ends ? cubic_slope(self, value, part->row + 1) : slope;
    c[0] = start;
    if (part->from > 0.0) { /* below the straight line, and the change by the corner at the row */
        c[0] += part->from * (value[part->row] + slope * part->from / 2.0);
        if (part->rounded > 0.0) c[0] += part->rounded * part->rounded * (cubic_slope(self, value, part->row) - slope) / 12.0;
    }
    c[1] = value[part->row] + slope * part->from;
    c[2] = first / 2.0;
    c[3] = (3.0 * slope - 2.0 * first - last) / (3.0 * h);
    c[4] = (first + last - 2.0 * slope) / (4.0 * h * h);
    c[5] = 0.0;
}

double table_value(const double *c, double x) { return c[0] + x * (c[1] + x * (c[2] + x * (c[3] + x * (c[4] + x * c[5])))); }

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
        if (at >= s[middle]) low = middle;
        else high = middle - 1;
    }
    return low;
}

/* Beyond the ends a piece keeps its value there, or continues straight with its slope. width: to the end. */
static void leave(bool goes_on, double width, double *c) {
    const double slope = goes_on ? table_slope(c, width) : 0.0;
    c[0] = table_value(c, width);
    c[1] = slope;
    memset(c + 2, 0, (MOST_TERMS - 2) * sizeof *c);
}

/* The part of a row's way in which a place lies, and where it begins and ends. */
static table_part part_at(const table_file *self, int row, double at, double held[2]) {
    const double *s = self->column[0];
    table_part part[MOST_PARTS];
    const int parts = table_parts(self, row, part);
    int i = 0;
    held[0] = s[row];
    for (;; ++i) {
        held[1] = i == parts - 1 ? s[row + 1] : s[row] + part[i].to;
        if (i == parts - 1 || at < held[1]) return part[i];
        held[0] = held[1];
    }
}

void table_look_up(const table_file *self, const table_description *table, double at, int *guess, double held[2],
                   double *coefficient) {
    const double *s = self->column[0], end = s[self->rows - 1];
    const bool before = at < s[0], behind = at >= end;
    const table_part part = part_at(self, *guess = row_before(self, at, *guess), at, held);
    *coefficient++ = behind ? end : held[0];
    if (before) {
        held[0] = -INFINITY;
        held[1] = s[0];
    } else if (behind) {
        held[0] = end;
        held[1] = INFINITY;
    }
    for (int i = 0; i < table->pieces; ++i) {
        const piece_description *piece = &MODEL.table_file->piece[table->piece[i]];
        double c[MOST_TERMS] = {0};
        MODEL.table_file->piece_between(self, table->piece[i], &part, c);
        if (before || behind) leave(piece->goes_on, behind ? part.to - part.from : 0.0, c);
        for (int power = 0; power <= piece->degree; ++power) *coefficient++ = c[power];
    }
}
