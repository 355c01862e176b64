/* The built-in wheel-slide protection: slide_protection.h.
 *
 * It keeps each wheelset near the slip of the best adhesion, once there is evidence of sliding.
 *
 * state of the vehicle   reference speed                             commands
 * no evidence            fastest wheel; falls at most as fast as     all apply
 *                        rolling wheels on any rail
 * evidence               falls at the last deceleration of the       by slip; one wheelset at a time is released
 *                        vehicle, never below the fastest wheel
 *
 * Evidence begins with a wheel far below the reference, or with all below it. It ends when all wheels have been braked freely
 * for a while. Meanwhile two tests on each wheel correct reference and deceleration. A sliding wheel responds to its valve at
 * once, because only its own inertia resists. A rolling wheel moves the vehicle, and hardly responds.
 *   Vented, without response:  the wheel rolls. Its speed is that of the vehicle.
 *   Filled, without response:  the wheel is below its best slip. Its speed bounds that of the vehicle from both sides.
 * Pressures are not measured, so the response is compared with the action of the valves (TYPICAL numbers below).
 *
 * Command by slip: the slip to come is the present one plus its rate times a lead time. Its rate includes the action of the
 * valves that sensors do not show yet. Above a band: vent. Below it: apply. In it: hold, but after a while in which a slip
 * does not grow, the brake is applied for an instant: behind the best slip a slip grows.
 *
 * If a sensor shows a reading that no wheel can produce, its wheelset gets a share of the pressure of its neighbour, by
 * model. Sizes of the wheels, relative to each other, are learned while all roll unbraked. Errors of the teeth are measured
 * while nothing slides, and lengthen the filters. A reading that is not finite is invalid: the sensor is rejected, and its
 * previous reading remains. */
#include "slide_protection.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

/* Acceleration below which a released wheel may have caught up with the vehicle, and above which it speeds up [m/s2]. */
static const double ROLLING = 0.3, SPEEDING = 0.6;
/* Gain of speed by which a wheel is known to have slid [m/s], at most this share of its speed. */
static const double GAIN = 0.25, GAIN_SHARE = 0.1;
/* Share of the speed by which all wheels fall below the limit of any rail if they slide together. */
static const double TOGETHER = 0.02;
/* Evidence ends after this time of free braking, if no wheel has gained speed for the second time [s]. */
static const double FREE = 1.5, QUIET = 2.0;
/* Times of venting after which a wheel is treated as rolling, if it was seen to speed up and if not [s]. */
static const double SHORTEST_RELEASE = 0.25, LONGEST_RELEASE = 0.8;
/* Deceleration above which no vented wheel is treated as rolling [m/s2]. */
static const double SLIDING = 2.0;
/* Time of braking without a command after which the wheels may show that the vehicle slows faster than before [s]. */
static const double FREELY_BRAKED = 0.3;
/* Least time between two true speeds for a deceleration [s], and least valid deceleration [m/s2]. */
static const double SHORTEST_BETWEEN = 0.5, LEAST_DECELERATION = 0.1;
/* Time for which a new sensor is only observed. Time between stored speeds while nothing slides. Time from the first true
 * speed of a slide to the second [s]. */
static const double SETTLING = 0.5, KEEPING = 1.0, SECOND_SYNCHRONISING = 1.5;
/* Speed below which the band of slips becomes narrower, and speed from which it stays so [m/s]. */
static const double FULL_BAND = 8.0, SLOW = 3.0;

/* TYPICAL numbers of vehicles and cylinders. VENTED: acceleration that a sliding wheel gains in a second of venting, over the
 * deceleration of the vehicle [1/s]. It is the mass on a wheelset over its rotating mass, divided by the time in which a
 * cylinder empties. VENTED_MOST, VENTED_FIRST: largest and first deceleration for it [m/s2]. FILLED: acceleration that it
 * loses in a second of filling [m/s3]. LAG: time until sensors show it [s]. */
static const double VENTED = 40.0, VENTED_MOST = 1.0, VENTED_FIRST = 0.3, FILLED = 13.0, LAG = 0.1;
/* Share of the full pressure that a second of filling adds; share of its pressure that a second of venting takes [1/s]. */
static const double FILLING = 0.57, EMPTYING = 3.0;
/* Acceleration due to venting and due to filling without response after which a wheel does not slide [m/s2]. */
static const double UNMOVED_VENTED = 2.0, UNMOVED_FILLED = 2.0;
/* A smaller change of acceleration is not taken for a response [m/s2]. To it is added the response of the vehicle: a share of
 * that of a sliding wheel [1], up to a limit [m/s2]. VENT_SEEN: a share of LAG of venting ends the test of filling [1]. */
static const double UNMOVED = 0.7, OF_VEHICLE = 0.1, OF_VEHICLE_MOST = 0.5, VENT_SEEN = 0.1;
/* Faster than the vehicle by this, a wheel slides [m/s2]. */
static const double FASTER = 2.0;
/* Largest slip speed below the best slip [m/s], and largest mean error of a deceleration due to growing slip [m/s2]. */
static const double CREEP = 0.4, CREEPING = 0.35;
/* Difference to the reference up to which the tests believe a wheel: in m/s, and as a share of the reference. */
static const double NEAR = 0.8, NEAR_SHARE = 0.02;
/* Acceleration of a released wheel from which its pressure is held [m/s2]. */
static const double RELEASED = 1.5;
/* Steady slip: time, largest change of acceleration, and duration of the pulse that follows [s, m/s2, s]. */
static const double STEADY = 0.4, STEADY_CHANGE = 0.4, PULSE = 0.04;

/* Noise of a reading without effect [m/s]. For noise above it: growth of the times of filters, and the largest of both [s];
 * growth of a change of acceleration without response [1/s]; growth of the difference that is evidence [1]. Noise is measured
 * over a time [s], below an acceleration [m/s2]. */
static const double NOISELESS = 0.045, NOISE_TIME = 2.0, NOISE_FIT = 0.1, NOISE_CALM = 0.15;
static const double NOISE_CHANGE = 8.0, NOISE_EVIDENT = 5.0, NOISE_MEASURED = 0.5, NOISE_BELOW = 1.5;
/* Sizes of wheels: acceleration below which all roll unbraked [m/s2], least speed [m/s], time [s], largest correction [1]. */
static const double COASTING = 0.3, SIZE_ABOVE = 3.0, SIZE_TIME = 0.3, SIZE_MOST = 0.05;

/* Limits for the rejection of a sensor. Change of the largest of the RECENT last readings between two samples [m/s], and
 * its increase for each second between them [m/s2]. The strongest brake stops a wheel at some 100 m/s2, and a late tooth
 * appears as low speed in only a few consecutive samples: filters use the second largest of RECENT readings. */
enum { RECENT = 5 };
static const double JUMP = 4.0, JUMPING = 150.0;
/* Readings for the filters, and least time between two [s]: enough for the longest time of a filter. */
enum { KEPT = 80 };
static const double BETWEEN = 0.0045;
/* Time for which a reading stays bit-identical [s], while others change by more than STAYS [m/s]. */
static const double STAYING = 0.3, STAYS = 0.5;
/* Time for which others have turned [s], and faster than this [m/s], while a sensor has shown 0. */
static const double BLIND = 1.0, BLIND_ABOVE = 3.0;
/* Share of the speed, and time [s], for which a sensor must agree with the others to be accepted again. */
static const double AGREES = 0.05, AGREEING = 2.0;
/* A wheel without sensor: share of the pressure of its neighbour with its tolerance [1]. Time of venting at first [s]: it ends
 * a lock that nothing showed. */
static const double UNSEEN_SHARE = 0.7, UNSEEN_BAND = 0.03, UNSEEN_VENT = 0.4;

enum { APPLY = WHEEL_SLIDE_APPLY, HOLD = WHEEL_SLIDE_HOLD, VENT = WHEEL_SLIDE_VENT, NOBODY = -1 };

/* State of a wheelset: speeds [m/s] and slopes [m/s2] of lines through its readings; times [s] of events, each valid if the
 * flag of the event is set. */
typedef struct {
    double reading, speed, acceleration, calm_speed, calm_acceleration, lowest, noise, size;
    double turns_since, vents_since, blocked_until;
    /* Readings for the filters with their times, the newest at `newest`; the last ones, of which the second
     * largest is used. */
    double kept[KEPT], kept_at[KEPT], recent_kept[RECENT];
    int count, newest;
    /* The last readings; time of the last change of the reading, and the fastest other wheel then; time since which a rejected
     * sensor agrees with the others; time of its rejection. */
    double recent[RECENT], changed_at, others, agrees_since, lost_at;
    int readings;
    /* Shares of the last LAG of venting and filling; pressure by model [1]. */
    double venting, filling, pressure;
    /* Acceleration due to venting without response, and the least one meanwhile; acceleration due to filling, with time, speed
     * and acceleration at its begin [m/s2, s, m/s]. */
    double unmoved_vented, least_acceleration, unmoved_filled, unmoved_at, unmoved_speed, unmoved_acceleration;
    /* Begin of a steady slip with the acceleration then; end of the pulse. */
    double steady_at, steady_acceleration, pulse_until;
    bool turns, vents, speeds_up, believed, agrees;
} wheel;

/* State of the vehicle; before: its deceleration before the last true speed. */
typedef struct {
    slide_thresholds thresholds;
    double time, reference, deceleration, before, evident_at, acted_at, gained_at;
    double synchronised_at, synchronised_speed, kept_at, kept_speed;
    int wheelsets, synchronised, released;
    bool begun, evident, any_believed;
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
    one->lost_at = self->time;
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

/* The second largest of the last readings. */
static double second(wheel *one, double speed) {
    double sorted[RECENT];
    memmove(one->recent_kept + 1, one->recent_kept, (RECENT - 1) * sizeof *one->recent_kept);
    one->recent_kept[0] = speed;
    if (one->recent_kept[RECENT - 1] <= 0.0) return speed;
    for (int i = 0; i < RECENT; ++i) {
        int place = i;
        for (; place > 0 && sorted[place - 1] < one->recent_kept[i]; --place) sorted[place] = sorted[place - 1];
        sorted[place] = one->recent_kept[i];
    }
    return sorted[1];
}

/* Stores a reading for the filters, from the first speed on. */
static void store(const protection *self, wheel *one, double speed) {
    if (one->count ? self->time - one->kept_at[one->newest] < BETWEEN : speed <= 0.0) return;
    one->newest = one->count ? (one->newest + 1) % KEPT : 0;
    one->kept[one->newest] = second(one, speed);
    one->kept_at[one->newest] = self->time;
    if (one->count < KEPT) ++one->count;
}

/* The line of least squares through the readings of the last `lasts` seconds, at least three: its end and its slope. */
static void fit(const protection *self, const wheel *one, double lasts, double *end, double *slope) {
    double n = 0.0, t = 0.0, tt = 0.0, v = 0.0, tv = 0.0;
    for (int k = 0; k < one->count; ++k) {
        const int place = (one->newest - k + KEPT) % KEPT;
        const double at = one->kept_at[place] - self->time;
        if (at < -lasts && k > 2) break;
        n += 1.0;
        t += at;
        tt += at * at;
        v += one->kept[place];
        tv += at * one->kept[place];
    }
    const double spread = n * tt - t * t;
    *slope = spread > 0.0 ? (n * tv - t * v) / spread : 0.0;
    *end = (v - *slope * t) / n;
}

/* Noise of the readings above that without effect [m/s]. */
static double noise(const wheel *one) { return larger(0.0, one->noise - NOISELESS); }

/* Takes a reading; a wheel whose sensor has shown only 0 starts with the first other reading. */
static void filter(const protection *self, wheel *one, double speed, double size) {
    const slide_thresholds *t = &self->thresholds;
    store(self, one, speed);
    if (!one->turns) {
        one->turns = speed > 0.0;
        one->turns_since = self->time;
        one->speed = one->calm_speed = one->lowest = speed;
    } else if (size > 0.0) {
        if (!self->evident && fabs(one->calm_acceleration) < NOISE_BELOW)
            one->noise += (fabs(one->kept[one->newest] - one->calm_speed) - one->noise) * size / (size + NOISE_MEASURED);
        const double more = NOISE_TIME * noise(one);
        fit(self, one, t->fit_time + smaller(NOISE_FIT, more), &one->speed, &one->acceleration);
        fit(self, one, t->calm_time + smaller(NOISE_CALM, more), &one->calm_speed, &one->calm_acceleration);
    }
    one->reading = speed;
}

/* True if a wheel shows its size. */
static bool is_sized(const protection *self, const wheel *one) {
    return one->believed && is_judged(self, one) && one->calm_speed > SIZE_ABOVE;
}

/* Learns the sizes of the wheels, relative to each other, while all roll unbraked. */
static void measure_sizes(protection *self, double size) {
    double sum = 0.0;
    int count = 0;
    for (const wheel *one = self->wheels; one < self->wheels + self->wheelsets; ++one) {
        if (!is_sized(self, one)) continue;
        if (fabs(one->calm_acceleration) > COASTING) return;
        sum += one->calm_speed;
        ++count;
    }
    for (wheel *one = self->wheels; count > 1 && one < self->wheels + self->wheelsets; ++one) {
        if (!is_sized(self, one)) continue;
        const double change = one->size * (sum / count / one->calm_speed - 1.0) * size / (size + SIZE_TIME);
        one->size = larger(1.0 - SIZE_MOST, smaller(1.0 + SIZE_MOST, one->size + change));
    }
}

/* A deceleration limited to the possible range [m/s2]. */
static double possible(const protection *self, double deceleration) {
    return smaller(larger(deceleration, LEAST_DECELERATION), self->thresholds.largest_deceleration);
}

/* Sets the mean deceleration since the last true speed. */
static void measure(protection *self, double speed) {
    const double elapsed = larger(self->time - self->synchronised_at, SHORTEST_BETWEEN);
    self->before = self->deceleration;
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
    bool any = false;
    double most = 0.0, least = 0.0, unsure = 0.0; /* by which a wheel is behind; by noise */
    for (const wheel *one = self->wheels; one < self->wheels + self->wheelsets; ++one) {
        unsure = larger(unsure, NOISE_EVIDENT * noise(one));
        if (!is_seen(self, one) || !is_judged(self, one)) continue;
        const double behind = self->reference - one->calm_speed;
        most = any ? larger(most, behind) : behind;
        least = any ? smaller(least, behind) : behind;
        any = true;
    }
    const double apart = larger(t->evident_slip * self->reference, t->least_evident_slip);
    const double together = larger(TOGETHER * self->reference, t->least_evident_slip);
    if (!any || !(most > apart + unsure || least > together + unsure)) return;
    self->evident = true;
    self->evident_at = self->gained_at = self->time;
    self->synchronised = 0;
    measure(self, self->reference);
}

/* The last deceleration of the vehicle or, while all are braked freely, that of the fastest wheel [m/s2]. */
static double known_deceleration(const protection *self, const wheel *fastest) {
    if (self->time - self->acted_at < FREELY_BRAKED) return self->deceleration;
    return larger(self->deceleration, possible(self, -fastest->calm_acceleration));
}

/* Records that a wheel has gained speed since the last true speed, or since its release. */
static void find_gain(protection *self, wheel *one) {
    one->lowest = smaller(one->lowest, one->calm_speed);
    const double gain = smaller(GAIN, GAIN_SHARE * larger(one->calm_speed, SLOW));
    if (!(one->calm_acceleration > SPEEDING && one->calm_speed - one->lowest > gain)) return;
    one->speeds_up = true;
    self->gained_at = self->time;
}

/* Acceleration that a sliding wheel gains in a second of venting [m/s3]: its torque is that of the adhesion. */
static double gained_by_venting(const protection *self) {
    const double known = self->synchronised < 2 ? VENTED_FIRST : smaller(self->deceleration, self->before);
    return VENTED * smaller(known, VENTED_MOST);
}

/* Begins the test of filling again. */
static void watch_filling(const protection *self, wheel *one) {
    one->unmoved_filled = 0.0;
    one->unmoved_at = self->time;
    one->unmoved_speed = one->calm_speed;
    one->unmoved_acceleration = one->calm_acceleration;
}

/* Adds what the brake has changed without response of the wheel. */
static void test_response(const protection *self, wheel *one, double size) {
    const double acceleration = one->calm_acceleration, unsure = NOISE_CHANGE * noise(one);
    const double filled = FILLED * one->filling, vented = gained_by_venting(self) * one->venting;
    one->least_acceleration = smaller(one->least_acceleration, acceleration);
    const double gained = acceleration - one->least_acceleration;
    const double of_vehicle = smaller(OF_VEHICLE_MOST, OF_VEHICLE * one->unmoved_vented);
    if (acceleration > ROLLING + unsure || acceleration < -self->deceleration - FASTER ||
        gained > UNMOVED + unsure + of_vehicle) {
        one->unmoved_vented = 0.0;
        one->least_acceleration = acceleration;
    } else {
        one->unmoved_vented = larger(0.0, one->unmoved_vented + size * (vented - filled));
        if (one->unmoved_vented == 0.0) one->least_acceleration = acceleration;
    }
    const double own = 0.5 * smaller(OF_VEHICLE_MOST, OF_VEHICLE * one->unmoved_filled);
    const bool moved = fabs(acceleration - one->unmoved_acceleration + own) > UNMOVED + unsure + own;
    if (moved || one->venting > VENT_SEEN) watch_filling(self, one);
    else one->unmoved_filled = larger(0.0, one->unmoved_filled + size * (filled - vented));
}

static bool is_near(const protection *self, const wheel *one) {
    return self->synchronised && one->calm_speed > self->reference - NEAR - NEAR_SHARE * self->reference;
}

/* True if a vented wheel rolls: it does not respond. Far from the reference it must be vented for a time. */
static bool has_caught_up(const protection *self, const wheel *one) {
    if (is_near(self, one)) return one->unmoved_vented > UNMOVED_VENTED;
    const double longest = one->speeds_up ? SHORTEST_RELEASE : LONGEST_RELEASE;
    const bool rolls = one->calm_acceleration < ROLLING && one->calm_acceleration > -SLIDING;
    return one->vents && rolls && self->time - one->vents_since > longest;
}

/* Takes the true speed, and from two of them the deceleration of the vehicle. */
static void synchronise(protection *self, double speed) {
    const bool later = self->synchronised == 0 || self->time - self->synchronised_at > SHORTEST_BETWEEN;
    if (later) {
        measure(self, speed);
        self->synchronised_at = self->kept_at = self->time;
        self->synchronised_speed = self->kept_speed = speed;
        ++self->synchronised;
    }
    self->reference = speed;
    self->released = NOBODY;
    for (wheel *one = self->wheels; one < self->wheels + self->wheelsets; ++one) {
        if (later) one->lowest = one->calm_speed;
        one->unmoved_vented = 0.0;
        watch_filling(self, one);
    }
}

/* Bounds reference and deceleration by a wheel below its best slip, whose slip is 0 to CREEP. */
static void bound(protection *self, const wheel *one) {
    const double lost = one->unmoved_speed - one->calm_speed, lasts = self->time - one->unmoved_at;
    const double least = (lost - CREEP) / lasts - CREEPING, most = (lost + CREEP) / lasts;
    self->deceleration = possible(self, smaller(larger(self->deceleration, least), most));
    self->reference = smaller(self->reference, one->calm_speed + CREEP);
}

/* Wheels slide: the reference falls at the last deceleration of the vehicle, until a wheel rolls. */
static void slide(protection *self, double size, const wheel *fastest) {
    const double falls = known_deceleration(self, fastest);
    const wheel *shows = NULL; /* the true speed */
    self->reference = larger(fastest->calm_speed, self->reference - falls * size);
    for (wheel *one = self->wheels; one < self->wheels + self->wheelsets; ++one) {
        if (!is_seen(self, one)) continue;
        find_gain(self, one);
        test_response(self, one, size);
        if (has_caught_up(self, one) && (!shows || one->calm_speed > shows->calm_speed)) shows = one;
    }
    if (shows) synchronise(self, larger(shows->calm_speed, fastest->calm_speed));
    for (wheel *one = self->wheels; !shows && one < self->wheels + self->wheelsets; ++one)
        if (is_seen(self, one) && is_near(self, one) && one->unmoved_filled > UNMOVED_FILLED) bound(self, one);
    const bool quiet = self->time - self->acted_at > FREE && self->time - self->gained_at > QUIET;
    if (self->synchronised > 1 && quiet) self->evident = false;
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

/* The acceleration of a wheel when sensors show what its valve has done [m/s2]. */
static double coming(const protection *self, const wheel *one) {
    return one->acceleration + LAG * (gained_by_venting(self) * one->venting - FILLED * one->filling);
}

/* A released wheelset is vented until it speeds up, and then held until it rolls. */
static int by_release(const protection *self, const wheel *one) {
    return one->acceleration > ROLLING && coming(self, one) > RELEASED ? HOLD : VENT;
}

static void begin_steady(const protection *self, wheel *one) {
    one->steady_at = self->time;
    one->steady_acceleration = one->calm_acceleration;
}

/* True during a pulse: after a while in which a held wheel has not slowed more and more. */
static bool is_pulsed(const protection *self, wheel *one) {
    if (self->time < one->pulse_until) return true;
    if (one->steady_acceleration - one->calm_acceleration > STEADY_CHANGE) begin_steady(self, one);
    if (self->time - one->steady_at < STEADY) return false;
    one->pulse_until = self->time + PULSE;
    return true;
}

/* Compares the slip to come, from the present one and its rate, with the band. */
static int by_slip(const protection *self, wheel *one) {
    const slide_thresholds *t = &self->thresholds;
    const double rate = -self->deceleration - coming(self, one);
    const double slip = self->reference - one->speed + t->lead_time * rate;
    const double share = smaller(1.0, larger(self->reference, SLOW) / FULL_BAND);
    if (slip > t->upper_slip * share) return VENT;
    if (slip < t->lower_slip * share || one->unmoved_filled > UNMOVED_FILLED) return APPLY;
    return is_pulsed(self, one) ? APPLY : HOLD;
}

static int command_of(protection *self, int number) {
    const slide_thresholds *t = &self->thresholds;
    wheel *one = &self->wheels[number];
    if (!(self->evident && is_judged(self, one)) || self->reference < t->slowest || self->time < one->blocked_until) {
        one->vents = false;
        return APPLY;
    }
    const bool released = is_released(self, number);
    const int command = released ? by_release(self, one) : by_slip(self, one);
    if (command != APPLY) self->acted_at = self->time;
    if (command != HOLD) begin_steady(self, one);
    if (command != VENT && !(released && one->vents)) {
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

/* The neighbour of a wheelset whose sensor is rejected, or another one with a sensor. */
static int neighbour_of(const protection *self, int number) {
    const int beside = number ^ 1;
    if (beside < self->wheelsets && self->wheels[beside].believed) return beside;
    for (int i = 0; i < self->wheelsets; ++i)
        if (self->wheels[i].believed) return i;
    return NOBODY;
}

/* The command for a wheelset without sensor. */
static int unseen_command(protection *self, int number) {
    wheel *one = &self->wheels[number];
    const int neighbour = neighbour_of(self, number);
    if (!self->evident) one->lost_at = self->time;
    if (!self->evident || neighbour == NOBODY) return APPLY;
    if (self->time - one->lost_at < UNSEEN_VENT) return VENT;
    const double above = one->pressure - UNSEEN_SHARE * self->wheels[neighbour].pressure;
    return above > UNSEEN_BAND ? VENT : above < -UNSEEN_BAND ? APPLY : HOLD;
}

/* Follows what the valve does. */
static void follow(wheel *one, int command, double size) {
    const double share = size / (size + LAG), change = command == APPLY  ? FILLING
                                                       : command == VENT ? -EMPTYING * one->pressure
                                                                         : 0.0;
    one->venting += share * ((command == VENT) - one->venting);
    one->filling += share * ((command == APPLY) - one->filling);
    one->pressure = larger(0.0, smaller(1.0, one->pressure + size * change));
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
        self->wheels[i].size = 1.0;
        self->wheels[i].blocked_until = self->wheels[i].changed_at = -INFINITY;
    }
}

/* Takes the readings of all sensors. */
static void take(protection *self, const double *wheel_speed, double size) {
    for (int i = 0; i < self->wheelsets; ++i) {
        wheel *one = &self->wheels[i];
        if (!isfinite(wheel_speed[i])) {
            if (one->believed) lose(self, one, size);
            one->agrees = false;
            continue;
        }
        believe(self, one, one->size * wheel_speed[i], size);
        filter(self, one, one->size * wheel_speed[i], size);
    }
    if (!self->evident) measure_sizes(self, size);
    self->any_believed = false;
    for (int i = 0; i < self->wheelsets; ++i) self->any_believed |= self->wheels[i].believed;
}

void wheel_slide_step(void *memory, double time, const double *wheel_speed, int *valve) {
    protection *self = memory;
    const double size = self->begun ? time - self->time : 0.0;
    self->begun = true;
    self->time = time;
    take(self, wheel_speed, size);
    const wheel *fastest = &self->wheels[chosen(self, true)];
    (self->evident ? slide : roll)(self, size, fastest);
    for (int i = 0; i < self->wheelsets; ++i)
        if (self->wheels[i].believed) valve[i] = command_of(self, i);
    for (int i = 0; i < self->wheelsets; ++i) {
        if (!self->wheels[i].believed) valve[i] = unseen_command(self, i);
        follow(&self->wheels[i], valve[i], size);
    }
}

void slide_set_thresholds(void *memory, const slide_thresholds *thresholds) {
    ((protection *)memory)->thresholds = *thresholds;
}

double slide_reference(const void *memory) { return ((const protection *)memory)->reference; }

int slide_believes(const void *memory, int wheelset) { return ((const protection *)memory)->wheels[wheelset].believed; }
