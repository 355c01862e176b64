"""Brake weight percentage and stopping distance: the conversion model of trains, and the assessment of single vehicles.

The brake weight percentage lambda is the braked weight over the mass, in %. The conversion model converts it to
decelerations and a build-up time (SUBSET-026 A.3.7 to A.3.9). It is valid from 30 to 250 %, up to 200 km/h. The
assessment converts a measured or computed stopping distance to lambda (EN 16834, UIC 544-1). SI units, except for
lambda in %.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

KILOMETRES_PER_HOUR = 3.6
#: Limits of the conversion model (SUBSET-026): percentages [%] and the highest speed [m/s] for which it is valid.
LEAST_PERCENTAGE, MOST_PERCENTAGE, MOST_SPEED = 30.0, 250.0, 200.0 / KILOMETRES_PER_HOUR
#: Largest percentage with which full service is computed [%] (SUBSET-026 A.3.7).
SERVICE_PERCENTAGE = 135.0
#: Largest length for which the first constants of a build-up time apply [m] (SUBSET-026 A.3.8, A.3.9).
SHORT_TRAIN = 900.0
#: Upper edge of each band of speed [km/h], and the deceleration in it [m/s2] as a polynomial of lambda, constant first
#: (SUBSET-026 A.3.7). It is larger from 100 to 120 km/h than just below, at every lambda up to 98 %.
BANDS = (
    (100.0, (0.0663, 4.72e-3, 6.10e-5, -6.30e-7)),
    (120.0, (0.1300, 5.14e-3, -4.54e-6, 2.73e-7)),
    (150.0, (0.0479, 5.81e-3, -6.76e-6, 5.58e-8)),
    (180.0, (0.0480, 5.52e-3, -3.85e-6, 3.00e-8)),
    (math.inf, (0.0559, 5.06e-3, 1.66e-6, 3.23e-9)),
)
#: Below the limit speed the deceleration is one straight line of lambda, constant first.
BASIC = (0.076, 0.0075)
#: The limit speed [km/h] is FACTOR lambda^POWER.
LIMIT_FACTOR, LIMIT_POWER = 16.85, 0.428
#: Equivalent build-up time of a single vehicle's brake [s] (EN 14531-1).
VEHICLE_BUILD_UP = 2.0


@dataclass(frozen=True)
class BuildUp:
    """Equivalent build-up time T = a + b l + c l^2 [s] with l in 100 m (SUBSET-026 A.3.8, A.3.9).

    `short` and `longer` are a, b, c up to SHORT_TRAIN and above it; None: no longer train. `least_length` [m] is used
    for shorter trains. `reaction_time` [s] is the time until the brakes begin to act, a part of T.
    """

    service: bool
    short: tuple[float, float, float]
    longer: tuple[float, float, float] | None
    least_length: float
    reaction_time: float

    @property
    def most_length(self) -> float:
        """Longest train for which the case is valid [m]."""
        return SHORT_TRAIN if self.longer is None else 1500.0


_LONG_EMERGENCY, _LONG_SERVICE = (-0.40, 1.60, 0.03), (10.50, 0.32, 0.18)


class BrakingKind(Enum):
    """Kinds of braking: emergency or full service, of a passenger train in P or a freight train in P or G."""

    EMERGENCY_PASSENGER_P = BuildUp(False, (2.30, 0.0, 0.17), None, 400.0, 1.42)
    EMERGENCY_FREIGHT_P = BuildUp(False, (2.30, 0.0, 0.17), _LONG_EMERGENCY, 400.0, 2.99)
    EMERGENCY_FREIGHT_G = BuildUp(False, (12.00, 0.0, 0.05), _LONG_EMERGENCY, 0.0, 9.30)
    SERVICE_PASSENGER_P = BuildUp(True, (3.00, 1.50, 0.10), None, 0.0, 1.06)
    SERVICE_FREIGHT_P = BuildUp(True, (3.00, 2.77, 0.0), _LONG_SERVICE, 0.0, 2.07)
    SERVICE_FREIGHT_G = BuildUp(True, (3.00, 2.77, 0.0), _LONG_SERVICE, 400.0, 5.70)


@dataclass(frozen=True)
class DecelerationStep:
    """One deceleration [m/s2] in a band of speed, from least to most [m/s]."""

    least: float
    most: float
    deceleration: float


@dataclass(frozen=True)
class Assessment:
    """Assessment of a single vehicle: speed [m/s], C [% m] and D [%] of lambda = C / S - D (EN 16834, UIC 544-1)."""

    speed: float
    constant: float
    offset: float


#: Assessments with 100 and 120 km/h. They are assumed, because the standard itself was not read.
FROM_100 = Assessment(100.0 / KILOMETRES_PER_HOUR, 52840.0, 10.0)
FROM_120 = Assessment(120.0 / KILOMETRES_PER_HOUR, 83634.0, 19.0)


def _within(name: str, value: float, unit: str, least: float, most: float, advice: str) -> float:
    """Return a value that lies within two limits. Raises ValueError, for NaN too."""
    if least <= value <= most and math.isfinite(value):
        return value
    limit = f"from {least:g} to {most:g} {unit}" if math.isfinite(most) else f"finite and at least {least:g} {unit}"
    raise ValueError(f"The {name} is {value:g} {unit}, but must be {limit}: {advice}.")


def _above_zero(name: str, value: float, unit: str, advice: str) -> float:
    """Return a finite value above 0. Raises ValueError, for NaN too."""
    if value > 0.0 and math.isfinite(value):
        return value
    raise ValueError(f"The {name} is {value:g} {unit}, but must be finite and above 0 {unit}: {advice}.")


def _valid_percentage(percentage: float) -> float:
    advice = "give one for which the conversion model is valid, or decelerations that were measured"
    return _within("brake weight percentage", percentage, "%", LEAST_PERCENTAGE, MOST_PERCENTAGE, advice)


def _valid_speed(speed: float) -> float:
    advice = "give the speed in m/s at which braking is asked for"
    return _within("speed", speed, "m/s", 0.0, MOST_SPEED, advice)


# ---- trains ----------------------------------------------------------------------------------------------------------


def build_up_time(case: BrakingKind, length: float) -> float:
    """Return the equivalent build-up time of a train's brakes [s] (SUBSET-026 A.3.8, A.3.9).

    Takes length [m].
    """
    of = case.value
    advice = f"give a length for which {case.name} has a build-up time, or another case"
    _within("length of the train", length, "m", 0.0, of.most_length, advice)
    hundreds = max(length, of.least_length) / 100.0
    constant, linear, square = of.longer if of.longer and length > SHORT_TRAIN else of.short
    return float(constant + linear * hundreds + square * hundreds**2)


def limit_speed(percentage: float) -> float:
    """Return the speed [m/s] up to which the deceleration is the basic one (SUBSET-026 A.3.7), by lambda [%]."""
    return float(LIMIT_FACTOR * _valid_percentage(percentage) ** LIMIT_POWER / KILOMETRES_PER_HOUR)


def deceleration_steps(case: BrakingKind, percentage: float) -> tuple[DecelerationStep, ...]:
    """Return decelerations over speed, slowest band first (SUBSET-026 A.3.7).

    Bands of speed that end below the limit speed are omitted. The first remaining one begins there.

    Takes percentage [%].
    """
    of = _valid_percentage(percentage)
    if case.value.service:
        of = min(of, SERVICE_PERCENTAGE)
    edge = limit_speed(of)
    steps = [DecelerationStep(0.0, edge, BASIC[0] + BASIC[1] * of)]
    for upper, polynomial in BANDS:
        most = upper / KILOMETRES_PER_HOUR
        if most > edge:
            deceleration = sum(factor * of**power for power, factor in enumerate(polynomial))
            steps.append(DecelerationStep(edge, most, deceleration))
            edge = most
    return tuple(steps)


def braking_distance(steps: Sequence[DecelerationStep], speed: float) -> float:
    """Return the distance under full deceleration [m] (EN 14531-1), the sum of v dv / a, from a speed [m/s]."""
    _valid_speed(speed)
    passed = [(min(speed, step.most), step) for step in steps if step.least < speed]
    return sum((fastest**2 - step.least**2) / (2 * step.deceleration) for fastest, step in passed)


def stopping_distance(case: BrakingKind, speed: float, percentage: float, length: float) -> float:
    """Return the distance of a train from demand to stop [m], v T plus braking distance (SUBSET-026 A.3.7 to A.3.9).

    The track is level.

    Takes speed [m/s], percentage [%], length [m].
    """
    coming = _valid_speed(speed) * build_up_time(case, length)
    return coming + braking_distance(deceleration_steps(case, percentage), speed)


def train_percentage(braked_weights: Sequence[float], masses: Sequence[float]) -> float:
    """Return the brake weight percentage of a train [%]: all braked weights over all masses, both [kg] (UIC 544-1).

    A vehicle whose brake is cut out has a braked weight of 0.
    """
    if len(braked_weights) != len(masses) or not len(masses):
        raise ValueError(
            f"There are {len(braked_weights)} braked weights and {len(masses)} masses, but each vehicle of at least "
            "one needs both: give as many of the ones as of the others."
        )
    for weight, mass in zip(braked_weights, masses, strict=True):
        _within("braked weight", weight, "kg", 0.0, math.inf, "give 0 where the brake is cut out")
        _above_zero("mass", mass, "kg", "give the mass of each vehicle with its load")
    return 100.0 * math.fsum(braked_weights) / math.fsum(masses)


def braked_weight(percentage: float, mass: float) -> float:
    """Return the braked weight of a vehicle [kg], lambda times its mass [kg] (UIC 544-1)."""
    _above_zero("brake weight percentage", percentage, "%", "give that of the assessment")
    return percentage / 100.0 * _above_zero("mass", mass, "kg", "give that of the vehicle with its load")


# ---- single vehicles -------------------------------------------------------------------------------------------------


def percentage_of_vehicle(distance: float, assessment: Assessment) -> float:
    """Return the percentage of a single vehicle [%] from its stopping distance [m], C / S - D (EN 16834, UIC 544-1)."""
    _above_zero("stopping distance", distance, "m", "give that from the demand to the stop")
    longest = assessment.constant / assessment.offset
    if distance >= longest:
        raise ValueError(
            f"The stopping distance is {distance:g} m, but must be below {longest:g} m, where the percentage would be "
            "0: give a shorter one, or assess the vehicle from another speed."
        )
    return assessment.constant / distance - assessment.offset


def distance_of_vehicle(percentage: float, assessment: Assessment) -> float:
    """Return the stopping distance of a vehicle [m] from its percentage [%], C / (lambda + D) (EN 16834, UIC 544-1)."""
    _above_zero("brake weight percentage", percentage, "%", "give that of the vehicle's assessment")
    return assessment.constant / (percentage + assessment.offset)


def mean_deceleration(speed: float, distance: float, build_up: float = VEHICLE_BUILD_UP) -> float:
    """Return the mean deceleration once the brake is on [m/s2], v^2 / (2 (S - T v)) (EN 14531-1).

    Takes speed [m/s], distance [m], build_up [s].
    """
    _above_zero("speed", speed, "m/s", "a vehicle that stands has no deceleration")
    _within("build-up time", build_up, "s", 0.0, math.inf, "give the equivalent time of the brake")
    least = build_up * speed
    if not (distance > least and math.isfinite(distance)):
        raise ValueError(
            f"The stopping distance is {distance:g} m, but must be finite and above {least:g} m, which the vehicle "
            "runs before its brake is on: give a longer distance or a shorter build-up time."
        )
    return speed**2 / (2 * (distance - least))


def force_of_percentage(percentage: float, turning_mass: float, assessment: Assessment) -> float:
    """Return the mean brake force at the rims [N] for which a vehicle has a percentage [%] (EN 14531-1, EN 16834).

    turning_mass: mass including the equivalent mass of rotating wheelsets [kg].
    """
    _above_zero("mass", turning_mass, "kg", "give that of the vehicle with its load and its rotating masses")
    return turning_mass * mean_deceleration(assessment.speed, distance_of_vehicle(percentage, assessment))


#: Speeds from rest to that of the assessment [m/s].
SPEEDS = np.linspace(0.0, FROM_100.speed, 401)


#: Further forces of a vehicle at SPEEDS [N]: none.
NOTHING = np.zeros(SPEEDS.size)


def braking_way(force: NDArray[np.float64], turning_mass: float, resistance: Sequence[float]) -> float:
    """Return the braking distance [m], int m v / F dv (EN 14531-1).

    F: forces at SPEEDS [N] and a resistance a + b v + c v^2.
    """
    a, b, c = resistance
    whole = force + a + b * SPEEDS + c * SPEEDS**2
    return float(np.trapezoid(turning_mass * SPEEDS / whole, SPEEDS))


def check_percentage(
    percentage: float, turning_mass: float, resistance: Sequence[float], beside: NDArray[np.float64] = NOTHING
) -> None:
    """Check that a percentage [%] needs a brake (UIC 544-1), 1e-3 of the mean force at least. Raises ValueError.

    beside: further forces at SPEEDS [N].
    """
    mean = force_of_percentage(percentage, turning_mass, FROM_100)
    way = turning_mass * FROM_100.speed**2 / (2 * mean)
    if braking_way(1e-3 * mean + beside, turning_mass, resistance) <= way:
        others, what = (" and magnets", "they stop") if beside.any() else ("", "the resistance stops")
        raise ValueError(
            f"lambda must be above that of the running resistance{others} alone; got {percentage:g} %, and {what}"
            " the vehicle in a shorter distance. Increase lambda, or decrease the resistance."
        )


def force_beside(
    resistance: Sequence[float], percentage: float, turning_mass: float, beside: NDArray[np.float64] = NOTHING
) -> float:
    """Return the constant force [N] that gives a vehicle a brake weight percentage [%] beside its resistance.

    A percentage is assessed by a stopping distance from 100 km/h, to which the running resistance a + b v + c v^2
    belongs (UIC 544-1). turning_mass [kg]: with that of the rotation; beside: further forces at SPEEDS [N].
    """
    mean = force_of_percentage(percentage, turning_mass, FROM_100)
    way = turning_mass * FROM_100.speed**2 / (2 * mean)

    def too_long(force: float) -> float:
        return braking_way(force + beside, turning_mass, resistance) - way

    check_percentage(percentage, turning_mass, resistance, beside)
    least = 0.2 * mean if too_long(0.2 * mean) > 0.0 else 1e-3 * mean
    return float(brentq(too_long, least, 1.001 * mean))
