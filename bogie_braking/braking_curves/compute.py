"""Limits and own stops of the command `etcs`."""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from typing import Any

import numpy as np

from bogie_braking.braking_curves.train_data import TrainData, train_data
from bogie_braking.supervised import OwnStop, own_stops
from products.braking_curves.gradients_of_line import gradients_of
from products.supervision import BASELINES, Curves, FixedValues, Gradients, supervise
from rbd_model.track.line import Line
from rbd_model.track.line_files import line_from_file
from readers.text import BadInputError

#: Numbers of speeds of tables and of curves.
IN_TABLE, IN_CURVES = 8, 160


@dataclass(frozen=True)
class Found:
    """Train data, limits over few and many speeds, own stops, the place that no train may pass [m], gradients."""

    data: TrainData
    few: Curves
    many: Curves
    stops: list[OwnStop]
    ends: float
    gradients: Gradients


def compute(chosen: argparse.Namespace) -> Found:
    """Return the limits of the train before the target, and its own stops.

    Parameters
    ----------
    chosen : Namespace
        Options of the command.

    Raises
    ------
    BadInputError
        If a file cannot be read, options contradict each other, or the train cannot brake.
    """
    largest, target = chosen.speed / 3.6, chosen.target_speed / 3.6
    line = _line(chosen)
    data = train_data(chosen, largest)
    set_up: dict[str, Any] = {
        "kind": "LOA" if target else "EOA",
        "target_speed": target,
        "beyond": 0.0 if target else chosen.beyond,
        "gradients": Gradients.level() if line is None else gradients_of(line),
        "fixed": FixedValues(T_indication_more=BASELINES[chosen.baseline]),
    }
    few = target + (largest - target) * np.arange(1, IN_TABLE + 1) / IN_TABLE
    many = target + (largest - target) * np.arange(1, IN_CURVES + 1) / IN_CURVES
    limits = supervise(data.train, chosen.target, few, **set_up)
    if not np.all(np.isfinite(limits.EBI)):
        raise BadInputError("The train cannot brake on the gradients before the target. Give a better brake or line.")
    stops = [] if target else own_stops(data.consist, few, limits.EBI, line)
    curves = supervise(data.train, chosen.target, many, **set_up)
    return Found(data, limits, curves, stops, chosen.target + set_up["beyond"], set_up["gradients"])


def check(chosen: argparse.Namespace) -> None:
    """Refuse a target that is not slower than the train, and a supervised location behind a moving target."""
    if chosen.target_speed >= chosen.speed:
        raise BadInputError(
            f"--target-speed must be below --speed, {chosen.speed:g} km/h; got {chosen.target_speed:g} km/h."
        )
    if chosen.target_speed and chosen.beyond:
        raise BadInputError("--beyond is the distance behind a stop; leave it out with --target-speed.")


def _line(chosen: argparse.Namespace) -> Line | None:
    try:
        return None if chosen.line is None else line_from_file(chosen.line)
    except ValueError as error:
        raise BadInputError(str(error)) from error
