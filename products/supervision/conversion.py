"""The conversion model: decelerations and build-up times of a brake percentage, SUBSET-026, A.3.7 and A.3.8."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from products.supervision.arguments import finite, name_among, numbers
from products.supervision.steps import Steps
from readers.text import BadInputError, shown

KMH = 1.0 / 3.6
#: Brake positions, and the longest train of each for which the model is defined [m].
BRAKE_POSITIONS = {"passenger P": 900.0, "freight P": 1500.0, "freight G": 1500.0}
#: Brake percentages [%] and largest speed [m/s] of the model; percentage above which a service brake gains nothing.
LEAST, MOST, FASTEST, SERVICE_MOST = 30.0, 250.0, 200.0 * KMH, 135.0
#: Speeds at which polynomials end [km/h], and their coefficients of 1, lambda, lambda^2, lambda^3 [m/s2], A.3.7.5.
ENDS = (100.0, 120.0, 150.0, 180.0)
COEFFICIENTS = (
    (0.0663, 4.72e-3, 6.1e-5, -6.3e-7),
    (0.13, 5.14e-3, -4.54e-6, 2.73e-7),
    (0.0479, 5.81e-3, -6.76e-6, 5.58e-8),
    (0.048, 5.52e-3, -3.85e-6, 3e-8),
    (0.0559, 5.06e-3, 1.66e-6, 3.23e-9),
)
#: Build-up times a + b x + c x^2 [s] of the length x in 100 m, and the least length [m], A.3.8: of the emergency brake,
#: of the service brake; for trains longer than LONG [m] that are not passenger trains.
EMERGENCY = {
    "passenger P": ((2.3, 0.0, 0.17), 400.0),
    "freight P": ((2.3, 0.0, 0.17), 400.0),
    "freight G": ((12.0, 0.0, 0.05), 0.0),
}
SERVICE = {
    "passenger P": ((3.0, 1.5, 0.1), 0.0),
    "freight P": ((3.0, 2.77, 0.0), 0.0),
    "freight G": ((3.0, 2.77, 0.0), 400.0),
}
LONG, LONG_EMERGENCY, LONG_SERVICE = 900.0, (-0.4, 1.6, 0.03), (10.5, 0.32, 0.18)
#: Largest step to which the limit speed may be rounded up [m/s].
COARSEST = 5.0 * KMH
#: Factor of build-up times where the target speed is above 0.
MOVING_TARGET = {"passenger P": 1.2, "freight P": 1.2, "freight G": 1.16}


@dataclass(frozen=True)
class ConvertedBrake:
    """Brakes of a train by its percentage: decelerations [m/s2], and build-up times for a target at rest [s]."""

    emergency: Steps
    service: Steps
    emergency_time: np.ndarray
    service_time: np.ndarray


def limit_speed(percentage: np.ndarray | float, resolution: float = 0.0) -> np.ndarray:
    """Return the speed up to which the first deceleration holds, A.3.7.4.

    Takes percentage [%], resolution [m/s]; returns [m/s].
    """
    speed = 16.85 * np.power(percentage, 0.428) * KMH
    return np.ceil(speed / resolution - 1e-9) * resolution if resolution else speed


def basic_decelerations(percentage: np.ndarray | float) -> np.ndarray:
    """Return all six steps of the basic deceleration, A.3.7.4 and A.3.7.5, also those that the model ignores.

    Takes percentage [%] (...); returns [m/s2] (..., 6).
    """
    share = np.asarray(percentage, dtype=float)[..., None]
    polynomials = [sum(one * share**n for n, one in enumerate(row)) for row in COEFFICIENTS]
    return np.concatenate([0.0075 * share + 0.076, *polynomials], axis=-1)


def deceleration_of(percentage: np.ndarray | float, resolution: float = 0.0) -> Steps:
    """Return the deceleration of a brake percentage by speed, A.3.7.

    Takes percentage [%] (...); returns [m/s2].
    """
    share = np.asarray(percentage, dtype=float)[..., None]
    limit, ends = limit_speed(share, resolution), np.array(ENDS) * KMH
    boundaries = np.concatenate([limit, np.maximum(limit, ends)], axis=-1)
    basic = basic_decelerations(percentage)
    ignored = np.concatenate([np.zeros_like(limit), limit > ends, np.zeros_like(limit)], axis=-1).astype(bool)
    return Steps(boundaries, np.where(ignored, basic[..., :1], basic))


def build_up_time(position: str, length: np.ndarray | float, emergency: bool) -> np.ndarray:
    """Return the equivalent build-up time for a target at rest, A.3.8.

    Takes length [m]; returns [s].
    """
    lengths = np.asarray(length, dtype=float)
    (a, b, c), least = (EMERGENCY if emergency else SERVICE)[position]
    x = np.maximum(lengths, least) / 100.0
    time = a + b * x + c * x**2
    if position == "passenger P":
        return time
    a, b, c = LONG_EMERGENCY if emergency else LONG_SERVICE
    x = lengths / 100.0
    return np.where(lengths > LONG, a + b * x + c * x**2, time)


def brake_of_percentage(
    percentage: np.ndarray | float, position: str, length: np.ndarray | float, resolution: float = 0.0
) -> ConvertedBrake:
    """Return what a brake percentage stands for in supervision, SUBSET-026, A.3.7 and A.3.8.

    Takes percentage [%], length [m].
    """
    name_among("brake_position", position, tuple(BRAKE_POSITIONS))
    resolution = finite("resolution", resolution)
    if not 0.0 <= resolution <= COARSEST:
        raise BadInputError(f"resolution must be 0 to {COARSEST:g} m/s; got {shown(resolution)}. Give 0 for none.")
    shares, lengths = numbers("percentage", percentage), numbers("length", length)
    if not np.all((shares >= LEAST) & (shares <= MOST)):
        raise BadInputError(
            f"The brake percentage must be {LEAST:g} to {MOST:g} % for the conversion model (SUBSET-026, A.3.7); got "
            f"{shown(shares.tolist())}. Give decelerations by speed instead."
        )
    if not np.all((lengths > 0.0) & (lengths <= BRAKE_POSITIONS[position])):
        raise BadInputError(
            f"The train must be longer than 0 m and at most {BRAKE_POSITIONS[position]:g} m long for the conversion "
            f"model in position {position} (SUBSET-026, A.3.7); got {shown(lengths.tolist())} m. Give decelerations by "
            "speed for a longer one."
        )
    return ConvertedBrake(
        deceleration_of(shares, resolution),
        deceleration_of(np.minimum(shares, SERVICE_MOST), resolution),
        build_up_time(position, lengths, emergency=True),
        build_up_time(position, lengths, emergency=False),
    )
