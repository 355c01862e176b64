/* Mathematical functions of lanes, from + - * / sqrt, comparisons and bits alone; included by lanes.h for each width.
 *
 * The largest errors among ten million arguments, in units in the last place: exp 0.95, log 0.85, sin and cos 0.8, tan 1.4,
 * asin and acos 1.2, atan 0.8, atan2 1.5, pow and cbrt 0.97. Special values are those of C99.
 *
 * Coefficients of sin, cos, log, asin and the parts of pi/2 and ln(2) are those of fdlibm (Sun Microsystems 1993,
 * netlib.org/fdlibm). So is the order of operations in the logarithm of pow. The polynomials of exp, atan and that logarithm
 * are minimax by Remez's exchange.
 *
 * The functions at the end, and sin, cos and tan of angles beyond 1e6, are the C library's. */

#define LANES_ROUND 6755399441055744.0 /* 1.5 * 2^52: added to a small number, the low bits are the nearest integer */
#define LANES_ROUND_BITS 0x4338000000000000ull
#define LANES_LOG2_E 1.44269504088896338700e+00
#define LANES_LN2_HIGH 6.93147180369123816490e-01 /* 32 bits */
#define LANES_LN2_LOW 1.90821492927058770002e-10
#define LANES_TWO_THIRDS_HIGH 0.6666666567325592 /* 26 bits */
#define LANES_TWO_THIRDS_LOW 9.934107462565104e-09
#define LANES_HALF_PI_HIGH 1.57079632679489655800e+00
#define LANES_HALF_PI_LOW 6.12323399573676603587e-17

LANES_FUNCTION real real_floor(real x) {
    const real size = real_fabs(x);
    const real near = real_copysign((size + 4503599627370496.0) - 4503599627370496.0, x);
    return real_select(size < 4503599627370496.0, near - real_of_mask(near > x), x);
}

LANES_FUNCTION real real_ceil(real x) { return -real_floor(-x); }

/* exp(high - low) for |high| below 0.35, low a correction. */
LANES_FUNCTION real lanes_exp_sum(real high, real low) {
    const real r = high - low, z = r * r, w = z * z;
    const real p01 = 0.50000000000000122 + 0.16666666666666699 * r;
    const real p23 = 0.041666666666515306 + 0.0083333333333073314 * r;
    const real p45 = 0.0013888888947052307 + 0.00019841269916969303 * r;
    const real p67 = 2.4801489898141959e-05 + 2.7557216743769239e-06 * r;
    const real p89 = 2.7631298225197778e-07 + 2.5117707397348456e-08 * r;
    const real p = (p01 + p23 * z) + ((p45 + p67 * z) + p89 * w) * w;
    return 1.0 + (high - (low - z * p));
}

/* Pass the lanes of x to a function that is called, not inlined: for rare arguments. It computes every lane again. */
LANES_FUNCTION real lanes_call(void (*edge)(const double *, double *), real x) {
    double argument[LANES], value[LANES];
    real_store(argument, x);
    edge(argument, value);
    return real_load(value);
}

LANES_FUNCTION real lanes_call2(void (*edge)(const double *, const double *, double *), real x, real y) {
    double first[LANES], second[LANES], value[LANES];
    real_store(first, x);
    real_store(second, y);
    edge(first, second, value);
    return real_load(value);
}

/* x * 2^n from the bits of LANES_ROUND + n: for results that are normal numbers. */
LANES_FUNCTION real lanes_scaled(real x, lanes_word rounded) { return lanes_of_word(lanes_word_of(x) + (rounded << 52)); }

/* The same for -1100 < n < 1100 by two factors, so that a result out of range is rounded once. */
LANES_FUNCTION real lanes_scaled_far(real x, lanes_word rounded) {
    const lanes_word exponent = rounded - (LANES_ROUND_BITS - 2046ull);
    const lanes_word half = exponent >> 1;
    return x * lanes_of_word(half << 52) * lanes_of_word((exponent - half) << 52);
}

/* exp(x - n ln(2)), n being the integer nearest to x / ln(2), from -1100 to 1100; *rounded is the bits of LANES_ROUND + n. */
LANES_FUNCTION real lanes_exp_part(real x, real low, lanes_word *rounded) {
    const real sum = x * LANES_LOG2_E + LANES_ROUND, n = sum - LANES_ROUND;
    *rounded = lanes_word_of(sum);
    return lanes_exp_sum(x - n * LANES_LN2_HIGH, n * LANES_LN2_LOW - low);
}

LANES_APART void lanes_exp_edge(const double *argument, double *value) {
    lanes_word rounded;
    real x = real_load(argument);
    x = real_select(x < -746.0, real_of(-746.0), x);
    x = real_select(x > 710.0, real_of(710.0), x);
    const real part = lanes_exp_part(x, real_of(0.0), &rounded);
    real_store(value, lanes_scaled_far(part, rounded));
}

LANES_FUNCTION real real_exp(real x) {
    lanes_word rounded;
    if (real_any(real_not(real_fabs(x) <= 708.0))) return lanes_call(lanes_exp_edge, x);
    const real part = lanes_exp_part(x, real_of(0.0), &rounded);
    return lanes_scaled(part, rounded);
}

/* x = m 2^n with m from `lowest` (below 1, its bits) to twice that, for positive normal x. */
LANES_FUNCTION real lanes_mantissa(real x, unsigned long long lowest, real *n) {
    const lanes_word bits = lanes_word_of(x) + (0x3ff0000000000000ull - lowest);
    *n = lanes_of_word((bits >> 52) | 0x4330000000000000ull) - 4503599627371519.0; /* 2^52 + 1023 */
    return lanes_of_word((bits & 0x000fffffffffffffull) + lowest);
}

#define LANES_SQRT_HALF 0x3fe6a09e667f3bcdull
#define LANES_SQRT_THREE_QUARTERS 0x3febb67ae8584caaull
#define LANES_SMALLEST_NORMAL 2.2250738585072014e-308

/* log(1 + f) + n ln(2) */
LANES_FUNCTION real lanes_log_sum(real f, real n) {
    const real s = f / (2.0 + f), z = s * s, w = z * z;
    const real even = w * (3.999999999940941908e-01 + w * (2.222219843214978396e-01 + w * 1.531383769920937332e-01));
    const real odd = z * ((6.666666666666735130e-01 + w * 2.857142874366239149e-01) +
                          w * w * (1.818357216161805012e-01 + w * 1.479819860511658591e-01));
    const real half_square = 0.5 * f * f;
    return n * LANES_LN2_HIGH - ((half_square - (s * (half_square + (even + odd)) + n * LANES_LN2_LOW)) - f);
}

LANES_APART void lanes_log_edge(const double *argument, double *value) {
    real n;
    const real x = real_load(argument);
    const real_mask small = x < LANES_SMALLEST_NORMAL;
    const real m = lanes_mantissa(real_select(small, x * 18014398509481984.0, x), LANES_SQRT_HALF, &n); /* 2^54 */
    real y = lanes_log_sum(m - 1.0, n - real_where(small, real_of(54.0)));
    y = real_select((x == x) & (x < HUGE_VAL), y, x); /* infinity and NaN are their own */
    y = real_select(x == 0.0, real_of(-HUGE_VAL), y);
    real_store(value, real_select(x < 0.0, real_of(NAN), y));
}

LANES_FUNCTION real real_log(real x) {
    real n;
    if (real_any(real_not((x >= LANES_SMALLEST_NORMAL) & (x < HUGE_VAL)))) return lanes_call(lanes_log_edge, x);
    const real m = lanes_mantissa(x, LANES_SQRT_HALF, &n);
    return lanes_log_sum(m - 1.0, n);
}

/* f of each lane by the C library. */
LANES_APART void lanes_each(double (*f)(double), const double *x, double *y) {
    LANES_LEAVE;
    for (int i = 0; i < LANES; ++i) y[i] = f(x[i]);
}

LANES_FUNCTION real lanes_by(double (*f)(double), real x) {
    double argument[LANES], value[LANES];
    real_store(argument, x);
    lanes_each(f, argument, value);
    return real_load(value);
}

LANES_APART void lanes_each2(double (*f)(double, double), const double *x, const double *y, double *z) {
    LANES_LEAVE;
    for (int i = 0; i < LANES; ++i) z[i] = f(x[i], y[i]);
}

LANES_FUNCTION real lanes_by2(double (*f)(double, double), real x, real y) {
    double first[LANES], second[LANES], value[LANES];
    real_store(first, x);
    real_store(second, y);
    lanes_each2(f, first, second, value);
    return real_load(value);
}

/* x - n pi/2 with its rounding error *low, |x| below 1e6, four parts of pi/2 of 33 bits and more; *turns ends in the bits
 * of n. The products of the first three are exact. */
LANES_FUNCTION real lanes_reduce(real x, real *low, lanes_word *turns) {
    const real rounded = x * 6.36619772367581382433e-01 + LANES_ROUND, n = rounded - LANES_ROUND;
    const real a = x - n * 1.57079632673412561417e+00;
    const real second = n * 6.07710050630396597660e-11, b = a - second;
    const real third = n * 2.02226624871116645580e-21, c = b - third;
    const real lost = n * 8.47842766036889956997e-32 - (((a - b) - second) + ((b - c) - third));
    const real high = c - lost;
    *low = (c - high) - lost;
    *turns = lanes_word_of(rounded);
    return high;
}

/* sin(high + low), |high| up to pi/4; `lost` is the rounding error of the result. */
LANES_FUNCTION real lanes_sin_core(real high, real low, real *lost) {
    const real z = high * high, v = z * high, w = z * z;
    const real r = (8.33333333332248946124e-03 + z * -1.98412698298579493134e-04) +
                   w * (2.75573137070700676789e-06 + z * -2.50507602534068634195e-08 + w * 1.58969099521155010221e-10);
    const real less = (z * (0.5 * low - v * r) - low) - v * -1.66666666666666324348e-01;
    const real y = high - less;
    *lost = (high - y) - less;
    return y;
}

LANES_FUNCTION real lanes_cos_core(real high, real low, real *lost) {
    const real z = high * high, w = z * z;
    const real r = (4.16666666666666019037e-02 + z * -1.38888888888741095749e-03) +
                   w * ((2.48015872894767294178e-05 + z * -2.75573143513906633035e-07) +
                        w * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11));
    const real half = 0.5 * z, most = 1.0 - half, rest = ((1.0 - most) - half) + (w * r - high * low);
    const real y = most + rest;
    *lost = (most - y) + rest;
    return y;
}

/* sin(x + quarters pi/2), |x| below 1e6. */
LANES_FUNCTION real lanes_turned_sin(real x, unsigned long long quarters) {
    real low, lost;
    lanes_word turns;
    const real high = lanes_reduce(x, &low, &turns);
    turns = turns + quarters;
    const real y = real_select(lanes_odd(turns), lanes_cos_core(high, low, &lost), lanes_sin_core(high, low, &lost));
    return lanes_of_word(lanes_word_of(y) ^ (((turns >> 1) & 1ull) << 63));
}

#define LANES_SMALL_ANGLE 1e6

/* Larger angles, infinities and NaN go to the C library, at every width. */
LANES_FUNCTION real lanes_or_by(real y, double (*f)(double), real x) {
    const real_mask regular = real_fabs(x) <= LANES_SMALL_ANGLE;
    if (real_any(real_not(regular))) y = real_select(regular, y, lanes_by(f, x));
    return y;
}

LANES_FUNCTION real real_sin(real x) { return lanes_or_by(lanes_turned_sin(x, 0), sin, x); }

LANES_FUNCTION real real_cos(real x) { return lanes_or_by(lanes_turned_sin(x, 1), cos, x); }

/* Both, with the bits that each has alone. */
LANES_FUNCTION void real_sin_cos(real x, real *sine, real *cosine) {
    real low, lost;
    lanes_word turns;
    const real high = lanes_reduce(x, &low, &turns);
    const real s = lanes_sin_core(high, low, &lost), c = lanes_cos_core(high, low, &lost);
    const real_mask odd = lanes_odd(turns);
    const real up = lanes_of_word(lanes_word_of(real_select(odd, c, s)) ^ (((turns >> 1) & 1ull) << 63));
    const real ahead = lanes_of_word(lanes_word_of(real_select(odd, s, c)) ^ ((((turns + 1ull) >> 1) & 1ull) << 63));
    *sine = lanes_or_by(up, sin, x);
    *cosine = lanes_or_by(ahead, cos, x);
}

/* The rounding errors of sine and cosine are taken out of their quotient. */
LANES_FUNCTION real real_tan(real x) {
    real low, sin_lost, cos_lost;
    lanes_word turns;
    const real high = lanes_reduce(x, &low, &turns);
    const real s = lanes_sin_core(high, low, &sin_lost), c = lanes_cos_core(high, low, &cos_lost);
    const real_mask odd = lanes_odd(turns);
    const real upper = real_select(odd, c, s), lower = real_select(odd, -s, c), y = upper / lower;
    const real lost = real_select(odd, cos_lost + y * sin_lost, sin_lost - y * cos_lost);
    return lanes_or_by(real_copysign(y + lost / lower, y), tan, x); /* the sum loses the sign of zero */
}

/* atan(t) - t, |t| up to 0.4376. */
LANES_FUNCTION real lanes_atan_rest(real t) {
    const real z = t * t, z2 = z * z, z4 = z2 * z2;
    const real a = (-0.33333333333333315 + 0.1999999999999309 * z) + (-0.14285714284845338 + 0.11111111056249351 * z) * z2;
    const real b = (-0.090909070568748529 + 0.076922595284548853 * z) + (-0.066659025205055636 + 0.058740184603534244 * z) * z2;
    const real c = (-0.05200100796327025 + 0.044330202829372785 * z) + (-0.031916929760849228 + 0.013693178148541419 * z) * z2;
    return t * z * (a + (b + c * z4) * z4);
}

/* base + tail + t + rest, base 0 or above |t|. */
LANES_FUNCTION real lanes_sum(real base, real tail, real t, real rest) {
    const real sum = base + t, lost = (base - sum) + t;
    return sum + ((lost + tail) + rest);
}

#define LANES_ATAN_HALF 4.63647609000806093515e-01 /* atan(1/2), and its rounding error */
#define LANES_ATAN_HALF_TAIL 2.26987774529616870924e-17

/* atan(x) = atan(c) + atan(t), t = (x - c) / (1 + c x), with c one of 0, 1/2, 1 and infinity. */
LANES_FUNCTION real real_atan(real x) {
    const real size = real_fabs(x);
    const real_mask half = size >= 0.4375, one = size >= 0.75, steep = size >= 2.4375;
    const real c = real_where(half, real_of(0.5)) + real_where(one, real_of(0.5));
    const real t = real_select(steep, real_of(-1.0), size - c) / real_select(steep, size, 1.0 + c * size);
    const real below = real_select(one, real_of(0.5 * LANES_HALF_PI_HIGH), real_where(half, real_of(LANES_ATAN_HALF)));
    const real base = real_select(steep, real_of(LANES_HALF_PI_HIGH), below);
    const real below_tail = real_select(one, real_of(0.5 * LANES_HALF_PI_LOW), real_where(half, real_of(LANES_ATAN_HALF_TAIL)));
    const real tail = real_select(steep, real_of(LANES_HALF_PI_LOW), below_tail);
    return real_copysign(lanes_sum(base, tail, t, lanes_atan_rest(t)), x);
}

/* The angle of the first half quadrant, as in atan, is added to turns pi/2 or taken from it. */
LANES_FUNCTION real real_atan2(real y, real x) {
    const real height = real_fabs(y), width = real_fabs(x);
    const real_mask steep = height > width, left = real_copysign(real_of(1.0), x) < 0.0;
    const real longer = real_select(steep, height, width), shorter = real_select(steep, width, height);
    const real scale =
        real_select(longer > 1e300, real_of(7.888609052210118e-31),
                    real_select(longer < 1e-200, real_of(2.037035976334486e+90), real_of(1.0))); /* 2^-100, 2^300 */
    const real b = longer * scale, a = shorter * scale;
    const real_mask half = (a >= 0.4375 * b) & (b > 0.0), one = (a >= 0.75 * b) & (b > 0.0);
    const real less = real_where(half, 0.5 * b) + real_where(one, 0.5 * b);
    const real more = real_where(half, 0.5 * a) + real_where(one, 0.5 * a);
    const real slope = real_select(a == b, real_of(0.0), (a - less) / (b + more));
    const real part = real_select(one, real_of(0.5 * LANES_HALF_PI_HIGH), real_where(half, real_of(LANES_ATAN_HALF)));
    const real part_tail = real_select(one, real_of(0.5 * LANES_HALF_PI_LOW), real_where(half, real_of(LANES_ATAN_HALF_TAIL)));
    const real turns = real_select(steep, real_of(1.0), real_where(left, real_of(2.0)));
    const real sign = real_select(left, real_of(-1.0), real_of(1.0)) * real_select(steep, real_of(-1.0), real_of(1.0));
    const real turned = turns * LANES_HALF_PI_HIGH, base = turned + sign * part;
    const real tail = ((turned - base) + sign * part) + (turns * LANES_HALF_PI_LOW + sign * part_tail);
    const real t = sign * slope;
    return real_copysign(lanes_sum(base, tail, t, lanes_atan_rest(t)), y);
}

/* asin(t) / t - 1 over z = t^2 up to 1/4. */
LANES_FUNCTION real lanes_asin_rest(real z) {
    const real w = z * z;
    const real p = (1.66666666666666657415e-01 + z * -3.25565818622400915405e-01) +
                   w * ((2.01212532134862925881e-01 + z * -4.00555345006794114027e-02) +
                        w * (7.91534994289814532176e-04 + z * 3.47933107596021167570e-05));
    const real q = (1.0 + z * -2.40339491173441421878e+00) +
                   w * ((2.02094576023350569471e+00 + z * -6.88283971605453293030e-01) + w * 7.70381505559019352791e-02);
    return z * p / q;
}

/* asin(x) = pi/2 - 2 asin(sqrt((1 - x) / 2)) above 1/2. */
LANES_FUNCTION real real_asin(real x) {
    const real size = real_fabs(x);
    const real_mask wide = size > 0.5;
    const real z = real_select(wide, 0.5 * (1.0 - size), x * x);
    const real t = real_select(wide, -2.0 * real_sqrt(z), size);
    const real base = real_where(wide, real_of(LANES_HALF_PI_HIGH)), tail = real_where(wide, real_of(LANES_HALF_PI_LOW));
    return real_copysign(lanes_sum(base, tail, t, t * lanes_asin_rest(z)), x);
}

LANES_FUNCTION real real_acos(real x) {
    const real size = real_fabs(x);
    const real_mask wide = size > 0.5;
    const real z = real_select(wide, 0.5 * (1.0 - size), x * x);
    const real t = real_select(wide, real_copysign(2.0 * real_sqrt(z), x), -x);
    const real turns = real_select(wide, real_where(x < 0.0, real_of(2.0)), real_of(1.0));
    return lanes_sum(turns * LANES_HALF_PI_HIGH, turns * LANES_HALF_PI_LOW, t, t * lanes_asin_rest(z));
}

/* The upper 26 bits of each number: products of two such are exact (Dekker, Numer. Math. 18, 1971). */
LANES_FUNCTION real lanes_cut(real x) { return lanes_of_word(lanes_word_of(x) & 0xfffffffff8000000ull); }

/* 3 (atanh(s) - s - s^3/3) / s^5 over z = s^2 up to 0.0102. */
LANES_FUNCTION real lanes_atanh_rest(real z) {
    const real w = z * z;
    return (0.59999999999999463 + 0.4285714285785282 * z) + (0.33333332982591372 + 0.27272812257469879 * z) * w +
           (0.23066084287234573 + 0.20697206748552052 * z) * (w * w);
}

/* 2 atanh((m - c) / (m + c)) with twice the precision as in fdlibm's pow, high + low, quotients up to 0.101. */
LANES_FUNCTION real lanes_log_ratio(real m, real c, real *low) {
    const real f = m - c, g = m + c, inverse = 1.0 / g;
    const real s_high = lanes_cut(f * inverse), g_high = lanes_cut(g), g_low = m - (g_high - c);
    const real s_low = ((f - s_high * g_high) - s_high * g_low) * inverse, s = s_high + s_low;
    const real z = s * s, square = s_high * s_high;
    const real rest = z * z * lanes_atanh_rest(z) + s_low * (s_high + s); /* 3 atanh(s) / s = 3 + square + rest */
    const real t_high = lanes_cut((3.0 + square) + rest), t_low = rest - ((t_high - 3.0) - square);
    const real most = s_high * t_high, less = s_low * t_high + t_low * s;
    const real high = lanes_cut(most + less);
    *low = high * LANES_TWO_THIRDS_LOW + (less - (high - most)) * (2.0 / 3.0);
    return high * LANES_TWO_THIRDS_HIGH;
}

/* log(x) - less ln(2) of positive normal x, high of 26 bits + low: n ln(2) + log(c) + 2 atanh((m - c) / (m + c)), c being 1 or 3/2. */
LANES_FUNCTION real lanes_log_long(real x, real less, real *low) {
    real n, ratio_low;
    const real m = lanes_mantissa(x, LANES_SQRT_THREE_QUARTERS, &n);
    n = n - less;
    const real_mask upper = m > 1.224744871391589; /* sqrt(3/2) */
    const real ratio = lanes_log_ratio(m, real_select(upper, real_of(1.5), real_of(1.0)), &ratio_low);
    const real large = n * LANES_LN2_HIGH + real_where(upper, real_of(4.05465107993222773075e-01)); /* exact */
    const real small = n * LANES_LN2_LOW + real_where(upper, real_of(1.14941608902909350082e-10)); /* of log(3/2) */
    const real total = large + ratio, rest = ((large - total) + ratio) + (small + ratio_low);
    const real high = lanes_cut(total + rest);
    *low = rest - (high - total);
    return high;
}

/* y (log(x) - less ln(2)) = result + *low. */
LANES_FUNCTION real lanes_times_log(real x, real less, real y, real *low) {
    real log_low;
    const real log_high = lanes_log_long(x, less, &log_low), y_high = lanes_cut(y);
    *low = (y - y_high) * log_high + y * log_low;
    return y_high * log_high;
}

/* C99's values of x^y, from |x|^y where neither is zero, infinite or NaN. */
LANES_FUNCTION real lanes_pow_special(real x, real y, real power) {
    const real size = real_fabs(x), half = 0.5 * y;
    const real_mask endless = real_fabs(y) == HUGE_VAL, negative = real_copysign(real_of(1.0), x) < 0.0;
    const real_mask whole = real_floor(y) == y, odd = whole & real_not(real_floor(half) == half);
    const real_mask grows = ((size > 1.0) & (y > 0.0)) | ((size < 1.0) & (y < 0.0));
    power = real_select((size == 0.0) | (size == HUGE_VAL) | endless, real_where(grows, real_of(HUGE_VAL)), power);
    power = real_select(negative & odd, -power, power);
    power = real_select((x < 0.0) & (size < HUGE_VAL) & real_not(whole), real_of(NAN), power);
    power = real_select((x != x) | (y != y), x + y, power);
    return real_select((x == 1.0) | (y == 0.0) | ((size == 1.0) & endless), real_of(1.0), power);
}

LANES_APART void lanes_pow_edge(const double *base, const double *power, double *value) {
    real low;
    lanes_word rounded;
    const real x = real_load(base), y = real_load(power), size = real_fabs(x);
    const real_mask small = size < LANES_SMALLEST_NORMAL;
    const real normal = real_select(small, size * 18014398509481984.0, size); /* 2^54 */
    real exponent = lanes_times_log(normal, real_where(small, real_of(54.0)), y, &low);
    const real_mask above = exponent > 710.0, below = exponent < -746.0;
    low = real_where(real_not(above | below), low);
    exponent = real_select(above, real_of(710.0), real_select(below, real_of(-746.0), exponent));
    const real part = lanes_exp_part(exponent, low, &rounded);
    real_store(value, lanes_pow_special(x, y, lanes_scaled_far(part, rounded)));
}

/* A base of zero, the commonest special value, is handled without that call. */
LANES_FUNCTION real real_pow(real x, real y) {
    real low;
    lanes_word rounded;
    const real_mask zero = (x == 0.0) & (real_copysign(real_of(1.0), x) > 0.0) & (y > 0.0);
    const real base = real_select(zero, real_of(1.0), x);
    const real exponent = lanes_times_log(base, real_of(0.0), y, &low);
    const real_mask regular = (base >= LANES_SMALLEST_NORMAL) & (base < HUGE_VAL) & (real_fabs(exponent) <= 700.0);
    if (real_any(real_not(regular))) return lanes_call2(lanes_pow_edge, x, y);
    const real part = lanes_exp_part(exponent, low, &rounded);
    return real_where(real_not(zero), lanes_scaled(part, rounded));
}

#define LANES_CBRT_2 1.259921049894873165
#define LANES_CBRT_HALF 0.7937005259840997374

/* Third root of positive normal numbers: of the mantissa by a polynomial (minimax, 1.2e-6) and one step of Halley's method,
 * which leaves 1.2e-18. */
LANES_FUNCTION real lanes_cbrt_part(real x) {
    real n;
    const real m = lanes_mantissa(x, LANES_SQRT_HALF, &n);
    const real sum = n * (1.0 / 3.0) + LANES_ROUND, rest = n - 3.0 * (sum - LANES_ROUND);
    const real z = m * m;
    const real low = 0.4216896946045899 + 1.0560154723829582 * m;
    const real high = (0.5109666048931906 - 0.17955721449059506 * m) + 0.0269549910387283 * z;
    const real guess = low + z * (m * high - 0.8360705352337751);
    const real_mask more = rest > 0.5, less = rest < -0.5;
    const real scale = real_select(more, real_of(2.0), real_select(less, real_of(0.5), real_of(1.0)));
    const real root = real_select(more, real_of(LANES_CBRT_2), real_select(less, real_of(LANES_CBRT_HALF), real_of(1.0)));
    const real mantissa = m * scale, y = guess * root, cube = y * y * y;
    return lanes_scaled(y + y * ((mantissa - cube) / (cube + cube + mantissa)), lanes_word_of(sum));
}

LANES_APART void lanes_cbrt_edge(const double *argument, double *value) {
    const real x = real_load(argument);
    const real_mask small = x < LANES_SMALLEST_NORMAL;
    const real root = lanes_cbrt_part(real_select(small, x * 18014398509481984.0, x)); /* 2^54 */
    const real finite = real_select(small, root * 3.814697265625e-06, root);           /* 2^-18 */
    const real known = real_select(x < HUGE_VAL, finite, x);
    const real positive = real_select(x > 0.0, known, real_of(NAN));
    real_store(value, real_select(x == 0.0, real_of(0.0), positive));
}

/* x to the power of a third, as pow computes it: NaN for a negative number. */
LANES_FUNCTION real real_cbrt(real x) {
    if (real_any(real_not((x >= LANES_SMALLEST_NORMAL) & (x < HUGE_VAL)))) return lanes_call(lanes_cbrt_edge, x);
    return lanes_cbrt_part(x);
}

/* Lane by lane through the C library; the bits are those of the platform. */
#define LANES_OF_LIBRARY(f)                                                                                                    \
    LANES_FUNCTION real real_##f(real x) { return lanes_by(f, x); }
#define LANES_OF_LIBRARY2(f)                                                                                                   \
    LANES_FUNCTION real real_##f(real x, real y) { return lanes_by2(f, x, y); }
LANES_OF_LIBRARY(sinh)
LANES_OF_LIBRARY(cosh)
LANES_OF_LIBRARY(tanh)
LANES_OF_LIBRARY(asinh)
LANES_OF_LIBRARY(acosh)
LANES_OF_LIBRARY(atanh)
LANES_OF_LIBRARY(expm1)
LANES_OF_LIBRARY(log1p)
LANES_OF_LIBRARY(erf)
LANES_OF_LIBRARY2(fmod)
LANES_OF_LIBRARY2(remainder)
LANES_OF_LIBRARY2(hypot)
#undef LANES_OF_LIBRARY
#undef LANES_OF_LIBRARY2
