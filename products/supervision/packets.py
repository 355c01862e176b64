"""Train data and national values in the resolution of their variables, rounded to the safe side.

Train data as SUBSET-027, 4.2.4.2 records them (message TRAIN DATA), national values as packet 3 has them (SUBSET-026,
7.5.1). No limit curve of the rounded numbers lies nearer to the target, from the speed of the foot of EBD on. Below it,
at a moving target, curves continue behind the target, where a weaker brake lies further. The guidance curve of a moving
target begins there, and may move towards it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from products.supervision.arguments import all_of_type
from products.supervision.conversion import KMH, MOVING_TARGET
from products.supervision.steps import Steps
from products.supervision.train import MOST_STEPS, SupervisedTrain, check_train
from products.supervision.values import NationalValues, check_national
from readers.text import BadInputError

#: Resolution, largest value and unit of a variable.
Limit = tuple[float, float, str]
#: Resolution, largest value and unit of decelerations, factors, build-up times, time of the cut-off and the length;
#: resolution of the largest speed [m/s]; speeds at which decelerations may change [m/s].
DECELERATION, FACTOR, BUILD_UP = (0.01, 2.55, "m/s2"), (0.05, 1.55, "1"), (0.05, 204.75, "s")
CUT_OFF, LENGTH = (0.01, 40.95, "s"), (1.0, 4095.0, "m")
V_MAXTRAIN, SPEEDS = 5.0 * KMH, np.arange(601) * KMH
#: Rotating masses that the variable has [%], and those between which the values without one are safe, 3.13.4.3.
MOST_ROTATING, SAFE_ROTATING = 15.0, (2.0, 15.0)
#: Packet 3: factors by speed, accelerations, speeds [m/s] and lengths [m] at which factors may change.
KV, REDUCED, KV_SPEEDS = (0.02, 2.54, "1"), (0.05, 3.15, "m/s2"), np.arange(0.0, 601.0, 5.0) * KMH
KR_LENGTHS = np.array([0.0, 25.0, 50.0, 75.0, 100.0, 150.0, *(100.0 * n for n in range(2, 28))])
#: Share of a resolution below which a difference is rounding of binary numbers.
NOISE = 1e-6
#: Attributes that a brake percentage states all at once.
OF_PERCENTAGE = ("A_brake_emergency", "A_brake_service", "T_brake_emergency", "T_brake_service")
#: Numbers of trains and countries that move: variable, attribute and unit.
OF_TRAINS = (
    ("L_TRAIN", "length", "m"),
    ("T_traction_cut_off", "T_traction_cut_off", "s"),
    ("T_brake_emergency", "T_brake_emergency", "s"),
    ("T_brake_service", "T_brake_service", "s"),
    ("M_BRAKE_PERCENTAGE", "percentage", "%"),
    ("A_brake_emergency", "A_brake_emergency", "m/s2"),
    ("A_brake_service", "A_brake_service", "m/s2"),
    ("Kdry_rst", "Kdry_rst", "1"),
    ("Kwet_rst", "Kwet_rst", "1"),
)
OF_COUNTRIES = (
    ("M_NVAVADH", "M_NVAVADH", "1"),
    ("A_NVP12", "A_NVP12", "m/s2"),
    ("A_NVP23", "A_NVP23", "m/s2"),
    ("M_NVKTINT", "Kt_int", "1"),
    ("A_NVMAXREDADH", "reduced_adhesion", "m/s2"),
    ("M_NVKVINT", "Kv_int", "1"),
    ("M_NVKVINT of set b", "Kv_int_b", "1"),
    ("M_NVKRINT", "Kr_int", "1"),
)


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
    length = _up("L_TRAIN", train.length, LENGTH)
    by_level: tuple[Steps, ...] = ()
    if train.percentage is not None:
        assert train.position is not None
        percentage = float(np.floor(float(np.asarray(train.percentage)) + NOISE))
        made = SupervisedTrain.of_percentage(percentage, train.position, length)
        brake: dict[str, Any] = {"percentage": percentage} | {name: getattr(made, name) for name in OF_PERCENTAGE}
        longer = (_number(made.T_brake_service) - _number(train.T_brake_service)) * MOVING_TARGET[train.position]
    elif train.position is not None:
        raise BadInputError(
            f"A train with position {train.position} must state its percentage, which is its train data; got "
            "decelerations alone. Make it with SupervisedTrain.of_percentage."
        )
    else:
        brake, by_level = _brake(train, dry_by_level)
        longer = brake["T_brake_service"] - _number(train.T_brake_service)
    # Traction is cut off T_bs2 before the emergency brake: a longer T_bs2 must not make this time earlier.
    later = longer if train.traction_command and train.service_command else 0.0
    rounded = replace(
        train,
        length=length,
        T_traction_cut_off=_up("T_traction_cut_off", _number(train.T_traction_cut_off) + later, CUT_OFF),
        rotating=_rotating(train.rotating),
        maximum_speed=_fastest(train.maximum_speed),
        **brake,
    )
    moves = _moves(OF_TRAINS, train, rounded)
    if train.rotating is not None and rounded.rotating is None:
        moves = (*moves, Move("M_rotating_nom", "% to unknown", _number(train.rotating)))
    return RoundedTrain(rounded, by_level, moves)


def _brake(train: SupervisedTrain, dry_by_level: Sequence[Steps]) -> tuple[dict[str, Any], tuple[Steps, ...]]:
    """Return the brake by decelerations, and Kdry_rst of all levels; deceleration and factors share their sections."""
    factors = {"Kdry_rst": train.Kdry_rst, "Kwet_rst": train.Kwet_rst}
    factors |= {f"Kdry_rst of level {n}": steps for n, steps in enumerate(dry_by_level)}
    given = {"A_brake_emergency": (train.A_brake_emergency, DECELERATION)}
    emergency, dry, wet, *by_level = _on_grid(
        SPEEDS, given | {name: (steps, FACTOR) for name, steps in factors.items()}
    )
    if emergency.values.size > MOST_STEPS:
        raise BadInputError(
            f"A_brake_emergency and its factors must share at most {MOST_STEPS} sections of speed (SUBSET-027, "
            f"4.2.4.2); got {emergency.values.size}. Give the factors the boundaries of the deceleration."
        )
    [service] = _on_grid(SPEEDS, {"A_brake_service": (train.A_brake_service, DECELERATION)})
    brake: dict[str, Any] = {"A_brake_emergency": emergency, "A_brake_service": service}
    for name in ("T_brake_service", "T_brake_emergency"):
        brake[name] = _up(name, getattr(train, name), BUILD_UP)
    return brake | {"Kdry_rst": dry, "Kwet_rst": wet}, tuple(by_level)


def _on_grid(places: np.ndarray, given: Mapping[str, tuple[Steps, Limit]]) -> list[Steps]:
    """Return step functions rounded down, on common boundaries that are among the places, nowhere above."""
    ends = np.unique(np.concatenate([steps.boundaries for steps, _ in given.values()]))
    if ends.size and ends[-1] > places[-1] * (1.0 + NOISE):
        raise BadInputError(
            f"{next(iter(given))} must have its last boundary at {places[-1]:g} or below; got {float(ends[-1]):g} "
            "(m/s or m)."
        )
    tolerance = NOISE * places[1]
    after = np.searchsorted(places, ends - tolerance)
    exact = np.abs(places[after] - ends) <= tolerance
    chosen = np.unique(np.concatenate([places[after], places[after[~exact] - 1]]))
    chosen = chosen[chosen > 0.0]
    rows = [_down(name, _lowest(steps, chosen, tolerance), limit) for name, (steps, limit) in given.items()]
    changes = np.any(np.diff(rows, axis=-1) != 0.0, axis=0)
    return [Steps(chosen[changes], row[np.append(True, changes)]) for row in rows]


def _lowest(steps: Steps, places: np.ndarray, tolerance: float) -> np.ndarray:
    """Return the lowest values between places."""
    first, last = np.append(0.0, places)[:, None], np.append(places, np.inf)[:, None]
    begins, ends = np.append(-np.inf, steps.boundaries), np.append(steps.boundaries, np.inf)
    touched = (begins < ends) & (begins < last - tolerance) & (ends > first + tolerance)
    return np.asarray(np.where(touched, steps.values, np.inf).min(axis=1))


def _down(name: str, values: np.ndarray, limit: Limit) -> np.ndarray:
    """Return values rounded down. Raises BadInputError if they have no place."""
    resolution, most, unit = limit
    rounded = np.round(np.floor(values / resolution + NOISE) * resolution, 6)
    end = "" if unit == "1" else f" {unit}"
    least = 0.0 if "level" in name else resolution  # no brake at a level bars that level, not the train
    if rounded.max() > most or rounded.min() < least:
        wrong = values.max() if rounded.max() > most else values.min()
        raise BadInputError(
            f"{name} must be {least:g} to {most:g}{end} in its variable; got {wrong:g}{end}. Correct it."
        )
    return rounded


def _up(name: str, value: object, limit: Limit) -> float:
    """Return a number rounded up. Raises BadInputError if it has no place."""
    number, (resolution, most, unit) = _number(value), limit
    rounded = float(np.round(np.ceil(number / resolution - NOISE) * resolution, 6)) + 0.0  # no -0.0
    if rounded > most:
        unit = "" if unit == "1" else unit
        raise BadInputError(f"{name} must be at most {most:g} {unit} in its variable; got {number:g}. Correct it.")
    return rounded


def _number(value: Any) -> float:
    return float(np.asarray(value, dtype=float))


def _rotating(share: object) -> float | None:
    """Return the rotating mass in whole percent; unknown where that is safe both uphill and downhill."""
    if share is None:
        return None
    number = _number(share)
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
    found = float(np.floor(_number(speed) / V_MAXTRAIN + NOISE) * V_MAXTRAIN)
    if not found:
        raise BadInputError("maximum_speed must be at least 5 km/h in its variable, V_MAXTRAIN; got less. Correct it.")
    return found


def _moves(names: Sequence[tuple[str, str, str]], before: object, after: object) -> tuple[Move, ...]:
    """Return the largest change of each number."""
    moves = []
    for name, attribute, unit in names:
        exact, rounded = getattr(before, attribute), getattr(after, attribute)
        if isinstance(exact, Steps):
            moves.append(Move(name, unit, _change(exact, rounded)))
        elif exact is not None:
            moves.append(Move(name, unit, float(np.abs(np.asarray(rounded) - np.asarray(exact)).max())))
    return tuple(moves)


def rounded_national(national: NationalValues) -> RoundedNational:
    """Return national values as packet 3 transmits them, none on the unsafe side."""
    check_national(national)
    sets = {"M_NVKVINT": (national.Kv_int, KV)}
    if national.Kv_int_b is not None:
        sets["M_NVKVINT of set b"] = (national.Kv_int_b, KV)
    kv = _on_grid(KV_SPEEDS, sets)
    [kr] = _on_grid(KR_LENGTHS, {"M_NVKRINT": (national.Kr_int, FACTOR)})
    adhesion = _down("A_NVMAXREDADH", np.array(national.reduced_adhesion), REDUCED)
    lower, upper = _between_sets(national, kv)
    rounded = replace(
        national,
        M_NVAVADH=float(np.round(np.floor(national.M_NVAVADH / FACTOR[0] + NOISE) * FACTOR[0], 6)),
        Kv_int=kv[0],
        Kv_int_b=kv[1] if len(kv) > 1 else None,
        A_NVP12=lower,
        A_NVP23=upper,
        Kr_int=kr,
        Kt_int=_up("M_NVKTINT", national.Kt_int, FACTOR),
        reduced_adhesion=(float(adhesion[0]), float(adhesion[1]), float(adhesion[2])),
    )
    return RoundedNational(rounded, _moves(OF_COUNTRIES, national, rounded))


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
