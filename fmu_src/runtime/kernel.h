/* The kernel: one simulated machine, seen as a table of variables and a step function.
 *
 * The equations are generated C, the model is constant data (model.h), and everything that changes lives in one `kernel`
 * block, so that saving a state is a copy. There are no globals besides the constant MODEL, hence any number of instances
 * may run at once. This is what faces and kernel.py use; the inside is in internal.h. */
#ifndef KERNEL_H
#define KERNEL_H

#include <stddef.h>

#include "model.h"

#if defined(_WIN32)
#define KERNEL_EXPORT __declspec(dllexport)
#else
#define KERNEL_EXPORT __attribute__((visibility("default")))
#endif

/* The numbers are those of fmi2Status, so that a face can pass them on unchanged. */
enum { KERNEL_OK = 0, KERNEL_WARNING = 1, KERNEL_DISCARD = 2, KERNEL_ERROR = 3 };

enum { MESSAGE_SIZE = 512 };

typedef struct kernel kernel;

/* Work done since the last reset. */
typedef struct {
    long long int right_hand_sides, jacobians, factorisations, steps, rejected, events;
} kernel_counters;

/* Functions that return int return a status unless they say otherwise; the sentence is in kernel_message. */
KERNEL_EXPORT kernel *kernel_create(void);
KERNEL_EXPORT void kernel_free(kernel *self);
KERNEL_EXPORT void kernel_reset(kernel *self);
KERNEL_EXPORT int kernel_set(kernel *self, int variable, double value);
KERNEL_EXPORT int kernel_set_rate(kernel *self, int variable, double rate);
KERNEL_EXPORT int kernel_get(kernel *self, int variable, double *value);
/* First derivatives of outputs by time at the end of the last step, the inputs going on as they did within it. */
KERNEL_EXPORT int kernel_get_rates(kernel *self, int count, const int *variable, double *rate);
/* Derivatives of outputs along a change of inputs and states; states that are not named are held. */
KERNEL_EXPORT int kernel_get_directional(kernel *self, int unknowns, const int *unknown, int knowns, const int *known,
                                         const double *change, double *result);
KERNEL_EXPORT int kernel_initialise(kernel *self, double time);
KERNEL_EXPORT void kernel_reopen(kernel *self);
KERNEL_EXPORT int kernel_step(kernel *self, double time, double size);
/* Whether a step ends early, with OK, where a friction begins to stick or to slide; kernel_time tells where. */
KERNEL_EXPORT void kernel_stop_at_events(kernel *self, int stops);
KERNEL_EXPORT int kernel_stops_at_events(const kernel *self);
KERNEL_EXPORT int kernel_record(kernel *self, double time, double size, double interval, int columns,
                                const int *variable, double *buffer, long long int rows);
KERNEL_EXPORT size_t kernel_state_size(const kernel *self);
KERNEL_EXPORT void kernel_save(const kernel *self, void *bytes);
KERNEL_EXPORT int kernel_restore(kernel *self, const void *bytes);
KERNEL_EXPORT double kernel_time(const kernel *self);
KERNEL_EXPORT int kernel_ended(const kernel *self);
KERNEL_EXPORT const char *kernel_message(const kernel *self);
KERNEL_EXPORT const char *kernel_journal(kernel *self);
KERNEL_EXPORT void kernel_counts(const kernel *self, kernel_counters *counts);
KERNEL_EXPORT int kernel_variable_count(void);
KERNEL_EXPORT const char *kernel_variable_name(int variable);
KERNEL_EXPORT int kernel_state_count(const kernel *self);
/* State, right-hand side (n values each) and Jacobian (n x n, by rows), once the algebraic states are consistent. */
KERNEL_EXPORT int kernel_linearise(kernel *self, double *state, double *slope, double *jacobian);
/* The equations for other methods, which start where the kernel stands: time goes on from there, inputs along their
 * ramps, modes as they are. Slopes of the differential states (m values) at a time and place, the algebraic states solved
 * for, and their Jacobian (m x m, by rows) unless null; */
KERNEL_EXPORT int kernel_slopes_at(kernel *self, double time, const double *place, double *slope, double *jacobian);
/* the smallest margin of modes and end conditions there: a switch is where it turns negative; */
KERNEL_EXPORT int kernel_margin_at(kernel *self, double time, const double *place, double *margin);
/* slopes, and residuals of algebraic states, of all n states, and their Jacobian (n x n, by rows) unless null. */
KERNEL_EXPORT int kernel_equations_at(kernel *self, double time, const double *state, double *slope, double *jacobian);
/* The kernel goes there and switches what has crossed; with `crossed`, what is nearest to it, if it is on this side.
 * `place` is what it is afterwards. */
KERNEL_EXPORT int kernel_arrive(kernel *self, double time, double *place, int crossed);
/* For benchmarks: call the right-hand side, the Jacobian or the step function `repeat` times at the present state. */
KERNEL_EXPORT int kernel_repeat_right_hand_side(kernel *self, long long int repeat);
KERNEL_EXPORT int kernel_repeat_jacobian(kernel *self, long long int repeat);
KERNEL_EXPORT int kernel_repeat_step(kernel *self, double time, double size, long long int repeat);

#endif
