/* A Rosenbrock method, and the work arrays of its stages. */
#ifndef TABLEAU_H
#define TABLEAU_H

#include "workspace.h"

struct rosenbrock_tableau {
    int stages;
    double gamma;
    double error_power; /* of the embedded method's error, for the choice of the next step */
    double alpha[MOST_STAGES], time_weight[MOST_STAGES];
    double a[MOST_STAGES][MOST_STAGES], c[MOST_STAGES][MOST_STAGES];
    double error[MOST_STAGES];  /* weights of the stages in the difference of the two methods */
    bool adds_one[MOST_STAGES]; /* whether a stage is at the place of the one before, plus one stage */
};

/* numbers: how many doubles each array has. `evaluate` computes the right-hand side at a share of the step. */
typedef struct {
    int numbers;
    const double *state, *slope, *time_slope, *differential;
    double *point, *trial;
    double *const *stage;
    void *self;
    void (*evaluate)(void *self, double alpha, const double *point, double *slope);
    void (*solve)(void *self, double *stage);
} stage_work;

#endif
