/* detail.h: each vehicle in detail is one more body of the couplers' steps. The force of a coupler at the middle of such a step
 * acts on both its vehicles during the whole step, so that its impulses are equal and opposite. The kernel continues from its own
 * state; with a rigid vehicle on a free rail this is the step of all other vehicles (Störmer and Verlet). */
#include "detail.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "train_inside.h"

/* Share of a step below which times are equal. */
static const double SAME = 1e-6;

typedef struct {
    long long int vehicle;
    struct kernel *machine;
    const detail_functions *call;
    detail_variables variable;
    double brake[DETAIL_WHEELSETS], turning[DETAIL_WHEELSETS];
    double origin; /* position of the vehicle where the kernel's coupler is at 0 [m] */
} detailed;

struct details {
    long long int count, failed;
    int began; /* all kernels have been initialised */
    double step, clock; /* longest step; time since the start of the run [s] */
    detailed *of;
};

static detailed *detailed_at(const train *self, long long int vehicle) {
    for (long long int n = 0; self->detail && n < self->detail->count; ++n)
        if (self->detail->of[n].vehicle == vehicle) return &self->detail->of[n];
    return NULL;
}

int detail_moves(const train *self, long long int vehicle) { return detailed_at(self, vehicle) != NULL; }

static double got(const detailed *one, int variable) {
    double value = NAN;
    if (variable >= 0 && one->call->get(one->machine, variable, &value) > KERNEL_WARNING) return NAN;
    return value;
}

/* Place or speed of the couplers' points on the body. */
static double at_couplers(const detailed *one, int along, int pitching) {
    return got(one, along) + (pitching >= 0 ? one->variable.height * got(one, pitching) : 0.0);
}

double detail_rim(const train *self, long long int vehicle, int wheelset) {
    const detailed *one = self->detail && self->detail->began ? detailed_at(self, vehicle) : NULL;
    return one ? one->turning[wheelset] * one->variable.radius : motion_wheel(self->moves)[vehicle];
}

static double rim_speed(detailed *one) {
    double sum = 0.0;
    for (int n = 0; n < one->variable.wheelsets; ++n) sum += one->turning[n] = got(one, one->variable.turning[n]);
    return sum * one->variable.radius / one->variable.wheelsets;
}

/* The inputs of a kernel in a coupler step, each a number and its value. */
static kernel_status act(const train *self, const detailed *one) {
    const detail_variables *variable = &one->variable;
    const long long int i = one->vehicle;
    const double *force = motion_force(self->moves), share = self->drive && self->drive->falls ? self->drive->share[i] : 1.0;
    const double arm = variable->radius / variable->wheelsets, pull = motion_acting(self->moves, ACTING_PULL)[i];
    kernel_status worst = one->call->set(one->machine, variable->front, force[i - 1]);
    const kernel_status rear = one->call->set(one->machine, variable->rear, -force[i]);
    worst = rear > worst ? rear : worst;
    for (int n = 0; n < variable->wheelsets; ++n) {
        const double values[] = {one->brake[n] * self->held[i] * arm, pull * arm, self->input[IN_FRICTION][i] * share};
        const int numbers[] = {variable->brake[n], variable->traction[n], variable->friction[n]};
        for (int k = 0; k < 3; ++k) {
            const kernel_status status = one->call->set(one->machine, numbers[k], values[k]);
            worst = status > worst ? status : worst;
        }
    }
    return worst;
}

/* Advances all kernels by a coupler step, after the other vehicles. */
static void follow(void *owner, double step) {
    train *self = (train *)owner;
    details *detail = self->detail;
    for (long long int n = 0; n < detail->count && detail->failed < 0; ++n) {
        detailed *one = &detail->of[n];
        kernel_status status = act(self, one);
        if (status <= KERNEL_WARNING) status = one->call->step(one->machine, one->call->time(one->machine), step);
        if (status > KERNEL_WARNING) detail->failed = one->vehicle;
        const double place = one->origin + at_couplers(one, one->variable.place, one->variable.pitch);
        const double speed = at_couplers(one, one->variable.speed, one->variable.pitch_rate);
        motion_move(self->moves, one->vehicle, place - step / 2.0 * speed, detail->failed < 0 ? speed : NAN, rim_speed(one));
    }
}

int train_detail(train *self, long long int vehicle, struct kernel *machine, const detail_functions *call,
                 const detail_variables *variable) {
    if (vehicle < 0 || vehicle >= self->vehicles || detail_moves(self, vehicle)) return 0;
    const int sensors = protection_wheelsets(self, vehicle);
    if (sensors && sensors != variable->wheelsets) return 0;
    details *detail = self->detail ? self->detail : (details *)calloc(1, sizeof *detail);
    if (!detail) return 0;
    self->detail = detail;
    detailed *of = (detailed *)realloc(detail->of, (size_t)(detail->count + 1) * sizeof *of);
    if (!of) return 0;
    detail->of = of;
    detailed *one = memset(&of[detail->count++], 0, sizeof *one);
    *one = (detailed){vehicle, machine, call, *variable, {0.0}, {0.0}, 0.0};
    for (int n = 0; n < DETAIL_WHEELSETS; ++n) one->brake[n] = 1.0;
    motion_follow(self->moves, follow, self);
    detail->failed = -1;
    double *saved = (double *)realloc(self->saved, (size_t)train_numbers(self) * sizeof(double));
    if (!saved) return 0;
    self->saved = saved;
    return 1;
}

void train_detail_begin(train *self) {
    if (!self->detail) return;
    self->detail->began = 1;
    train_set_motion(self, NULL);
}

void detail_try(train *self) {
    if (self->detail) self->detail->failed = -1;
}

void detail_forget(train *self) {
    if (!self->detail) return;
    self->detail->began = 0;
    self->detail->clock = 0.0;
    for (long long int n = 0; n < self->detail->count; ++n)
        for (int k = 0; k < DETAIL_WHEELSETS; ++k) self->detail->of[n].brake[k] = 1.0;
}

void detail_settle(train *self) {
    for (long long int n = 0; self->detail && self->detail->began && n < self->detail->count; ++n) {
        detailed *one = &self->detail->of[n];
        one->origin = motion_place(self->moves)[one->vehicle] - at_couplers(one, one->variable.place, one->variable.pitch);
        motion_move(self->moves, one->vehicle, motion_place(self->moves)[one->vehicle],
                    at_couplers(one, one->variable.speed, one->variable.pitch_rate), rim_speed(one));
    }
}

void detail_free(details *self) {
    if (self) free(self->of);
    free(self);
}

double detail_rounding(const train *self) { return self->detail ? 2.0 * SAME * self->detail->step : 0.0; }

double detail_step(const train *self, double left) {
    details *detail = self->detail;
    const double next = floor(detail->clock / detail->step + SAME) + 1.0, due = next * detail->step - detail->clock;
    const int on_grid = left > due - SAME * detail->step;
    const double step = !on_grid ? left : fabs(due - detail->step) < SAME * detail->step ? detail->step : due;
    detail->clock = on_grid ? next * detail->step : detail->clock + left;
    return step;
}

void detail_outputs(train *self) {
    for (long long int n = 0; self->detail && self->detail->began && n < self->detail->count; ++n) {
        const detailed *one = &self->detail->of[n];
        self->output[OUT_SPEED][one->vehicle] = got(one, one->variable.axle_speed);
    }
}

void detail_forces(train *self) {
    for (long long int n = 0; self->detail && self->detail->began && n < self->detail->count; ++n) {
        const detailed *one = &self->detail->of[n];
        double sum = 0.0;
        for (int k = 0; k < one->variable.wheelsets; ++k) sum += got(one, one->variable.creep[k]);
        self->output[OUT_RAIL_FORCE][one->vehicle] = sum;
    }
}

/* Numbers of a kernel's sealed state. */
static long long int numbers_of(const detailed *one) {
    return (long long int)((one->call->state_size(one->machine) + sizeof(double) - 1) / sizeof(double));
}

long long int detail_numbers(const train *self) {
    long long int count = self->detail ? 2 : 0;
    for (long long int n = 0; self->detail && n < self->detail->count; ++n)
        count += 1 + 2 * DETAIL_WHEELSETS + numbers_of(&self->detail->of[n]);
    return count;
}

void detail_save(const train *self, double *numbers) {
    if (!self->detail) return;
    *numbers++ = self->detail->clock;
    *numbers++ = self->detail->began;
    for (long long int n = 0; n < self->detail->count; ++n) {
        const detailed *one = &self->detail->of[n];
        *numbers++ = one->origin;
        memcpy(numbers, one->brake, sizeof one->brake);
        memcpy(numbers += DETAIL_WHEELSETS, one->turning, sizeof one->turning);
        numbers += DETAIL_WHEELSETS + numbers_of(one);
        numbers[-1] = 0.0; /* all bytes of the last number are set */
        one->call->save(one->machine, numbers - numbers_of(one));
    }
}

void detail_load(train *self, const double *numbers) {
    if (!self->detail) return;
    self->detail->clock = *numbers++;
    self->detail->began = *numbers++ != 0.0;
    for (long long int n = 0; n < self->detail->count; ++n) {
        detailed *one = &self->detail->of[n];
        one->origin = *numbers++;
        memcpy(one->brake, numbers, sizeof one->brake);
        memcpy(one->turning, numbers += DETAIL_WHEELSETS, sizeof one->turning);
        (void)one->call->restore(one->machine, numbers += DETAIL_WHEELSETS, one->call->state_size(one->machine));
        numbers += numbers_of(one);
    }
}

void train_detail_step(train *self, double step) {
    if (self->detail) self->detail->step = step;
}

long long int train_detail_failed(const train *self) { return self->detail ? self->detail->failed : -1; }

double *train_detail_brake(train *self, long long int vehicle) {
    detailed *one = detailed_at(self, vehicle);
    return one ? one->brake : NULL;
}

const double *train_detail_turning(const train *self, long long int vehicle) {
    const detailed *one = detailed_at(self, vehicle);
    return one ? one->turning : NULL;
}
