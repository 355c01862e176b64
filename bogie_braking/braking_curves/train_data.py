"""Train data of the command `etcs`, from the consist of a file."""

from __future__ import annotations

import argparse
from dataclasses import dataclass, replace

import numpy as np

from bogie_braking.braking_curves.safety import Safety, safety_of
from bogie_braking.supervised import FromRuns, brake_units, supervised_train, with_factors
from products.supervision import SupervisedTrain, dry_factors, rounded_down
from products.train.consist import Consist
from products.train.foreign import consist_from
from readers.text import BadInputError


@dataclass(frozen=True)
class TrainData:
    """Train data, and their source.

    Parameters
    ----------
    train : SupervisedTrain
        Numbers of the train.
    consist : Consist
        The train itself.
    runs : FromRuns or None
        Stops that gave the numbers; None if the brake percentage gave them.
    factors : ndarray or None
        Kdry_rst of the levels 0 to 9 by failures and spreads, rounded down, if any are given.
    safety : Safety or None
        The same by a file of tolerances, with its causes.
    """

    train: SupervisedTrain
    consist: Consist
    runs: FromRuns | None = None
    factors: np.ndarray | None = None
    safety: Safety | None = None


def train_data(chosen: argparse.Namespace, largest: float) -> TrainData:
    """Return train data by the brake percentage, or by own stops.

    Parameters
    ----------
    chosen : Namespace
        Options of the command.
    largest : float
        Largest speed [m/s].

    Raises
    ------
    BadInputError
        If options contradict each other, or the train has no such data.
    """
    try:
        consist, _ = consist_from(chosen.file)
    except ValueError as error:
        raise BadInputError(str(error)) from error
    if chosen.position is not None:
        given = (chosen.dry, chosen.wet, chosen.failure, chosen.spread, chosen.common, chosen.tolerances)
        if given != (1.0, 1.0, 0.0, 0.0, 0.0, None):
            raise BadInputError("Factors act on decelerations, not on percentages. Leave them out with --position.")
        percentage = min(consist.percentage, 250.0)
        train = SupervisedTrain.of_percentage(
            percentage, chosen.position, consist.length, service_command=chosen.service, maximum_speed=largest
        )
        return TrainData(train, consist)
    runs = supervised_train(consist, largest, service_command=chosen.service)
    safety = _safety(chosen, consist, largest, float(runs.train.T_brake_emergency))
    factors = _factors(chosen, consist, largest) if safety is None else rounded_down(safety.factors)
    train = runs.train
    if safety is not None:
        train = replace(train, T_brake_emergency=float(safety.build_up[chosen.level]))
    if factors is not None and not factors[chosen.level]:
        raise BadInputError(
            f"At level {chosen.level} no brake force is left: Kdry_rst is 0 with these failures and spreads. "
            "Give a lower --level or smaller numbers."
        )
    dry = chosen.dry if factors is None else factors[chosen.level]
    return TrainData(with_factors(train, dry, chosen.wet), consist, runs, factors, safety)


def _safety(chosen: argparse.Namespace, consist: Consist, largest: float, build_up: float) -> Safety | None:
    """Return factors by the file of tolerances, if there is one."""
    if chosen.tolerances is None:
        return None
    if (chosen.dry, chosen.failure, chosen.spread, chosen.common) != (1.0, 0.0, 0.0, 0.0):
        raise BadInputError(
            "--tolerances states what --dry, --failure, --spread and --common state too. Leave these out; "
            "the file has lost, spread and common for them."
        )
    return safety_of(chosen.tolerances, consist, largest / 2.0, build_up, chosen.level)


def _factors(chosen: argparse.Namespace, consist: Consist, largest: float) -> np.ndarray | None:
    """Return Kdry_rst of all levels by failures and spreads, rounded down; None without any."""
    if not (chosen.failure or chosen.spread or chosen.common):
        return None
    if chosen.dry != 1.0:
        raise BadInputError(
            "--dry states Kdry_rst, which follows from --failure, --spread and --common. Leave one out."
        )
    units = brake_units(consist, largest / 2.0, chosen.failure, chosen.spread)
    return rounded_down(dry_factors(units, chosen.common))
