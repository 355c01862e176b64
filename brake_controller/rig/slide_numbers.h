/* Numbers of the built-in wheel-slide protection: all assumed, and chosen with the thresholds (docs/fitted.md). */
#ifndef SLIDE_NUMBERS_H
#define SLIDE_NUMBERS_H

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
/* A wheel below this share of the reference [1] that gains no speed for a time of venting [s] is locked, by a valve that sticks
 * or for want of adhesion. */
static const double LOCKED_BELOW = 0.2, LOCKED_FROM = 0.5;
/* Deceleration above which no vented wheel is treated as rolling [m/s2]; distance to the fastest one [m/s], to which the largest
 * correction of sizes is added after LONGEST_RELEASE. */
static const double SLIDING = 2.0, BEHIND = 0.3;
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
/* Largest slip speed below the best slip [m/s], and largest mean error of a deceleration due to growing slip [m/s2]. A wheel
 * below its best slip for longer than BOUNDED postpones a release, at most by POSTPONED [s]. */
static const double CREEP = 0.4, CREEPING = 0.35, BOUNDED = 1.5, POSTPONED = 5.0;
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
/* Time for which a reading stays bit-identical [s], while others change by more than this without and with evidence [m/s]. */
static const double STAYING = 0.3, STAYS = 0.5, STAYS_SLIDING = 0.15;
/* Time for which others have turned [s], and faster than this [m/s], while a sensor has shown 0. */
static const double BLIND = 1.0, BLIND_ABOVE = 3.0;
/* Share of the speed, and time [s], for which a sensor must agree with the others to be accepted again. */
static const double AGREES = 0.05, AGREEING = 2.0;
/* A wheel without an accepted sensor gets the commands of its neighbour, but only a share of its fillings [1]. The share is
 * OF_NEIGHBOUR times the ratio of the mean pressures by model while its sensor worked, from LEAST_SHARE to MOST_SHARE. It is
 * STUCK_SHARE if the sensor stayed constant, and UNKNOWN_SHARE if it never worked. Means are over MEAN_TIME [s]. */
static const double OF_NEIGHBOUR = 0.95, LEAST_SHARE = 0.65, MOST_SHARE = 1.0, STUCK_SHARE = 0.85, UNKNOWN_SHARE = 0.7;
static const double MEAN_TIME = 4.0;
/* It may have locked unseen, and is vented first: after the rejection, for each m/s of the speed after a constant reading, and
 * after evidence [s, s2/m, s]. Then it is filled to a share of the pressure that it gets from its neighbour [1]. */
static const double LOST_VENT = 0.4, STUCK_VENT = 0.05, UNSEEN_VENT = 0.8, REFILLED = 0.85;
/* Without evidence its pressure stays below this share of the neighbour's [1], until that has been full for a time [s]: the
 * neighbour slides first. */
static const double FIRST_SHARE = 0.8, FULL_TIME = 0.5;

#endif
