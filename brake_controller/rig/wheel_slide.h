/* A wheel-slide controller in C, as a shared library: these three functions, and nothing else.
 *
 *     cc -shared -fPIC -O2 -o libmine.so mine.c            (Windows: cl /LD mine.c)
 *
 * One library runs many controllers at once, in threads too. Each controller stores its state in its own memory, and there
 * are no globals. Code from Simulink or from translators of Structured Text is called from wheel_slide_step. */
#ifndef WHEEL_SLIDE_H
#define WHEEL_SLIDE_H

#include <stddef.h>

#if defined(_WIN32)
#define WHEEL_SLIDE_SHOWN __declspec(dllexport)
#elif defined(__GNUC__)
#define WHEEL_SLIDE_SHOWN __attribute__((visibility("default")))
#else
#define WHEEL_SLIDE_SHOWN
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* Commands of a valve. */
enum { WHEEL_SLIDE_APPLY = 0, WHEEL_SLIDE_HOLD = 1, WHEEL_SLIDE_VENT = 2 };

/* Bytes of memory of one controller for this number of wheelsets, at most 1 MB; it is aligned for any type. */
WHEEL_SLIDE_SHOWN size_t wheel_slide_size(int wheelsets);
/* Called before the first step of a run; all bytes of the memory are 0. period: time between two steps [s]. */
WHEEL_SLIDE_SHOWN void wheel_slide_start(void *memory, int wheelsets, double period);
/* Writes commands for the valves of all wheelsets from their sensors' circumferential speeds [m/s], at a time since the
 * start of the run [s]. */
WHEEL_SLIDE_SHOWN void wheel_slide_step(void *memory, double time, const double *wheel_speed, int *valve);

#ifdef __cplusplus
}
#endif

#endif
