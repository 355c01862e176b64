/* The methods: linear equations, algebraic states, steps, modes, and the loop over the steps. */
#ifndef METHOD_H
#define METHOD_H

#include "instance.h"

typedef struct rosenbrock_tableau rosenbrock_tableau; /* tableau.h */
typedef struct stepper stepper;                       /* stepper.h */

/* Largest ratio of a column's entries to the diagonal one at which the diagonal is still used as the pivot. The rows have
 * different units, so only a diagonal that is almost zero is refused. */
static const double PIVOT_RATIO = 1e8;
/* Linear equations: factors of M diagonal - J, in the order of the states; and of the algebraic part of J. Return whether the
 * matrix is regular. */
RUNTIME_LOCAL bool linear_factorise_step(kernel *self, step_factors *of, const double *jacobian, double diagonal);
RUNTIME_LOCAL void linear_solve_step(kernel *self, const step_factors *of, double *vector);
RUNTIME_LOCAL bool linear_factorise_algebraic(const kernel *self, dense_factors *of, const double *jacobian);
RUNTIME_LOCAL void linear_solve_algebraic(const dense_factors *of, double *vector);
/* Return whether factors made before still exist: others may have taken their place in the dense matrix. */
RUNTIME_LOCAL bool linear_has_factors(const kernel *self, const step_factors *of);
/* Add the present Jacobian times a vector; and write it as a matrix by rows. */
RUNTIME_LOCAL void linear_add_product(const kernel *self, const double *vector, double *sum);
RUNTIME_LOCAL void linear_write_by_rows(const kernel *self, double *matrix);
/* Algebraic states, the others held, solved until their scaled change is below `tolerance` or round-off; all leave the
 * slopes in work.slope; whether that succeeds. Newton's method from work.jacobian, which is that of `state`; */
RUNTIME_LOCAL bool algebraic_solve(kernel *self, double offset, double *state, double tolerance);
/* the same at the present state, which is linearised first, with a message on failure; */
RUNTIME_LOCAL bool algebraic_begin(kernel *self, double offset, double tolerance);
/* at most one step of it, which the slopes follow along the Jacobian; false only where there are no factors; */
RUNTIME_LOCAL bool algebraic_correct(kernel *self, double *state, double tolerance);
/* with given factors throughout, the old values kept where that fails; */
RUNTIME_LOCAL bool algebraic_follow(kernel *self, const dense_factors *of, double offset, double *state, double tolerance);
/* with the last factors while Newton's method converges with them, and otherwise with new ones. */
RUNTIME_LOCAL bool algebraic_find(kernel *self, double offset, double *state, double tolerance);
/* The present state with algebraic states solved for the present inputs, and the Jacobian there; NULL if that fails. The state
 * itself is unchanged: a reading changes no run. */
RUNTIME_LOCAL const double *algebraic_place(kernel *self);
/* Jacobian without algebraic states at the present state, by rows. */
RUNTIME_LOCAL bool algebraic_reduce(kernel *self, double offset, double *jacobian);
/* Rosenbrock methods. The error of a trial step is in units of the tolerance; a value that is not <= 1, NaN included,
 * means "reject". The new state is in work.trial. */
#ifndef ONE_UNIT /* there their definitions come first */
extern const rosenbrock_tableau RODAS5P, ROS34PW2;
#endif
RUNTIME_LOCAL void rosenbrock_evaluate_jacobian(kernel *self, double offset, const double *state, double *jacobian);
RUNTIME_LOCAL void rosenbrock_linearise(kernel *self, double offset, const double *state);
RUNTIME_LOCAL bool rosenbrock_factorise(kernel *self, const rosenbrock_tableau *method, step_factors *of,
                                        const double *jacobian, double size);
RUNTIME_LOCAL double rosenbrock_step(kernel *self, const rosenbrock_tableau *method, const step_factors *of, double offset,
                                     double size);
/* Linearise before a trial. */
RUNTIME_LOCAL double rosenbrock_try(kernel *self, const rosenbrock_tableau *method, double offset, double size);
/* ROS34PW2 if it is the chosen method, else RODAS5P. */
RUNTIME_LOCAL const rosenbrock_tableau *rosenbrock_method(const kernel *self);
/* The step whose error would be about the tolerance, and as much of it as one step may differ from the one before. */
RUNTIME_LOCAL double rosenbrock_allowed_size(const rosenbrock_tableau *method, double size, double error);
RUNTIME_LOCAL double rosenbrock_next_size(const rosenbrock_tableau *method, double size, double error);
RUNTIME_LOCAL void rosenbrock_interpolate(const kernel *self, double fraction, double *state);
/* With ROS34PW2: a step with the kept Jacobian, which is computed again when it is too old or the step fails. */
RUNTIME_LOCAL double reuse_try(kernel *self, double offset, double size);
/* Keep the Jacobian of the present state until some time; return whether it is usable; and make a step with it, unchanged. */
RUNTIME_LOCAL void reuse_remember(kernel *self, double offset, double until);
RUNTIME_LOCAL bool reuse_serves(const kernel *self, double offset);
RUNTIME_LOCAL double reuse_short_step(kernel *self, double offset, double size);
RUNTIME_LOCAL double runge_kutta_try(kernel *self, double offset, double size); /* its error is 0 or NaN */
RUNTIME_LOCAL kernel_status runge_kutta_guard(kernel *self, double offset, double size);
/* If the system requires it, replace the start values in run.state by a steady state; return whether one was found. */
RUNTIME_LOCAL bool steady_find(kernel *self);
/* Modes and end conditions. Velocity of a friction, and a state with that velocity exactly 0. */
RUNTIME_LOCAL double modes_velocity(const friction_description *friction, const double *state);
RUNTIME_LOCAL void modes_stop(const friction_description *friction, double *state);
RUNTIME_LOCAL void modes_refresh(kernel *self, double offset);
RUNTIME_LOCAL void modes_hold(const kernel *self, double *state);
RUNTIME_LOCAL double modes_direction_margin(const kernel *self, int i, const double *state);
RUNTIME_LOCAL double modes_margin(kernel *self, double offset, const double *state);
RUNTIME_LOCAL int modes_switch(kernel *self, double offset, double least);
RUNTIME_LOCAL bool modes_warn(kernel *self, double offset);
/* Report changes of frictions that stick or slide, as soon as they count; return whether there were any. */
RUNTIME_LOCAL bool reported_follow(kernel *self, double offset);
/* Model exchange: something has switched or stopped now. */
RUNTIME_LOCAL void modes_grow_reluctant(kernel *self);
/* Model exchange: a step of the host begins here; slopes were read; and it ends here, a status where that is warned of. */
RUNTIME_LOCAL void explicit_host_begin(kernel *self);
RUNTIME_LOCAL void explicit_host_read(kernel *self);
RUNTIME_LOCAL kernel_status explicit_host_guard(kernel *self);
/* Place of a state of model exchange among those of the chosen system; -1: it does not have that one. */
RUNTIME_LOCAL int exchange_state(const kernel *self, int number);
/* At the end of a step that is not repeated: frictions that have crossed zero stop if they can be held. All modes are found
 * again, in one round. Returns whether something began or ceased to be stuck. */
RUNTIME_LOCAL bool modes_settle(kernel *self, double offset);
/* Write the rows that are due by the time `until`, from a step that began at `offset`; of size 0: from the state. */
RUNTIME_LOCAL void record_until(kernel *self, double offset, double size, double until);
/* Begin a kernel_step before its steps; and end it after them, `reached` seconds on with this status. `noted`: records before
 * it. */
RUNTIME_LOCAL kernel_status step_begin(kernel *self, double time, double size);
RUNTIME_LOCAL kernel_status step_end(kernel *self, unsigned long long noted, double size, double reached, kernel_status status);
/* All steps of a kernel_step of `size`; reached: where they end. */
RUNTIME_LOCAL kernel_status integrate(kernel *self, double size, double *reached);

#endif
