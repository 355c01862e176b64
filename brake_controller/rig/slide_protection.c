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
 * If a sensor shows a reading that no wheel can produce, its wheelset gets the commands of its neighbour with a share of the
 * fillings. Sizes of the wheels, relative to each other, are learned while all roll unbraked. Errors of the teeth are measured
 * while nothing slides, and lengthen the filters. A reading that is not finite is invalid: the sensor is rejected, and its
 * previous reading remains. If a valve sticks, its wheel may lock: then it does not show the speed of the vehicle. */
#include "slide_protection.h"

#include "slide_numbers.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

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
     * sensor agrees with the others. */
    double recent[RECENT], changed_at, others, agrees_since;
    int readings;
    /* Shares of the last LAG of venting and filling; pressure by model, its mean while wheels slide [1]; last time at which it
     * was not full. Without sensor: share of the neighbour's fillings, what is due of them [1]; end of venting. */
    double venting, filling, pressure, mean, full_at, share, due, vented_until;
    /* Acceleration due to venting without response, and the least one meanwhile; acceleration due to filling, with time, speed
     * and acceleration at its begin [m/s2, s, m/s]. */
    double unmoved_vented, least_acceleration, unmoved_filled, unmoved_at, unmoved_speed, unmoved_acceleration;
    /* Begin of a steady slip with the acceleration then; end of the pulse. */
    double steady_at, steady_acceleration, pulse_until;
    bool turns, vents, locked, refills, speeds_up, believed, agrees;
} wheel;

/* State of the vehicle; before: its deceleration before the last true speed. */
typedef struct {
    slide_thresholds thresholds;
    double time, reference, deceleration, before, evident_at, acted_at, gained_at, bounded_at;
    double synchronised_at, synchronised_speed, kept_at, kept_speed;
    int wheelsets, synchronised, released;
    bool begun, evident, any_believed;
    wheel wheels[1]; /* the first of all; wheel_slide_size counts the others */
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

/* The number of the fastest or of the slowest wheel that is used, and not locked if there is one. */
static int chosen(const protection *self, bool fastest) {
    const wheel *found = NULL;
    for (const wheel *one = self->wheels; one < self->wheels + self->wheelsets; ++one) {
        if (!is_seen(self, one) || (one->locked && found)) continue;
        if (!found || found->locked || (fastest ? one->calm_speed > found->calm_speed : one->calm_speed < found->calm_speed))
            found = one;
    }
    return (int)(found - self->wheels);
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

/* The neighbour of a wheelset, or another one, with a sensor. */
static int neighbour_of(const protection *self, int number) {
    const int beside = number ^ 1;
    if (beside < self->wheelsets && self->wheels[beside].believed) return beside;
    for (int i = 0; i < self->wheelsets; ++i)
        if (self->wheels[i].believed) return i;
    return NOBODY;
}

/* Rejects a sensor from now on. */
static void lose(protection *self, wheel *one, double size) {
    one->believed = one->agrees = false;
    const int beside = neighbour_of(self, (int)(one - self->wheels));
    one->vented_until = self->time + LOST_VENT;
    one->share = beside != NOBODY && self->evident && self->wheels[beside].mean > 0.0
                     ? smaller(MOST_SHARE, larger(LEAST_SHARE, OF_NEIGHBOUR * one->mean / self->wheels[beside].mean))
                     : UNKNOWN_SHARE;
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
        one->believed = one->believed && !is_blind(self, others);
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
    const bool stays =
        self->time - one->changed_at > STAYING && fabs(others - one->others) > (self->evident ? STAYS_SLIDING : STAYS);
    if (jumps(one, speed, size) || stays) lose(self, one, size);
    if (stays) {
        one->vented_until = self->time + STUCK_VENT * others;
        one->share = STUCK_SHARE;
    }
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
    if (one->calm_speed > LOCKED_BELOW * self->reference) one->locked = false;
    else if (one->vents && !one->speeds_up && self->time - one->vents_since > LOCKED_FROM) one->locked = true;
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

/* True if a vented wheel rolls: it does not respond, and is not behind. Far from the reference it must be vented for a time. */
static bool has_caught_up(const protection *self, const wheel *one, const wheel *fastest) {
    const double vented = one->vents ? self->time - one->vents_since : 0.0;
    const double unsized = vented > LONGEST_RELEASE ? SIZE_MOST * fastest->calm_speed : 0.0;
    if (one->calm_speed < fastest->calm_speed - BEHIND - unsized) return false;
    if (is_near(self, one)) return one->unmoved_vented > UNMOVED_VENTED;
    const double longest = one->speeds_up ? SHORTEST_RELEASE : LONGEST_RELEASE;
    const bool rolls = one->calm_acceleration < ROLLING && one->calm_acceleration > -SLIDING;
    return one->vents && !one->locked && rolls && vented > longest;
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
    if (lasts > BOUNDED) self->bounded_at = self->time;
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
        if (has_caught_up(self, one, fastest) && (!shows || one->calm_speed > shows->calm_speed)) shows = one;
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
    if (self->released != NOBODY && self->wheels[self->released].locked) self->released = NOBODY;
    const double since = larger(self->synchronised_at, smaller(self->bounded_at, self->synchronised_at + POSTPONED));
    if (self->released == NOBODY && self->time - since > due) self->released = chosen(self, self->synchronised > 0);
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

/* The command for a wheelset without sensor. */
static int unseen_command(protection *self, int number, const int *valve) {
    wheel *one = &self->wheels[number];
    const int neighbour = neighbour_of(self, number);
    if (neighbour == NOBODY) return APPLY;
    const wheel *beside = &self->wheels[neighbour];
    if (!self->evident) {
        one->vented_until = self->time + UNSEEN_VENT;
        one->due = 0.0;
        const bool behind = beside->pressure < 1.0 || self->time - beside->full_at < FULL_TIME;
        return behind && one->pressure > FIRST_SHARE * beside->pressure ? HOLD : APPLY;
    }
    const bool vents = self->time < one->vented_until;
    one->refills = vents || (one->refills && one->pressure < REFILLED * one->share * beside->pressure);
    if (vents) return VENT;
    if (one->refills) return APPLY;
    if (valve[neighbour] != APPLY) return valve[neighbour];
    one->due += one->share;
    if (one->due < 1.0) return HOLD;
    one->due -= 1.0;
    return APPLY;
}

/* Follows what the valve does. */
static void follow(const protection *self, wheel *one, int command, double size) {
    const double share = size / (size + LAG), change = command == APPLY  ? FILLING
                                                       : command == VENT ? -EMPTYING * one->pressure
                                                                         : 0.0;
    one->venting += share * ((command == VENT) - one->venting);
    one->filling += share * ((command == APPLY) - one->filling);
    one->pressure = larger(0.0, smaller(1.0, one->pressure + size * change));
    if (self->evident) one->mean += size / (size + MEAN_TIME) * (one->pressure - one->mean);
    else one->mean = one->pressure;
    if (one->pressure < 1.0) one->full_at = self->time;
}

size_t wheel_slide_size(int wheelsets) { return offsetof(protection, wheels) + (size_t)wheelsets * sizeof(wheel); }

void wheel_slide_start(void *memory, int wheelsets, double period) {
    protection *self = (protection *)memory;
    (void)period;
    const slide_thresholds common = SLIDE_COMMON;
    self->thresholds = common;
    self->wheelsets = wheelsets;
    self->evident_at = self->acted_at = -INFINITY;
    self->released = NOBODY;
    for (int i = 0; i < wheelsets; ++i) {
        self->wheels[i].believed = true;
        self->wheels[i].size = 1.0;
        self->wheels[i].share = UNKNOWN_SHARE;
        self->wheels[i].blocked_until = self->wheels[i].changed_at = -INFINITY;
    }
}

/* True if no wheel that is used is braked. */
static bool is_coasting(const protection *self) {
    for (const wheel *one = self->wheels; one < self->wheels + self->wheelsets; ++one)
        if (one->believed && fabs(one->calm_acceleration) > COASTING) return false;
    return true;
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
    if (!self->evident && is_coasting(self))
        for (int i = 0; i < self->wheelsets; ++i) self->wheels[i].pressure = 0.0;
    self->any_believed = false;
    for (int i = 0; i < self->wheelsets; ++i) self->any_believed |= self->wheels[i].believed;
}

void wheel_slide_step(void *memory, double time, const double *wheel_speed, int *valve) {
    protection *self = (protection *)memory;
    const double size = self->begun ? time - self->time : 0.0;
    self->begun = true;
    self->time = time;
    take(self, wheel_speed, size);
    const wheel *fastest = &self->wheels[chosen(self, true)];
    (self->evident ? slide : roll)(self, size, fastest);
    for (int i = 0; i < self->wheelsets; ++i)
        if (self->wheels[i].believed) valve[i] = command_of(self, i);
    for (int i = 0; i < self->wheelsets; ++i) {
        if (!self->wheels[i].believed) valve[i] = unseen_command(self, i, valve);
        follow(self, &self->wheels[i], valve[i], size);
    }
}

void slide_set_thresholds(void *memory, const slide_thresholds *thresholds) {
    ((protection *)memory)->thresholds = *thresholds;
}

double slide_reference(const void *memory) { return ((const protection *)memory)->reference; }

int slide_believes(const void *memory, int wheelset) { return ((const protection *)memory)->wheels[wheelset].believed; }
