"""Limits and own stops of the command `etcs`."""

from __future__ import annotations

import argparse
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from bogie_braking.braking_curves.train_data import TrainData, reading, train_data
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
    release_speed,
    rounded_national,
    rounded_train,
    supervise,
    without_effect,
)
from rbd_model.track.line import FRICTIONS, Line
from rbd_model.track.line_files import line_from_file
from readers.text import BadInputError

#: Numbers of speeds of tables and of curves.
IN_TABLE, IN_CURVES = 8, 160
#: Limits in the order in which they are met, and limits of some targets and countries alone.
LIMITS, OTHERS = ("I", "P", "W", "SBI", "EBI", "EBD"), ("GUI", "SBI1", "SBI2", "SBD")
#: Least shift of a limit by rounding [m]: less is the rounding of binary numbers.
SEEN = 1e-6


@dataclass(frozen=True)
class LimitShift:
    """Shift of a limit by rounding, at most: nearer to the target, further from it [m]; nearer up to a speed [m/s]."""

    name: str
    nearer: float
    further: float
    below: float


@dataclass(frozen=True)
class CurveResults:
    """Results of the command."""

    chosen: argparse.Namespace
    data: TrainData
    country: NationalValues  # with the confidence level in use
    kind: str  # of the target
    few: Curves  # over speeds of the table
    many: Curves  # over speeds of the curves
    stops: list[OwnStop]  # from EBI at the speeds of the table
    gradients: Gradients
    line: Line | None  # None: level
    moves: tuple[Move, ...]  # what --rounded changed in train data and national values
    shifts: tuple[LimitShift, ...]  # what --rounded changed in the limits
    release_speed: float | None  # [m/s]; None without a supervised location behind the target
    without_effect: list[str]  # national values that change no limit of the train, with the reasons

    @property
    def covered(self) -> tuple[float, float] | None:
        """Return the places where the rows of the line begin and end [m], None without a line."""
        return (
            None if self.line is None else (float(self.line.rows["distance"][0]), float(self.line.rows["distance"][-1]))
        )

    @property
    def least_friction(self) -> float:
        """Return the least factor of the line on the friction of a rail."""
        rows = {} if self.line is None else self.line.rows
        return min((float(rows[name].min()) for name in FRICTIONS if name in rows), default=1.0)

    @property
    def ends(self) -> float:
        """Return the place that no train may pass [m]."""
        return float(self.chosen.target + self.chosen.beyond)

    @property
    def limits(self) -> list[str]:
        """Return the names of the limits that the target has."""
        return [*LIMITS, *(name for name in OTHERS if getattr(self.few, name) is not None)]

    def distances(self, names: list[str]) -> list[list[float]]:
        """Return rows of speed [km/h] and distances of limits and own stops before the end [m]."""
        columns = [getattr(self.few, name).tolist() for name in names]
        columns += [[stop.ends for stop in self.stops]] if self.stops else []
        speeds = (3.6 * self.few.V_est).tolist()
        return [[speed, *(self.ends - place for place in row)] for speed, *row in zip(speeds, *columns, strict=True)]


def compute(chosen: argparse.Namespace) -> CurveResults:
    """Return the limits of the train before the target, and its own stops."""
    kind = _kind(chosen)
    with reading():
        line = None if chosen.line is None else line_from_file(chosen.line)
        country = NationalValues() if chosen.national is None else read_national(chosen.national)
    country = country if chosen.level is None else replace(country, M_NVEBCL=chosen.level)
    data, largest = train_data(chosen, country.M_NVEBCL)
    _check_speeds(chosen, 3.6 * largest)
    exact, exact_country = data.train, country
    moves: tuple[Move, ...] = ()
    shifts: tuple[LimitShift, ...] = ()
    if chosen.rounded:
        data, country, moves = _rounded(data, country)
    common: dict[str, Any] = {
        "gradients": Gradients.level() if line is None else gradients_of(line),
        "fixed": FixedValues(T_indication_more=BASELINES[chosen.baseline]),
        "slippery": chosen.slippery,
    }
    target = chosen.target_speed / 3.6
    towards = common | {"kind": kind, "target_speed": target, "beyond": chosen.beyond}
    few, many = (
        supervise(
            data.train,
            chosen.target,
            target + (largest - target) * np.arange(1, number + 1) / number,
            national=country,
            **towards,
        )
        for number in (IN_TABLE, IN_CURVES)
    )
    if not np.all(np.isfinite(few.EBI)):
        raise BadInputError("The train cannot brake on the gradients before the target. Give a better brake or line.")
    stops = [] if kind != "EOA" or data.consist is None else own_stops(data.consist, few.V_est, few.EBI, line)
    if chosen.rounded:
        before = supervise(exact, chosen.target, many.V_est, national=exact_country, **towards)
        shifts = _shifts(before, many)
    release = None
    if chosen.beyond:
        release = release_speed(data.train, chosen.beyond, place=chosen.target, national=country, **common)
    silent = without_effect(data.train, country, chosen.slippery)
    gradients = common["gradients"]
    return CurveResults(chosen, data, country, kind, few, many, stops, gradients, line, moves, shifts, release, silent)


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


def _rounded(data: TrainData, country: NationalValues) -> tuple[TrainData, NationalValues, tuple[Move, ...]]:
    """Return train and country as their packets hold them, and what moved."""
    train, values = rounded_train(data.train, data.dry_by_level), rounded_national(country)
    moves = tuple(move for move in (*train.moves, *values.moves) if move.most > 1e-9)
    return replace(data, train=train.train, dry_by_level=train.dry_by_level), values.national, moves


def _shifts(before: Curves, after: Curves) -> tuple[LimitShift, ...]:
    """Return the shifts of all limits from those of the exact train and country."""
    shifts = []
    for name in (*LIMITS, "GUI"):
        exact, rounded = getattr(before, name), getattr(after, name)
        if exact is not None and np.all(np.isfinite(exact) & np.isfinite(rounded)):
            moved = rounded - exact
            near = moved > SEEN
            below = float(after.V_est[near].max()) if near.any() else 0.0
            shifts.append(LimitShift(name, float(moved[near].max(initial=0.0)), float(max(-moved.min(), 0.0)), below))
    return tuple(shifts)
