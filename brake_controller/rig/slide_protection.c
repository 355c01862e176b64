/* The built-in wheel-slide protection: slide_protection.h.
 *
 * It keeps the slip of each wheelset in a band around that of the best adhesion, once there is evidence of sliding.
 *
 * Without evidence the reference speed is that of the fastest wheel, at any deceleration that rolling wheels reach on any
 * rail, and no valve leaves "apply". Evidence is a wheel that falls below the reference: it disagrees with another wheel, or
 * all slow faster than any rail allows. After evidence the reference falls at the last deceleration of the bogie. A wheelset
 * is released until it rolls and shows the true speed: at once the slowest, later, from time to time, the fastest. The
 * evidence ends if no wheel has gained speed since the last such release. Braked wheels that roll never gain speed.
 *
 * A wheel is braked until its sensor has shown a speed for a while, and so are all below the slowest reference. If a sensor
 * shows a reading that no wheel can produce, its wheel gets the commands of the others until it agrees with them again.
 *
 * A reading that is not finite is invalid: the sensor is rejected, and its previous reading remains. */
#include "slide_protection.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

/* Acceleration below which a released wheel has caught up with the bogie, and above which it speeds up [m/s2]. */
static const double ROLLING = 0.3, SPEEDING = 0.6;
/* Gain of speed by which a wheel is known to have slid, as a share of its speed. */
static const double GAIN = 0.02;
/* Share of the speed by which all wheels fall below the limit of any rail if they slide together. */
static const double TOGETHER = 0.02;
/* Times of venting after which a wheel is treated as rolling, if it was seen to speed up and if not [s]. */
static const double SHORTEST_RELEASE = 0.25, LONGEST_RELEASE = 0.8;
/* Time of braking without a command after which the wheels may show that the bogie slows faster than before [s]. */
static const double FREELY_BRAKED = 0.3;
/* Least time between two true speeds for a deceleration [s], and least valid deceleration [m/s2]. */
static const double SHORTEST_BETWEEN = 0.5, LEAST_DECELERATION = 0.1;
/* Time for which a new sensor is only observed. Time between stored speeds while nothing slides. Time from the first true
 * speed of a slide to the second [s]. */
static const double SETTLING = 0.5, KEEPING = 1.0, SECOND_SYNCHRONISING = 1.5;
/* Limits for the rejection of a sensor. Change of the largest of the RECENT last readings between two samples [m/s], and
 * its increase for each second between them [m/s2]. The strongest brake stops a wheel at some 100 m/s2, and a late tooth
 * appears as low speed in only a few consecutive samples. */
enum { RECENT = 5 };
static const double JUMP = 4.0, JUMPING = 150.0;
/* Time for which a reading stays bit-identical [s], while others change by more than STAYS [m/s]. */
static const double STAYING = 0.3, STAYS = 0.5;
/* Time for which others have turned [s], and faster than this [m/s], while a sensor has shown 0. */
static const double BLIND = 1.0, BLIND_ABOVE = 3.0;
/* Share of the speed, and time [s], for which a sensor must agree with the others to be accepted again. */
static const double AGREES = 0.05, AGREEING = 2.0;

enum { APPLY = WHEEL_SLIDE_APPLY, HOLD = WHEEL_SLIDE_HOLD, VENT = WHEEL_SLIDE_VENT, NOBODY = -1 };

/* State of a wheelset: filtered speeds [m/s] and slopes [m/s2]; times [s] of events, each valid if the flag of the event is
 * set. */
typedef struct {
    double reading, speed, acceleration, calm_speed, calm_acceleration, lowest;
    double turns_since, vents_since, blocked_until;
    /* The last readings; time of the last change of the reading, and the fastest other wheel then; time since which a rejected
     * sensor agrees with the others. */
    double recent[RECENT], changed_at, others, agrees_since;
    int readings;
    bool turns, vents, speeds_up, believed, agrees;
} wheel;

typedef struct {
    slide_thresholds thresholds;
    double time, reference, deceleration, evident_at, acted_at;
    double synchronised_at, synchronised_speed, kept_at, kept_speed;
    int wheelsets, synchronised, released;
    bool begun, evident, gained, any_believed;
    wheel wheels[];
} protection;

static double larger(double one, double other) { return other > one ? other : one; }

static double smaller(double one, double other) { return other < one ? other : one; }

static double largest_of(const double *numbers, int count) {
    double found = numbers[0];
    for (int i = 1; i < count; ++i) found = larger(found, numbers[i]);
    return found;
}

/* True if a wheel is used: its sensor is accepted, or all are rejected. */
static bool is_seen(const protection *self, const wheel *one) { return one->believed || !self->any_believed; }

/* The number of the fastest or of the slowest wheel that is used. */
static int chosen(const protection *self, bool fastest) {
    int found = NOBODY;
    for (int i = 0; i < self->wheelsets; ++i) {
        const double speed = self->wheels[i].calm_speed;
        if (!is_seen(self, &self->wheels[i])) continue;
        if (found == NOBODY || (fastest ? speed > self->wheels[found].calm_speed : speed < self->wheels[found].calm_speed))
            found = i;
    }
    return found;
}

/* True if a sensor has shown a speed for longer than SETTLING. */
static bool is_judged(const protection *self, const wheel *one) {
    return one->turns && self->time - one->turns_since > SETTLING;
}

/* Accepts a sensor again that agrees with the others for a while, and changes. */
static void agree(const protection *self, wheel *one, double speed, double others) {
    if (speed == one->reading || fabs(one->calm_speed - others) > AGREES * others) {
        one->agrees = false;
    } else if (!one->agrees) {
        one->agrees = true;
        one->agrees_since = self->time;
    } else if (self->time - one->agrees_since > AGREEING) {
        one->believed = true;
        one->readings = 0;
    }
}

/* True if a sensor has shown 0 while others have turned for a while. */
static bool is_blind(const protection *self, double others) {
    const wheel *first = NULL;
    for (const wheel *one = self->wheels; one < self->wheels + self->wheelsets; ++one)
        if (one->turns && (!first || one->turns_since < first->turns_since)) first = one;
    return first && self->time - first->turns_since > BLIND && others > BLIND_ABOVE;
}

/* True if the largest of the recent readings changes more than a wheel can; stores the reading. */
static bool jumps(wheel *one, double speed, double size) {
    const bool whole = one->readings == RECENT;
    const double before = whole ? largest_of(one->recent, RECENT) : 0.0;
    if (whole) memmove(one->recent, one->recent + 1, (RECENT - 1) * sizeof *one->recent);
    else ++one->readings;
    one->recent[one->readings - 1] = speed;
    return whole && fabs(largest_of(one->recent, RECENT) - before) > JUMP + JUMPING * size;
}

/* Rejects a sensor from now on. */
static void lose(protection *self, wheel *one, double size) {
    one->believed = one->agrees = false;
    self->released = NOBODY;
    /* Evidence that came while the sensor failed was its own. */
    self->evident = self->evident && self->time - self->evident_at > (RECENT + 0.5) * size;
}

/* Checks whether a sensor shows a reading that no wheel can produce: a jump, a constant while others change, 0. */
static void believe(protection *self, wheel *one, double speed, double size) {
    const wheel *fastest = NULL; /* of the other, accepted ones */
    for (const wheel *other = self->wheels; other < self->wheels + self->wheelsets; ++other)
        if (other != one && other->believed && (!fastest || other->calm_speed > fastest->calm_speed)) fastest = other;
    if (size == 0.0 || !fastest) return;
    const double others = fastest->calm_speed;
    if (!one->turns) {
        one->believed = !is_blind(self, others);
        return;
    }
    if (!one->believed) {
        agree(self, one, speed, others);
        return;
    }
    if (speed != one->reading || speed == 0.0 || !one->readings) {
        one->changed_at = self->time;
        one->others = others;
    }
    const bool stays = self->time - one->changed_at > STAYING && fabs(others - one->others) > STAYS;
    if (jumps(one, speed, size) || stays) lose(self, one, size);
}

/* Takes a reading; a wheel whose sensor has shown only 0 starts with the first other reading. */
static void filter(const protection *self, wheel *one, double speed, double size) {
    const slide_thresholds *t = &self->thresholds;
    if (!one->turns) {
        one->turns = speed > 0.0;
        one->turns_since = self->time;
        one->speed = one->calm_speed = one->lowest = speed;
    } else if (size > 0.0) {
        double change = (speed - one->speed) * size / (size + t->filter_time);
        one->speed += change;
        one->acceleration += (change / size - one->acceleration) * size / (size + t->slope_time);
        const double share = size / (size + t->calm_time);
        /* A late tooth appears as low speed in one sample; a wheel that slows is slow in the next one too. */
        change = (larger(speed, one->reading) - one->calm_speed) * share;
        one->calm_speed += change;
        one->calm_acceleration += (change / size - one->calm_acceleration) * share;
    }
    one->reading = speed;
}

/* A deceleration limited to the possible range [m/s2]. */
static double possible(const protection *self, double deceleration) {
    return smaller(larger(deceleration, LEAST_DECELERATION), self->thresholds.largest_deceleration);
}

/* Sets the mean deceleration since the last true speed. */
static void measure(protection *self, double speed) {
    const double elapsed = larger(self->time - self->synchronised_at, SHORTEST_BETWEEN);
    self->deceleration = possible(self, (self->synchronised_speed - speed) / elapsed);
}

/* Stores a speed every KEEPING seconds; the one before the last was true though a slide may have begun since. */
static void keep(protection *self, double speed) {
    const bool known = self->kept_speed > 0.0;
    if (known && self->time - self->kept_at < KEEPING) return;
    self->synchronised_at = known ? self->kept_at : self->time;
    self->synchronised_speed = known ? self->kept_speed : speed;
    self->kept_at = self->time;
    self->kept_speed = speed;
}

/* No wheel has slid: the reference is the fastest one's speed, and falls no faster than any rail allows. */
static void roll(protection *self, double size, const wheel *fastest) {
    const slide_thresholds *t = &self->thresholds;
    self->reference = larger(fastest->calm_speed, self->reference - t->largest_deceleration * size);
    keep(self, self->reference);
    const double apart = larger(t->evident_slip * self->reference, t->least_evident_slip);
    const double together = larger(TOGETHER * self->reference, t->least_evident_slip);
    bool any = false;
    double most = 0.0, least = 0.0; /* by which a wheel is behind */
    for (const wheel *one = self->wheels; one < self->wheels + self->wheelsets; ++one) {
        if (!is_seen(self, one) || !is_judged(self, one)) continue;
        const double behind = self->reference - one->calm_speed;
        most = any ? larger(most, behind) : behind;
        least = any ? smaller(least, behind) : behind;
        any = true;
    }
    if (!any || !(most > apart || least > together)) return;
    self->evident = self->gained = true;
    self->evident_at = self->time;
    self->synchronised = 0;
    measure(self, self->reference);
}

/* The last deceleration of the bogie or, while all are braked freely, that of the fastest wheel [m/s2]. */
static double known_deceleration(const protection *self, const wheel *fastest) {
    if (self->time - self->acted_at < FREELY_BRAKED) return self->deceleration;
    return larger(self->deceleration, possible(self, -fastest->calm_acceleration));
}

/* The speed below which slips are measured in m/s [m/s]. */
static double slow(const protection *self) { return self->thresholds.least_slip / self->thresholds.upper_slip; }

/* Records that a wheel has gained speed since the last true speed, or since its release. */
static void find_gain(protection *self, wheel *one) {
    one->lowest = smaller(one->lowest, one->calm_speed);
    const double gain = GAIN * larger(one->calm_speed, slow(self));
    if (one->calm_acceleration > SPEEDING && one->calm_speed - one->lowest > gain) self->gained = one->speeds_up = true;
}

/* A vented wheel speeds up until it rolls; one that never slid is treated as rolling after a while. */
static bool has_caught_up(const protection *self, const wheel *one) {
    const double longest = one->speeds_up ? SHORTEST_RELEASE : LONGEST_RELEASE;
    return one->vents && one->calm_acceleration < ROLLING && self->time - one->vents_since > longest;
}

/* Takes the true speed, and from two of them the deceleration of the bogie. */
static void synchronise(protection *self, double speed) {
    if (self->synchronised == 0 || self->time - self->synchronised_at > SHORTEST_BETWEEN) {
        measure(self, speed);
        self->synchronised_at = self->kept_at = self->time;
        self->synchronised_speed = self->kept_speed = speed;
        ++self->synchronised;
        /* The first two are too close for wheels to slide in between; at low speed wheels lock before new evidence. */
        if (self->synchronised > 2 && speed > slow(self)) {
            self->evident = self->gained;
            self->gained = false;
        }
        for (int i = 0; i < self->wheelsets; ++i) self->wheels[i].lowest = self->wheels[i].calm_speed;
    }
    self->reference = speed;
    self->released = NOBODY;
}

/* Wheels slide: the reference falls at the last deceleration of the bogie, until a released wheel rolls. */
static void slide(protection *self, double size, const wheel *fastest) {
    const double falls = known_deceleration(self, fastest);
    const wheel *shows = NULL; /* the true speed */
    self->reference = larger(fastest->calm_speed, self->reference - falls * size);
    for (wheel *one = self->wheels; one < self->wheels + self->wheelsets; ++one) {
        if (!is_seen(self, one)) continue;
        find_gain(self, one);
        if (has_caught_up(self, one) && (!shows || one->calm_speed > shows->calm_speed)) shows = one;
    }
    if (shows) synchronise(self, shows->calm_speed);
    if (self->reference < self->thresholds.slowest) {
        self->evident = false;
        self->released = NOBODY;
    }
}

/* True if this wheelset is released to show the true speed: first one that slides. */
static bool is_released(protection *self, int number) {
    const double due = self->synchronised == 0   ? 0.0
                       : self->synchronised == 1 ? SECOND_SYNCHRONISING
                                                 : self->thresholds.synchronising_period;
    if (self->released == NOBODY && self->time - self->synchronised_at > due)
        self->released = chosen(self, self->synchronised > 0);
    return self->released == number;
}

/* Compares the slip to come, from the present one and its rate, with the band. */
static int by_slip(const protection *self, const wheel *one) {
    const slide_thresholds *t = &self->thresholds;
    const double scale = larger(self->reference, slow(self));
    if (scale == 0.0) return APPLY; /* all wheels stand */
    double slip = (self->reference - one->speed) / scale;
    slip += t->lead_time * (-self->deceleration - one->acceleration) / scale;
    return slip > t->upper_slip ? VENT : slip < t->lower_slip ? APPLY : HOLD;
}

static int command_of(protection *self, int number) {
    const slide_thresholds *t = &self->thresholds;
    wheel *one = &self->wheels[number];
    if (!(self->evident && is_judged(self, one)) || self->reference < t->slowest || self->time < one->blocked_until) {
        one->vents = false;
        return APPLY;
    }
    const int command = is_released(self, number) ? VENT : by_slip(self, one);
    if (command != APPLY) self->acted_at = self->time;
    if (command != VENT) {
        one->vents = false;
    } else if (!one->vents) {
        one->vents = true;
        one->vents_since = self->time;
        one->speeds_up = false;
        one->lowest = one->calm_speed;
    } else if (self->time - one->vents_since > t->watchdog) {
        one->blocked_until = self->time + t->watchdog;
        return APPLY;
    }
    return command;
}

size_t wheel_slide_size(int wheelsets) { return sizeof(protection) + (size_t)wheelsets * sizeof(wheel); }

void wheel_slide_start(void *memory, int wheelsets, double period) {
    protection *self = memory;
    (void)period;
    self->thresholds = (slide_thresholds)SLIDE_COMMON;
    self->wheelsets = wheelsets;
    self->evident_at = self->acted_at = -INFINITY;
    self->released = NOBODY;
    for (int i = 0; i < wheelsets; ++i) {
        self->wheels[i].believed = true;
        self->wheels[i].blocked_until = self->wheels[i].changed_at = -INFINITY;
    }
}

void wheel_slide_step(void *memory, double time, const double *wheel_speed, int *valve) {
    protection *self = memory;
    const double size = self->begun ? time - self->time : 0.0;
    self->begun = true;
    self->time = time;
    for (int i = 0; i < self->wheelsets; ++i) {
        wheel *one = &self->wheels[i];
        if (!isfinite(wheel_speed[i])) {
            if (one->believed) lose(self, one, size);
            one->agrees = false;
            continue;
        }
        believe(self, one, wheel_speed[i], size);
        filter(self, one, wheel_speed[i], size);
    }
    self->any_believed = false;
    for (int i = 0; i < self->wheelsets; ++i) self->any_believed |= self->wheels[i].believed;
    const wheel *fastest = &self->wheels[chosen(self, true)];
    (self->evident ? slide : roll)(self, size, fastest);
    int most = APPLY;
    for (int i = 0; i < self->wheelsets; ++i) {
        if (!self->wheels[i].believed) continue;
        valve[i] = command_of(self, i);
        if (valve[i] > most) most = valve[i];
    }
    for (int i = 0; i < self->wheelsets; ++i)
        if (!self->wheels[i].believed) valve[i] = most;
}

void slide_set_thresholds(void *memory, const slide_thresholds *thresholds) {
    ((protection *)memory)->thresholds = *thresholds;
}

double slide_reference(const void *memory) { return ((const protection *)memory)->reference; }

int slide_believes(const void *memory, int wheelset) { return ((const protection *)memory)->wheels[wheelset].believed; }
