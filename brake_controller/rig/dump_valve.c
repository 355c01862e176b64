/* A simple wheel-slide protection with one dump valve a bogie, written from the description in Open Rails
 * (github.com/openrails/openrails, pull request 444 and AirSinglePipe.cs):
 *
 * - The dump valve of a bogie releases both wheelsets when their rotations differ by a set speed.
 * - It closes when the difference is small again, or while the slow wheelset speeds up faster than a set rate.
 * - After 7 s of continuous release it closes, and stays closed until the vehicle has stopped.
 *
 * The description gives no speeds and no rate: they are assumed. A difference is that to the fastest wheelset of the
 * vehicle. The valve is also disabled at low pressure in the brake pipe, which is not an input here. A run ends where the vehicle
 * stops, so a closed valve stays closed. */
#include <stdbool.h>

#include "wheel_slide.h"

/* Differences for opening and closing the valve [m/s], acceleration for closing it over READINGS steps [m/s2], and longest
 * continuous release [s]. */
static const double opens = 1.5, closes = 0.5, speeds_up = 5.0, longest = 7.0;

/* A bogie has two wheelsets; a vehicle has at most 16. */
enum { BOGIE = 2, MOST = 16, READINGS = 20 };

typedef struct {
    bool open, locked_out;
    int steps; /* with the valve open, in a row */
} dump_valve;

typedef struct {
    int wheelsets, seen;
    double period, reading[MOST][READINGS];
    dump_valve valve[MOST / BOGIE];
} protection;

size_t wheel_slide_size(int wheelsets) {
    (void)wheelsets;
    return sizeof(protection);
}

void wheel_slide_start(void *memory, int wheelsets, double period) {
    protection *self = (protection *)memory;
    self->wheelsets = wheelsets;
    self->period = period;
}

/* Acceleration of a wheelset over the last readings [m/s2]; 0 at the start. Its oldest reading is replaced. */
static double acceleration(protection *self, int i, double speed) {
    double *oldest = &self->reading[i][self->seen % READINGS];
    const double gain = self->seen < READINGS ? 0.0 : speed - *oldest;
    *oldest = speed;
    return gain / (READINGS * self->period);
}

/* Opens or closes the valve of a bogie from its largest difference and the acceleration of that wheelset. */
static void decide(const protection *self, dump_valve *one, double difference, double gains) {
    one->open = !one->locked_out && gains <= speeds_up && difference > (one->open ? closes : opens);
    one->steps = one->open ? one->steps + 1 : 0;
    if ((one->steps - 0.5) * self->period < longest) return;
    one->open = false;
    one->locked_out = true;
}

void wheel_slide_step(void *memory, double time, const double *wheel_speed, int *valve) {
    protection *self = (protection *)memory;
    double fastest = 0.0;
    (void)time;
    for (int i = 0; i < self->wheelsets; ++i)
        if (wheel_speed[i] > fastest) fastest = wheel_speed[i];
    for (int first = 0; first < self->wheelsets; first += BOGIE) {
        double difference = 0.0, gains = 0.0;
        dump_valve *one = &self->valve[first / BOGIE];
        for (int i = first; i < first + BOGIE && i < self->wheelsets; ++i) {
            const double gain = acceleration(self, i, wheel_speed[i]);
            if (fastest - wheel_speed[i] <= difference) continue;
            difference = fastest - wheel_speed[i];
            gains = gain;
        }
        decide(self, one, difference, gains);
        for (int i = first; i < first + BOGIE && i < self->wheelsets; ++i)
            valve[i] = one->open ? WHEEL_SLIDE_VENT : WHEEL_SLIDE_APPLY;
    }
    ++self->seen;
}
