"""Train data and national values in the resolution of their variables, rounded to the safe side.

Train data as SUBSET-027, 4.2.4.2 records them (message TRAIN DATA), national values as packet 3 has them (SUBSET-026,
7.5.1). No limit curve of the rounded numbers lies nearer to the target, from the speed of the foot of EBD on. Below it,
at a moving target, curves continue behind the target, where a weaker brake lies further. The guidance curve of a moving
target begins there, and may move towards it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from products.supervision.arguments import all_of_type
from products.supervision.conversion import KMH, MOVING_TARGET
from products.supervision.steps import Steps
from products.supervision.train import MOST_STEPS, SupervisedTrain, check_train
from products.supervision.values import NationalValues, check_national
from readers.text import BadInputError

#: Resolution and largest value of decelerations [m/s2], factors [1], build-up times [s], time of the cut-off [s] and
#: the length [m]; resolution of the largest speed [m/s]; speeds at which decelerations may change [m/s].
DECELERATION, FACTOR, BUILD_UP, CUT_OFF = (0.01, 2.55), (0.05, 1.55), (0.05, 204.75), (0.01, 40.95)
LENGTH, V_MAXTRAIN, SPEEDS = (1.0, 4095.0), 5.0 * KMH, np.arange(601) * KMH
#: Rotating masses that the variable has [%], and those between which the values without one are safe, 3.13.4.3.
MOST_ROTATING, SAFE_ROTATING = 15.0, (2.0, 15.0)
#: Packet 3: factors by speed [1], accelerations [m/s2], speeds [m/s] and lengths [m] at which factors may change.
KV, REDUCED, KV_SPEEDS = (0.02, 2.54), (0.05, 3.15), np.arange(0.0, 601.0, 5.0) * KMH
KR_LENGTHS = np.array([0.0, 25.0, 50.0, 75.0, 100.0, 150.0, *(100.0 * n for n in range(2, 28))])
#: Share of a resolution below which a difference is rounding of binary numbers.
NOISE = 1e-6


@dataclass(frozen=True)
class Move:
    """Change of a number by rounding.

    Parameters
    ----------
    name : str
        Variable.
    unit : str
        Its unit.
    most : float
        Largest change among its values [unit]; 0 if all fitted. Between two places of its packet, a boundary has the
        lower step; this does not count.
    """

    name: str
    unit: str
    most: float


@dataclass(frozen=True)
class RoundedTrain:
    """A train in the resolution of train data, Kdry_rst of each level given, and what moved."""

    train: SupervisedTrain
    dry_by_level: tuple[Steps, ...]
    moves: tuple[Move, ...]


@dataclass(frozen=True)
class RoundedNational:
    """National values in the resolution of packet 3, and what moved."""

    national: NationalValues
    moves: tuple[Move, ...]


def rounded_train(train: SupervisedTrain, dry_by_level: Sequence[Steps] = ()) -> RoundedTrain:
    """Return a train as the on-board unit stores it, no number on the unsafe side."""
    check_train(train)
    all_of_type("dry_by_level", dry_by_level, Steps, "Give Steps for each level, or ().")
    if np.ndim(train.length) or train.A_brake_emergency.values.ndim > 1:
        raise BadInputError("Rounding takes one train; got several. Take them one by one.")
    length = _up("L_TRAIN", train.length, *LENGTH, "m")
    if train.percentage is not None:
        return _rounded_percentage(train, length)
    if train.position is not None:
        raise BadInputError(
            f"A train with position {train.position} must state its percentage, which is its train data; got "
            "decelerations alone. Make it with SupervisedTrain.of_percentage."
        )
    emergency, *factors = _sections(train, dry_by_level)
    [service] = _on_grid([train.A_brake_service], ["A_brake_service"], SPEEDS, [(*DECELERATION, "m/s2")])
    T_bs = _up("T_brake_service", train.T_brake_service, *BUILD_UP, "s")
    later = 0.0
    if train.traction_command and train.service_command:
        # Traction is cut off T_bs2 before the emergency brake: a longer T_bs2 must not make this time earlier.
        later = T_bs - float(train.T_brake_service)
    rounded = replace(
        train,
        length=length,
        A_brake_emergency=emergency,
        A_brake_service=service,
        T_brake_emergency=_up("T_brake_emergency", train.T_brake_emergency, *BUILD_UP, "s"),
        T_brake_service=T_bs,
        T_traction_cut_off=_up("T_traction_cut_off", float(train.T_traction_cut_off) + later, *CUT_OFF, "s"),
        Kdry_rst=factors[0],
        Kwet_rst=factors[1],
        rotating=_rotating(train.rotating),
        maximum_speed=_fastest(train.maximum_speed),
    )
    return RoundedTrain(rounded, tuple(factors[2:]), _moves(train, rounded))


def _sections(train: SupervisedTrain, dry_by_level: Sequence[Steps]) -> list[Steps]:
    """Return deceleration, Kdry_rst, Kwet_rst and those of all levels, which share their sections of speed."""
    names = ["A_brake_emergency", "Kdry_rst", "Kwet_rst", *(f"Kdry_rst of level {n}" for n in range(len(dry_by_level)))]
    given = [train.A_brake_emergency, train.Kdry_rst, train.Kwet_rst, *dry_by_level]
    found = _on_grid(given, names, SPEEDS, [(*DECELERATION, "m/s2"), *[(*FACTOR, "1")] * (len(given) - 1)])
    if found[0].values.size > MOST_STEPS:
        raise BadInputError(
            f"A_brake_emergency and its factors must share at most {MOST_STEPS} sections of speed (SUBSET-027, "
            f"4.2.4.2); got {found[0].values.size}. Give the factors the boundaries of the deceleration."
        )
    return found


def _on_grid(
    given: Sequence[Steps],
    names: Sequence[str],
    places: np.ndarray,
    limits: Sequence[tuple[float, float, str]],
) -> list[Steps]:
    """Return step functions rounded down, on common boundaries that are among the places, nowhere above."""
    ends = np.unique(np.concatenate([one.boundaries for one in given]))
    if ends.size and ends[-1] > places[-1] * (1.0 + NOISE):
        raise BadInputError(
            f"{names[0]} must have its last boundary at {places[-1]:g} or below; got {float(ends[-1]):g} (m/s or m)."
        )
    tolerance = NOISE * places[1]
    after = np.searchsorted(places, ends - tolerance)
    exact = np.abs(places[after] - ends) <= tolerance
    chosen = np.unique(np.concatenate([places[after], places[after[~exact] - 1]]))
    chosen = chosen[chosen > 0.0]
    rows = [
        _down(_lowest(one, chosen, tolerance), *limit, name)
        for one, name, limit in zip(given, names, limits, strict=True)
    ]
    changes = np.any(np.diff(rows, axis=-1) != 0.0, axis=0)
    return [Steps(chosen[changes], row[np.append(True, changes)]) for row in rows]


def _lowest(steps: Steps, places: np.ndarray, tolerance: float) -> np.ndarray:
    """Return the lowest values between places."""
    first, last = np.append(0.0, places)[:, None], np.append(places, np.inf)[:, None]
    begins, ends = np.append(-np.inf, steps.boundaries), np.append(steps.boundaries, np.inf)
    touched = (begins < ends) & (begins < last - tolerance) & (ends > first + tolerance)
    return np.asarray(np.where(touched, steps.values, np.inf).min(axis=1))


def _down(values: np.ndarray, resolution: float, most: float, unit: str, name: str) -> np.ndarray:
    """Return values rounded down. Raises BadInputError if they have no place."""
    found = np.round(np.floor(values / resolution + NOISE) * resolution, 6)
    end = "" if unit == "1" else f" {unit}"
    least = 0.0 if "level" in name else resolution  # no brake at a level bars that level, not the train
    if found.max() > most or found.min() < least:
        wrong = values.max() if found.max() > most else values.min()
        raise BadInputError(
            f"{name} must be {least:g} to {most:g}{end} in its variable; got {wrong:g}{end}. Correct it."
        )
    return found


def _up(name: str, value: object, resolution: float, most: float, unit: str) -> float:
    """Return a number rounded up. Raises BadInputError if it has no place."""
    number = float(np.asarray(value, dtype=float))
    found = float(np.round(np.ceil(number / resolution - NOISE) * resolution, 6)) + 0.0  # no -0.0
    if found > most:
        raise BadInputError(f"{name} must be at most {most:g} {unit} in its variable; got {number:g}. Correct it.")
    return found


def _rotating(share: object) -> float | None:
    """Return the rotating mass in whole percent; unknown where that is safe both uphill and downhill."""
    if share is None:
        return None
    number = float(np.asarray(share, dtype=float))
    if abs(number - round(number)) < NOISE and number <= MOST_ROTATING:
        return float(round(number))
    least, most = SAFE_ROTATING
    if least <= number <= most:
        return None
    raise BadInputError(
        f"M_rotating_nom must be an integer from 0 to 15 %, or lie from {least:g} to {most:g} %, where 'unknown' "
        f"is safe; got {number:g} %. Correct it."
    )


def _fastest(speed: object) -> float | None:
    """Return the largest speed rounded down, V_MAXTRAIN."""
    if speed is None:
        return None
    found = float(np.floor(float(np.asarray(speed, dtype=float)) / V_MAXTRAIN + NOISE) * V_MAXTRAIN)
    if not found:
        raise BadInputError("maximum_speed must be at least 5 km/h in its variable, V_MAXTRAIN; got less. Correct it.")
    return found


def _rounded_percentage(train: SupervisedTrain, length: float) -> RoundedTrain:
    """Return a train by its brake percentage, from which the on-board unit computes all else."""
    assert train.percentage is not None
    assert train.position is not None
    percentage = float(np.floor(float(np.asarray(train.percentage)) + NOISE))
    made = SupervisedTrain.of_percentage(percentage, train.position, length)
    later = 0.0
    if train.traction_command and train.service_command:
        longer = float(np.asarray(made.T_brake_service)) - float(np.asarray(train.T_brake_service))
        later = longer * MOVING_TARGET[train.position]
    cut_off = _up("T_traction_cut_off", float(train.T_traction_cut_off) + later, *CUT_OFF, "s")
    rounded = replace(
        train,
        length=length,
        percentage=percentage,
        A_brake_emergency=made.A_brake_emergency,
        A_brake_service=made.A_brake_service,
        T_brake_emergency=made.T_brake_emergency,
        T_brake_service=made.T_brake_service,
        T_traction_cut_off=cut_off,
        rotating=_rotating(train.rotating),
        maximum_speed=_fastest(train.maximum_speed),
    )
    return RoundedTrain(rounded, (), _moves(train, rounded))


def _moves(train: SupervisedTrain, rounded: SupervisedTrain) -> tuple[Move, ...]:
    """Return the largest change of each number."""
    moves = [
        Move(name, unit, abs(float(np.asarray(getattr(rounded, of))) - float(np.asarray(getattr(train, of)))))
        for name, of, unit in (
            ("L_TRAIN", "length", "m"),
            ("T_traction_cut_off", "T_traction_cut_off", "s"),
            ("T_brake_emergency", "T_brake_emergency", "s"),
            ("T_brake_service", "T_brake_service", "s"),
        )
    ]
    if rounded.percentage is not None and train.percentage is not None:
        moves.append(
            Move("M_BRAKE_PERCENTAGE", "%", abs(float(rounded.percentage) - float(np.asarray(train.percentage))))
        )
    for name, unit in (
        ("A_brake_emergency", "m/s2"),
        ("A_brake_service", "m/s2"),
        ("Kdry_rst", "1"),
        ("Kwet_rst", "1"),
    ):
        moves.append(Move(name, unit, _change(getattr(train, name), getattr(rounded, name))))
    if train.rotating is not None and rounded.rotating is None:
        moves.append(Move("M_rotating_nom", "% to unknown", float(np.asarray(train.rotating))))
    return tuple(moves)


def rounded_national(national: NationalValues) -> RoundedNational:
    """Return national values as packet 3 transmits them, none on the unsafe side."""
    check_national(national)
    sets = [national.Kv_int] if national.Kv_int_b is None else [national.Kv_int, national.Kv_int_b]
    names = ["M_NVKVINT", "M_NVKVINT of set b"][: len(sets)]
    kv = _on_grid(sets, names, KV_SPEEDS, [(*KV, "1")] * len(sets))
    [kr] = _on_grid([national.Kr_int], ["M_NVKRINT"], KR_LENGTHS, [(*FACTOR, "1")])
    adhesion = _down(np.array(national.reduced_adhesion), *REDUCED, "m/s2", "A_NVMAXREDADH")
    lower, upper = _between_sets(national, kv)
    rounded = replace(
        national,
        M_NVAVADH=float(np.round(np.floor(national.M_NVAVADH / FACTOR[0] + NOISE) * FACTOR[0], 6)),
        Kv_int=kv[0],
        Kv_int_b=kv[1] if len(kv) > 1 else None,
        A_NVP12=lower,
        A_NVP23=upper,
        Kr_int=kr,
        Kt_int=_up("M_NVKTINT", national.Kt_int, *FACTOR, ""),
        reduced_adhesion=(float(adhesion[0]), float(adhesion[1]), float(adhesion[2])),
    )
    moves = [
        Move(name, unit, float(np.abs(np.asarray(getattr(rounded, of)) - np.asarray(getattr(national, of))).max()))
        for name, of, unit in (
            ("M_NVAVADH", "M_NVAVADH", "1"),
            ("A_NVP12", "A_NVP12", "m/s2"),
            ("A_NVP23", "A_NVP23", "m/s2"),
            ("M_NVKTINT", "Kt_int", "1"),
            ("A_NVMAXREDADH", "reduced_adhesion", "m/s2"),
        )
    ]
    pairs = [*zip(names, sets, kv, strict=True), ("M_NVKRINT", national.Kr_int, kr)]
    return RoundedNational(rounded, (*moves, *(Move(name, "1", _change(one, other)) for name, one, other in pairs)))


def _between_sets(national: NationalValues, kv: Sequence[Steps]) -> tuple[float, float]:
    """Return A_NVP12 and A_NVP23 on multiples of 0.05 m/s2: up if set a is the lower one, down if set b is."""
    given = np.array([national.A_NVP12, national.A_NVP23])
    steps = given / REDUCED[0]
    up = down = True
    if len(kv) > 1:
        change = kv[1].with_others(lambda one, other: one - other, kv[0]).values
        up, down = bool(np.all(change >= 0.0)), bool(np.all(change <= 0.0))
    if not (up or down) and np.any(np.abs(steps - np.round(steps)) > NOISE):
        raise BadInputError(
            f"A_NVP12 and A_NVP23 must be multiples of 0.05 m/s2, as neither set of M_NVKVINT is the lower one; got "
            f"{given[0]:g} and {given[1]:g} m/s2. Give others."
        )
    found = np.round((np.ceil(steps - NOISE) if up else np.floor(steps + NOISE)) * REDUCED[0], 6)
    return float(found[0]) + 0.0, float(found[1]) + 0.0


def _change(one: Steps, other: Steps) -> float:
    """Return the largest change of the value of a step: the least one over its speeds, without moved boundaries."""
    change = one.with_others(lambda value, another: value - another, other)
    begins = np.append(0.0, change.boundaries)
    wide = np.append(np.diff(begins) > NOISE, True)
    steps = np.searchsorted(one.boundaries, begins + NOISE / 2.0)
    moved = np.abs(change.values)
    return max(float(moved[wide & (steps == n)].min()) for n in np.unique(steps[wide]))
