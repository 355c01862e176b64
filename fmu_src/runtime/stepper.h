/* A kernel_step in progress: it requests trial steps, one after the other, and takes the result of each. The same control works
 * for one instance and for many that make their trials at once. */
#ifndef STEPPER_H
#define STEPPER_H

#include "method.h"

typedef enum {
    STEPPER_BEGINS, /* a step, where the one before ended */
    STEPPER_TRIES, /* a step of `size` */
    STEPPER_LOCATES, /* a switch, by a step of `size` */
    STEPPER_ARRIVES, /* at the switch, by a step of `size` */
    STEPPER_DONE
} stepper_phase;

typedef struct {
    double size, error;
} rejected_trial;

/* The first margin that turns negative between two lengths of a step, of which one is kept at each end. */
typedef struct {
    double left, right, at_left, at_right, left_weight, right_weight;
} bracket;

struct stepper {
    stepper_phase phase;
    kernel_status status;
    bool fixed; /* steps of integration_step, by an implicit method */
    double whole; /* size of the kernel_step [s] */
    double offset, remaining; /* since its start, and to its end [s] */
    double size; /* of the requested trial [s] */
    double margin; /* at the end of the step found; negative: a switch lies within it */
    int tried; /* trials so far */
    double wanted, proposed, longest; /* requested first; by the error of the step before; by the limited changes */
    rejected_trial before;
    bracket within;
    double crossing; /* size of the step that crosses [s] */
    double steepness; /* of the margin, by the continuous extension; 0: that does not help */
    int by_extension; /* trials that are left to it */
    int located; /* trials so far of the search for the switch */
};

/* Begin a kernel_step of `size` seconds. */
RUNTIME_LOCAL void stepper_begin(kernel *self, stepper *run, double size);
/* End a step of `size`: begins the next one, or is done. */
static inline void stepper_go_on(stepper *run) {
    run->offset = run->size == run->remaining ? run->whole : run->offset + run->size;
    run->phase = run->offset < run->whole ? STEPPER_BEGINS : STEPPER_DONE;
}
/* At the beginning of a step: request a trial, or be done. */
RUNTIME_LOCAL void stepper_ask(kernel *self, stepper *run);
/* Make the requested trial; the new state is in work.trial. */
RUNTIME_LOCAL double stepper_try(kernel *self, const stepper *run);
/* Take a trial with its error in units of the tolerance: request another one, begin the next step, or be done. */
RUNTIME_LOCAL void stepper_take(kernel *self, stepper *run, double error);
/* The same functions for steps of a fixed size. */
RUNTIME_LOCAL void fixed_begin(kernel *self, stepper *run);
RUNTIME_LOCAL void fixed_ask(kernel *self, stepper *run);
RUNTIME_LOCAL void fixed_take(kernel *self, stepper *run, double error);
RUNTIME_LOCAL double fixed_size(const kernel *self, double remaining);
/* Fail with the message that a fixed step has no finite end. */
RUNTIME_LOCAL void fixed_failed(kernel *self, stepper *run);
/* A step that crosses a switch: request shorter ones until the first margin has just turned negative. */
RUNTIME_LOCAL void locate_begin(kernel *self, stepper *run);
RUNTIME_LOCAL void locate_take(kernel *self, stepper *run);

#endif
