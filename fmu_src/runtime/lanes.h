/* A `real` of LANES doubles, LANES being 1, 2, 4 or 8, with the operators of C and the functions of lanes_math.h.
 *
 * Included before functions for this width, as often as wanted, with lanes_end.h behind them; between the two the compiler may
 * use AVX2 (4 lanes) or AVX-512 (8), which the processor must have: lanes_of_processor. Results are bit-identical at every
 * width with every compiler that does not fuse or reorder operations (-ffp-contract=off, no -ffast-math, no -freciprocal-math).
 * Exceptions are the bits of a NaN and results of the C library (lanes_math.h). All names end in the width, which the macros of
 * lanes_names.h put there, so that several widths stand in one unit. A function that is not inlined takes lanes by pointers. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "lanes_names.h"
#include "lanes_widest.h"
#include "piecewise.h"
#include "records.h"

#if LANES > LANES_WIDEST
#error "LANES is more than LANES_WIDEST"
#endif

#if LANES == 1
#define LANES_NAME(x) x##_1
#elif LANES == 2
#define LANES_NAME(x) x##_2
#elif LANES == 4
#define LANES_NAME(x) x##_4
#elif LANES == 8
#define LANES_NAME(x) x##_8
#else
#error "LANES is not 1, 2, 4 or 8"
#endif
#define real LANES_NAME(real)
#define real_mask LANES_NAME(real_mask)

#if LANES > 2 && defined(__clang__)
#pragma clang diagnostic push
#pragma clang diagnostic ignored "-Wpragma-clang-attribute" /* a region may be empty */
#if LANES == 4
#pragma clang attribute push(__attribute__((target("avx2"))), apply_to = function)
#else
#pragma clang attribute push(__attribute__((target("avx512f,avx512dq,avx512vl"))), apply_to = function)
#endif
#pragma clang diagnostic pop
#elif LANES > 2
#pragma GCC push_options
#if LANES == 4
#pragma GCC target("avx2")
#else
#pragma GCC target("avx512f,avx512dq,avx512vl")
#endif
#endif

/* The last statement of a function of many lanes that scalar code calls: old SSE code after it would be slow. */
#if LANES > 2
#define LANES_LEAVE __builtin_ia32_vzeroupper()
#else
#define LANES_LEAVE ((void)0)
#endif

#ifndef LANES_FUNCTION
#if defined(__GNUC__) || defined(__clang__)
/* GCC's C++ asks for its library of exceptions where a function might throw, clang's where one says that it does not. */
#ifdef __clang__
#define LANES_FUNCTION static inline __attribute__((always_inline, unused))
#define LANES_APART static __attribute__((noinline, unused))
#else
#define LANES_FUNCTION static inline __attribute__((always_inline, unused, nothrow))
#define LANES_APART static __attribute__((noinline, unused, nothrow))
#endif
#define LANES_ALIGNED __attribute__((aligned(64)))
#else
#define LANES_FUNCTION static __forceinline
#define LANES_APART static __declspec(noinline)
#define LANES_ALIGNED __declspec(align(64))
#endif
#ifdef __has_builtin
#if __has_builtin(__builtin_elementwise_sqrt) && __has_builtin(__builtin_elementwise_floor)
#define LANES_ELEMENTWISE
#endif
#endif
#endif

#if LANES == 1 && !defined(LANES_1_KNOWN)
#define LANES_1_KNOWN
#include "lanes_scalar.h"
#include "lanes_math.h"
#include "lanes_table.h"
#include "lanes_records.h"
#elif LANES == 2 && !defined(LANES_2_KNOWN)
#define LANES_2_KNOWN
#include "lanes_vector.h"
#include "lanes_math.h"
#include "lanes_table.h"
#include "lanes_records.h"
#elif LANES == 4 && !defined(LANES_4_KNOWN)
#define LANES_4_KNOWN
#include "lanes_vector.h"
#include "lanes_math.h"
#include "lanes_table.h"
#include "lanes_records.h"
#elif LANES == 8 && !defined(LANES_8_KNOWN)
#define LANES_8_KNOWN
#include "lanes_vector.h"
#include "lanes_math.h"
#include "lanes_table.h"
#include "lanes_records.h"
#endif
