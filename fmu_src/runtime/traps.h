/* Floating-point exceptions of a host. The equations compute with infinite numbers and with NaN, as IEEE 754 intends: 1/0 is "no
 * limit". Hosts in Delphi or Fortran may have these exceptions end the program. They are masked within each call of FMI, and the
 * host's masks are put back at its end. A call in a host that masks them costs the reading of two registers. */
#ifndef TRAPS_H
#define TRAPS_H

#include <stdbool.h>

#if defined(__GNUC__) && !defined(__cplusplus) && (defined(__x86_64__) || (defined(__i386__) && defined(__SSE__)))
#include <xmmintrin.h>

enum { SSE_MASKS = 0x1F80, SSE_FLAGS = 0x3F, X87_MASKS = 0x3F };

typedef struct {
    unsigned sse;
    unsigned short x87;
    bool changed;
} host_traps;

static inline void traps_set_x87(unsigned short control) {
    __asm__ volatile("fnclex\n\tfldcw %0" : : "m"(control)); /* a flag that is set would end the program later */
}

static inline host_traps traps_mask(void) {
    host_traps host = {_mm_getcsr(), 0, false};
    __asm__ volatile("fnstcw %0" : "=m"(host.x87));
    host.changed = (host.sse & SSE_MASKS) != SSE_MASKS || (host.x87 & X87_MASKS) != X87_MASKS;
    if (host.changed) {
        _mm_setcsr((host.sse | SSE_MASKS) & ~(unsigned)SSE_FLAGS);
        traps_set_x87((unsigned short)(host.x87 | X87_MASKS));
    }
    return host;
}

static inline void traps_restore(const host_traps *host) {
    if (!host->changed) return;
    traps_set_x87(host->x87);
    _mm_setcsr(host->sse);
}

#define MASK_TRAPS __attribute__((cleanup(traps_restore), unused)) const host_traps traps = traps_mask()
#else /* processors without such exceptions; compilers without scopes that clean up, and C++, where these bring its runtime */
#define MASK_TRAPS (void)0
#endif

#endif
