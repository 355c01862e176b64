/* Mathematical functions of lanes, from + - * / sqrt, comparisons and bits alone; included by lanes.h for each width.
 *
 * Special values are those of C99. Coefficients: sin, cos, log, asin and the parts of pi/2 and ln(2) are those of fdlibm
 * (Sun Microsystems 1993, netlib.org/fdlibm); exp, atan and the logarithm of pow are minimax polynomials computed for this
 * file by Remez's exchange with 60 digits. */

#define LANES_SIGN 0x8000000000000000ull
#define LANES_ROUND 6755399441055744.0 /* 1.5 * 2^52: added to a small number, the low bits are the nearest integer */
#define LANES_ROUND_BITS 0x4338000000000000ull
#define LANES_LOG2_E 1.44269504088896338700e+00
#define LANES_LN2_HIGH 6.93147180369123816490e-01 /* 32 bits */
#define LANES_LN2_LOW 1.90821492927058770002e-10
#define LANES_HALF_PI_HIGH 1.57079632679489655800e+00
#define LANES_HALF_PI_LOW 6.12323399573676603587e-17

LANES_FUNCTION real real_fabs(real x)
{
    return lanes_of_word(lanes_word_of(x) & ~LANES_SIGN);
}

/* |x| with the sign of `sign`. */
LANES_FUNCTION real real_copysign(real x, real sign)
{
    return lanes_of_word((lanes_word_of(x) & ~LANES_SIGN) | (lanes_word_of(sign) & LANES_SIGN));
}

LANES_FUNCTION real real_floor(real x)
{
    const real size = real_fabs(x);
    const real near = real_copysign((size + 4503599627370496.0) - 4503599627370496.0, x);
    return real_select(size < 4503599627370496.0, near - real_of_mask(near > x), x);
}

LANES_FUNCTION real real_ceil(real x)
{
    return -real_floor(-x);
}

/* exp(high - low) for |high| below 0.35, low a correction. */
LANES_FUNCTION real lanes_exp_sum(real high, real low)
{
    const real r = high - low, z = r * r, w = z * z;
    const real p01 = 0.50000000000000122 + 0.16666666666666699 * r;
    const real p23 = 0.041666666666515306 + 0.0083333333333073314 * r;
    const real p45 = 0.0013888888947052307 + 0.00019841269916969303 * r;
    const real p67 = 2.4801489898141959e-05 + 2.7557216743769239e-06 * r;
    const real p89 = 2.7631298225197778e-07 + 2.5117707397348456e-08 * r;
    const real p = (p01 + p23 * z) + ((p45 + p67 * z) + p89 * w) * w;
    return 1.0 + (high - (low - z * p));
}

/* x * 2^n from the bits of LANES_ROUND + n, -1100 < n < 1100, by two factors, so that the result is rounded once. */
LANES_FUNCTION real lanes_power(real x, lanes_word rounded)
{
    const lanes_word exponent = rounded - (LANES_ROUND_BITS - 2046ull);
    const lanes_word half = exponent >> 1;
    return x * lanes_of_word(half << 52) * lanes_of_word((exponent - half) << 52);
}

LANES_FUNCTION real real_exp(real x)
{
    x = real_select(x < -746.0, real_of(-746.0), x);
    x = real_select(x > 710.0, real_of(710.0), x);
    const real rounded = x * LANES_LOG2_E + LANES_ROUND, n = rounded - LANES_ROUND;
    return lanes_power(lanes_exp_sum(x - n * LANES_LN2_HIGH, n * LANES_LN2_LOW), lanes_word_of(rounded));
}

/* x = m 2^n with m from sqrt(1/2) to sqrt(2), for positive finite x. */
LANES_FUNCTION real lanes_mantissa(real x, real *n)
{
    const real_mask tiny = x < 2.2250738585072014e-308;
    const lanes_word bits = lanes_word_of(real_select(tiny, x * 18014398509481984.0, x)) + 0x00095f619980c433ull;
    const real exponent = lanes_of_word((bits >> 52) | 0x4330000000000000ull) - 4503599627370496.0;
    *n = exponent - real_select(tiny, real_of(1077.0), real_of(1023.0));
    return lanes_of_word((bits & 0x000fffffffffffffull) + 0x3fe6a09e667f3bcdull);
}

LANES_FUNCTION real real_log(real x)
{
    real n;
    const real f = lanes_mantissa(x, &n) - 1.0;
    const real s = f / (2.0 + f), z = s * s, w = z * z;
    const real even = w * (3.999999999940941908e-01 + w * (2.222219843214978396e-01 + w * 1.531383769920937332e-01));
    const real odd = z * (6.666666666666735130e-01 +
                          w * (2.857142874366239149e-01 +
                               w * (1.818357216161805012e-01 + w * 1.479819860511658591e-01)));
    const real half_square = 0.5 * f * f;
    real y = n * LANES_LN2_HIGH - ((half_square - (s * (half_square + (even + odd)) + n * LANES_LN2_LOW)) - f);
    const real_mask regular = (x > 0.0) & (x < HUGE_VAL);
    if (real_any(real_not(regular))) {
        y = real_select(regular | (x < 0.0), y, x); /* infinity and NaN are their own */
        y = real_select(x == 0.0, real_of(-HUGE_VAL), y);
        y = real_select(x < 0.0, real_of(NAN), y);
    }
    return y;
}

/* f of each lane by the C library. */
LANES_APART void lanes_each(double (*f)(double), const double *x, double *y)
{
    LANES_LEAVE;
    for (int i = 0; i < LANES; ++i)
        y[i] = f(x[i]);
}

LANES_FUNCTION real lanes_by(double (*f)(double), real x)
{
    double argument[LANES], value[LANES];
    real_store(argument, x);
    lanes_each(f, argument, value);
    return real_load(value);
}

LANES_APART void lanes_each2(double (*f)(double, double), const double *x, const double *y, double *z)
{
    LANES_LEAVE;
    for (int i = 0; i < LANES; ++i)
        z[i] = f(x[i], y[i]);
}

LANES_FUNCTION real lanes_by2(double (*f)(double, double), real x, real y)
{
    double first[LANES], second[LANES], value[LANES];
    real_store(first, x);
    real_store(second, y);
    lanes_each2(f, first, second, value);
    return real_load(value);
}

/* x - n pi/2 with its rounding error *low, |x| below 1e6, four parts of pi/2 of 33 bits and more; *turns ends in the bits
 * of n. The products of the first three are exact. */
LANES_FUNCTION real lanes_reduce(real x, real *low, lanes_word *turns)
{
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

/* sin and cos of high + low, |high| up to pi/4. */
LANES_FUNCTION real lanes_sin_core(real high, real low)
{
    const real z = high * high, v = z * high, w = z * z;
    const real r = (8.33333333332248946124e-03 + z * -1.98412698298579493134e-04) +
                   w * (2.75573137070700676789e-06 + z * -2.50507602534068634195e-08 + w * 1.58969099521155010221e-10);
    return high - ((z * (0.5 * low - v * r) - low) - v * -1.66666666666666324348e-01);
}

LANES_FUNCTION real lanes_cos_core(real high, real low)
{
    const real z = high * high, w = z * z;
    const real r = (4.16666666666666019037e-02 + z * -1.38888888888741095749e-03) +
                   w * ((2.48015872894767294178e-05 + z * -2.75573143513906633035e-07) +
                        w * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11));
    const real half = 0.5 * z, y = 1.0 - half;
    return y + (((1.0 - y) - half) + (w * r - high * low));
}

/* sin(x + quarters pi/2), |x| below 1e6. */
LANES_FUNCTION real lanes_turned_sin(real x, unsigned long long quarters)
{
    real low;
    lanes_word turns;
    const real high = lanes_reduce(x, &low, &turns);
    turns = turns + quarters;
    const real y = real_select(lanes_odd(turns), lanes_cos_core(high, low), lanes_sin_core(high, low));
    return lanes_of_word(lanes_word_of(y) ^ (((turns >> 1) & 1ull) << 63));
}

#define LANES_SMALL_ANGLE 1e6

/* Larger angles, infinities and NaN go to the C library, at every width. */
LANES_FUNCTION real lanes_or_by(real y, double (*f)(double), real x)
{
    const real_mask regular = real_fabs(x) <= LANES_SMALL_ANGLE;
    if (real_any(real_not(regular)))
        y = real_select(regular, y, lanes_by(f, x));
    return y;
}

LANES_FUNCTION real real_sin(real x)
{
    return lanes_or_by(lanes_turned_sin(x, 0), sin, x);
}

LANES_FUNCTION real real_cos(real x)
{
    return lanes_or_by(lanes_turned_sin(x, 1), cos, x);
}

LANES_FUNCTION real real_tan(real x)
{
    real low;
    lanes_word turns;
    const real high = lanes_reduce(x, &low, &turns);
    const real s = lanes_sin_core(high, low), c = lanes_cos_core(high, low);
    const real_mask odd = lanes_odd(turns);
    const real y = real_select(odd, c, s) / real_select(odd, -s, c);
    return lanes_or_by(y, tan, x);
}

/* atan(t) - t, t from 0 to 1. */
LANES_FUNCTION real lanes_atan_rest(real t)
{
    const real z = t * t, z2 = z * z, z4 = z2 * z2, z8 = z4 * z4;
    const real a = (-0.33333333333333093 + 0.19999999999955423 * z) +
                   (-0.14285714282801271 + 0.11111111013619744 * z) * z2;
    const real b = (-0.090909071187035867 + 0.076922811806002564 * z) +
                   (-0.066664149508826681 + 0.058805923039957901 * z) * z2;
    const real c = (-0.052538045654580964 + 0.047232904387094606 * z) +
                   (-0.042217112216943568 + 0.036693412219835055 * z) * z2;
    const real d = (-0.029985415317106263 + 0.022084991353898874 * z) +
                   (-0.013994865716726227 + 0.007263292475005954 * z) * z2;
    const real e = (-0.0029193187748577645 + 0.00084347997286623197 * z) +
                   (-0.00015479677513599092 + 1.348931959239204e-05 * z) * z2;
    return t * z * ((a + b * z4) + ((c + d * z4) + e * z8) * z8);
}

/* base + tail + sign * atan(t): the sum that ends atan and atan2, base 0 or above t. */
LANES_FUNCTION real lanes_atan_sum(real base, real tail, real t, real rest)
{
    const real sum = base + t, lost = (base - sum) + t;
    return sum + ((lost + tail) + rest);
}

LANES_FUNCTION real real_atan(real x)
{
    const real size = real_fabs(x);
    const real_mask steep = size > 1.0;
    const real t = real_select(steep, real_of(-1.0), size) / real_select(steep, size, real_of(1.0));
    const real y = lanes_atan_sum(real_where(steep, real_of(LANES_HALF_PI_HIGH)),
                                  real_where(steep, real_of(LANES_HALF_PI_LOW)), t, lanes_atan_rest(t));
    return real_copysign(y, x);
}

LANES_FUNCTION real real_atan2(real y, real x)
{
    const real height = real_fabs(y), width = real_fabs(x);
    const real_mask steep = height > width, left = real_copysign(real_of(1.0), x) < 0.0;
    const real upper = real_select(steep, width, height), lower = real_select(steep, height, width);
    real t = real_select(upper == lower, real_of_mask(upper > 0.0), upper / lower);
    t = real_select(steep, real_select(left, t, -t), real_select(left, -t, t));
    const real turns = real_select(steep, real_of(1.0), real_where(left, real_of(2.0)));
    const real angle = lanes_atan_sum(turns * LANES_HALF_PI_HIGH, turns * LANES_HALF_PI_LOW, t, lanes_atan_rest(t));
    return real_copysign(angle, y);
}

/* asin(t) / t - 1 over z = t^2 up to 1/4. */
LANES_FUNCTION real lanes_asin_rest(real z)
{
    const real w = z * z;
    const real p = (1.66666666666666657415e-01 + z * -3.25565818622400915405e-01) +
                   w * ((2.01212532134862925881e-01 + z * -4.00555345006794114027e-02) +
                        w * (7.91534994289814532176e-04 + z * 3.47933107596021167570e-05));
    const real q = (1.0 + z * -2.40339491173441421878e+00) +
                   w * ((2.02094576023350569471e+00 + z * -6.88283971605453293030e-01) + w * 7.70381505559019352791e-02);
    return z * p / q;
}

LANES_FUNCTION real real_asin(real x)
{
    const real size = real_fabs(x);
    const real_mask wide = size > 0.5;
    const real z = real_select(wide, 0.5 * (1.0 - size), x * x);
    const real t = real_select(wide, real_sqrt(z), size);
    const real angle = t * lanes_asin_rest(z);
    const real small = t + angle;
    return real_copysign(real_select(wide, LANES_HALF_PI_HIGH - (2.0 * small - LANES_HALF_PI_LOW), small), x);
}

LANES_FUNCTION real real_acos(real x)
{
    const real size = real_fabs(x);
    const real_mask wide = size > 0.5;
    const real z = real_select(wide, 0.5 * (1.0 - size), x * x);
    const real t = real_select(wide, real_sqrt(z), x);
    const real rest = t * lanes_asin_rest(z);
    const real middle = LANES_HALF_PI_HIGH - (t - (LANES_HALF_PI_LOW - rest));
    const real right = 2.0 * (t + rest), left = 2.0 * (LANES_HALF_PI_HIGH - (t + (rest - LANES_HALF_PI_LOW)));
    return real_select(wide, real_select(x > 0.0, right, left), middle);
}
