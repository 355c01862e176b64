/* The kernel: one simulated machine, seen as a table of variables and a step function.
 *
 * The equations are generated C, the model is constant data (model.h), the state of a run is one block (state.h), so that
 * saving it is a copy, and what steps are computed in is apart (workspace.h). There are no globals besides the constant
 * MODEL, hence any number of instances may run at once. This is what a face uses; kernel.py uses studies.h as well. The
 * inside is in instance.h. */
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

/* What returns int returns a count or an index; the sentence to a status is in the journal, see kernel_hear. */
KERNEL_EXPORT kernel *kernel_create(void);
KERNEL_EXPORT void kernel_free(kernel *self);
KERNEL_EXPORT void kernel_reset(kernel *self);
/* Whether the variable takes this value, before the run and as an input within it: a status, with the sentence. */
KERNEL_EXPORT kernel_status kernel_check_set(kernel *self, int variable, double value);
KERNEL_EXPORT kernel_status kernel_set(kernel *self, int variable, double value);
KERNEL_EXPORT kernel_status kernel_set_rate(kernel *self, int variable, double rate);
KERNEL_EXPORT kernel_status kernel_check_rate(kernel *self, int variable, double rate);
KERNEL_EXPORT kernel_status kernel_get(kernel *self, int variable, double *value);
/* The variable that names a file: it is read at once; after a refusal the one before it stays. Text that is got belongs to
 * the kernel and lasts until it is set again. */
KERNEL_EXPORT kernel_status kernel_set_text(kernel *self, int variable, const char *text);
KERNEL_EXPORT kernel_status kernel_get_text(kernel *self, int variable, const char **text);
/* First derivatives of outputs by time at the end of the last step, the inputs going on as they did within it. */
KERNEL_EXPORT kernel_status kernel_get_rates(kernel *self, int count, const int *variable, double *rate);
/* Derivatives of outputs along a change of inputs and states; states that are not named are held. */
KERNEL_EXPORT kernel_status kernel_get_directional(kernel *self, int unknowns, const int *unknown, int knowns, const int *known,
                                                   const double *change, double *result);
KERNEL_EXPORT kernel_status kernel_initialise(kernel *self, double time);
KERNEL_EXPORT void kernel_reopen(kernel *self);
KERNEL_EXPORT kernel_status kernel_step(kernel *self, double time, double size);
/* Before initialisation, what the host plans; null: it says nothing. A tolerance that does not serve is only warned of. */
KERNEL_EXPORT kernel_status kernel_plan(kernel *self, const double *tolerance, double start, const double *stop);
/* Whether a step ends early, with OK, where a friction begins to stick or to slide; kernel_time tells where. If not, a
 * step within which the run ends is discarded, and the state is the one before it. Of a kernel that was told neither,
 * the state is the one at the end of the run. */
KERNEL_EXPORT void kernel_stop_at_events(kernel *self, bool stops);
/* Model exchange: how many states and event indicators it has; none of a model without it. */
KERNEL_EXPORT int kernel_exchange_states(void);
KERNEL_EXPORT int kernel_exchange_indicators(void);
/* Scales of these states, which are those of the model at any time. */
KERNEL_EXPORT void kernel_get_nominals(double *nominal);
/* Once initialised: refuses a system with other states, and opens the parameters again. */
KERNEL_EXPORT kernel_status kernel_check_exchange(kernel *self);
/* The place of an integrator, and what the equations say there; a discard asks it for a shorter step. */
KERNEL_EXPORT kernel_status kernel_set_time(kernel *self, double time);
KERNEL_EXPORT kernel_status kernel_set_states(kernel *self, const double *state);
KERNEL_EXPORT kernel_status kernel_get_states(kernel *self, double *state);
KERNEL_EXPORT kernel_status kernel_get_slopes(kernel *self, double *slope);
KERNEL_EXPORT kernel_status kernel_get_indicators(kernel *self, double *indicator);
/* Behind the table of variables and one more number, the time's, slopes and indicators are variables too, in any system, 0
 * of what it does not have: place of such a variable among them, or a number below 0; and its value. */
KERNEL_EXPORT int kernel_exchanged_number(int variable);
KERNEL_EXPORT kernel_status kernel_get_exchanged(kernel *self, int number, double *value);
/* At an event: switches what has crossed, which may end the run. `jumped`: since the event before, an input, a slope or
 * a state has come to another value at once, so that an integrator of several steps must begin anew. */
KERNEL_EXPORT kernel_status kernel_find_modes(kernel *self, bool *jumped);
/* Behind a step: whether something has crossed; and says what only warns. */
KERNEL_EXPORT kernel_status kernel_complete_step(kernel *self, bool *crossed);
/* All that a run changes, for faces, which seal it with what they add. */
RUNTIME_LOCAL size_t kernel_block_size(const kernel *self);
RUNTIME_LOCAL void kernel_copy_block(const kernel *self, void *bytes);
RUNTIME_LOCAL kernel_status kernel_take_block(kernel *self, const void *bytes);
/* The same, sealed (sealed.h): bytes that were changed, and those of another model, are refused. */
KERNEL_EXPORT size_t kernel_state_size(const kernel *self);
KERNEL_EXPORT void kernel_save(const kernel *self, void *bytes);
KERNEL_EXPORT kernel_status kernel_restore(kernel *self, const void *bytes, size_t size);
KERNEL_EXPORT double kernel_time(const kernel *self);
KERNEL_EXPORT bool kernel_ended(const kernel *self);
/* Statuses, a bit for each, whose sentences somebody hears: all, before the first call. */
KERNEL_EXPORT void kernel_listen(kernel *self, unsigned statuses);
/* The oldest sentence that was not heard yet; whether there was one. Its text lasts until the next call. */
KERNEL_EXPORT bool kernel_hear(kernel *self, kernel_sentence *heard);
KERNEL_EXPORT int kernel_state_count(const kernel *self);

#endif
