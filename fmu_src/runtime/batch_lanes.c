/* Computations in all lanes of a batch: linearisation, factors, stages, margins. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "batch_lanes.h"
#include "lanes_widest.h"

#define LANES BATCH_LANES
#include "lanes.h"
#include "rosenbrock_stages.h"

enum { ALIGNMENT = 64 };

static double *carve_lanes(double *room, size_t *used, int count) {
    double *start = room ? room + *used : NULL;
    const size_t line = ALIGNMENT / sizeof(double);
    *used += ((size_t)count * LANES + line - 1) / line * line;
    return start;
}

/* Lay out the numbers that are kept from step to step. */
static size_t lay_out_constants(batch *self, double *room) {
    size_t used = 0;
    self->numbers.parameter = carve_lanes(room, &used, self->system->parameters);
    self->numbers.derived = carve_lanes(room, &used, self->system->derived);
    return used;
}

/* Lay out the work arrays of a step. */
static size_t lay_out_work(batch *self, double *room) {
    const system_description *system = self->system;
    lane_numbers *n = &self->numbers;
    size_t used = 0;
    double **const single[] = {&n->origin, &n->offset, &n->wanted, &n->allowed, &n->time, &n->error, &n->regular};
    double **const vectors[] = {&n->state, &n->slope, &n->time_slope, &n->differential, &n->point, &n->trial};
    for (size_t i = 0; i < sizeof single / sizeof single[0]; ++i) *single[i] = carve_lanes(room, &used, 1);
    for (size_t i = 0; i < sizeof vectors / sizeof vectors[0]; ++i) *vectors[i] = carve_lanes(room, &used, system->states);
    for (int i = 0; i < MOST_STAGES; ++i) n->stage[i] = carve_lanes(room, &used, system->states);
    n->input = carve_lanes(room, &used, system->inputs);
    n->rate = carve_lanes(room, &used, system->inputs);
    n->stage_input = carve_lanes(room, &used, system->inputs);
    n->mode = carve_lanes(room, &used, system->frictions);
    n->coefficient = carve_lanes(room, &used, system->table_coefficients);
    n->argument = carve_lanes(room, &used, system->tables);
    n->jacobian = carve_lanes(room, &used, system->nonzeros);
    n->entry = carve_lanes(room, &used, system->factors);
    n->capacity = carve_lanes(room, &used, 2 * system->frictions);
    n->end_capacity = carve_lanes(room, &used, 2 * system->frictions);
    n->drive = carve_lanes(room, &used, system->frictions);
    n->end_drive = carve_lanes(room, &used, system->frictions);
    n->margin = carve_lanes(room, &used, system->conditions);
    n->largest_change = carve_lanes(room, &used, system->limits);
    n->output = carve_lanes(room, &used, system->outputs);
    return used;
}

/* Return aligned memory for `count` numbers within the block `own`, which the caller frees; NULL if out of memory. */
static double *aligned_room(size_t count, double **own) {
    const size_t line = ALIGNMENT / sizeof(double);
    *own = (double *)calloc(count + line, sizeof(double));
    if (!*own) return NULL;
    const size_t beside = (size_t)*own % ALIGNMENT / sizeof(double);
    return *own + (beside ? line - beside : 0);
}

bool batch_lay_out(batch *self, const batch *beside) {
    if (beside) self->numbers = beside->numbers;
    double *room = aligned_room(lay_out_constants(self, NULL), &self->constants);
    if (!room) return false;
    (void)lay_out_constants(self, room);
    if (beside) return true;
    room = aligned_room(lay_out_work(self, NULL), &self->room);
    if (!room) return false;
    (void)lay_out_work(self, room);
    for (int i = 0; i < self->system->states * LANES; ++i) self->numbers.differential[i] = 1.0;
    return true;
}

/* Compute inputs and pieces of the table file at `share` of the wanted steps; functions may be called there afterwards. */
static void locate(batch *self, double share) {
    const system_description *system = self->system;
    lane_numbers *n = &self->numbers;
    const real offset = real_load(n->offset) + share * real_load(n->wanted);
    real_store(n->time, real_load(n->origin) + offset);
    for (int i = 0; i < system->inputs; ++i)
        real_store(n->stage_input + i * LANES, real_load(n->input + i * LANES) + offset * real_load(n->rate + i * LANES));
}

static void call(batch *self, lanes_function function, const double *state, double *const *result) {
    const lane_numbers *n = &self->numbers;
    const double *argument[ARG_COUNT] = {n->time,    state,   n->stage_input, n->rate, n->parameter,
                                         n->derived, n->mode, n->coefficient, NULL};
    function(argument, result);
}

/* Look up the table file, each lane in its own; between functions of many lanes. */
static void look_up(batch *self, const double *state) {
    const system_description *system = self->system;
    lane_numbers *n = &self->numbers;
    for (int rank = 0, first = 0; rank < system->table_ranks; ++rank) {
        call(self, self->of->table_argument[rank], state, &n->argument);
        int i = first;
        for (; i < system->tables && system->table[i].rank == rank; ++i)
            for (int l = 0; l < LANES; ++l) {
                kernel *own = self->lane[l].self;
                if (!own) continue;
                const double at = n->argument[(i - first) * LANES + l];
                double *held = own->given.held + 2 * i, *coefficient = own->given.coefficient + system->table[i].place;
                if (!(at >= held[0] && at < held[1]))
                    table_look_up(own->table, &system->table[i], at, &own->given.row[i], held, coefficient);
            }
        first = i;
    }
    for (int l = 0; l < LANES; ++l) {
        const kernel *own = self->lane[l].self;
        for (int i = 0; own && i < system->table_coefficients; ++i) n->coefficient[i * LANES + l] = own->given.coefficient[i];
    }
}

static void place_at(batch *self, double share, const double *state) {
    locate(self, share);
    if (self->system->tables) look_up(self, state);
}

static void add_known(known_place *known, generated_function function, double *first, int size) {
    known_function *one = &known->function[known->functions++];
    memset(one, 0, sizeof *one);
    one->function = function;
    one->result[0] = first;
    one->size[0] = size;
}

static void begin_known(batch *self, known_place *known, known_function *function, const double *state) {
    known->lanes = LANES;
    known->function = function;
    known->functions = 0;
    known->state = state;
    known->mode = self->numbers.mode;
}

/* Return whether some lane requires a drive, see find_drive_and_capacity in modes.c. */
static bool asks_for_drive(const batch *self, const double *state, const double *capacity) {
    const system_description *system = self->system;
    for (int i = 0; i < system->frictions; ++i)
        for (int l = 0; l < LANES; ++l) {
            const friction_description *friction = &system->friction[i];
            const double velocity =
                state[friction->velocity * LANES + l] + (friction->other < 0 ? 0.0 : state[friction->other * LANES + l]);
            if (self->numbers.mode[i * LANES + l] == 0.0 || fabs(velocity) <= capacity[(system->frictions + i) * LANES + l])
                return true;
        }
    return false;
}

/* Capacities, and drives if a lane requires them. */
static void find_modes(batch *self, known_place *known, const double *state, double *capacity, double *drive) {
    const system_description *system = self->system;
    if (!system->frictions) return;
    call(self, self->of->capacity, state, &capacity);
    add_known(known, system->capacity, capacity, 2 * system->frictions);
    if (!asks_for_drive(self, state, capacity)) return;
    call(self, self->of->drive, state, &drive);
    add_known(known, system->drive, drive, system->frictions);
}

const known_place *batch_start(batch *self, bool modes) {
    const system_description *system = self->system;
    lane_numbers *n = &self->numbers;
    begin_known(self, &self->start, self->of_start, n->state);
    place_at(self, 0.0, n->state);
    if (modes) find_modes(self, &self->start, n->state, n->capacity, n->drive);
    double *result[] = {n->jacobian, n->time_slope, n->slope};
    call(self, self->of->jacobian, n->state, result);
    add_known(&self->start, system->jacobian, n->jacobian, 0); /* the Jacobian stays in the lanes, whose steps it makes */
    known_function *jacobian = &self->start.function[self->start.functions - 1];
    for (int i = 1; i < MOST_RESULTS; ++i) {
        jacobian->result[i] = result[i];
        jacobian->size[i] = system->states;
    }
    if (system->limits) {
        call(self, self->of->largest_change, n->state, &n->largest_change);
        add_known(&self->start, system->largest_change, n->largest_change, system->limits);
    }
    LANES_LEAVE;
    return &self->start;
}

/* Compute factors of 1 / (gamma h) - J; `regular` marks the lanes in which they are usable. */
static void factorise(batch *self) {
    const system_description *system = self->system;
    lane_numbers *n = &self->numbers;
    double *entry = n->entry;
    const real diagonal = 1.0 / (self->tableau->gamma * real_load(n->wanted));
    for (int i = 0; i < system->states; ++i)
        real_store(n->point + i * LANES, diagonal * real_load(n->differential + i * LANES));
    self->of->factorise(n->jacobian, n->point, entry);
    real_mask regular = real_of(0.0) < real_of(1.0);
    for (int i = 0; i < system->states; ++i) regular = regular & (real_fabs(real_load(entry + i * LANES)) < real_of(INFINITY));
    for (int i = system->states; i < system->states + system->lower_factors; ++i)
        regular = regular & (real_fabs(real_load(entry + i * LANES)) <= real_of(PIVOT_RATIO));
    real_store(n->regular, real_of_mask(regular));
}

static void evaluate_stage(void *of, double alpha, const double *point, double *k) {
    batch *self = (batch *)of;
    place_at(self, alpha, point);
    call(self, self->of->ode, point, &k);
}

static void solve_stage(void *of, double *k) {
    const batch *self = (const batch *)of;
    self->of->substitute(self->numbers.entry, k);
}

/* Compute the error as at the end of rosenbrock_step. */
static void find_error(batch *self) {
    const system_description *system = self->system;
    const lane_numbers *n = &self->numbers;
    const real allowed = real_load(n->allowed);
    real sum = real_of(0.0);
    for (int i = 0; i < system->states; ++i) {
        real difference = real_of(0.0);
        for (int j = 0; j < self->tableau->stages; ++j)
            difference = difference + self->tableau->error[j] * real_load(n->stage[j] + i * LANES);
        const real scaled = difference * allowed / system->nominal[i];
        sum = sum + scaled * scaled;
    }
    real_store(n->error, real_sqrt(sum / (double)system->states));
}

/* Return whether a lane ends its kernel_step there, if the trial is accepted. */
static bool ends(const batch *self) {
    for (int l = 0; l < LANES; ++l) {
        const lane *one = &self->lane[l];
        if (one->self && one->run.size == one->run.remaining) return true;
    }
    return false;
}

const known_place *batch_try(batch *self) {
    const system_description *system = self->system;
    lane_numbers *n = &self->numbers;
    const stage_work work = {
        system->states * LANES, n->state,   n->slope, n->time_slope, n->differential, n->point, n->trial, n->stage, self,
        evaluate_stage,         solve_stage};
    factorise(self);
    LANES_NAME(rosenbrock_stages)(self->tableau, &work, real_load(n->wanted));
    find_error(self);
    begin_known(self, &self->end, self->of_end, n->trial);
    place_at(self, 1.0, n->trial);
    find_modes(self, &self->end, n->trial, n->end_capacity, n->end_drive);
    if (system->conditions) {
        call(self, self->of->condition_margin, n->trial, &n->margin);
        add_known(&self->end, system->condition_margin, n->margin, system->conditions);
    }
    self->ends = ends(self);
    if (self->ends) {
        call(self, self->of->output, n->trial, &n->output);
        add_known(&self->end, system->output, n->output, system->outputs);
    }
    LANES_LEAVE;
    return &self->end;
}
#include "lanes_end.h"
