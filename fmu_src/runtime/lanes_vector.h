/* Primitives of lanes_math.h for several lanes, by the vector extensions of GCC and clang; included by lanes.h. */
typedef double real __attribute__((vector_size(8 * LANES)));
typedef double lanes_loose __attribute__((vector_size(8 * LANES), aligned(8), may_alias));
typedef __typeof__(*(real *)0 < *(real *)0) real_mask;
typedef unsigned long long lanes_word __attribute__((vector_size(8 * LANES))); /* the bits of doubles */

LANES_FUNCTION lanes_word lanes_word_of(real x) { return (lanes_word)x; }

LANES_FUNCTION real lanes_of_word(lanes_word bits) { return (real)bits; }

/* Mask of the numbers whose lowest bit is set. */
LANES_FUNCTION real_mask lanes_odd(lanes_word bits) { return (real_mask)(0ull - (bits & 1ull)); }

LANES_FUNCTION real real_load(const double *p) { return *(const lanes_loose *)p; }

LANES_FUNCTION void real_store(double *p, real x) { *(lanes_loose *)p = x; }

LANES_FUNCTION real real_of(double x) {
#if LANES == 2
    const real all = {x, x};
#elif LANES == 4
    const real all = {x, x, x, x};
#else
    const real all = {x, x, x, x, x, x, x, x};
#endif
    return all;
}

LANES_FUNCTION real real_fabs(real x) { return lanes_of_word(lanes_word_of(x) & 0x7fffffffffffffffull); }

/* |x| with the sign of `sign`. */
LANES_FUNCTION real real_copysign(real x, real sign) {
    return lanes_of_word((lanes_word_of(x) & 0x7fffffffffffffffull) | (lanes_word_of(sign) & 0x8000000000000000ull));
}

/* The ith number of each lane's row. */
LANES_FUNCTION real real_from(const double *const *row, int i) {
#if LANES == 2
    return (real){row[0][i], row[1][i]};
#elif LANES == 4
    return (real){row[0][i], row[1][i], row[2][i], row[3][i]};
#else
    return (real){row[0][i], row[1][i], row[2][i], row[3][i], row[4][i], row[5][i], row[6][i], row[7][i]};
#endif
}

LANES_FUNCTION real_mask real_not(real_mask m) { return ~m; }

LANES_FUNCTION real real_select(real_mask m, real a, real b) {
#if LANES == 4 && !defined(__clang__)
    return __builtin_ia32_blendvpd256(b, a, (real)m);
#else
    return (real)(((real_mask)a & m) | ((real_mask)b & ~m));
#endif
}

LANES_FUNCTION real real_where(real_mask m, real a) { return (real)((real_mask)a & m); }

LANES_FUNCTION real real_of_mask(real_mask m) { return real_where(m, real_of(1.0)); }

LANES_FUNCTION real_mask real_is(real x) { return x != 0.0; }

/* Return whether any lane is set. */
LANES_FUNCTION int real_any(real_mask m) {
#if LANES == 8
    return __builtin_ia32_cvtq2mask512(m) != 0;
#elif LANES == 4
    return __builtin_ia32_movmskpd256((real)m) != 0;
#elif defined(__SSE2__)
    return __builtin_ia32_movmskpd((real)m) != 0;
#else
    return (m[0] | m[1]) != 0;
#endif
}

LANES_FUNCTION real real_sqrt(real x) {
#if defined(LANES_ELEMENTWISE)
    return __builtin_elementwise_sqrt(x);
#elif LANES == 8 && !defined(__clang__)
    return __builtin_ia32_sqrtpd512_mask(x, x, -1, 4);
#elif LANES == 4 && !defined(__clang__)
    return __builtin_ia32_sqrtpd256(x);
#elif defined(__SSE2__) && !defined(__clang__)
    return __builtin_ia32_sqrtpd(x);
#else
    for (int i = 0; i < LANES; ++i) x[i] = __builtin_sqrt(x[i]);
    return x;
#endif
}
