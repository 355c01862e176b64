/* The data that change during a run: one block, which is saved, restored and compared as it is. */
#ifndef STATE_H
#define STATE_H

#include <stdbool.h>
#include <stddef.h>

/* The single numbers, at the head of the block. */
typedef struct {
    double time;
    double proposed_step;
    double kept_time, kept_until, kept_size; /* kept Jacobian: when it was taken, until when it is used, its step */
    unsigned long long table;    /* mark of the table file; 0: no file */
    unsigned long long records;  /* the same of the file of records */
    double switched, reluctance; /* model exchange: time of the last switch, and its effect on reluctance, see modes.c */
    double guard_warned;           /* quantity in the last warning about fixed steps; 0: none yet */
    int kept_steps;              /* steps with the kept Jacobian so far; -1: none is kept */
    int pause;                   /* short steps before a Jacobian is kept again */
    int switches;                /* steps that ended in a switch, less those that did not */
    int guard_wait;              /* steps until the stability of an explicit method is checked again */
    int system;                  /* its place in the model; -1 before initialisation */
    int ended;                   /* 1 + index of the end condition that stopped the run; 0: running */
    bool outputs_stale;
    bool inputs_jumped; /* model exchange: an input was set to another value since modes were found last */
    bool watched;       /* whether reports of frictions may change without a switch */
} run_record;

typedef struct {
    run_record *now;
    double *value, *input_rate, *last_rate; /* by variable of the model */
    double *state, *mode, *derived;
    double *warned; /* by condition: 1 if its warning was given */
    double *reported; /* by friction: how often its sticking counted; below 0 while it does, see reported.c */
    double *kept_state, *kept_input, *kept_mode; /* where the kept Jacobian was taken */
    double *block;  /* all of it */
    size_t doubles; /* its length */
    size_t changing; /* as much of it, from its beginning, as changes within a step */
    size_t unread;   /* as much as changes where outputs are computed when they are read */
} run_state;

#endif
