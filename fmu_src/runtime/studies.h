/* Further functions of a kernel for studies, through kernel.py: names, records, counts, the equations. FMUs do not contain
 * them. */
#ifndef STUDIES_H
#define STUDIES_H

#include "kernel.h"

KERNEL_EXPORT int kernel_variable_count(void);
KERNEL_EXPORT const char *kernel_variable_name(int variable);
/* Set the largest number of lanes in the equations, up to that of the processor; return the number used. */
KERNEL_EXPORT int kernel_use_lanes(kernel *self, int most);
/* Return the message of the last status. */
KERNEL_EXPORT const char *kernel_message(const kernel *self);
KERNEL_EXPORT void kernel_counts(const kernel *self, kernel_counters *counts);
/* A step with a row of variables every `interval` seconds, the start included; rows that are not reached become NaN. */
KERNEL_EXPORT kernel_status kernel_record(kernel *self, double time, double size, double interval, int columns,
                                          const int *variable, double *buffer, long long int rows);
/* State, right-hand side (n values each) and Jacobian (n x n, by rows), once the algebraic states are consistent. */
KERNEL_EXPORT kernel_status kernel_linearise(kernel *self, double *state, double *slope, double *jacobian);
/* The equations for other methods, which start where the kernel stands: time goes on from there, inputs along their
 * ramps, modes as they are. Slopes of the differential states (m values) at a time and place, the algebraic states solved
 * for, and their Jacobian (m x m, by rows) unless null; */
KERNEL_EXPORT kernel_status kernel_slopes_at(kernel *self, double time, const double *place, double *slope, double *jacobian);
/* the smallest margin of modes and end conditions there: a switch is where it turns negative; */
KERNEL_EXPORT kernel_status kernel_margin_at(kernel *self, double time, const double *place, double *margin);
/* slopes, and residuals of algebraic states, of all n states, and their Jacobian (n x n, by rows) unless null. */
KERNEL_EXPORT kernel_status kernel_equations_at(kernel *self, double time, const double *state, double *slope,
                                                double *jacobian);
/* Move the kernel there and switch what has crossed; with `crossed`, also the switch nearest to it on this side. `place` is the
 * state afterwards. */
KERNEL_EXPORT kernel_status kernel_arrive(kernel *self, double time, double *place, bool crossed);
/* For benchmarks: call the right-hand side, the Jacobian or the step function `repeat` times at the present state. */
KERNEL_EXPORT kernel_status kernel_repeat_right_hand_side(kernel *self, long long int repeat);
KERNEL_EXPORT kernel_status kernel_repeat_jacobian(kernel *self, long long int repeat);
KERNEL_EXPORT kernel_status kernel_repeat_step(kernel *self, double time, double size, long long int repeat);

#endif
