/* Primitives of lanes_math.h for one lane; included by lanes.h. */
typedef double real_1;
typedef int real_mask_1;
typedef double lanes_loose_1; /* in memory */
typedef uint64_t lanes_word_1; /* the bits of a double */

LANES_FUNCTION lanes_word lanes_word_of(real x) {
    lanes_word bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

LANES_FUNCTION real lanes_of_word(lanes_word bits) {
    real x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* Mask of the numbers whose lowest bit is set. */
LANES_FUNCTION real_mask lanes_odd(lanes_word bits) { return (int)(bits & 1); }

LANES_FUNCTION real real_load(const double *p) { return *p; }

LANES_FUNCTION void real_store(double *p, real x) { *p = x; }

LANES_FUNCTION real real_of(double x) { return x; }

LANES_FUNCTION real real_fabs(real x) { return fabs(x); }

LANES_FUNCTION real real_copysign(real x, real sign) { return copysign(x, sign); }

/* The ith number of each lane's row. */
LANES_FUNCTION real real_from(const double *const *row, int i) { return row[0][i]; }

LANES_FUNCTION real_mask real_not(real_mask m) { return !m; }

LANES_FUNCTION real real_select(real_mask m, real a, real b) { return m ? a : b; }

LANES_FUNCTION real real_where(real_mask m, real a) { return m ? a : 0.0; }

LANES_FUNCTION real real_of_mask(real_mask m) { return m ? 1.0 : 0.0; }

LANES_FUNCTION real_mask real_is(real x) { return x != 0.0; }

LANES_FUNCTION int real_any(real_mask m) { return m; }

LANES_FUNCTION real real_sqrt(real x) { return sqrt(x); }
