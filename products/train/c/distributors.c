/* Distributors of a pipe's vehicles: rows of each kind, in the layout of rows.h. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipe_inside.h"
#include "rows.h"

/* The kinds that a vehicle has. */
#define EACH_KIND(self, one)                                                                                                   \
    for (distributors *one = (self)->own; one < (self)->own + KINDS; ++one)                                                    \
        if (one->count)
#define EACH_CONST(self, one)                                                                                                  \
    for (const distributors *one = (self)->own; one < (self)->own + KINDS; ++one)                                              \
        if (one->count)

void distributors_free(pipe *self) {
    for (int k = 0; k < KINDS; ++k) {
        free(self->own[k].memory);
        free(self->own[k].vehicle);
    }
    memset(self->own, 0, sizeof self->own);
}

/* Allocates memory for this many rows; returns 0 if out of memory. */
static int lay(distributors *self, long long int rows) {
    const int states = KIND[self->kind].states, given = KIND[self->kind].given;
    const rows_part parts[] = {{&self->state, states, 1e5},
                               {&self->before, states, 0.0},
                               {&self->kept, states, 0.0},
                               {&self->first, states, 0.0},
                               {&self->given, given, 1.0},
                               {&self->air, PIPE_STATES, 1.0},
                               {&self->command, COMMAND_ROWS, 0.0},
                               {&self->rate, states + ANSWER_ROWS, 0.0},
                               {&self->pressing, KIND[self->kind].presses, 1e5}};
    self->stride = rows_stride(rows);
    self->memory = ROWS_LAY(parts, self->stride);
    self->vehicle = (long long int *)malloc((size_t)(3 * rows) * sizeof(long long int));
    if (!self->memory || !self->vehicle) return 0;
    self->cell = self->vehicle + rows;
    self->of = self->cell + rows;
    return 1;
}

/* Air at rest, after the last one. */
static void put_air(distributors *self) {
    static const double air[PIPE_STATES] = {1.2, 0.0, 2.5e5};
    for (int n = 0; n < PIPE_STATES; ++n) rows_fill(self->air + n * self->stride, self->stride, air[n]);
}

static int parts_of(const double *parts, long long int vehicle) {
    return parts && parts[vehicle] >= 2.0 ? (int)parts[vehicle] : 0;
}

/* Adds the parts of all vehicles' cylinders after the rows of the vehicles. */
static void add_parts(distributors *self, const double *parts) {
    self->rows = self->count;
    for (long long int i = 0; i < self->count; ++i) {
        self->of[i] = i;
        for (int n = parts_of(parts, self->vehicle[i]); n > 0; --n) {
            const long long int row = self->rows++;
            self->vehicle[row] = self->vehicle[i];
            self->cell[row] = self->cell[i];
            self->of[row] = i;
            for (int k = 0; k < KIND[self->kind].given; ++k)
                self->given[row + k * self->stride] = self->given[i + k * self->stride];
        }
    }
}

int pipe_vehicles(pipe *self, long long int count, const long long int *kind, const long long int *cell, const double *parts,
                  const double *const given[KINDS], int brake_model, double pace) {
    distributors_free(self);
    long long int counts[KINDS] = {0};
    for (long long int v = 0; v < count; ++v) counts[kind[v]] += 1 + parts_of(parts, v);
    for (int k = 0; k < KINDS; ++k) {
        distributors *one = &self->own[k];
        one->kind = k;
        one->form = 2 * k + (brake_model != BRAKE_MODEL_WHOLE);
        one->lanes = self->lanes;
        if (counts[k] && !lay(one, counts[k])) return 0;
    }
    for (long long int v = 0; v < count; ++v) {
        distributors *one = &self->own[kind[v]];
        one->vehicle[one->count] = v;
        one->cell[one->count++] = cell[v];
    }
    EACH_KIND(self, one) {
        put_air(one);
        rows_put(one->given, one->stride, given[one->kind], KIND[one->kind].given, one->count);
        add_parts(one, parts);
    }
    self->brake_model = brake_model;
    self->pace = pace;
    return 1;
}

void pipe_charge(pipe *self, double charged, double around, double cylinder) {
    const double start[STARTS] = {[START_CHARGED] = charged, [START_AROUND] = around, [START_CYLINDER] = cylinder};
    EACH_KIND(self, one)
    for (int n = 0; n < KIND[one->kind].states; ++n)
        for (long long int i = 0; i < one->rows; ++i) one->state[i + n * one->stride] = start[KIND[one->kind].start[n]];
}

void pipe_protect(pipe *self, const double *protection) {
    EACH_KIND(self, one)
    for (long long int i = 0; i < one->count; ++i) {
        const double command = protection[one->vehicle[i]];
        one->command[i + COMMAND_HELD * one->stride] = command != PROTECTION_APPLY;
        one->command[i + COMMAND_VENTED * one->stride] = command == PROTECTION_RELEASE;
    }
}

void pipe_dump(pipe *self, const double *held, const double *vented) {
    EACH_KIND(self, one)
    for (long long int i = 0; i < one->count; ++i) {
        one->command[i + COMMAND_HELD * one->stride] = held[one->vehicle[i]];
        one->command[i + COMMAND_VENTED * one->stride] = vented[one->vehicle[i]];
    }
}

void pipe_dump_parts(pipe *self, long long int vehicle, const double *held, const double *vented) {
    EACH_KIND(self, one)
    for (long long int i = one->count, n = 0; i < one->rows; ++i)
        if (one->vehicle[i] == vehicle) {
            one->command[i + COMMAND_HELD * one->stride] = held[n];
            one->command[i + COMMAND_VENTED * one->stride] = vented[n++];
        }
}

void pipe_vent_parts(pipe *self, long long int vehicle) {
    EACH_KIND(self, one)
    for (long long int i = one->count; i < one->rows; ++i)
        if (one->vehicle[i] == vehicle)
            one->command[i + COMMAND_HELD * one->stride] = one->command[i + COMMAND_VENTED * one->stride] = 1.0;
}

void pipe_demand(pipe *self, const double *share, const double *ordered) {
    EACH_KIND(self, one)
    for (long long int i = 0; i < one->rows; ++i) {
        one->command[i + COMMAND_DEMANDED * one->stride] = share[one->vehicle[i]];
        one->command[i + COMMAND_ORDERED * one->stride] = ordered[one->vehicle[i]];
    }
}

int pipe_is_assisted(const pipe *self) {
    EACH_CONST(self, one)
    if (KIND[one->kind].assisted) return 1;
    return 0;
}

void pipe_vehicle_states(const pipe *self, int kind, double *state) {
    const distributors *one = &self->own[kind];
    if (one->count) rows_get(state, one->state, one->stride, KIND[kind].states, one->count);
}

long long int distributors_numbers(const pipe *self) {
    long long int count = 0;
    EACH_CONST(self, one) count += KIND[one->kind].states * one->rows;
    return count;
}

void distributors_save(const pipe *self, double *numbers) {
    EACH_CONST(self, one) {
        rows_get(numbers, one->state, one->stride, KIND[one->kind].states, one->rows);
        numbers += KIND[one->kind].states * one->rows;
    }
}

void distributors_load(pipe *self, const double *numbers) {
    EACH_KIND(self, one) {
        rows_put(one->state, one->stride, numbers, KIND[one->kind].states, one->rows);
        numbers += KIND[one->kind].states * one->rows;
    }
}

/* Pressures that press the brakes: those of the cylinders, or what they depend on. */
static const double *pressing(const distributors *self) {
    if (!KIND[self->kind].presses) return self->state + KIND[self->kind].cylinder * self->stride;
    IN_LANES(distributors_press);
    return self->pressing;
}

void pipe_pressures(const pipe *self, double *line, double *cylinder) {
    EACH_CONST(self, one) {
        for (long long int i = 0; i < one->count && line; ++i) {
            const double *u = self->state + one->cell[i], momentum = u[self->stride];
            /* (kappa - 1) times inner energy */
            line[one->vehicle[i]] = 0.4 * (u[2 * self->stride] - momentum * momentum / u[0] / 2.0);
        }
        const double *pressure = cylinder ? pressing(one) : NULL;
        for (long long int i = 0; i < one->count && cylinder; ++i) cylinder[one->vehicle[i]] = pressure[i];
    }
}

void pipe_part_pressures(const pipe *self, long long int vehicle, double *pressure) {
    EACH_CONST(self, one) {
        const double *found = one->rows > one->count ? pressing(one) : NULL;
        for (long long int i = one->count; i < one->rows; ++i)
            if (one->vehicle[i] == vehicle) *pressure++ = found[i];
    }
}

/* Gives a vehicle the mean rates of its parts, and its parts all of these except that of the cylinder. */
static void share_parts(distributors *self) {
    for (long long int first = self->count, end = first; first < self->rows; first = end) {
        const long long int of = self->of[first];
        while (end < self->rows && self->of[end] == of) ++end;
        for (int n = 0; n < KIND[self->kind].states + ANSWER_ROWS; ++n) {
            double *rate = self->rate + n * self->stride, sum = 0.0;
            for (long long int i = first; i < end; ++i) sum += rate[i];
            rate[of] = sum / (double)(end - first);
            for (long long int i = first; i < end && n != KIND[self->kind].cylinder; ++i) rate[i] = rate[of];
        }
    }
}

static void answer(distributors *self) {
    IN_LANES(distributors_answer);
    share_parts(self);
}

void distributors_act(pipe *self, pipe_passed *passed) {
    const long long int stride = self->stride;
    EACH_KIND(self, one) {
        for (long long int i = 0; i < one->rows; ++i)
            for (int n = 0; n < PIPE_STATES; ++n) one->air[i + n * one->stride] = self->state[one->cell[i] + n * stride];
        answer(one);
        if (self->brake_model == BRAKE_MODEL_DELAY) continue;
        const double *found = one->rate + KIND[one->kind].states * one->stride;
        const double *mass = found + ANSWER_TAKEN * one->stride, *energy = found + ANSWER_ENTHALPY * one->stride;
        for (long long int i = 0; i < one->count; ++i) {
            const long long int cell = one->cell[i];
            self->rate[cell] -= mass[i] * self->over_volume[cell];
            self->rate[cell + 2 * stride] -= energy[i] * self->over_volume[cell];
            passed->vehicle_mass += mass[i];
            passed->vehicle_energy += energy[i];
            passed->cylinder_mass += found[i + ANSWER_FILLING * one->stride];
        }
    }
}

void distributors_go_on(pipe *self, double share, double step) {
    EACH_KIND(self, one)
    for (int n = 0; n < KIND[one->kind].states; ++n) {
        const long long int at = n * one->stride;
        pipe_mix(one->state + at, one->before + at, one->rate + at, one->rows, share, step);
    }
}

void distributors_copy(pipe *self, int to, int from) {
    EACH_KIND(self, one) {
        double *blocks[] = {one->state, one->before, one->kept, one->first};
        const size_t size = (size_t)(KIND[one->kind].states * one->stride) * sizeof(double);
        memcpy(blocks[to] - ROWS_EDGE, blocks[from] - ROWS_EDGE, size);
    }
}

bool distributors_sound(const pipe *self) {
    EACH_CONST(self, one)
    for (int n = 0; n < KIND[one->kind].states; ++n) {
        const double *state = one->state + n * one->stride;
        for (long long int i = 0; i < one->rows; ++i)
            if (!(state[i] > 0.0 && isfinite(state[i]))) return false;
    }
    return true;
}
