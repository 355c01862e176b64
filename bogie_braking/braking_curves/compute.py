"""Limits and own stops of the command `etcs`."""

from __future__ import annotations

import argparse
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from bogie_braking.braking_curves.train_data import TrainData, train_data
from bogie_braking.supervised import OwnStop, own_stops
from products.braking_curves.gradients_of_line import gradients_of
from products.etcs_files.national import read_national
from products.supervision import (
    BASELINES,
    Curves,
    FixedValues,
    Gradients,
    Move,
    NationalValues,
    SupervisedTrain,
    release_speed,
    rounded_national,
    rounded_train,
    supervise,
    without_effect,
)
from rbd_model.track.line import Line
from rbd_model.track.line_files import line_from_file
from readers.text import BadInputError

#: Numbers of speeds of tables and of curves.
IN_TABLE, IN_CURVES = 8, 160
#: Least shift of a limit by rounding [m]: less is the rounding of binary numbers.
SEEN = 1e-6


@dataclass(frozen=True)
class Shift:
    """Shift of a limit by rounding, at most: nearer to the target, further from it [m]; nearer up to a speed [m/s]."""

    name: str
    nearer: float
    further: float
    below: float


@dataclass(frozen=True)
class Found:
    """Results of the command.

    Parameters
    ----------
    data : TrainData
        The train.
    country : NationalValues
        National values, with the confidence level in use.
    kind : str
        Kind of the target.
    few, many : Curves
        Limits over speeds of the table and of the curves.
    stops : list of OwnStop
        Own stops from EBI at the speeds of the table.
    ends : float
        Place that no train may pass [m].
    gradients : Gradients
        Of the line.
    moves : tuple of Move
        What rounding changed, with `--rounded`.
    shifts : tuple of Shift
        What rounding changed in the limits, with `--rounded`.
    release_speed : float or None
        Release speed that the on-board unit calculates [m/s]; None without a supervised location behind the target.
    without_effect : tuple of str
        National values that change no limit of the train, with the reasons.
    covered : tuple of float or None
        Places where the rows of the line begin and end [m]; None: level.
    """

    data: TrainData
    country: NationalValues
    kind: str
    few: Curves
    many: Curves
    stops: list[OwnStop]
    ends: float
    gradients: Gradients
    moves: tuple[Move, ...] = ()
    shifts: tuple[Shift, ...] = ()
    release_speed: float | None = None
    without_effect: tuple[str, ...] = ()
    covered: tuple[float, float] | None = None


def compute(chosen: argparse.Namespace) -> Found:
    """Return the limits of the train before the target, and its own stops."""
    kind, line, country = _kind(chosen), _line(chosen), _country(chosen)
    data, largest = train_data(chosen, country.M_NVEBCL)
    _check_speeds(chosen, 3.6 * largest)
    target = chosen.target_speed / 3.6
    exact = data.train, country
    data, country, moves = _rounded(data, country) if chosen.rounded else (data, country, ())
    set_up: dict[str, Any] = {
        "kind": kind,
        "target_speed": target,
        "beyond": chosen.beyond,
        "gradients": Gradients.level() if line is None else gradients_of(line),
        "fixed": FixedValues(T_indication_more=BASELINES[chosen.baseline]),
        "national": country,
        "slippery": chosen.slippery,
    }
    few = target + (largest - target) * np.arange(1, IN_TABLE + 1) / IN_TABLE
    many = target + (largest - target) * np.arange(1, IN_CURVES + 1) / IN_CURVES
    limits = supervise(data.train, chosen.target, few, **set_up)
    if not np.all(np.isfinite(limits.EBI)):
        raise BadInputError("The train cannot brake on the gradients before the target. Give a better brake or line.")
    stops = [] if kind != "EOA" or data.consist is None else own_stops(data.consist, few, limits.EBI, line)
    curves = supervise(data.train, chosen.target, many, **set_up)
    shifts = _shifts(*exact, chosen.target, curves, set_up) if chosen.rounded else ()
    ends = chosen.target + chosen.beyond
    release = None
    if chosen.beyond:
        others = {name: set_up[name] for name in ("gradients", "fixed", "national", "slippery")}
        release = release_speed(data.train, chosen.beyond, place=chosen.target, **others)
    silent = tuple(without_effect(data.train, country, chosen.slippery))
    covered = None if line is None else (float(line.rows["distance"][0]), float(line.rows["distance"][-1]))
    return Found(
        data, country, kind, limits, curves, stops, ends, set_up["gradients"], moves, shifts, release, silent, covered
    )


def _check_speeds(chosen: argparse.Namespace, largest: float) -> None:
    if chosen.target_speed >= largest:
        raise BadInputError(
            f"--target-speed must be below --speed, {largest:g} km/h; got {chosen.target_speed:g} km/h. Correct one."
        )


def _kind(chosen: argparse.Namespace) -> str:
    """Return the kind of target, if speeds and distances belong to it."""
    if chosen.speed is not None:
        _check_speeds(chosen, chosen.speed)
    kind: str = chosen.kind or ("LOA" if chosen.target_speed else "EOA")
    if kind == "EOA" and chosen.target_speed:
        raise BadInputError(
            f"--target-speed must be 0 with --kind EOA, an end of authority; got {chosen.target_speed:g} km/h. Give "
            "LOA or MRSP."
        )
    if kind != "EOA" and chosen.beyond:
        raise BadInputError(
            f"--beyond is the distance behind a stop; leave it out with --target-speed or --kind {kind}."
        )
    return kind


def _country(chosen: argparse.Namespace) -> NationalValues:
    """Return the national values, with the confidence level of the command line."""
    try:
        country = NationalValues() if chosen.national is None else read_national(chosen.national)
    except ValueError as error:
        raise BadInputError(str(error)) from error
    return country if chosen.level is None else replace(country, M_NVEBCL=chosen.level)


def _rounded(data: TrainData, country: NationalValues) -> tuple[TrainData, NationalValues, tuple[Move, ...]]:
    """Return train and country as their packets hold them, and what moved."""
    train, values = rounded_train(data.train, data.dry_by_level), rounded_national(country)
    moves = tuple(move for move in (*train.moves, *values.moves) if move.most > 1e-9)
    return replace(data, train=train.train, dry_by_level=train.dry_by_level), values.national, moves


def _shifts(
    train: SupervisedTrain, country: NationalValues, place: float, after: Curves, set_up: dict[str, Any]
) -> tuple[Shift, ...]:
    """Return the shifts of all limits from those of the exact train and country."""
    before, found = supervise(train, place, after.V_est, **set_up | {"national": country}), []
    for name in ("I", "P", "W", "SBI", "EBI", "EBD", "GUI"):
        one, other = getattr(before, name), getattr(after, name)
        if one is not None and np.all(np.isfinite(one) & np.isfinite(other)):
            moved = other - one
            near = moved > SEEN
            below = float(after.V_est[near].max()) if near.any() else 0.0
            found.append(Shift(name, float(moved[near].max(initial=0.0)), float(max(-moved.min(), 0.0)), below))
    return tuple(found)


def _line(chosen: argparse.Namespace) -> Line | None:
    try:
        return None if chosen.line is None else line_from_file(chosen.line)
    except ValueError as error:
        raise BadInputError(str(error)) from error
