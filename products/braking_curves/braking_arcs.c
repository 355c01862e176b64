/* Arcs of braking curves, and the limits that follow from them. */
#include "braking_arcs.h"

#include <math.h>

#define KMH (1.0 / 3.6)
/* The error of the speed is constant below and above, and linear in between [m/s]. */
static const double SLOW = 30.0 * KMH, FAST = 500.0 * KMH, SLOW_ERROR = 2.0 * KMH, FAST_ERROR = 12.0 * KMH;

double steps_at(const speed_steps *self, double speed) {
    int step = 0;
    while (step < self->count - 1 && speed > self->boundary[step]) ++step;
    return self->value[step];
}

void steps_product(const speed_steps factor[3], speed_steps *product) {
    int count = 0;
    for (int k = 0; k < 3; ++k)
        for (int n = 0; n < factor[k].count - 1; ++n) {
            int at = count++;
            for (; at > 0 && product->boundary[at - 1] > factor[k].boundary[n]; --at)
                product->boundary[at] = product->boundary[at - 1];
            product->boundary[at] = factor[k].boundary[n];
        }
    product->count = count + 1;
    for (int n = 0; n <= count; ++n) {
        const double within = n < count ? product->boundary[n] : INFINITY;
        product->value[n] = steps_at(&factor[0], within) * steps_at(&factor[1], within) * steps_at(&factor[2], within);
    }
}

/* ---- the curve ---- */

/* A point of the curve, and the numbers of its step of speed and of its part of the line. */
typedef struct {
    double place, square;
    int step, part;
} curve_point;

/* Number of places, ascending, before one; `with`: or at it. */
static int edges_before(const line_slopes *line, double place, bool with) {
    int low = 0, high = line->edges;
    while (low < high) {
        const int middle = low + (high - low) / 2;
        if (line->edge[middle] < place || (with && line->edge[middle] == place)) low = middle + 1;
        else high = middle;
    }
    return low;
}

static double curve_rate(const curve_point *at, const speed_steps *brake, const line_slopes *line) {
    return brake->value[at->step] + line->slope[at->part];
}

/* Move a point to the end of its arc: to higher speeds and back along the line (way 1), or down to rest (way -1). Returns
 * whether another arc begins there. */
static bool curve_advance(curve_point *at, const speed_steps *brake, const line_slopes *line, int way) {
    const int edge = way > 0 ? at->part - 1 : at->part, bound = way > 0 ? at->step : at->step - 1;
    const bool has_edge = edge >= 0 && edge < line->edges, has_bound = bound >= 0 && bound < brake->count - 1;
    const double rate = curve_rate(at, brake, line);
    if (!(rate > 0.0) || (way > 0 && !has_edge && !has_bound)) return false;
    const double limit = has_bound ? brake->boundary[bound] * brake->boundary[bound] : way > 0 ? INFINITY : 0.0;
    const double by_edge = has_edge ? fabs(line->edge[edge] - at->place) : INFINITY;
    const double by_bound = fabs(limit - at->square) / (2.0 * rate);
    if (by_edge < by_bound) {
        at->square += way * 2.0 * rate * by_edge;
        at->place = line->edge[edge];
        at->part -= way;
        return true;
    }
    at->place -= way * by_bound;
    at->square = limit;
    if (has_bound) at->step += way;
    return has_bound;
}

/* A point from which to walk: up, a boundary at the speed is passed; down, it is ahead. */
static curve_point curve_start(double place, double square, const speed_steps *brake, const line_slopes *line, int way) {
    curve_point at = {place, square, 0, edges_before(line, place, way < 0)};
    for (; at.step < brake->count - 1; ++at.step) {
        const double bound = brake->boundary[at.step] * brake->boundary[at.step];
        if (way > 0 ? bound > square : bound >= square) break;
    }
    return at;
}

int curve_room(int edges) { return PRODUCT_STEPS - 1 + edges + 1; }

void curve_find(braking_curve *self, double place, double speed, const speed_steps *brake, const line_slopes *line,
                double most) {
    curve_point at = curve_start(place, speed * speed, brake, line, -1);
    while (curve_advance(&at, brake, line, -1)) continue; /* to rest, or as far as the train brakes */
    at = curve_start(at.place, at.square, brake, line, 1);
    self->count = 0;
    do self->arc[self->count++] = (braking_arc){at.place, at.square, curve_rate(&at, brake, line)};
    while (curve_advance(&at, brake, line, 1) && at.square < most * most && self->count < curve_room(line->edges));
}

/* The last arc that begins at the square of a speed or below. */
static const braking_arc *curve_arc(const braking_curve *self, double square) {
    int low = 1, high = self->count;
    while (low < high) {
        const int middle = low + (high - low) / 2;
        if (self->arc[middle].square <= square) low = middle + 1;
        else high = middle;
    }
    return &self->arc[low - 1];
}

double curve_place(const braking_curve *self, double speed) {
    const braking_arc *arc = curve_arc(self, speed * speed);
    const double lost = speed * speed - arc->square;
    if (lost <= 0.0) return arc->place;
    return arc->rate > 0.0 ? arc->place - lost / (2.0 * arc->rate) : -INFINITY;
}

/* ---- limits ---- */

double speed_error(double speed) {
    if (speed <= SLOW) return SLOW_ERROR;
    if (speed >= FAST) return FAST_ERROR;
    return SLOW_ERROR + (FAST_ERROR - SLOW_ERROR) * ((speed - SLOW) / (FAST - SLOW));
}

/* The speed with its error, its derivative by the speed, and the speed that has it. */
static double with_error(const supervision_limit *self, double speed) {
    return self->compensated ? speed + speed_error(speed) : speed;
}
static double error_slope(const supervision_limit *self, double speed) {
    return self->compensated && speed > SLOW && speed < FAST ? 1.0 + (FAST_ERROR - SLOW_ERROR) / (FAST - SLOW) : 1.0;
}
static double without_error(const supervision_limit *self, double sum) {
    if (!self->compensated) return sum;
    if (sum <= SLOW + SLOW_ERROR) return sum - SLOW_ERROR;
    if (sum >= FAST + FAST_ERROR) return sum - FAST_ERROR;
    return SLOW + (sum - SLOW - SLOW_ERROR) / (1.0 + (FAST_ERROR - SLOW_ERROR) / (FAST - SLOW));
}

double limit_reached(const supervision_limit *self, double speed) {
    return fmax(with_error(self, speed) + self->pulled, self->target) + self->crept;
}

double limit_place(const supervision_limit *self, double speed) {
    const double fast = with_error(self, speed), after = fmax(fast + self->pulled, self->target);
    const double with_traction = fmax(fast + self->pulled / 2.0, self->target) * self->traction;
    const double way = with_traction + (after + self->crept / 2.0) * self->building;
    return curve_place(self->curve, after + self->crept) - way - self->lag * speed;
}

/* Narrow a range of speeds, within which the limit passes a place, by a speed between both. */
static void limit_narrow(const supervision_limit *self, double place, double speed, double *low, double *high) {
    if (!(speed > *low && speed < *high)) return;
    if (limit_place(self, speed) >= place) *low = speed;
    else *high = speed;
}

/* Narrow the range to one arc. */
static void limit_narrow_to_arc(const supervision_limit *self, double place, double *low, double *high) {
    int first = 0, last = self->curve->count;
    while (first < last) {
        const int middle = first + (last - first) / 2;
        const double reached = sqrt(self->curve->arc[middle].square) - self->crept - self->pulled;
        const double speed = without_error(self, reached);
        limit_narrow(self, place, speed, low, high);
        if (speed <= *low) first = middle + 1;
        else last = middle;
    }
}

double limit_speed(const supervision_limit *self, double place, double most) {
    double low = 0.0, high = most;
    if (!(limit_place(self, low) >= place)) return 0.0;
    if (limit_place(self, high) >= place) return most;
    limit_narrow_to_arc(self, place, &low, &high);
    limit_narrow(self, place, SLOW, &low, &high);
    limit_narrow(self, place, FAST, &low, &high);
    limit_narrow(self, place, without_error(self, self->target - self->pulled), &low, &high);
    limit_narrow(self, place, without_error(self, self->target - self->pulled / 2.0), &low, &high);
    /* Between both the place is a parabola of the speed: place(low) - h x - a x^2. */
    const double middle = low + (high - low) / 2.0, fast = with_error(self, middle), slope = error_slope(self, middle);
    const double reached = limit_reached(self, middle), left = limit_place(self, low) - place;
    const braking_arc *arc = curve_arc(self->curve, reached * reached);
    const double after = fast + self->pulled > self->target ? slope : 0.0;
    /* Below the target's speed, and below the foot of a curve that the train cannot follow, the curve has one place. */
    const bool falls = after > 0.0 && reached * reached > arc->square;
    if (!(left > 0.0) || (falls && !(arc->rate > 0.0))) return low;
    const double bend = falls ? after / arc->rate : 0.0;
    const double pulling = fast + self->pulled / 2.0 > self->target ? slope : 0.0;
    const double a = after * bend / 2.0;
    const double h = limit_reached(self, low) * bend + pulling * self->traction + after * self->building + self->lag;
    const double x = 2.0 * left / (h + sqrt(h * h + 4.0 * a * left));
    return x < high - low ? low + x : high;
}
