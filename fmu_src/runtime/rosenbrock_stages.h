/* The stages of a Rosenbrock method over LANES numbers at once: states of one instance, or one state of instances. Stands
 * between lanes.h and lanes_end.h; rosenbrock.c has the formula. */

/* sum = base + some stages by their weights. */
LANES_FUNCTION void LANES_NAME(stages_sum)(const stage_work *of, int first, int end, const double *weight, const double *base,
                                           double *sum) {
    int i = 0;
    for (; i + LANES < of->numbers; i += 2 * LANES) { /* two at a time, which do not wait for each other */
        real one = real_load(base + i), two = real_load(base + i + LANES);
        for (int j = first; j < end; ++j) {
            const double *k = of->stage[j] + i;
            one = one + weight[j] * real_load(k);
            two = two + weight[j] * real_load(k + LANES);
        }
        real_store(sum + i, one);
        real_store(sum + i + LANES, two);
    }
    for (; i < of->numbers; i += LANES) {
        real one = real_load(base + i);
        for (int j = first; j < end; ++j) one = one + weight[j] * real_load(of->stage[j] + i);
        real_store(sum + i, one);
    }
}

/* Add the contribution of earlier stages, and the slope along time, to the right-hand side k. */
LANES_FUNCTION void LANES_NAME(stages_add)(const stage_work *of, int stages, const double *weight, real inverse,
                                           double along_time, real size, double *k) {
    for (int i = 0; i < of->numbers; i += LANES) {
        real history = real_of(0.0), own = real_load(k + i);
        for (int j = 0; j < stages; ++j) history = history + weight[j] * real_load(of->stage[j] + i);
        own = own + real_load(of->differential + i) * (inverse * history);
        if (along_time != 0.0) own = own + along_time * size * real_load(of->time_slope + i);
        real_store(k + i, own);
    }
}

/* All stages, and the state that the step leads to in `trial`; size: of the step, in each lane. */
LANES_FUNCTION void LANES_NAME(rosenbrock_stages)(const rosenbrock_tableau *method, const stage_work *of, real size) {
    const real inverse = 1.0 / size;
    for (int stage = 0; stage < method->stages; ++stage) {
        double *k = of->stage[stage];
        const int first = method->adds_one[stage] ? stage - 1 : 0;
        if (stage == 0) {
            memcpy(k, of->slope, (size_t)of->numbers * sizeof *k);
        } else {
            LANES_NAME(stages_sum)(of, first, stage, method->a[stage], first > 0 ? of->point : of->state, of->point);
            of->evaluate(of->self, method->alpha[stage], of->point, k);
        }
        LANES_NAME(stages_add)(of, stage, method->c[stage], inverse, method->time_weight[stage], size, k);
        of->solve(of->self, k);
    }
    for (int i = 0; i < of->numbers; i += LANES)
        real_store(of->trial + i, real_load(of->point + i) + real_load(of->stage[method->stages - 1] + i));
}
