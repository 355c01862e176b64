/* A wheel on its rail by strips, contact model 3: several patches of any shape, with creep forces strip by strip.
 *
 * The method is that of distance.py, normal.py and strip_creep.py in this folder, which cite the source of each formula and
 * are finer and slower. Here the wheel's contour is divided into segments, at places where contact of rigid bodies would
 * jump. Each has STRIPS strips from the first to the last place where it overlaps its rail. Strips of different segments
 * interact in pressure and in creep. The reference computes the ellipse's factor kappa patch by patch. Here it is computed
 * for each segment with all strips that join it without a gap, so that the forces do not jump where patches meet or part.
 *
 * Axes of one wheel: x ahead, y outwards, z up; the right wheel is the mirror image of a left one. */
#include <math.h>
#include <string.h>

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC push_options
#pragma GCC optimize("O2") /* generated code has O1; loops gain a ninth by more */
#endif

enum { STRIPS = 8, CELLS = 8, SAMPLES = 24, MOST_SEGMENTS = 6, MOST = STRIPS * MOST_SEGMENTS, TERMS = 12, ELLIPTIC = 7 };
enum { ARGUMENTS = 13, OF_SEGMENT = 11, OF_WHEEL = 3, MOST_RESULTS = OF_SEGMENT * MOST_SEGMENTS + OF_WHEEL };
enum { ROUNDS = 40 }; /* of a search that ends after a few */
static const double PI = 3.14159265358979324, EULER = 2.71828182845904524, TINY = 1e-300;

/* A quintic spline with equal pieces. */
typedef struct {
    double first, width;
    int pieces;
    const double *coefficient;
} contour_of;

/* Both contours, and the segments of the wheel's, each with its two ends [m], from the flange outwards. */
typedef struct {
    contour_of wheel, rail;
    int segments;
    const double *segment;
} wheel_on_rail;

/* Polynomials of ln(B/A) for ln(alpha), of ln(kappa (a/b)^2) for ln(kappa), and of 1/c for Kalker's coefficients over c
 * (strip_creep.py). Also of m1 for (K - E) / m = P(m1) + Q(m1) ln(1/m1). The limits are those of the first three arguments. */
typedef struct {
    double alpha[TERMS], kappa[TERMS], ahead[TERMS], aside[TERMS], spin[TERMS], plain[ELLIPTIC], logarithmic[ELLIPTIC];
    double curvatures[2], loads[2], grips[2];
} fits_of;

/* Position of the wheelset in the axes of this wheel, and its motion in the axes of the track. */
typedef struct {
    double axes[3][3], lateral, height, level, outwards, radius, wheel_half, rail_half;
} stand_of;

/* axle: its direction, outwards and upwards; slope: of the rail, the same; creeps_on_slope: 1 if creepage follows the slope
 * of the rail, else 0. */
typedef struct {
    double velocity[3], rate[3], axle[2], slope[2], friction, creeps_on_slope;
} motion_of;

/* The steel, and the surface of rbd_model/track/friction.py. */
typedef struct {
    double creepage_speed, modulus, plane_modulus, ratio, decay, fall, adhesion, damping, gauge_face;
} steel_of;

/* One strip: its nearest point from the wheelset's centre [m], on both contours, gap [m], normal, A [1/m], breadth and
 * half length [m], load for each metre of breadth [N/m]. */
typedef struct {
    double arm[3], on_rail, gap, sine, cosine, curvature, stretch, breadth, overlap, half_length, line_load, pressure;
    int segment;
} strip_of;

typedef struct {
    int count;
    strip_of strip[MOST];
    double nearest[MOST_SEGMENTS]; /* largest overlap of each segment, negative where it hangs over the rail [m] */
    double ends[MOST_SEGMENTS][2]; /* of the part of each segment that overlaps; where the gap is least, if none does [m] */
    int overlaps[MOST_SEGMENTS];
    int touching, inside[MOST];    /* strips that bear a load, in whose order the rest is */
    double stretch[MOST][MOST];    /* what Carter's stress on one strip stretches at others, as `factorise` leaves it */
    double pull[MOST];             /* that stress for a creepage of 1 everywhere */
    double ahead[MOST], aside[MOST], turning[MOST]; /* growth of the stress, over the shear modulus [1/m], [1/m2] */
} pressed_of;

static double series(const double *coefficient, double x) {
    double value = coefficient[TERMS - 1];
    for (int power = TERMS - 2; power >= 0; --power) value = value * x + coefficient[power];
    return value;
}

static double within(double x, const double *limits) { return fmin(fmax(x, limits[0]), limits[1]); }

/* Height of a contour and, if `slope` is not NULL, its slope; returns 0 outside of the contour. */
static int height_of(const contour_of *contour, double y, double *height, double *slope) {
    const double place = (y - contour->first) / contour->width;
    if (!(place >= 0.0 && place <= contour->pieces)) return 0;
    const int piece = place < contour->pieces ? (int)place : contour->pieces - 1;
    const double *c = contour->coefficient + 6 * piece, x = y - (contour->first + piece * contour->width);
    *height = ((((c[5] * x + c[4]) * x + c[3]) * x + c[2]) * x + c[1]) * x + c[0];
    if (slope) *slope = (((5 * c[5] * x + 4 * c[4]) * x + 3 * c[3]) * x + 2 * c[2]) * x + c[1];
    return 1;
}

/* The wheel's place s over the rail, distance.py. */
static strip_of strip_at(const wheel_on_rail *pair, const stand_of *stand, double s) {
    strip_of found = {{0.0, 0.0, 0.0}, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0};
    double contour = 0.0, slope = 0.0, under = 0.0;
    if (!height_of(&pair->wheel, s, &contour, &slope)) return found;
    const double (*axes)[3] = stand->axes, radius = stand->radius - contour;
    const double ahead = axes[0][0], up = axes[0][2];
    const double lead = -slope * stand->outwards * stand->level, rest = sqrt(1.0 - lead * lead);
    const double sine = stand->level * (lead * ahead + rest * up);
    const double cosine = stand->level * (rest * ahead - lead * up);
    const double own[3] = {radius * sine, stand->wheel_half + s, -radius * cosine}, leaning[3] = {-sine, -slope, cosine};
    double normal[3];
    for (int i = 0; i < 3; ++i) {
        found.arm[i] = axes[i][0] * own[0] + axes[i][1] * own[1] + axes[i][2] * own[2];
        normal[i] = axes[i][0] * leaning[0] + axes[i][1] * leaning[1] + axes[i][2] * leaning[2];
    }
    const double size = 1.0 / sqrt(normal[1] * normal[1] + normal[2] * normal[2]);
    found.sine = -normal[1] * size;
    found.cosine = normal[2] * size;
    found.on_rail = stand->lateral + found.arm[1] - stand->rail_half;
    if (height_of(&pair->rail, found.on_rail, &under, 0)) found.gap = stand->height + found.arm[2] - under;
    found.curvature = found.cosine / (2.0 * radius);
    found.stretch = sqrt(1.0 + slope * slope);
    return found;
}

/* The gap alone. */
static double gap_at(const wheel_on_rail *pair, const stand_of *stand, double s) {
    double contour = 0.0, slope = 0.0, under = 0.0;
    if (!height_of(&pair->wheel, s, &contour, &slope)) return 1.0;
    const double (*axes)[3] = stand->axes, lead = -slope * stand->outwards * stand->level;
    const double rest = sqrt(1.0 - lead * lead), radius = (stand->radius - contour) * stand->level;
    const double own[3] = {radius * (lead * axes[0][0] + rest * axes[0][2]), stand->wheel_half + s,
                           -radius * (rest * axes[0][0] - lead * axes[0][2])};
    const double y = axes[1][0] * own[0] + axes[1][1] * own[1] + axes[1][2] * own[2];
    const double z = axes[2][0] * own[0] + axes[2][1] * own[1] + axes[2][2] * own[2];
    if (!height_of(&pair->rail, stand->lateral + y - stand->rail_half, &under, 0)) return 1.0;
    return stand->height + z - under;
}

/* Where the gap is 0 between a place where it is negative and one where it is not: the secants of Illinois. */
static double crossing(const wheel_on_rail *pair, const stand_of *stand, double inside, double outside) {
    double below = gap_at(pair, stand, inside), above = gap_at(pair, stand, outside), last = 0.0;
    for (int i = 0; i < ROUNDS && fabs(outside - inside) > 1e-12; ++i) {
        const double middle = inside + (outside - inside) * below / (below - above);
        const double gap = gap_at(pair, stand, middle);
        if (fabs(gap) < 1e-16) return middle;
        if (gap < 0.0) {
            inside = middle;
            below = gap;
            if (last < 0.0) above *= 0.5;
        } else {
            outside = middle;
            above = gap;
            if (last > 0.0) below *= 0.5;
        }
        last = gap;
    }
    return inside;
}

/* The lowest place near a sample, by parabolas closer and closer. */
static double lowest_near(const wheel_on_rail *pair, const stand_of *stand, double place, double reach) {
    for (int i = 0; i < 3; ++i, reach *= 0.1) {
        const double left = gap_at(pair, stand, place - reach), here = gap_at(pair, stand, place);
        const double right = gap_at(pair, stand, place + reach), bend = left - 2.0 * here + right;
        if (bend > 0.0) place += reach * fmin(fmax(0.5 * (left - right) / bend, -1.0), 1.0);
    }
    return place;
}

/* The part of a segment that overlaps the rail; 0 where none does. least: its smallest gap. */
static int overlap_of(const wheel_on_rail *pair, const stand_of *stand, const double *segment, double *ends, double *least) {
    double gap[SAMPLES + 1];
    const double pitch = (segment[1] - segment[0]) / (double)SAMPLES;
    int lowest = 0, first = -1, last = -1;
    for (int i = 0; i <= SAMPLES; ++i) {
        gap[i] = gap_at(pair, stand, segment[0] + i * pitch);
        if (gap[i] < gap[lowest]) lowest = i;
        if (gap[i] < 0.0) {
            last = i;
            if (first < 0) first = i;
        }
    }
    *least = gap[lowest];
    ends[0] = ends[1] = segment[0] + lowest * pitch;
    double low = segment[0] + first * pitch, high = segment[0] + last * pitch;
    if (first < 0) { /* perhaps between two samples */
        if (lowest == 0 || lowest == SAMPLES) return 0;
        low = high = lowest_near(pair, stand, segment[0] + lowest * pitch, pitch);
        *least = gap_at(pair, stand, low);
        first = last = lowest;
        if (!(*least < 0.0)) return 0;
    }
    ends[0] = first == 0 ? segment[0] : crossing(pair, stand, low, segment[0] + (first - 1) * pitch);
    ends[1] = last == SAMPLES ? segment[1] : crossing(pair, stand, high, segment[0] + (last + 1) * pitch);
    return ends[1] > ends[0];
}

/* Where an end of an overlap goes as the wheelset moves by next to nothing: two steps of a secant; the end of a segment stays
 * where it is. */
static double moved_end(const wheel_on_rail *pair, const stand_of *stand, const double *segment, double end) {
    static const double BESIDE = 1e-7;
    if (end == segment[0] || end == segment[1]) return end;
    const double here = gap_at(pair, stand, end), slope = (gap_at(pair, stand, end + BESIDE) - here) / BESIDE;
    if (!(fabs(slope) > 0.0)) return end;
    const double moved = end - here / slope;
    return moved - gap_at(pair, stand, moved) / slope;
}

/* The same as `overlap_of` from where it was before the wheelset moved by next to nothing. */
static void move_overlap(const wheel_on_rail *pair, const stand_of *stand, const double *segment, int overlaps, double *ends,
                         double *least) {
    *least = gap_at(pair, stand, ends[0]);
    for (int i = 0; i < 2 && overlaps; ++i) ends[i] = moved_end(pair, stand, segment, ends[i]);
}

/* Strips of all segments that overlap, normal.py; `nearest` of those that do not is negative. The overlaps are searched for
 * if `anew` is not 0; otherwise `found` has them for a neighbouring place. */
static void lay_strips(const wheel_on_rail *pair, const stand_of *stand, pressed_of *found, int anew) {
    found->count = 0;
    for (int segment = 0; segment < pair->segments; ++segment) {
        double *ends = found->ends[segment], least;
        const double *whole = pair->segment + 2 * segment;
        if (anew) found->overlaps[segment] = overlap_of(pair, stand, whole, ends, &least);
        else move_overlap(pair, stand, whole, found->overlaps[segment], ends, &least);
        found->nearest[segment] = -least;
        if (!found->overlaps[segment]) continue;
        const double pitch = (ends[1] - ends[0]) / (double)STRIPS;
        double deepest = 0.0;
        for (int i = 0; i < STRIPS; ++i) {
            strip_of *strip = &found->strip[found->count++];
            *strip = strip_at(pair, stand, ends[0] + (i + 0.5) * pitch);
            strip->breadth = pitch * strip->stretch;
            strip->overlap = -strip->gap * strip->cosine;
            strip->segment = segment;
            deepest = fmax(deepest, strip->overlap);
        }
        found->nearest[segment] = deepest;
    }
}

/* Half lengths of a segment's strips to begin with, and which of them will touch: Hertz's ellipse, normal.py. */
static void begin(const fits_of *fits, strip_of *strip, int *touch) {
    double deepest = 1e-14, half = 0.0, along = 0.0;
    for (int i = 0; i < STRIPS; ++i) {
        deepest = fmax(deepest, strip[i].overlap);
        half += 0.5 * strip[i].breadth;
        along += strip[i].curvature / (double)STRIPS;
    }
    const double ratio = within(log(deepest / (half * half * along)), fits->curvatures);
    const double alpha = exp(series(fits->alpha, ratio)), beta = exp(series(fits->alpha, -ratio));
    for (int i = 0; i < STRIPS; ++i) {
        const double square = deepest - beta * (deepest - strip[i].overlap);
        touch[i] = square > 0.0;
        strip[i].half_length = sqrt(fmax(square, 0.1 * deepest) / (alpha * along));
    }
}

/* (K - E) / m^(1/2) of m = 1 / (1 + ratio), which both lowering and stretch are made of. */
static double beside(const fits_of *fits, double ratio) {
    const double m = 1.0 / (1.0 + ratio), m1 = ratio * m;
    double plain = fits->plain[ELLIPTIC - 1], logarithmic = fits->logarithmic[ELLIPTIC - 1];
    for (int power = ELLIPTIC - 2; power >= 0; --power) {
        plain = plain * m1 + fits->plain[power];
        logarithmic = logarithmic * m1 + fits->logarithmic[power];
    }
    return sqrt(m) * (plain - logarithmic * log(m1));
}

/* Square of the distance between the middles of two strips [m2]. */
static double away(const strip_of *one, const strip_of *other) {
    const double y = one->arm[1] - other->arm[1], z = one->arm[2] - other->arm[2];
    return y * y + z * z;
}

/* How far 1 N/m on strip `by` lowers the middles of all strips, times the plane modulus: Johnson (1985), section 3.2. */
static void lower(const fits_of *fits, const pressed_of *found, int by, double *lowering) {
    const strip_of *strip = found->strip, *loaded = strip + by;
    const double mean = loaded->breadth / (2.0 * EULER), inverse = 1.0 / loaded->half_length;
    const double scale = 4.0 / (PI * PI) * loaded->breadth * inverse, square = inverse * inverse;
    for (int at = 0; at < found->count; ++at)
        lowering[at] = scale * beside(fits, square * (at == by ? mean * mean : away(strip + at, loaded)));
}

/* Both triangular factors of a matrix, in place; its diagonal is the largest of each row. */
static void factorise(int count, double matrix[MOST][MOST]) {
    for (int pivot = 0; pivot < count; ++pivot) {
        const double inverse = 1.0 / matrix[pivot][pivot];
        for (int row = pivot + 1; row < count; ++row) {
            const double factor = matrix[row][pivot] * inverse;
            for (int column = pivot + 1; column < count; ++column) matrix[row][column] -= factor * matrix[pivot][column];
            matrix[row][pivot] = factor;
        }
    }
}

/* Solves in place with the factors of `factorise`. */
static void solve(int count, double factors[MOST][MOST], double *value) {
    for (int row = 1; row < count; ++row)
        for (int column = 0; column < row; ++column) value[row] -= factors[row][column] * value[column];
    for (int row = count - 1; row >= 0; --row) {
        for (int column = row + 1; column < count; ++column) value[row] -= factors[row][column] * value[column];
        value[row] /= factors[row][row];
    }
}

/* Loads of the strips, none negative, that lower the surfaces by their overlap: Knothe and Le The (1984), normal.py. */
static void carry(const fits_of *fits, double plane_modulus, pressed_of *found, int *touch) {
    static const double ENOUGH = 1e-6;
    double lowering[MOST][MOST], matrix[MOST][MOST], load[MOST], deepest = 0.0;
    int inside[MOST], known[MOST] = {0};
    strip_of *strip = found->strip;
    for (int i = 0; i < found->count; ++i) deepest = fmax(deepest, strip[i].overlap);
    for (int round = 0; round < ROUNDS; ++round) {
        int count = 0, changed = 0;
        for (int i = 0; i < found->count; ++i) {
            strip[i].line_load = 0.0;
            if (!touch[i]) continue;
            if (!known[i]) lower(fits, found, i, lowering[i]);
            known[i] = 1;
            inside[count++] = i;
        }
        for (int i = 0; i < count; ++i) {
            load[i] = plane_modulus * strip[inside[i]].overlap;
            for (int j = 0; j < count; ++j) matrix[i][j] = lowering[inside[j]][inside[i]];
        }
        factorise(count, matrix);
        solve(count, matrix, load);
        for (int i = 0; i < count; ++i) {
            strip[inside[i]].line_load = fmax(load[i], 0.0);
            if (load[i] < 0.0) changed = 1, touch[inside[i]] = 0;
        }
        if (changed) continue;
        for (int i = 0; i < found->count; ++i) {
            if (touch[i]) continue;
            double left = plane_modulus * strip[i].overlap;
            for (int j = 0; j < count; ++j) left -= lowering[inside[j]][i] * load[j];
            if (left > ENOUGH * plane_modulus * deepest) changed = 1, touch[i] = 1;
        }
        if (!changed) return;
    }
}

/* Share of each strip in the patch of a segment: as much as the line load between it and the segment's largest. */
static int share_of(const pressed_of *found, int segment, double *share) {
    int top = -1;
    for (int i = 0; i < found->count; ++i) {
        share[i] = 0.0;
        if (found->strip[i].segment == segment && (top < 0 || found->strip[i].line_load > found->strip[top].line_load)) top = i;
    }
    if (top < 0 || !(found->strip[top].line_load > 0.0)) return -1;
    for (int step = -1; step <= 1; step += 2) {
        double valley = found->strip[top].line_load;
        for (int i = top; i >= 0 && i < found->count && found->strip[i].line_load > 0.0; i += step) {
            valley = fmin(valley, found->strip[i].line_load);
            share[i] = valley / found->strip[i].line_load;
        }
    }
    return top;
}

/* Half lengths by the loads: p = kappa A a E*, with the ellipse's kappa for each segment, normal.py. */
static void lengthen(const fits_of *fits, double plane_modulus, pressed_of *found, int segment) {
    double share[MOST], load = 0.0, along = 0.0;
    const int top = share_of(found, segment, share);
    if (top < 0) return;
    for (int i = 0; i < found->count; ++i) {
        const double part = share[i] * found->strip[i].line_load * found->strip[i].breadth;
        load += part;
        along += part * found->strip[i].curvature;
    }
    along /= load;
    const double across = 0.75 * load / found->strip[top].line_load;
    const double known = log(1.5 * load / (PI * plane_modulus * along * across * across * across));
    const double kappa = exp(series(fits->kappa, within(known, fits->loads)));
    for (int i = 0; i < found->count; ++i) {
        strip_of *strip = &found->strip[i];
        if (strip->segment != segment) continue;
        const double stiffness = kappa * strip->curvature * plane_modulus;
        strip->half_length = sqrt(2.0 / PI * strip->line_load / stiffness);
        strip->pressure = stiffness * strip->half_length;
    }
}

static double arithmetic_geometric_mean(double large, double small) {
    for (int i = 0; i < 5; ++i) {
        const double mean = 0.5 * (large + small);
        small = sqrt(large * small);
        large = mean;
    }
    return large;
}

/* How the strips that touch stretch each other, and how the stress grows along them: strip_creep.py. */
static void stiffen(const fits_of *fits, pressed_of *found) {
    static const double LEAST_PULL = 0.05;
    double weight[MOST][MOST], stiff[2][MOST], turned[MOST];
    int count = 0;
    for (int i = 0; i < found->count; ++i)
        if (found->strip[i].line_load > 0.0) found->inside[count++] = i;
    found->touching = count;
    for (int by = 0; by < count; ++by) {
        const strip_of *strip = &found->strip[found->inside[by]];
        const double a = strip->half_length, half = 0.5 * strip->breadth, inverse = 1.0 / a, square = inverse * inverse;
        for (int at = 0; at < count; ++at) {
            const double ratio = square * away(&found->strip[found->inside[at]], strip), m = 1.0 / (1.0 + ratio);
            weight[at][by] = m * sqrt(m);
            found->stretch[at][by] = at == by ? 2.0 * half / arithmetic_geometric_mean(sqrt(a * a + half * half), half)
                                              : 4.0 / PI * half * inverse * m * beside(fits, ratio);
        }
        found->pull[by] = 1.0;
    }
    factorise(count, found->stretch);
    solve(count, found->stretch, found->pull);
    for (int by = 0; by < count; ++by) {
        const strip_of *strip = &found->strip[found->inside[by]];
        double carried = 0.0, turning = 0.0;
        for (int i = 0; i < count; ++i) {
            const strip_of *other = &found->strip[found->inside[i]];
            const double part = weight[i][by] * other->half_length * other->half_length * other->breadth;
            carried += part;
            turning += part * other->half_length;
        }
        found->pull[by] = fmax(found->pull[by], LEAST_PULL);
        const double grip = 0.5 * PI * PI * found->pull[by], known = within(1.0 / grip, fits->grips);
        const double force = grip * strip->half_length * strip->breadth;
        stiff[0][by] = force * series(fits->ahead, known) / (PI * carried);
        stiff[1][by] = force * series(fits->aside, known) / (PI * carried);
        turned[by] = 1.125 * force * strip->half_length * series(fits->spin, known) / turning;
    }
    for (int at = 0; at < count; ++at) {
        found->ahead[at] = found->aside[at] = found->turning[at] = 0.0;
        for (int by = 0; by < count; ++by) {
            found->ahead[at] += weight[at][by] * stiff[0][by];
            found->aside[at] += weight[at][by] * stiff[1][by];
            found->turning[at] += weight[at][by] * turned[by];
        }
    }
}

/* Contact and pressure of the wheel, and the response of its strips to creepage. */
static void press(const wheel_on_rail *pair, const fits_of *fits, const stand_of *stand, double plane_modulus,
                  pressed_of *found, int anew) {
    int touch[MOST];
    lay_strips(pair, stand, found, anew);
    for (int i = 0; i < found->count; i += STRIPS) begin(fits, found->strip + i, touch + i);
    carry(fits, plane_modulus, found, touch);
    for (int segment = 0; segment < pair->segments; ++segment) lengthen(fits, plane_modulus, found, segment);
    stiffen(fits, found);
}

/* A stress that is met by friction: FASTSIM with three flexibilities, strip_creep.py. */
static void cut(double *stress, double limit, const double *flexible) {
    const double size = sqrt(stress[0] * stress[0] + stress[1] * stress[1]);
    if (!(size > limit)) return;
    const double beyond = size / fmax(limit, TINY) - 1.0;
    for (int i = 0; i < 2; ++i) stress[i] /= 1.0 + beyond / flexible[i];
    const double share = limit / fmax(sqrt(stress[0] * stress[0] + stress[1] * stress[1]), TINY);
    for (int i = 0; i < 2; ++i) stress[i] *= share;
}

/* Force of a strip [N] for the stress's growth [Pa/m], that by spin [Pa/m2], and friction. */
static void creep_of_strip(const strip_of *strip, const double *steady, double turning, double limit, const double *flexible,
                           double *force) {
    static const double MEAN =
        2.0 / 3.0 + 1.0 / (3.0 * (double)CELLS * (double)CELLS); /* of the parabola in the middles of the cells */
    double stress[2] = {0.0, 0.0}, total[2] = {0.0, 0.0}, before = 1.0;
    for (int cell = 0; cell < CELLS; ++cell) {
        const double place = 1.0 - (2 * cell + 1.0) / (double)CELLS;
        const double moved = strip->half_length * (before - place);
        const double turned = 0.5 * (before + place) * strip->half_length;
        before = place;
        stress[0] -= moved * steady[0];
        stress[1] -= moved * (steady[1] + turning * turned);
        /* A parabola with the load of half an ellipse. */
        cut(stress, limit * (1.0 - place * place) * 0.25 * PI / MEAN, flexible);
        total[0] += stress[0];
        total[1] += stress[1];
    }
    for (int i = 0; i < 2; ++i) force[i] = total[i] * 2.0 * strip->half_length / (double)CELLS * strip->breadth;
}

/* As `RailSlope` of pressing_patch.py; ahead [m]: where the strip touches, and so moves down. */
typedef struct {
    double aside, drift, ahead;
} rail_slope_of;

static rail_slope_of rail_slope(const strip_of *strip, const motion_of *motion) {
    const double *slope = motion->slope, *axle = motion->axle, radius = strip->cosine / (2.0 * strip->curvature);
    const double drift = motion->creeps_on_slope * (strip->cosine * slope[1] - strip->sine * slope[0]);
    const rail_slope_of found = {motion->creeps_on_slope * (strip->cosine * slope[0] + strip->sine * slope[1]), drift,
                                 radius * drift / (strip->cosine * axle[0] + strip->sine * axle[1])};
    return found;
}

/* How the wheel's surface slides at a strip: ahead, to the side [m/s], spin [rad/s], and closing in on the rail. */
static void slide(const strip_of *strip, const motion_of *motion, double *sliding) {
    const double *w = motion->rate, *r = strip->arm;
    const double v[3] = {motion->velocity[0] + w[1] * r[2] - w[2] * r[1], motion->velocity[1] + w[2] * r[0] - w[0] * r[2],
                         motion->velocity[2] + w[0] * r[1] - w[1] * r[0]};
    const double drift = strip->cosine * motion->slope[1] - strip->sine * motion->slope[0];
    const double sideways = strip->cosine * v[1] + strip->sine * v[2];
    const rail_slope_of on = rail_slope(strip, motion);
    sliding[2] = strip->cosine * w[2] - strip->sine * w[1];
    sliding[3] = motion->velocity[0] * drift + strip->sine * v[1] - strip->cosine * v[2];
    sliding[0] = v[0] + on.aside * sideways - on.drift * sliding[3];
    sliding[1] = sideways - on.aside * v[0] - on.ahead * (strip->sine * w[1] - strip->cosine * w[2]);
}

/* Adds what a strip does to its wheelset: `force` ahead and to the side, and the load that presses it. */
static void add_strip(const strip_of *strip, const motion_of *motion, const double *sliding, const double *force, double load,
                      double elastic, double *result) {
    const double drift = strip->cosine * motion->slope[1] - strip->sine * motion->slope[0], *r = strip->arm;
    const rail_slope_of on = rail_slope(strip, motion);
    const double ahead = force[0] - on.aside * force[1], aside = force[1] + on.aside * force[0];
    const double normal = load + on.drift * force[0];
    const double f[3] = {ahead, strip->cosine * aside - strip->sine * normal, strip->sine * aside + strip->cosine * normal};
    result[0] += f[0] - drift * normal;
    result[1] += f[1];
    result[2] += f[2];
    result[3] += r[1] * f[2] - r[2] * f[1];
    result[4] += r[2] * f[0] - r[0] * f[2] - on.ahead * strip->sine * force[1];
    result[5] += r[0] * f[1] - r[1] * f[0] + on.ahead * strip->cosine * force[1];
    result[6] += force[0];
    result[7] -= force[0] * sliding[0] + force[1] * sliding[1];
    result[9] += (load - elastic) * sliding[3];
    result[10] += 0.5 * elastic * strip->overlap; /* work of surfaces that are lowered in proportion */
}

/* Friction of a strip that slides, rbd_model/track/friction.py. */
static double friction_of(const strip_of *strip, const motion_of *motion, const steel_of *steel, const double *sliding) {
    const double share = fmin(fmax((strip->sine - HEAD_ENDS) / (GAUGE_FACE_BEGINS - HEAD_ENDS), 0.0), 1.0);
    const double friction = motion->friction * (1.0 + (steel->gauge_face - 1.0) * share * share * (3.0 - 2.0 * share));
    const double speed = sqrt(sliding[0] * sliding[0] + sliding[1] * sliding[1]);
    return friction * (steel->fall * exp(-steel->decay * speed) + steel->ratio);
}

/* Creep forces of all strips, and what each does for its segment. */
static void creep(pressed_of *found, const motion_of *motion, const steel_of *steel, double *result) {
    double sliding[MOST][4], pulled[2][MOST];
    const int count = found->touching;
    for (int i = 0; i < count; ++i) {
        slide(&found->strip[found->inside[i]], motion, sliding[i]);
        for (int k = 0; k < 2; ++k) pulled[k][i] = sliding[i][k];
    }
    for (int k = 0; k < 2; ++k) solve(count, found->stretch, pulled[k]);
    const double speed = motion->velocity[0], least = steel->creepage_speed, modulus = steel->modulus * steel->adhesion;
    const double stiffness = modulus / sqrt(speed * speed + least * least), ahead = fmax(fmin(speed / least, 1.0), -1.0);
    for (int i = 0; i < count; ++i) {
        const strip_of *strip = &found->strip[found->inside[i]];
        const double elastic = strip->line_load * strip->breadth;
        const double factor = fmax(1.0 + steel->damping * sliding[i][3], 0.0), share = stiffness / found->pull[i];
        const double steady[2] = {share * found->ahead[i] * pulled[0][i], share * found->aside[i] * pulled[1][i]};
        const double whole = 2.0 / (found->ahead[i] + found->aside[i]);
        const double flexible[2] = {whole * found->aside[i], whole * found->ahead[i]};
        double force[2];
        creep_of_strip(strip, steady, ahead * stiffness * sliding[i][2] * found->turning[i],
                       friction_of(strip, motion, steel, sliding[i]) * factor * strip->pressure, flexible, force);
        add_strip(strip, motion, sliding[i], force, factor * elastic, elastic, result + OF_SEGMENT * strip->segment);
    }
}

/* Centre of the squared overlap of the undeformed surfaces: place on the rail [m], angle [rad]; largest pressure. */
static void middle_of(const pressed_of *found, double *result) {
    double sum = 0.0;
    result[0] = result[1] = result[2] = 0.0;
    for (int i = 0; i < found->count; ++i) {
        const strip_of *strip = &found->strip[i];
        const double depth = fmax(-strip->gap, 0.0);
        const double weight = depth * depth * sqrt(depth * strip->cosine / strip->curvature) * strip->breadth * strip->cosine;
        sum += weight;
        result[0] += weight * strip->on_rail;
        result[1] += weight * atan2(strip->sine, strip->cosine);
        result[2] = fmax(result[2], strip->pressure);
    }
    if (sum > 0.0)
        for (int k = 0; k < 2; ++k) result[k] /= sum;
}

static void stand_where(const double *argument, const double *wheel, stand_of *stand) {
    const double side = wheel[0], yaw = side * argument[8], roll = side * argument[9];
    const double cy = cos(yaw), sy = sin(yaw), cr = cos(roll), sr = sin(roll);
    const double axes[3][3] = {{cy, -sy * cr, sy * sr}, {sy, cy * cr, -cy * sr}, {0.0, sr, cr}};
    for (int i = 0; i < 9; ++i) stand->axes[i / 3][i % 3] = axes[i / 3][i % 3];
    stand->outwards = axes[0][1];
    stand->level = 1.0 / sqrt(axes[0][0] * axes[0][0] + axes[0][2] * axes[0][2]);
    stand->lateral = side * argument[6];
    stand->height = argument[7];
    stand->radius = wheel[1];
    stand->wheel_half = wheel[2];
    stand->rail_half = wheel[3];
}

static void move_how(const double *argument, double side, const stand_of *stand, motion_of *motion) {
    const double own[3] = {side * argument[3], argument[4], side * argument[5]};
    for (int i = 0; i < 3; ++i)
        motion->rate[i] = stand->axes[i][0] * own[0] + stand->axes[i][1] * own[1] + stand->axes[i][2] * own[2];
    motion->axle[0] = stand->axes[1][1];
    motion->axle[1] = stand->axes[2][1];
    motion->velocity[0] = argument[0];
    motion->velocity[1] = side * argument[1];
    motion->velocity[2] = argument[2];
    motion->slope[0] = side * argument[10];
    motion->slope[1] = argument[11];
    motion->friction = argument[12];
}

/* Contact of the wheel: `found` has it, or has it for a neighbouring place, or it is searched for again. */
typedef enum { TOUCHES_THERE, TOUCHES_BESIDE, TOUCHES_ANEW } touches;

/* All results for arguments and constants. */
static void forces_of_wheel(const wheel_on_rail *pair, const fits_of *fits, const double *argument, const double *constant,
                            pressed_of *found, touches where, double *result) {
    const double side = constant[0];
    const steel_of steel = {constant[4], constant[5],  constant[5] / (1.0 - constant[12]),
                            constant[6], constant[7],  constant[8],
                            constant[9], constant[10], constant[11]};
    stand_of stand;
    motion_of motion;
    stand_where(argument, constant, &stand);
    move_how(argument, side, &stand, &motion);
    motion.creeps_on_slope = constant[13];
    if (where != TOUCHES_THERE) press(pair, fits, &stand, steel.plane_modulus, found, where == TOUCHES_ANEW);
    for (int i = 0; i < OF_SEGMENT * pair->segments; ++i) result[i] = 0.0;
    creep(found, &motion, &steel, result);
    for (int segment = 0; segment < pair->segments; ++segment) {
        double *of = result + OF_SEGMENT * segment, moment[3];
        of[8] = found->nearest[segment];
        for (int i = 0; i < 3; ++i) /* in the wheelset's own axes */
            moment[i] = stand.axes[0][i] * of[3] + stand.axes[1][i] * of[4] + stand.axes[2][i] * of[5];
        of[1] *= side;
        of[3] = side * moment[0];
        of[4] = moment[1];
        of[5] = side * moment[2];
    }
    middle_of(found, result + OF_SEGMENT * pair->segments);
}

/* Results, and with `slopes` their derivatives by differences: a search has no others. Only the four coordinates move
 * the place where the wheel touches. */
static void wheel_on_strips(const wheel_on_rail *pair, const fits_of *fits, const double *argument, const double *constant,
                            double *result, double *slope) {
    static const double STEP[ARGUMENTS] = {1e-7, 1e-8, 1e-8, 1e-8, 1e-8, 1e-8, 2e-9, 2e-9, 1e-8, 2e-9, 1e-8, 1e-8, 1e-7};
    const int count = OF_SEGMENT * pair->segments + OF_WHEEL;
    pressed_of found, moved;
    double at[ARGUMENTS], there[MOST_RESULTS];
    forces_of_wheel(pair, fits, argument, constant, &found, TOUCHES_ANEW, result);
    if (!slope) return;
    for (int i = 0; i < ARGUMENTS; ++i) at[i] = argument[i];
    for (int i = 0; i < ARGUMENTS; ++i) {
        const int coordinate = i >= 6 && i < 10;
        at[i] = argument[i] + STEP[i];
        const double step = at[i] - argument[i];
        if (coordinate) {
            memcpy(moved.ends, found.ends, sizeof found.ends);
            memcpy(moved.overlaps, found.overlaps, sizeof found.overlaps);
        }
        forces_of_wheel(pair, fits, at, constant, coordinate ? &moved : &found, coordinate ? TOUCHES_BESIDE : TOUCHES_THERE,
                        there);
        at[i] = argument[i];
        for (int k = 0; k < count; ++k) slope[i * count + k] = (there[k] - result[k]) / step;
    }
}

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC pop_options
#endif
