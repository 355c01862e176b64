/* Run the rig as instances do, with vehicles of prescribed motion; exit status 0 if every run ended. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "rig.h"
#include "wheel_slide.h"

enum { ROWS = 5, WHEELSETS = 16, SAMPLES = 4000, WIDTH = 2 + 5 * WHEELSETS + 2 };

static void start(void *memory, int wheelsets, double period) {
    (void)period;
    memcpy(memory, &wheelsets, sizeof wheelsets);
}
static void step(void *memory, double time, const double *speed, int *valve) {
    int wheelsets;
    memcpy(&wheelsets, memory, sizeof wheelsets);
    for (int i = 0; i < wheelsets; ++i) valve[i] = time > 15.0 && i == 3 ? 9 : speed[i] < 5.0;
}

/* Write the observations of a vehicle that decelerates by 1 m/s2 with sliding wheels. */
static void show(double time, int row, double *outputs) {
    const double speed = fmax(20.0 - row - time, 0.0);
    memset(outputs, 0, WIDTH * sizeof(double));
    outputs[0] = speed;
    outputs[1] = time;
    for (int i = 0; i < WHEELSETS; ++i) {
        outputs[2 + i] = 40.0 * time;
        outputs[2 + WHEELSETS + i] = i % 3 ? speed : 0.0;
        outputs[2 + 2 * WHEELSETS + i] = 1e5 * (1.0 + sin(time));
        outputs[2 + 3 * WHEELSETS + i] = -1e4;
    }
    outputs[WIDTH - 1] = 5e5 - time;
}

/* inside: the controller is in C; own: use the built-in wheel-slide protection. */
static int run(bool inside, bool own) {
    rig_settings settings = {WHEELSETS, 0.46, 5e-3, 1.0, 380e3, 300.0, 0.3, 0.25, 0.3, 3.0, 1, 0, {300, 0.03, 1e-6, 5.0}};
    rig_controller controller = {start, step, sizeof(int)};
    if (own) controller = (rig_controller){wheel_slide_start, wheel_slide_step, wheel_slide_size(WHEELSETS)};
    double time[ROWS], speed[ROWS * WHEELSETS], error[WHEELSETS * 300], *outputs = malloc(ROWS * WIDTH * sizeof(double));
    double inputs[ROWS * 2 * WHEELSETS], *sample = malloc(ROWS * 50 * (3 + 6 * WHEELSETS) * sizeof(double));
    int valve[ROWS * WHEELSETS] = {0}, status[ROWS] = {0}, ended = 0;
    long long int written[ROWS];
    rig_wheelset wheelset[WHEELSETS] = {0};
    for (int i = 0; i < WHEELSETS; ++i) wheelset[i] = (rig_wheelset){1.0 + 0.01 * i, 2.0, 3.0, 0.05 * i, i % 4, i % 2};
    for (int i = 0; i < WHEELSETS * 300; ++i) error[i] = 0.4 * sin(i);
    if (!inside) controller.step = NULL;
    rig_desk desk = {time, speed, valve};
    rig_notes notes = {20, 50, sample, written};
    settings.wheelsets = 17;
    if (rig_create(ROWS, &settings, &controller, &desk)) return 1;
    settings.wheelsets = WHEELSETS;
    rig *self = rig_create(ROWS, &settings, &controller, &desk);
    if (!self) return 2;
    rig_write_down(self, &notes);
    for (int row = 0; row < ROWS; ++row) {
        show(0.0, row, outputs + row * WIDTH);
        rig_begin(self, row, 0.02, row % 2 ? error : NULL, wheelset);
        if (!inside) rig_sample(self, row, 0, outputs + row * WIDTH);
    }
    for (int n = 0; n < SAMPLES; ++n) {
        for (int row = 0; row < ROWS; ++row) show(5e-3 * n, row, outputs + row * WIDTH);
        status[ROWS - 1] = n > 1000 ? 3 : 0; /* this run is lost on the way */
        if (inside) rig_between(self, 0, ROWS, status, outputs, inputs);
        else {
            valve[0] = n > 500 ? 5 : 2;
            rig_take_or_sample(self, 0, ROWS, status, outputs, inputs);
            rig_take_or_sample(self, 0, ROWS, status, outputs, inputs);
        }
    }
    for (int row = 0; row < ROWS; ++row) ended += rig_scores(self)[row].state != RIG_RUNS;
    const bool gave_up = own || !isnan(rig_scores(self)[0].failed_at);
    rig_free(self);
    rig_free(NULL);
    free(outputs);
    free(sample);
    return ended == ROWS && gave_up ? 0 : 3;
}

int main(void) { return run(true, false) + 10 * run(false, false) + 100 * run(true, true); }
