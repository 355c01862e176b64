/* Gravity, curves and friction of the rails on a train's vehicles. Single vehicles round the corners at the line's points over 1 m (docs/line.md);
 * corners stay here. Rounding would change the mean gradient over a length L by the change of slope times 1 m2 / (12 L). */
#include <math.h>

#include "train_inside.h"

/* The row before a place, searched from the last one found. */
static long long int row_at(const train *self, double at, long long int guess) {
    const double *distance = self->line[POINT_DISTANCE];
    while (guess + 1 < self->points - 1 && distance[guess + 1] <= at) ++guess;
    while (guess > 0 && distance[guess] > at) --guess;
    return guess;
}

/* Integral of a column from the first point on; the column is linear between points, and constant beyond the ends. */
static double integral_at(const train *self, const double *column, const double *integral, double at, long long int row) {
    const double *distance = self->line[POINT_DISTANCE];
    const double first = distance[0], last = distance[self->points - 1];
    if (self->points < 2 || at <= first) return (at - first) * column[0];
    if (at >= last) return integral[self->points - 1] + (at - last) * column[self->points - 1];
    const double over = at - distance[row], share = over / (distance[row + 1] - distance[row]);
    return integral[row] + over * (column[row] + share * (column[row + 1] - column[row]) / 2.0);
}

/* Mean of a column over a vehicle. */
static double mean_over(train *self, int column, const double *integral, long long int vehicle, double middle) {
    const double *values = self->line[column], half = self->length[vehicle] / 2.0;
    long long int row = row_at(self, middle + half, self->hint[vehicle]);
    const double ahead = integral_at(self, values, integral, middle + half, row);
    row = self->hint[vehicle] = row_at(self, middle - half, row);
    return (ahead - integral_at(self, values, integral, middle - half, row)) / self->length[vehicle];
}

/* Curvature between its points [1/m]; beyond its ends a line is straight. */
static double curvature_at(const train *self, double at, long long int row) {
    const double *distance = self->line[POINT_DISTANCE], *curvature = self->line[POINT_CURVATURE];
    if (self->points < 2 || at < distance[0] || at > distance[self->points - 1]) return 0.0;
    return curvature[row] + (at - distance[row]) / (distance[row + 1] - distance[row]) * (curvature[row + 1] - curvature[row]);
}

/* Resistance of a curve over weight, v. Roeckl: 0.65 m / (R - 55 m) from 300 m on, 0.5 m / (R - 30 m) below. */
static double roeckl(double curvature) {
    const double radius = 1.0 / fmax(fabs(curvature), 1e-9);
    return radius >= 300.0 ? 0.65 / (radius - 55.0) : 0.5 / (fmax(radius, 60.0) - 30.0);
}

/* A vehicle's weight is distributed over its length: gravity follows its mean gradient, and the limit of its rail force, friction
 * times weight (Coulomb), the mean friction of the rails below it. */
void line_act(train *self, double step) {
    const double *place = motion_place(self->moves), *speed = motion_speed(self->moves);
    double *slope = motion_acting(self->moves, ACTING_SLOPE), *body = motion_acting(self->moves, ACTING_BODY);
    double *friction = motion_acting(self->moves, ACTING_FRICTION);
    if (self->level && self->even) return; /* nothing has been written there */
    for (long long int i = 0; i < self->vehicles; ++i) {
        const double middle = place[i] + self->centre[i] + speed[i] * step / 2.0, weight = self->mass[i] * GRAVITY;
        if (!self->even) friction[i] = self->input[IN_FRICTION][i] * mean_over(self, POINT_FRICTION, self->grip, i, middle);
        if (self->level) continue;
        slope[i] = -weight * mean_over(self, POINT_GRADIENT, self->height, i, middle);
        const double bend = curvature_at(self, middle, row_at(self, middle, self->hint[i]));
        body[i] = bend == 0.0 ? 0.0 : weight * roeckl(bend);
    }
}
