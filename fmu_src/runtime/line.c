/* The line of an instance: nodes along it, and between them polynomials for the generated functions. */
#include "line.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double FELT_NODES = 8.0; /* so many nodes make up the shortest thing on a line that is to be felt */

void line_free(line_data *self) {
    if (!self) return;
    for (int i = 0; i < LINE_ROWS; ++i) free(self->row[i]);
    free(self);
}

/* Slope and bend at a node by the parabola through it and its neighbours; none at the ends, beyond which nothing changes. */
static void differences(const line_data *self, const double *value, int node, double *slope, double *bend) {
    const double *s = self->row[LINE_DISTANCE];
    *slope = *bend = 0.0;
    if (node == 0 || node == self->nodes - 1) return;
    const double before = s[node] - s[node - 1], behind = s[node + 1] - s[node];
    const double rise = (value[node] - value[node - 1]) / before, next = (value[node + 1] - value[node]) / behind;
    *slope = (rise * behind + next * before) / (before + behind);
    *bend = 2.0 * (next - rise) / (before + behind);
}

/* Quintic of the distance from the first of two nodes, from values, slopes and bends at both, gain and distance between them. */
static void quintic(const double first[3], const double second[3], double gain, double h, double *c) {
    const double square = h * h;
    c[0] = first[0];
    c[1] = first[1];
    c[2] = first[2] / 2.0;
    c[3] = (20.0 * gain - (8.0 * second[1] + 12.0 * first[1]) * h - (3.0 * first[2] - second[2]) * square) /
           (2.0 * square * h);
    c[4] = (-30.0 * gain + (14.0 * second[1] + 16.0 * first[1]) * h + (3.0 * first[2] - 2.0 * second[2]) * square) /
           (2.0 * square * square);
    c[5] = (12.0 * gain - 6.0 * (second[1] + first[1]) * h - (first[2] - second[2]) * square) / (2.0 * square * square * h);
}

/* A value that is a column of the file: with two continuous derivatives. */
static void smooth(const line_data *self, int row, int node, double *c) {
    const double *s = self->row[LINE_DISTANCE], *value = self->row[row];
    double end[2][3];
    for (int i = 0; i < 2; ++i) {
        end[i][0] = value[node + i];
        differences(self, value, node + i, &end[i][1], &end[i][2]);
    }
    quintic(end[0], end[1], end[1][0] - end[0][0], s[node + 1] - s[node], c);
}

/* The integral of a column: that of the cubic with its values and slopes. start: its value at the first node. */
static void integral(const line_data *self, int row, int node, double start, double *c) {
    const double *s = self->row[LINE_DISTANCE], *value = self->row[row];
    const double h = s[node + 1] - s[node], gain = (value[node + 1] - value[node]) / h;
    double slope[2], bend;
    for (int i = 0; i < 2; ++i) differences(self, value, node + i, &slope[i], &bend);
    c[0] = start;
    c[1] = value[node];
    c[2] = slope[0] / 2.0;
    c[3] = (3.0 * gain - 2.0 * slope[0] - slope[1]) / (3.0 * h);
    c[4] = (slope[0] + slope[1] - 2.0 * gain) / (4.0 * h * h);
    c[5] = 0.0;
}

static double value_of(const double *c, double x) {
    return c[0] + x * (c[1] + x * (c[2] + x * (c[3] + x * (c[4] + x * c[5]))));
}

static double slope_of(const double *c, double x) {
    return c[1] + x * (2.0 * c[2] + x * (3.0 * c[3] + x * (4.0 * c[4] + x * 5.0 * c[5])));
}

/* What is integrated for the plan: places ahead and aside and the way seen from above; each is whole metres and a rest. */
enum { PLAN = 3 };
static const int PLAN_NEAR[PLAN] = {LINE_AHEAD, LINE_ASIDE, LINE_LEVEL};
static const int PLAN_FAR[PLAN] = {LINE_AHEAD_FAR, LINE_ASIDE_FAR, LINE_LEVEL_FAR};

/* How these grow with the way, of which `level` is seen from above, at a heading; and what a turn adds to that. */
static void directions(double angle, double along[PLAN], double across[PLAN]) {
    along[0] = across[1] = cos(angle);
    along[1] = sin(angle);
    across[0] = -along[1];
    along[2] = 1.0;
    across[2] = 0.0;
}

static void plan(const line_data *self, int node, int which, double *c) {
    const double *far = self->row[PLAN_FAR[which]], *near = self->row[PLAN_NEAR[which]];
    const double h = self->row[LINE_DISTANCE][node + 1] - self->row[LINE_DISTANCE][node];
    double heading[6], rise[6], end[2][3], along[PLAN], across[PLAN];
    integral(self, LINE_CURVATURE, node, self->row[LINE_HEADING][node], heading);
    integral(self, LINE_GRADIENT, node, 0.0, rise);
    for (int i = 0; i < 2; ++i) {
        const double x = i * h, sine = slope_of(rise, x), level = sqrt(1.0 - sine * sine);
        const double steepening = 2.0 * rise[2] + x * (6.0 * rise[3] + x * 12.0 * rise[4]);
        directions(value_of(heading, x), along, across);
        end[i][0] = near[node];
        end[i][1] = level * along[which];
        end[i][2] = -sine * steepening / level * along[which] + level * slope_of(heading, x) * across[which];
    }
    quintic(end[0], end[1], (far[node + 1] - far[node]) + (near[node + 1] - near[node]), h, c);
}

/* From a node to the next: Gauss's quadrature with five points. */
static void way(const line_data *self, int node, double found[PLAN]) {
    static const double place[5] = {-0.9061798459386640, -0.5384693101056831, 0.0, 0.5384693101056831, 0.9061798459386640};
    static const double weight[5] = {0.2369268850561891, 0.4786286704993665, 0.5688888888888889, 0.4786286704993665,
                                     0.2369268850561891};
    const double half = (self->row[LINE_DISTANCE][node + 1] - self->row[LINE_DISTANCE][node]) / 2.0;
    double heading[6], rise[6], along[PLAN], across[PLAN];
    integral(self, LINE_CURVATURE, node, self->row[LINE_HEADING][node], heading);
    integral(self, LINE_GRADIENT, node, 0.0, rise);
    for (int which = 0; which < PLAN; ++which) found[which] = 0.0;
    for (int i = 0; i < 5; ++i) {
        const double x = half * (1.0 + place[i]), sine = slope_of(rise, x);
        directions(value_of(heading, x), along, across);
        for (int which = 0; which < PLAN; ++which) found[which] += half * weight[i] * sqrt(1.0 - sine * sine) * along[which];
    }
}

void line_integrate(line_data *self) {
    double heading[6], rise[6], gained[PLAN], **row = self->row;
    row[LINE_HEADING][0] = row[LINE_RISE][0] = 0.0;
    for (int which = 0; which < PLAN; ++which) row[PLAN_NEAR[which]][0] = row[PLAN_FAR[which]][0] = 0.0;
    for (int i = 0; i + 1 < self->nodes; ++i) {
        const double h = row[LINE_DISTANCE][i + 1] - row[LINE_DISTANCE][i];
        integral(self, LINE_CURVATURE, i, row[LINE_HEADING][i], heading);
        integral(self, LINE_GRADIENT, i, row[LINE_RISE][i], rise);
        row[LINE_HEADING][i + 1] = value_of(heading, h);
        row[LINE_RISE][i + 1] = value_of(rise, h);
        way(self, i, gained);
        for (int which = 0; which < PLAN; ++which) { /* whole metres apart: no digits are lost far from the start */
            const double rest = row[PLAN_NEAR[which]][i] + gained[which], whole = floor(rest + 0.5);
            row[PLAN_FAR[which]][i + 1] = row[PLAN_FAR[which]][i] + whole;
            row[PLAN_NEAR[which]][i + 1] = rest - whole;
        }
    }
}

/* The node at or before a place, the first or the last but one beyond the ends. */
static int node_before(const line_data *self, double at, int guess) {
    const double *s = self->row[LINE_DISTANCE];
    int low = 0, high = self->nodes - 2;
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

/* Straight lines between the nodes: a smoother curve might fall below 0 beside leaves. */
static void friction(const line_data *self, int row, int node, double *c) {
    const double *s = self->row[LINE_DISTANCE], *value = self->row[row];
    c[0] = value ? value[node] : 1.0;
    if (value) c[1] = (value[node + 1] - value[node]) / (s[node + 1] - s[node]);
}

static void piece(const line_data *self, int column, int node, double *c) {
    memset(c, 0, 6 * sizeof *c);
    for (int which = 0; which < PLAN; ++which) {
        if (column == PLAN_NEAR[which]) plan(self, node, which, c);
        if (column == PLAN_FAR[which]) c[0] = self->row[column][node];
    }
    if (column == LINE_HEADING) integral(self, LINE_CURVATURE, node, self->row[LINE_HEADING][node], c);
    if (column == LINE_RISE) integral(self, LINE_GRADIENT, node, self->row[LINE_RISE][node], c);
    if (column == LINE_FELT) c[0] = FELT_NODES * (self->row[LINE_DISTANCE][node + 1] - self->row[LINE_DISTANCE][node]);
    if (column == LINE_LEFT_FRICTION || column == LINE_RIGHT_FRICTION) friction(self, column, node, c);
    const int of_file = column == LINE_CANT || (column >= LINE_LATERAL && column <= LINE_RIGHT);
    if (of_file && self->row[column]) smooth(self, column, node, c);
}

/* Beyond the ends the line goes on straight, level across as it was there, with its last gradient. width: to the end. */
static void go_on(int column, double width, double *c) {
    int goes = column == LINE_RISE;
    for (int which = 0; which < PLAN; ++which) goes |= column == PLAN_NEAR[which];
    const double slope = goes ? slope_of(c, width) : 0.0;
    c[0] = value_of(c, width);
    c[1] = slope;
    memset(c + 2, 0, 4 * sizeof *c);
}

/* Degrees of the columns' pieces, as LINE_COLUMNS in system.py has them. */
static const int DEGREE[LINE_DISTANCE] = {4, 5, 4, 5, 0, 5, 0, 5, 0, 5, 5, 5, 5, 1, 1, 0};

void line_look_up(const line_data *self, const table_description *table, double at, int *guess, double held[2],
                  double *coefficient) {
    const double *s = self->row[LINE_DISTANCE];
    const int last = self->nodes - 1, before = at < s[0], behind = at >= s[last];
    const int node = *guess = node_before(self, at, *guess);
    const double origin = *coefficient++ = behind ? s[last] : s[node];
    held[0] = before ? -INFINITY : origin;
    held[1] = before ? s[0] : behind ? INFINITY : s[node + 1];
    for (int i = 0; i < table->columns; ++i) {
        const int column = table->column[i];
        double c[6];
        piece(self, column, node, c);
        if (before || behind) go_on(column, behind ? s[last] - s[node] : 0.0, c);
        for (int power = 0; power <= DEGREE[column]; ++power) *coefficient++ = c[power];
    }
}
