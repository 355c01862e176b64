/* Sensors, controllers, valves and scores of many machines: rig.h. */
#include "rig.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "wheel_slide.h"

/* A kernel_status above this: the step failed, or the run has ended by itself. */
#define WORKS 1

/* One run: its sensors are `wheelsets` long, its controller's memory `size`. */
typedef struct {
    long long int samples;
    double end_speed, speed, lagged, smooth; /* the last speed [m/s], the acceleration behind one lag and two [m/s2] */
    bool asks; /* whether a controller at the desk is to answer what was seen */
    encoder *sensor;
    rig_wheelset *wheelset;
    double *seen, *locked, *skid, *pressure, *vented, *error; /* one array; locked, vented: samples in a row */
    int *valve;
    void *memory;
} rig_run;

struct rig {
    rig_settings settings;
    rig_controller controller;
    rig_desk desk;
    long long int rows;
    rig_run *run;
    rig_score *score;
    rig_notes notes;
};

static void *room(size_t count, size_t size) { return calloc(count ? count : 1, size ? size : 1); }

rig *rig_create(long long int rows, const rig_settings *settings, const rig_controller *controller, const rig_desk *desk) {
    rig *self = settings->wheelsets <= RIG_MOST ? (rig *)room(1, sizeof *self) : NULL;
    if (!self) return NULL;
    self->settings = *settings;
    self->controller = *controller;
    self->desk = *desk;
    self->rows = rows;
    self->run = (rig_run *)room((size_t)rows, sizeof *self->run);
    self->score = (rig_score *)room((size_t)rows, sizeof *self->score);
    const size_t n = (size_t)settings->wheelsets;
    bool whole = self->run && self->score;
    for (long long int row = 0; whole && row < rows; ++row) {
        rig_run *one = &self->run[row];
        one->sensor = (encoder *)room(n, sizeof *one->sensor);
        one->wheelset = (rig_wheelset *)room(n, sizeof *one->wheelset);
        one->seen = (double *)room(n * (size_t)(5 + settings->encoder.pulses), sizeof(double));
        one->valve = (int *)room(n, sizeof(int));
        one->memory = room(1, guarded_bytes(controller));
        whole = one->sensor && one->wheelset && one->seen && one->valve && one->memory;
        if (!whole) break;
        one->locked = one->seen + n;
        one->skid = one->locked + n;
        one->pressure = one->skid + n;
        one->vented = one->pressure + n;
        one->error = one->vented + n;
    }
    if (whole) return self;
    rig_free(self);
    return NULL;
}

void rig_free(rig *self) {
    for (long long int row = 0; self && self->run && row < self->rows; ++row) {
        rig_run *one = &self->run[row];
        free(one->sensor);
        free(one->wheelset);
        free(one->seen);
        free(one->valve);
        free(one->memory);
    }
    if (!self) return;
    free(self->run);
    free(self->score);
    free(self);
}

static void gone_beyond(rig *self, long long int row) {
    rig_give_up(self, row);
    self->score[row].valve = RIG_BEYOND;
}

void rig_begin(rig *self, long long int row, double end_speed, const double *error, const rig_wheelset *wheelset) {
    const rig_settings *s = &self->settings;
    rig_run *one = &self->run[row];
    const size_t n = (size_t)s->wheelsets, pulses = (size_t)s->encoder.pulses;
    one->samples = 0;
    one->end_speed = end_speed;
    one->speed = one->lagged = one->smooth = 0.0;
    one->asks = false;
    memcpy(one->wheelset, wheelset, n * sizeof *wheelset);
    if (error) memcpy(one->error, error, n * pulses * sizeof(double));
    for (size_t i = 0; i < n; ++i) {
        encoder_begin(&one->sensor[i], error ? one->error + i * pulses : NULL, wheelset[i].phase);
        one->locked[i] = one->skid[i] = one->pressure[i] = one->vented[i] = one->seen[i] = 0.0;
        one->valve[i] = WHEEL_SLIDE_APPLY;
    }
    if (self->notes.every) self->notes.count[row] = 0;
    memset(&self->score[row], 0, sizeof self->score[row]);
    self->score[row].failed_at = NAN;
    self->score[row].reservoir = s->reservoir ? INFINITY : 0.0;
    if (!self->controller.step) return;
    if (!guarded_start(&self->controller, one->memory, s->wheelsets, s->period)) gone_beyond(self, row);
}

/* Number of outputs of a vehicle. */
static size_t width(const rig_settings *s) { return (size_t)(2 + 5 * s->wheelsets + (s->reservoir ? 2 : 0)); }

const rig_score *rig_scores(const rig *self) { return self->score; }

void rig_write_down(rig *self, const rig_notes *notes) { self->notes = *notes; }

/* Records a sample if it is due. */
static void note(rig *self, long long int row, double time, const double *outputs) {
    const rig_notes *notes = &self->notes;
    const rig_run *one = &self->run[row];
    const int n = self->settings.wheelsets;
    if (!notes->every || notes->count[row] == notes->room) return;
    if (one->samples % notes->every && self->score[row].state == RIG_RUNS) return;
    double *to = notes->sample + (row * notes->room + notes->count[row]++) * (3 + 6 * n);
    to[0] = time;
    to[1] = outputs[0];
    to[2] = outputs[1];
    for (int i = 0; i < n; ++i) {
        to[3 + i] = outputs[2 + n + i];
        to[3 + n + i] = one->seen[i];
        to[3 + 2 * n + i] = outputs[2 + 2 * n + i];
        to[3 + 3 * n + i] = one->valve[i];
        to[3 + 4 * n + i] = outputs[2 + 3 * n + i];
        to[3 + 5 * n + i] = outputs[2 + 4 * n + i];
    }
}

/* Filters the acceleration since the last sample by two lags of jerk_time, and scores the jerk of the filtered one. */
static void feel(const rig_settings *s, rig_run *one, rig_score *score, double speed) {
    const double slope = one->samples ? (speed - one->speed) / s->period : 0.0;
    one->lagged += (slope - one->lagged) * s->period / (s->jerk_time + s->period);
    const double jerk = (one->lagged - one->smooth) / (s->jerk_time + s->period);
    one->smooth += jerk * s->period;
    one->speed = speed;
    if (speed > s->check_above) score->jerk = fmax(score->jerk, fabs(jerk));
}

/* Adds a sample to the score of a run. */
static void judge(rig *self, long long int row, double time, const double *outputs) {
    const rig_settings *s = &self->settings;
    const int n = s->wheelsets;
    const double speed = outputs[0], *omega = outputs + 2 + n, *pressure = omega + n, *creep = pressure + n,
                 *air = creep + 2 * n;
    rig_run *one = &self->run[row];
    rig_score *score = &self->score[row];
    bool good = true;
    for (int i = 0; i < n; ++i) {
        const bool slides = s->driven ? s->radius * omega[i] > 2.0 * speed : omega[i] == 0.0;
        one->locked[i] = slides && speed > s->lock_above ? one->locked[i] + 1.0 : 0.0;
        score->longest_lock = fmax(score->longest_lock, one->locked[i] * s->period);
        one->skid[i] = omega[i] == 0.0 ? one->skid[i] + speed * s->period : 0.0;
        score->longest_skid = fmax(score->longest_skid, one->skid[i]);
        score->sliding[i] += fabs(creep[i] * (speed - s->radius * omega[i])) * s->period;
        score->filled += fmax(pressure[i] - one->pressure[i], 0.0);
        one->pressure[i] = pressure[i];
        const double slip = 1.0 - s->radius * omega[i] / fmax(speed, 1e-9);
        good &= (s->driven ? -slip : slip) <= s->band;
    }
    if (s->reservoir) {
        score->taken = air[0];
        score->reservoir = fmin(score->reservoir, air[1]);
    }
    feel(s, one, score, speed);
    if (time > s->brake_start && speed > s->check_above) {
        score->checked += 1.0;
        score->band += good;
    }
    score->time = time;
    score->speed = speed;
    score->distance = outputs[1];
    if (time > s->brake_start && (s->driven ? speed >= one->end_speed : speed < one->end_speed)) score->state = RIG_DONE;
    else if (time >= s->longest) score->state = RIG_TOO_LONG;
}

/* Reading of a wheelset's sensor at a time: the circumferential speed of its wheels, unless the sensor fails [m/s]. */
static double seen(const rig_settings *s, const rig_run *one, int i, double time, double reading) {
    const rig_wheelset *of = &one->wheelset[i];
    const double speed = s->radius * of->radius * reading;
    const int fails = time >= of->sensor_from ? of->sensor : SENSOR_WORKS;
    return fails == SENSOR_STUCK ? one->seen[i] : fails == SENSOR_ZERO ? 0.0 : fails == SENSOR_DOUBLED ? 2.0 * speed : speed;
}

/* Samples a row; returns true if its run continues after this sample. */
static bool sample(rig *self, long long int row, int status, const double *outputs, double *wheel_speed) {
    const rig_settings *s = &self->settings;
    rig_run *one = &self->run[row];
    if (self->score[row].state == RIG_RUNS && status > WORKS) self->score[row].state = RIG_LOST;
    if (self->score[row].state != RIG_RUNS) return false;
    const double time = (double)one->samples * s->period;
    for (int i = 0; i < s->wheelsets; ++i)
        wheel_speed[i] = one->seen[i] = seen(s, one, i, time, encoder_read(&one->sensor[i], &s->encoder, time, outputs[2 + i]));
    judge(self, row, time, outputs);
    note(self, row, time, outputs);
    return self->score[row].state == RIG_RUNS;
}

/* Sets the inputs of a row's vehicle at the time of the last sample, and lets it continue. */
static void set(rig *self, long long int row, double *inputs) {
    const rig_settings *s = &self->settings;
    rig_run *one = &self->run[row];
    rig_score *score = &self->score[row];
    const bool demanded = (double)one->samples * s->period >= s->brake_start;
    for (int i = 0; i < s->wheelsets; ++i) {
        inputs[i] = demanded ? s->demand : 0.0;
        inputs[s->wheelsets + i] = one->valve[i];
        score->commands += one->valve[i] != WHEEL_SLIDE_APPLY;
        one->vented[i] = one->valve[i] == WHEEL_SLIDE_VENT ? one->vented[i] + 1.0 : 0.0;
        score->longest_vent = fmax(score->longest_vent, one->vented[i] * s->period);
    }
    ++one->samples;
}

/* Takes the answer of a controller, or gives the controller up; valves that stick stay in their position. */
static void take(rig *self, long long int row, const int *valve) {
    rig_run *one = &self->run[row];
    rig_score *score = &self->score[row];
    if (!isnan(score->failed_at)) return;
    for (int i = 0; i < self->settings.wheelsets; ++i)
        if (valve[i] < WHEEL_SLIDE_APPLY || valve[i] > WHEEL_SLIDE_VENT) {
            score->valve = i;
            score->answer = valve[i];
            rig_give_up(self, row);
            return;
        }
    const double time = (double)one->samples * self->settings.period;
    for (int i = 0; i < self->settings.wheelsets; ++i) {
        const rig_wheelset *of = &one->wheelset[i];
        if (!(of->valve_sticks && time >= of->valve_from)) one->valve[i] = valve[i];
    }
}

void rig_give_up(rig *self, long long int row) {
    rig_run *one = &self->run[row];
    if (!isnan(self->score[row].failed_at)) return;
    self->score[row].failed_at = (double)one->samples * self->settings.period;
    for (int i = 0; i < self->settings.wheelsets; ++i) one->valve[i] = WHEEL_SLIDE_APPLY;
}

void rig_sample(rig *self, long long int row, int status, const double *outputs) {
    rig_run *one = &self->run[row];
    self->desk.time[row] = (double)one->samples * self->settings.period;
    one->asks = sample(self, row, status, outputs, self->desk.wheel_speed + row * self->settings.wheelsets);
}

bool rig_take_or_sample(void *context, long long int first, long long int count, const int *status, const double *outputs,
                        double *inputs) {
    rig *self = (rig *)context;
    const int n = self->settings.wheelsets;
    bool any = false;
    for (long long int i = 0; i < count; ++i) {
        const long long int row = first + i;
        if (!self->run[row].asks) continue;
        self->run[row].asks = false;
        take(self, row, self->desk.valve + row * n);
        set(self, row, inputs + i * 2 * n);
        any = true;
    }
    for (long long int i = 0; i < count && !any; ++i)
        if (self->score[first + i].state == RIG_RUNS)
            rig_sample(self, first + i, status[i], outputs + (size_t)i * width(&self->settings));
    return any;
}

bool rig_between(void *context, long long int first, long long int count, const int *status, const double *outputs,
                 double *inputs) {
    rig *self = (rig *)context;
    const int n = self->settings.wheelsets;
    bool any = false;
    for (long long int i = 0; i < count; ++i) {
        const long long int row = first + i;
        double wheel_speed[RIG_MOST];
        int valve[RIG_MOST];
        if (!sample(self, row, status[i], outputs + (size_t)i * width(&self->settings), wheel_speed)) continue;
        memcpy(valve, self->run[row].valve, (size_t)n * sizeof *valve);
        if (isnan(self->score[row].failed_at) && self->controller.step) {
            const double time = (double)self->run[row].samples * self->settings.period;
            if (guarded_step(&self->controller, self->run[row].memory, n, time, wheel_speed, valve)) take(self, row, valve);
            else gone_beyond(self, row);
        }
        set(self, row, inputs + i * 2 * n);
        any = true;
    }
    return any;
}
