"""The conversion model: decelerations and build-up times of a brake percentage, SUBSET-026, A.3.7 and A.3.8."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from brake_controller.brake_weight import (
    BANDS,
    BASIC,
    LEAST_PERCENTAGE,
    LIMIT_FACTOR,
    LIMIT_POWER,
    MOST_PERCENTAGE,
    SERVICE_PERCENTAGE,
    SHORT_TRAIN,
    BrakingKind,
)
from products.supervision.arguments import finite, name_among, numbers
from products.supervision.steps import Steps
from readers.text import BadInputError, shown

KMH = 1.0 / 3.6
#: Brake positions, and the longest train of each for which the model is defined [m].
BRAKE_POSITIONS = {"passenger P": 900.0, "freight P": 1500.0, "freight G": 1500.0}
#: Brake percentages [%] and largest speed [m/s] of the model; percentage above which a service brake gains nothing.
LEAST, MOST, FASTEST, SERVICE_MOST = LEAST_PERCENTAGE, MOST_PERCENTAGE, 200.0 * KMH, SERVICE_PERCENTAGE
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
    speed = LIMIT_FACTOR * np.power(percentage, LIMIT_POWER) * KMH
    return np.ceil(speed / resolution - 1e-9) * resolution if resolution else speed


def basic_decelerations(percentage: np.ndarray | float) -> np.ndarray:
    """Return all six steps of the basic deceleration, A.3.7.4 and A.3.7.5, also those that the model ignores.

    Takes percentage [%] (...); returns [m/s2] (..., 6).
    """
    share = np.asarray(percentage, dtype=float)[..., None]
    polynomials = [sum(factor * share**n for n, factor in enumerate(row)) for _, row in BANDS]
    return np.concatenate([BASIC[1] * share + BASIC[0], *polynomials], axis=-1)


def deceleration_of(percentage: np.ndarray | float, resolution: float = 0.0) -> Steps:
    """Return the deceleration of a brake percentage by speed, A.3.7.

    Takes percentage [%] (...); returns [m/s2].
    """
    share = np.asarray(percentage, dtype=float)[..., None]
    limit, ends = limit_speed(share, resolution), np.array([end for end, _ in BANDS[:-1]]) * KMH
    boundaries = np.concatenate([limit, np.maximum(limit, ends)], axis=-1)
    basic = basic_decelerations(percentage)
    ignored = np.concatenate([np.zeros_like(limit), limit > ends, np.zeros_like(limit)], axis=-1).astype(bool)
    return Steps(boundaries, np.where(ignored, basic[..., :1], basic))


def build_up_time(position: str, length: np.ndarray | float, emergency: bool) -> np.ndarray:
    """Return the equivalent build-up time for a target at rest, A.3.8.

    Takes length [m]; returns [s].
    """
    of = BrakingKind[f"{'EMERGENCY' if emergency else 'SERVICE'}_{position.upper().replace(' ', '_')}"].value
    lengths = np.asarray(length, dtype=float)
    x = np.maximum(lengths, of.least_length) / 100.0
    short, longer = (a + b * x + c * x**2 for a, b, c in (of.short, of.longer or of.short))
    return np.where(lengths > SHORT_TRAIN, longer, short)


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
