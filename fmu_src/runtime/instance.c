/* An instance: its memory, and small questions about it. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "instance.h"
#include "lanes_widest.h"

/* The largest of each number over the systems, so that the memory suffices for each of them. */
static dimensions largest_dimensions(void) {
    dimensions most;
    memset(&most, 0, sizeof most);
    for (int i = 0; i < MODEL.systems; ++i) {
        const system_description *one = &MODEL.system[i];
#define GROW(member)                                                                                                           \
    if (one->member > most.member) most.member = one->member
        GROW(states);
        GROW(algebraics);
        GROW(nonzeros);
        GROW(factors);
        GROW(inputs);
        GROW(parameters);
        GROW(derived);
        GROW(frictions);
        GROW(outputs);
        GROW(tables);
        GROW(table_coefficients);
        GROW(limits);
        GROW(conditions);
#undef GROW
    }
    return most;
}

/* Room for an even count, so that two may be computed at once. */
static double *carve(double *block, size_t *used, int count) {
    double *start = block ? block + *used : NULL;
    *used += (size_t)(count + count % 2);
    return start;
}

/* Lay the state of the run out in its block; without a block only count the doubles. */
static size_t lay_out_run(run_state *run, const dimensions *room, double *block) {
    size_t used = 0;
    run->now = (run_record *)carve(block, &used, (int)((sizeof(run_record) + sizeof(double) - 1) / sizeof(double)));
    run->state = carve(block, &used, room->states);
    run->mode = carve(block, &used, room->frictions);
    run->warned = carve(block, &used, room->conditions);
    run->reported = carve(block, &used, room->frictions);
    run->kept_state = carve(block, &used, room->states);
    run->kept_input = carve(block, &used, room->inputs);
    run->kept_mode = carve(block, &used, room->frictions);
    run->unread = used;
    run->value = carve(block, &used, MODEL.variables);
    run->changing = used;
    run->input_rate = carve(block, &used, MODEL.variables);
    run->last_rate = carve(block, &used, MODEL.variables);
    run->derived = carve(block, &used, room->derived);
    run->block = block;
    return run->doubles = used;
}

static void lay_out_step(step_workspace *work, const dimensions *room, double *block, size_t *used) {
    const int n = room->states, m = room->algebraics;
    double **const vectors[] = {&work->differential, &work->slope,   &work->time_slope, &work->point,
                                &work->trial,        &work->ordered, &work->direction,  &work->image};
    for (size_t i = 0; i < sizeof vectors / sizeof vectors[0]; ++i) *vectors[i] = carve(block, used, n);
    for (int i = 0; i < MOST_STAGES; ++i) work->stage[i] = carve(block, used, n);
    work->jacobian = carve(block, used, room->nonzeros);
    work->factors.packed = carve(block, used, room->factors);
    work->dense.matrix = carve(block, used, n * n);
    work->algebraic.matrix = carve(block, used, m * m);
    work->correction = carve(block, used, m);
    work->guess = carve(block, used, m);
    work->follow = carve(block, used, m);
    work->largest_change = carve(block, used, room->limits);
}

/* The same for the workspaces. */
static size_t lay_out_work(kernel *self, double *block) {
    const dimensions *room = &self->room;
    const int n = room->states, exchanged = kernel_exchange_states();
    size_t used = 0;
    self->backup = carve(block, &used, (int)self->run.doubles);
    self->given.parameter = carve(block, &used, room->parameters);
    self->given.input = carve(block, &used, room->inputs);
    self->given.rate = carve(block, &used, room->inputs);
    self->given.stage_input = carve(block, &used, room->inputs);
    self->given.coefficient = carve(block, &used, room->table_coefficients);
    self->given.table_at = carve(block, &used, room->tables);
    self->given.held = carve(block, &used, 2 * room->tables);
    self->given.seed = carve(block, &used, 1 + n + room->inputs);
    lay_out_step(&self->work, room, block, &used);
    self->kept.jacobian = carve(block, &used, room->nonzeros);
    self->kept.factors.packed = carve(block, &used, room->factors);
    self->kept.algebraic.matrix = carve(block, &used, room->algebraics * room->algebraics);
    self->modes.drive = carve(block, &used, room->frictions);
    self->modes.capacity = carve(block, &used, 2 * room->frictions);
    self->modes.reported = carve(block, &used, 2 * room->frictions);
    self->modes.before = carve(block, &used, room->frictions);
    self->modes.overshoot = carve(block, &used, room->frictions);
    self->modes.margin = carve(block, &used, room->frictions + room->conditions);
    self->reading.output = carve(block, &used, room->outputs);
    self->reading.output_rate = carve(block, &used, room->outputs);
    double **const vectors[] = {&self->reading.slope_change, &self->reading.place,      &self->reading.state,
                                &self->reading.first_slope,  &self->reading.last_slope, &self->steady.start,
                                &self->steady.change,        &self->steady.answer,      &self->steady.pace,
                                &self->host.state,           &self->host.slope,         &self->host.change,
                                &self->host.slope_before};
    for (size_t i = 0; i < sizeof vectors / sizeof vectors[0]; ++i) *vectors[i] = carve(block, &used, n);
    self->host.growth = carve(block, &used, exchanged * exchanged);
    self->host.square = carve(block, &used, exchanged * exchanged);
    return used;
}

static void lay_out_pivots(kernel *self) {
    self->work.dense.pivot = self->pivots;
    self->work.algebraic.pivot = self->work.dense.pivot + self->room.states;
    self->kept.algebraic.pivot = self->work.algebraic.pivot + self->room.algebraics;
    self->given.row = self->kept.algebraic.pivot + self->room.algebraics;
}

kernel *kernel_create(void) {
    kernel *self = (kernel *)calloc(1, sizeof *self);
    if (!self) return NULL;
    self->lanes = lanes_of_processor();
    self->room = largest_dimensions();
    double *block = (double *)calloc(lay_out_run(&self->run, &self->room, NULL), sizeof(double));
    const int places = self->room.states + 2 * self->room.algebraics + self->room.tables;
    self->run.block = block;
    self->scratch = (double *)calloc(lay_out_work(self, NULL), sizeof(double));
    self->pivots = (int *)calloc((size_t)places + 1, sizeof(int));
    self->warned = (char *)calloc((size_t)MODEL.variables, 1);
    if (!block || !self->scratch || !self->pivots || !self->warned) {
        kernel_free(self);
        return NULL;
    }
    (void)lay_out_run(&self->run, &self->room, block);
    (void)lay_out_work(self, self->scratch);
    lay_out_pivots(self);
    kernel_reset(self);
    return self;
}

/* Also of one that was made in part only. */
void kernel_free(kernel *self) {
    if (!self) return;
    table_free(self->table);
    free(self->table_path);
    records_free(self->records);
    free(self->records_path);
    free(self->run.block);
    free(self->scratch);
    free(self->pivots);
    free(self->warned);
    free(self);
}

void kernel_reset(kernel *self) {
    kernel_leave_table(self);
    kernel_leave_records(self);
    memset(self->run.block, 0, self->run.doubles * sizeof(double));
    memset(self->warned, 0, (size_t)MODEL.variables);
    memset(&self->counters, 0, sizeof self->counters);
    for (int i = 0; i < MODEL.variables; ++i) self->run.value[i] = MODEL.variable[i].start;
    self->run.now->system = -1;
    self->host.steps = 0;
    self->host.slope_known = false;
    self->requested.stop_time = INFINITY;
    self->system = NULL;
    self->messages.message[0] = '\0';
    self->messages.length = self->messages.heard = 0;
    self->messages.noted = self->messages.lost = 0;
}

double kernel_time(const kernel *self) { return self->run.now->time; }
bool kernel_ended(const kernel *self) { return self->run.now->ended != 0; }
int kernel_state_count(const kernel *self) { return self->system ? self->system->states : 0; }
