/* The kernel: one simulated vehicle with a table of variables and a step function.
 *
 * The equations are generated C, and the model is constant data (model.h). The state of a run is one block (state.h), so that
 * saving it is a copy. Work arrays of a step are separate (workspace.h). The constant MODEL is the only global, so any number
 * of instances may run at once. The FMI interfaces use this header; kernel.py uses studies.h as well. The internals are in
 * instance.h. */
#ifndef KERNEL_H
#define KERNEL_H

#include <stddef.h>

#include "model.h"
#include "status.h"

/* Seen from outside of the library for kernel.py, and of no FMU. */
#if !defined(KERNEL_LIBRARY)
#define KERNEL_EXPORT RUNTIME_LOCAL
#elif defined(_WIN32)
#define KERNEL_EXPORT __declspec(dllexport)
#else
#define KERNEL_EXPORT __attribute__((visibility("default")))
#endif

typedef struct kernel kernel;

/* Work done since the last reset. */
typedef struct {
    long long int right_hand_sides, jacobians, factorisations, steps, rejected, events;
} kernel_counters;

/* Functions that return int return a count or an index. The message to a status is in the log, see kernel_hear. */
KERNEL_EXPORT kernel *kernel_create(void);
KERNEL_EXPORT void kernel_free(kernel *self);
KERNEL_EXPORT void kernel_reset(kernel *self);
/* Check whether the variable takes this value, before the run and as an input within it; return a status, with a message. */
KERNEL_EXPORT kernel_status kernel_check_set(kernel *self, int variable, double value);
KERNEL_EXPORT kernel_status kernel_set(kernel *self, int variable, double value);
KERNEL_EXPORT kernel_status kernel_set_rate(kernel *self, int variable, double rate);
KERNEL_EXPORT kernel_status kernel_check_rate(kernel *self, int variable, double rate);
KERNEL_EXPORT kernel_status kernel_get(kernel *self, int variable, double *value);
/* The variable that names a file: it is read at once; after a refusal the one before it stays. Text that is got belongs to
 * the kernel and lasts until it is set again. */
KERNEL_EXPORT kernel_status kernel_set_text(kernel *self, int variable, const char *text);
KERNEL_EXPORT kernel_status kernel_get_text(kernel *self, int variable, const char **text);
/* First derivatives of outputs by time at the end of the last step, with inputs continued at their rates of that step. */
KERNEL_EXPORT kernel_status kernel_get_rates(kernel *self, int count, const int *variable, double *rate);
/* Derivatives of outputs along a change of inputs and states; states that are not named are held. */
KERNEL_EXPORT kernel_status kernel_get_directional(kernel *self, int unknowns, const int *unknown, int knowns, const int *known,
                                                   const double *change, double *result);
KERNEL_EXPORT kernel_status kernel_initialise(kernel *self, double time);
KERNEL_EXPORT void kernel_reopen(kernel *self);
KERNEL_EXPORT kernel_status kernel_step(kernel *self, double time, double size);
/* Set the host's settings before initialisation; NULL: not set. An unsuitable tolerance causes only a warning. */
KERNEL_EXPORT kernel_status kernel_plan(kernel *self, const double *tolerance, double start, const double *stop);
/* Set whether a step ends early, with OK, if a friction begins to stick or to slide; kernel_time returns that time. If false,
 * a step within which the run ends is discarded, and the state is the one before it. If this is never called, the state is the
 * one at the end of the run. */
KERNEL_EXPORT void kernel_stop_at_events(kernel *self, bool stops);
/* Model exchange: number of states and of event indicators; 0 for a model without it. */
KERNEL_EXPORT int kernel_exchange_states(void);
KERNEL_EXPORT int kernel_exchange_indicators(void);
/* Scales of these states, which are those of the model at any time. */
KERNEL_EXPORT void kernel_get_nominals(double *nominal);
/* Once initialised: refuses a system with other states, and opens the parameters again. */
KERNEL_EXPORT kernel_status kernel_check_exchange(kernel *self);
/* Set the time and states of an integrator and evaluate the equations there; a discard requests a shorter step. */
KERNEL_EXPORT kernel_status kernel_set_time(kernel *self, double time);
KERNEL_EXPORT kernel_status kernel_set_states(kernel *self, const double *state);
KERNEL_EXPORT kernel_status kernel_get_states(kernel *self, double *state);
KERNEL_EXPORT kernel_status kernel_get_slopes(kernel *self, double *slope);
KERNEL_EXPORT kernel_status kernel_get_indicators(kernel *self, double *indicator);
/* Extra variables in any system: numbers after the table of variables and the time are slopes and event indicators, with the
 * value 0 if the system does not have them. Return the index among them, below 0 for another variable; and the value. */
KERNEL_EXPORT int kernel_exchanged_number(int variable);
KERNEL_EXPORT kernel_status kernel_get_exchanged(kernel *self, int number, double *value);
/* At an event: switches what has crossed, which may end the run. `jumped`: since the event before, an input, a slope or a state
 * has come to another value at once, so that a multistep integrator must restart. */
KERNEL_EXPORT kernel_status kernel_find_modes(kernel *self, bool *jumped);
/* After a step: finds whether something has crossed and writes the warnings. */
KERNEL_EXPORT kernel_status kernel_complete_step(kernel *self, bool *crossed);
/* Everything that a run changes; the FMI interfaces add their own data and a seal. */
RUNTIME_LOCAL size_t kernel_block_size(const kernel *self);
RUNTIME_LOCAL void kernel_copy_block(const kernel *self, void *bytes);
RUNTIME_LOCAL kernel_status kernel_take_block(kernel *self, const void *bytes);
/* The same, sealed (sealed.h): bytes that were changed, and those of another model, are refused. */
KERNEL_EXPORT size_t kernel_state_size(const kernel *self);
KERNEL_EXPORT void kernel_save(const kernel *self, void *bytes);
KERNEL_EXPORT kernel_status kernel_restore(kernel *self, const void *bytes, size_t size);
KERNEL_EXPORT double kernel_time(const kernel *self);
KERNEL_EXPORT bool kernel_ended(const kernel *self);
/* Set the statuses, a bit for each, whose messages are read; all, before the first call. */
KERNEL_EXPORT void kernel_listen(kernel *self, unsigned statuses);
/* Return whether an unread message exists, and the oldest one in `heard`. Its text is valid until the next call. */
KERNEL_EXPORT bool kernel_hear(kernel *self, kernel_sentence *heard);
KERNEL_EXPORT int kernel_state_count(const kernel *self);

#endif
