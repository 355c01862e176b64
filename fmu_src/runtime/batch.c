/* Control of runs in lanes, see batch.h. Computations in all lanes are in batch_lanes.c. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "batch_lanes.h"

/* CONTROLLED: instances whose steps alternate with the calls between steps, in whole groups; few enough for a core's cache. */
enum { W = BATCH_LANES, CONTROLLED = 8 * W };

batch *batch_create(const batch *beside) {
    batch *self = (batch *)calloc(1, sizeof *self);
    if (!self) return NULL;
    self->of = &BATCH;
    self->system = &MODEL.system[BATCH.system];
    self->place = (int *)malloc((size_t)MODEL.variables * sizeof(int));
    bool complete = self->place && batch_lay_out(self, beside);
    for (int i = 0; i < MODEL.variables && self->place; ++i) self->place[i] = -1;
    for (int i = 0; i < self->system->outputs && self->place; ++i) self->place[self->system->output_variable[i]] = i;
    if (complete) return self;
    batch_free(self);
    return NULL;
}

void batch_free(batch *self) {
    if (!self) return;
    for (int l = 0; l < W; ++l) kernel_free(self->own[l]);
    free(self->room);
    free(self->constants);
    free(self->place);
    free(self);
}

int batch_lanes(void) { return W; }
void batch_free_message(char *message) { free(message); }

void batch_forget(batch *self) {
    for (int l = 0; l < W; ++l) self->lane[l].constants_of = NULL;
}

/* ---- one round: a step is begun, tried and taken --------------------------------------------------------------- */

static bool is_active(const lane *one) { return one->self != NULL; }

static int first_active(const batch *self) {
    for (int l = 0; l < W; ++l)
        if (is_active(&self->lane[l])) return l;
    return -1;
}

static void spread(double *numbers, int l, const double *source, int count) {
    for (int i = 0; i < count; ++i) numbers[i * W + l] = source[i];
}

/* Copy what is constant in a kernel_step into a lane; the constants of a run only if those of another instance are there. */
static void take_in(batch *self, int l, const kernel *own) {
    const system_description *system = self->system;
    lane_numbers *n = &self->numbers;
    if (self->lane[l].constants_of != own) {
        spread(n->parameter, l, own->given.parameter, system->parameters);
        spread(n->derived, l, own->run.derived, system->derived);
        spread(n->coefficient, l, own->given.coefficient, system->table_coefficients);
        self->lane[l].constants_of = own;
    }
    spread(n->input, l, own->given.input, system->inputs);
    spread(n->rate, l, own->given.rate, system->inputs);
    n->origin[l] = own->given.step_origin;
    n->allowed[l] = 1.0 / own->run.value[MODEL.tolerance];
}

/* Copy the place of each lane; an inactive lane copies that of the first active one. */
static void take_in_places(batch *self) {
    const int first = first_active(self);
    lane_numbers *n = &self->numbers;
    for (int l = 0; l < W; ++l) {
        const lane *one = &self->lane[is_active(&self->lane[l]) ? l : first];
        if (!is_active(&self->lane[l])) take_in(self, l, one->self);
        spread(n->state, l, one->self->run.state, self->system->states);
        spread(n->mode, l, one->self->run.mode, self->system->frictions);
        n->offset[l] = one->run.offset;
        n->wanted[l] = one->run.size > 0.0 ? one->run.size : 1.0;
    }
}

static void know(batch *self, int l, const known_place *start, const known_place *end) {
    kernel *own = self->lane[l].self;
    own->known[0] = start;
    own->known[1] = end;
}

static void set_known(known_place *known, int l, const known_place *all, double offset) {
    *known = *all;
    known->offset = offset;
    known->lane = l;
}

/* Return whether a lane's instance is in this state, with the modes of the lane. */
static bool stands_at(const batch *self, int l, const double *state) {
    const kernel *own = self->lane[l].self;
    for (int i = 0; i < self->system->states; ++i)
        if (own->run.state[i] != state[i * W + l]) return false;
    for (int i = 0; i < self->system->frictions; ++i)
        if (own->run.mode[i] != self->numbers.mode[i * W + l]) return false;
    return true;
}

/* Return whether an instance makes the same steps as the lanes: with an exact Jacobian and without algebraic states. */
static bool goes_in_lanes(const kernel *own) {
    if (own->system->algebraics) return false;
    return own->work.method == METHOD_EXACT ||
           (own->work.method == METHOD_REUSED && own->run.value[MODEL.integration_step] > 0.0);
}

/* Begin a step in a lane, which then requests a trial or is done. all: results known at the place of each lane; NULL:
 * nothing. */
static void begin_in_lane(batch *self, int l, const known_place *all) {
    lane *one = &self->lane[l];
    const double offset = one->run.offset;
    if (all) set_known(&one->start, l, all, offset);
    know(self, l, all ? &one->start : NULL, NULL);
    if (one->begins) stepper_begin(one->self, &one->run, one->size);
    one->begins = false;
    stepper_ask(one->self, &one->run);
    /* False if a step alone has led elsewhere, or a mode was another one. */
    one->linearised = all && one->run.offset == offset && stands_at(self, l, self->numbers.state);
    know(self, l, NULL, NULL);
}

/* Begin the steps of lanes that ended one. */
static void begin_steps(batch *self) {
    bool begin_runs = false, together = false;
    for (int l = 0; l < W; ++l) {
        const lane *one = &self->lane[l];
        if (!is_active(one) || one->run.phase != STEPPER_BEGINS || !goes_in_lanes(one->self)) continue;
        begin_runs |= one->begins;
        together = true;
    }
    if (together) take_in_places(self);
    const known_place *all = together ? batch_start(self, begin_runs) : NULL;
    for (int l = 0; l < W; ++l) {
        const lane *one = &self->lane[l];
        if (is_active(one) && one->run.phase == STEPPER_BEGINS) begin_in_lane(self, l, goes_in_lanes(one->self) ? all : NULL);
    }
}

static bool asks(const lane *one) {
    return is_active(one) && one->run.phase != STEPPER_DONE && one->run.phase != STEPPER_BEGINS;
}

/* The stages, for the continuous extension. */
static void take_out_stages(const batch *self, int l) {
    kernel *own = self->lane[l].self;
    for (int stage = 0; stage < MOST_STAGES; ++stage)
        for (int i = 0; i < self->system->states; ++i) own->work.stage[stage][i] = self->numbers.stage[stage][i * W + l];
}

/* Takes the trial that was made together. */
static void take_trial(batch *self, int l, const known_place *all) {
    lane *one = &self->lane[l];
    kernel *own = one->self;
    const double end = one->run.offset + one->run.size;
    own->counters.factorisations++;
    own->counters.right_hand_sides += self->tableau->stages - 1;
    for (int i = 0; i < self->system->states; ++i) own->work.trial[i] = self->numbers.trial[i * W + l];
    set_known(&one->end, l, all, end);
    know(self, l, NULL, &one->end);
    const double error = self->numbers.error[l];
    const bool found = one->run.phase == STEPPER_TRIES && error <= 1.0 && !one->run.fixed;
    if (found && modes_margin(own, end, own->work.trial) < 0.0) take_out_stages(self, l);
    stepper_take(own, &one->run, error);
}

static void try_alone(lane *one) {
    if (one->linearised) rosenbrock_linearise(one->self, one->run.offset, one->self->run.state); /* the lanes have it */
    stepper_take(one->self, &one->run, stepper_try(one->self, &one->run));
}

static void try_steps(batch *self) {
    self->tableau = NULL;
    for (int l = 0; l < W; ++l) {
        lane *one = &self->lane[l];
        one->together = false;
        if (!asks(one) || !one->linearised) continue;
        const rosenbrock_tableau *method = rosenbrock_method(one->self);
        if (!self->tableau) self->tableau = method; /* lanes with the other method step alone */
        one->together = method == self->tableau;
        self->numbers.wanted[l] = one->run.size;
    }
    const known_place *all = self->tableau ? batch_try(self) : NULL;
    for (int l = 0; l < W; ++l) {
        lane *one = &self->lane[l];
        if (!asks(one)) continue;
        if (one->together && self->numbers.regular[l] != 0.0) take_trial(self, l, all);
        else try_alone(one);
    }
}

/* End the kernel_steps that are done, with the results known at their end. */
static kernel_status end_step(batch *self, int l) {
    lane *one = &self->lane[l];
    const kernel_status status = step_end(one->self, one->noted, one->size, one->run.offset, one->run.status);
    know(self, l, NULL, NULL);
    return status;
}

static void round_of_steps(batch *self, void *work, void (*end)(batch *self, void *work, int l, kernel_status status)) {
    begin_steps(self);
    try_steps(self);
    for (int l = 0; l < W; ++l) {
        lane *one = &self->lane[l];
        if (!is_active(one)) continue;
        if (one->run.phase == STEPPER_DONE) end(self, work, l, end_step(self, l));
        else know(self, l, NULL, NULL);
    }
}

/* Make a kernel_step of an instance in a lane; return whether it may begin. */
static kernel_status begin_step(batch *self, int l, kernel *own, double size) {
    lane *one = &self->lane[l];
    one->noted = own->messages.noted;
    const kernel_status status = step_begin(own, own->run.now->time, size);
    if (status != KERNEL_OK) return status;
    memset(&one->run, 0, sizeof one->run);
    one->self = own;
    one->size = size;
    one->begins = true;
    take_in(self, l, own);
    return KERNEL_OK;
}

/* ---- runs ----------------------------------------------------------------------------------------------------- */

/* Return the messages of a run, of a failed one only the last; NULL if there is no message or no memory. */
static char *words_of(kernel *own, kernel_status status) {
    kernel_sentence heard = {status, own->messages.message};
    size_t length = 0;
    char *words = NULL;
    while (status > KERNEL_DISCARD ? !words : kernel_hear(own, &heard)) {
        const size_t more = strlen(heard.text);
        char *longer = (char *)realloc(words, length + more + 2);
        if (!longer) break;
        words = longer;
        if (length) words[length++] = ' ';
        memcpy(words + length, heard.text, more + 1);
        length += more;
    }
    return words;
}

static void leave_run(const batch_runs *runs, long long int row, kernel *own, kernel_status status) {
    double *result = runs->result + row * runs->outputs;
    for (int i = 0; i < runs->outputs && status <= KERNEL_DISCARD; ++i)
        if (kernel_get(own, runs->output[i], &result[i]) > KERNEL_WARNING) status = KERNEL_ERROR;
    const bool failed = status > KERNEL_DISCARD;
    for (int i = 0; i < runs->outputs && failed; ++i) result[i] = NAN;
    runs->status[row] = (int)status;
    runs->end[row] = failed ? NAN : own->run.now->time;
    if (runs->messages && (failed || runs->all_messages)) runs->messages[row] = words_of(own, status);
}

/* Return whether the runs have a file of this path. */
static bool has_file(const batch_runs *runs, const char *path) {
    for (int i = 0; path && i < runs->files; ++i)
        if (strcmp(runs->path[i], path) == 0) return true;
    return false;
}

/* All variables to their start values; the files of all runs are read once. */
static kernel_status reset_run(const batch_runs *runs, kernel *own) {
    kernel before = *own;
    const bool table = has_file(runs, own->table_path), records = has_file(runs, own->records_path);
    if (table) own->table = NULL, own->table_path = NULL;
    if (records) own->records = NULL, own->records_path = NULL;
    kernel_reset(own);
    own->reads_outputs_later = false;
    if (table) {
        own->table = before.table;
        own->table_path = before.table_path;
        own->run.now->table = own->table->mark;
    }
    if (records) {
        own->records = before.records;
        own->records_path = before.records_path;
        own->run.now->records = own->records->mark;
    }
    kernel_status status = KERNEL_OK;
    for (int i = 0; i < runs->files && status == KERNEL_OK; ++i) {
        const char *path;
        status = kernel_get_text(own, runs->file[i], &path);
        if (status == KERNEL_OK && strcmp(path, runs->path[i]) != 0)
            status = kernel_set_text(own, runs->file[i], runs->path[i]);
    }
    return status;
}

static kernel_status initialise_run(const batch_runs *runs, long long int row, kernel *own) {
    kernel_sentence heard;
    kernel_status status = reset_run(runs, own);
    for (int i = 0; i < runs->variables && status <= KERNEL_WARNING; ++i)
        status = kernel_set(own, runs->variable[i], runs->value[row * runs->variables + i]);
    while (runs->all_messages && kernel_hear(own, &heard)) continue;
    if (status <= KERNEL_WARNING) status = kernel_initialise(own, runs->start);
    if (status <= KERNEL_WARNING && own->system != &MODEL.system[BATCH.system])
        status = kernel_fail(own, KERNEL_ERROR, "This batch runs the system %s; these values choose %s.",
                             MODEL.system[BATCH.system].name, own->system->name);
    return status;
}

/* Puts the next run into a lane; those that cannot begin are left at once. */
static void next_run(batch *self, const batch_runs *runs, int l) {
    kernel *own = self->own[l];
    self->lane[l].self = NULL;
    for (;;) {
        const long long int row = __atomic_fetch_add(runs->next, 1, __ATOMIC_RELAXED);
        if (row >= runs->count) return;
        kernel_status status = initialise_run(runs, row, own);
        self->lane[l].constants_of = NULL;
        self->lane[l].row = row;
        if (status <= KERNEL_WARNING) status = begin_step(self, l, own, runs->stop - runs->start);
        if (status == KERNEL_OK) return;
        self->lane[l].self = NULL;
        leave_run(runs, row, own, status);
    }
}

static void end_run(batch *self, void *work, int l, kernel_status status) {
    const batch_runs *runs = (const batch_runs *)work;
    leave_run(runs, self->lane[l].row, self->lane[l].self, status);
    next_run(self, runs, l);
}

bool batch_run(batch *self, const batch_runs *runs) {
    for (int l = 0; l < W; ++l) {
        if (!self->own[l] && !(self->own[l] = kernel_create())) return false;
        self->own[l]->recorder = &self->no_rows;
    }
    for (int l = 0; l < W; ++l) next_run(self, runs, l);
    while (first_active(self) >= 0) round_of_steps(self, (void *)(size_t)runs, end_run);
    return true;
}

/* ---- steps of instances --------------------------------------------------------------------------------------- */

/* Read the outputs, from the lanes if they are known there. */
static void leave_step(batch *self, const batch_steps *steps, int l, kernel_status status) {
    const lane *one = &self->lane[l];
    kernel *own = one->self;
    double *result = steps->result + one->row * steps->outputs;
    const bool known = status <= KERNEL_DISCARD && self->ends && one->together && stands_at(self, l, self->numbers.trial);
    steps->status[one->row] = (int)status;
    for (int i = 0; i < steps->outputs; ++i) {
        const int place = known ? self->place[steps->output[i]] : -1;
        result[i] = place < 0 ? NAN : self->numbers.output[place * W + l];
        if (!isfinite(result[i]) && kernel_get(own, steps->output[i], &result[i]) > KERNEL_WARNING) {
            steps->status[one->row] = KERNEL_ERROR;
            result[i] = NAN;
        }
    }
}

static void end_steps(batch *self, void *work, int l, kernel_status status) {
    leave_step(self, (const batch_steps *)work, l, status);
    self->lane[l].self = NULL;
}

/* Return whether an input has this value, bit for bit: it was checked when it was set. */
static bool has_input(const kernel *own, int variable, double value) {
    return MODEL.variable[variable].causality == CAUSALITY_INPUT && own->run.input_rate[variable] == 0.0 &&
           memcmp(&own->run.value[variable], &value, sizeof value) == 0;
}

static kernel_status set_inputs(const batch_steps *steps, long long int row, kernel *own) {
    kernel_status status = KERNEL_OK;
    for (int i = 0; i < steps->inputs && status <= KERNEL_WARNING; ++i) {
        const double value = steps->value[row * steps->inputs + i];
        if (!has_input(own, steps->input[i], value)) status = kernel_set(own, steps->input[i], value);
    }
    own->run.now->outputs_stale = true;
    if (status <= KERNEL_WARNING && own->system != &MODEL.system[BATCH.system])
        status = kernel_fail(own, KERNEL_ERROR, "This batch runs the system %s alone.", MODEL.system[BATCH.system].name);
    own->reads_outputs_later = true;
    return status;
}

/* A step of up to BATCH_LANES instances. */
static void step_group(batch *self, const batch_steps *steps, long long int first) {
    for (int l = 0; l < W && first + l < steps->count; ++l) {
        const long long int row = first + l;
        kernel *own = steps->instance[row];
        /* One that has ended keeps its last sentence. */
        kernel_status status = own->run.now->ended ? KERNEL_DISCARD : set_inputs(steps, row, own);
        if (status <= KERNEL_WARNING) status = begin_step(self, l, own, steps->size);
        self->lane[l].row = row;
        if (status == KERNEL_OK) continue;
        self->lane[l].self = own;
        self->lane[l].together = false;
        end_steps(self, (void *)(size_t)steps, l, status);
    }
    while (first_active(self) >= 0) round_of_steps(self, (void *)(size_t)steps, end_steps);
}

void batch_step(batch *const *group, const batch_steps *steps) {
    for (long long int first = 0; first < steps->count; first += W) step_group(group[first / W], steps, first);
}

/* The instances from one on, CONTROLLED at most. */
static batch_steps part_of(const batch_steps *steps, long long int row) {
    batch_steps part = *steps;
    part.count = steps->count - row < CONTROLLED ? steps->count - row : CONTROLLED;
    part.instance += row;
    part.value += row * steps->inputs;
    part.result += row * steps->outputs;
    part.status += row;
    return part;
}

void batch_control(batch *const *group, const batch_steps *steps, long long int count, batch_between between, void *context,
                   long long int first) {
    for (long long int row = 0; row < steps->count; row += CONTROLLED) {
        const batch_steps part = part_of(steps, row);
        double *value = (double *)(size_t)part.value;
        for (long long int step = 0; step < count; ++step) {
            if (!between(context, first + row, part.count, part.status, part.result, value)) break;
            batch_step(group + row / W, &part);
        }
    }
}

void batch_read_outputs(const batch_steps *steps) {
    for (long long int row = 0; row < steps->count; ++row) {
        steps->status[row] = KERNEL_OK;
        for (int i = 0; i < steps->outputs; ++i) {
            double *result = &steps->result[row * steps->outputs + i];
            const kernel_status status = kernel_get(steps->instance[row], steps->output[i], result);
            if (status > KERNEL_WARNING) steps->status[row] = (int)status;
        }
    }
}
