/* Number of lanes that compiler, target and processor support; lanes.h defines the lanes. */
#ifndef LANES_WIDEST_H
#define LANES_WIDEST_H

/* The widest LANES in a binary of this compiler and target, or as -DLANES_WIDEST says, which may be less; 1: lanes.h may not
 * be included with more. GCC for Windows does not align 32-byte values on the stack (GCC bug 54412). */
#ifdef LANES_WIDEST
#elif !defined(__GNUC__) && !defined(__clang__)
#define LANES_WIDEST 1
#elif defined(__x86_64__) && defined(_WIN32) && !defined(__clang__)
#define LANES_WIDEST 2
#elif defined(__x86_64__)
#define LANES_WIDEST 8
#elif defined(__i386__) && defined(__SSE2_MATH__)
#define LANES_WIDEST 2
#elif defined(__aarch64__) || defined(__wasm_simd128__)
#define LANES_WIDEST 2
#else
#define LANES_WIDEST 1
#endif

#if LANES_WIDEST > 2
#include <cpuid.h>

/* The states that the operating system keeps for a thread, as bits of XCR0; needs OSXSAVE. */
static inline unsigned lanes_states_kept(void) {
    unsigned low, high;
    __asm__ volatile("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
    return low;
}
#endif

/* The widest LANES that this binary may run on this processor under this operating system: 8 with AVX-512 F, DQ and VL,
 * 4 with AVX2, otherwise what every processor of the target has. */
static inline int lanes_of_processor(void) {
#if LANES_WIDEST > 2
    enum { OSXSAVE_AND_AVX = 3 << 27, AVX2 = 1 << 5, SSE_AVX_STATES = 0x6, AVX512_STATES = 0xe6 };
    const unsigned f_dq_vl = 1u << 16 | 1u << 17 | 1u << 31;
    unsigned a, b, c, d;
    if (!__get_cpuid(1, &a, &b, &c, &d) || (c & OSXSAVE_AND_AVX) != OSXSAVE_AND_AVX) return 2;
    const unsigned kept = lanes_states_kept();
    if ((kept & SSE_AVX_STATES) != SSE_AVX_STATES || !__get_cpuid_count(7, 0, &a, &b, &c, &d) || !(b & AVX2)) return 2;
    return LANES_WIDEST == 8 && (kept & AVX512_STATES) == AVX512_STATES && (b & f_dq_vl) == f_dq_vl ? 8 : 4;
#else
    return LANES_WIDEST;
#endif
}

#endif
