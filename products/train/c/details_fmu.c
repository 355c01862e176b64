/* details_fmu.h with the kernel of the vehicles in the same binary. The file details.bin begins with the number of vehicles and
 * the step of the train [s]. Each vehicle has its number from 0 and the numbers of its `detail_variables`. The variables of
 * initial_speed and of the files of line and profiles follow; -1: no file. Then come pairs of variable and start value after their
 * count, and outputs after theirs. */
#include "details_fmu.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "arrays.h"
#include "detail.h"
#include "kernel.h"

enum { PATH = 4096 };

typedef struct {
    long long int vehicle, starts, outputs;
    int speed, line, profile;
    kernel *machine;
    detail_variables variable;
    const double *start, *output;
} built;

struct fmu_details {
    double *numbers;
    long long int count;
    unsigned long long mark;
    built *of;
    char folder[PATH], problem[MESSAGE_SIZE];
};

static const detail_functions CALL = {kernel_set,        kernel_get,  kernel_step,   kernel_time,
                                      kernel_state_size, kernel_save, kernel_restore};

/* Numbers that are read one after the other; `left` is below 0 beyond their end. */
typedef struct {
    const double *at;
    long long int left;
} cursor;

static const double *several(cursor *from, long long int count) {
    const double *found = from->at;
    from->left = count < 0 || count > from->left ? -1 : from->left - count;
    if (from->left >= 0) from->at += count;
    return from->left >= 0 ? found : NULL;
}

static double next(cursor *from) {
    const double *found = several(from, 1);
    return found && fabs(*found) < 1e9 ? *found : -1.0;
}

static void read_variables(cursor *from, detail_variables *to) {
    int *single[] = {&to->wheelsets, &to->front, &to->rear,       &to->place,
                     &to->speed,     &to->pitch, &to->pitch_rate, &to->axle_speed};
    int *each[] = {to->brake, to->traction, to->friction, to->turning, to->creep};
    for (size_t n = 0; n < sizeof single / sizeof *single; ++n) *single[n] = (int)next(from);
    if (to->wheelsets < 1 || to->wheelsets > DETAIL_WHEELSETS) from->left = -1;
    for (size_t n = 0; n < sizeof each / sizeof *each; ++n)
        for (int k = 0; k < to->wheelsets && from->left >= 0; ++k) each[n][k] = (int)next(from);
    to->radius = next(from);
    const double *height = several(from, 1);
    to->height = height ? *height : 0.0;
}

static int read_built(cursor *from, built *to) {
    to->vehicle = (long long int)next(from);
    read_variables(from, &to->variable);
    to->speed = (int)next(from);
    to->line = (int)next(from);
    to->profile = (int)next(from);
    to->starts = (long long int)next(from);
    to->start = several(from, 2 * to->starts);
    to->outputs = (long long int)next(from);
    to->output = several(from, to->outputs);
    return from->left >= 0 && to->vehicle >= 0;
}

void details_free(fmu_details *self) {
    for (long long int n = 0; self && self->of && n < self->count; ++n) kernel_free(self->of[n].machine);
    if (!self) return;
    free(self->of);
    free(self->numbers);
    free(self);
}

static kernel_status set_file(const fmu_details *self, const built *one, int variable, const char *name) {
    char path[PATH + 64];
    print_text(path, sizeof path, "%s/%s_%lld.csv", self->folder, name, one->vehicle + 1);
    return variable < 0 ? KERNEL_OK : kernel_set_text(one->machine, variable, path);
}

/* Gives a kernel its files; a saved state needs them in an instance that was never initialised. */
static kernel_status set_files(const fmu_details *self, const built *one) {
    const kernel_status status = set_file(self, one, one->line, "line");
    return status <= KERNEL_WARNING ? set_file(self, one, one->profile, "profile") : status;
}

static int make(fmu_details *self, const char *folder, size_t count, train *own) {
    strcpy(self->folder, folder);
    cursor from = {self->numbers, (long long int)count};
    const double vehicles = next(&from), step = next(&from);
    if (!(vehicles >= 1.0 && vehicles < (double)count)) return 0;
    self->of = (built *)calloc((size_t)vehicles, sizeof *self->of);
    for (self->count = 0; self->of && self->count < (long long int)vehicles; ++self->count) {
        built *one = &self->of[self->count];
        if (!read_built(&from, one)) return 0;
        one->machine = kernel_create();
        if (!one->machine || !train_detail(own, one->vehicle, one->machine, &CALL, &one->variable)) return 0;
        (void)set_files(self, one); /* a run refuses what is wrong with them */
    }
    train_detail_step(own, step);
    return self->of != NULL && step > 0.0;
}

fmu_details *details_create(const char *folder, train *own, char problem[MESSAGE_SIZE]) {
    fmu_details *self = (fmu_details *)calloc(1, sizeof *self);
    size_t count = 0;
    if (self) self->numbers = arrays_read(folder, "details.bin", &count, problem);
    if (self && self->numbers && strlen(folder) < PATH - 64 && make(self, folder, count, own)) {
        self->mark = arrays_mark_of(self->numbers, count);
        return self;
    }
    if (!*problem) print_text(problem, MESSAGE_SIZE, "details.bin must be that of this FMU. Build the FMU again.");
    details_free(self);
    return NULL;
}

/* Adds a kernel's messages, each after its vehicle. */
static void hear(const built *one, char problem[MESSAGE_SIZE]) {
    kernel_sentence heard;
    while (kernel_hear(one->machine, &heard)) {
        const size_t length = strlen(problem);
        print_text(problem + length, MESSAGE_SIZE - length, "%sVehicle %lld: %s", length ? " " : "", one->vehicle + 1,
                   heard.text);
    }
}

static kernel_status start(const fmu_details *self, const built *one, double time, double speed) {
    kernel_status worst = KERNEL_OK, status;
    kernel_reset(one->machine);
    for (long long int n = 0; n < one->starts && worst <= KERNEL_WARNING; ++n) {
        status = kernel_set(one->machine, (int)one->start[2 * n], one->start[2 * n + 1]);
        worst = status > worst ? status : worst;
    }
    if (worst <= KERNEL_WARNING) worst = kernel_set(one->machine, one->speed, speed);
    if (worst <= KERNEL_WARNING) worst = set_files(self, one);
    return worst <= KERNEL_WARNING ? kernel_initialise(one->machine, time) : worst;
}

void details_start(fmu_details *self, train *own, double time, double speed, double distance) {
    *self->problem = '\0';
    for (long long int n = 0; n < self->count; ++n) {
        const built *one = &self->of[n];
        if (one->line >= 0 && distance != 0.0)
            print_text(self->problem, MESSAGE_SIZE,
                       "start_distance must be 0 m with vehicles in detail on a line; got %g m. Build the FMU with a line that "
                       "begins elsewhere.",
                       distance);
        else if (start(self, one, time, speed) > KERNEL_WARNING) hear(one, self->problem);
        if (*self->problem) return;
    }
    train_detail_begin(own);
}

int details_refused(const fmu_details *self, char problem[MESSAGE_SIZE]) {
    if (!self || !*self->problem) return 0;
    strcpy(problem, self->problem);
    return 1;
}

void details_outputs(const fmu_details *self, double *values) {
    for (long long int n = 0; self && n < self->count; ++n)
        for (long long int k = 0; k < self->of[n].outputs; ++k, ++values)
            if (kernel_state_count(self->of[n].machine))
                (void)kernel_get(self->of[n].machine, (int)self->of[n].output[k], values);
}

unsigned long long details_mark(const fmu_details *self) { return self ? self->mark : 0; }

void details_hear(fmu_details *self, char problem[MESSAGE_SIZE]) {
    for (long long int n = 0; self && n < self->count; ++n) hear(&self->of[n], problem);
}
