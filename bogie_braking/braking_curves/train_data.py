"""Train data of the command `etcs`, from the consist of a file."""

from __future__ import annotations

import argparse
from dataclasses import dataclass

import numpy as np

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
        Kdry_rst of the levels 0 to 9 by failures and spreads, if any are given.
    """

    train: SupervisedTrain
    consist: Consist
    runs: FromRuns | None = None
    factors: np.ndarray | None = None


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
        if (chosen.dry, chosen.wet, chosen.failure, chosen.spread, chosen.common) != (1.0, 1.0, 0.0, 0.0, 0.0):
            raise BadInputError("Factors act on decelerations, not on percentages. Leave them out with --position.")
        percentage = min(consist.percentage, 250.0)
        train = SupervisedTrain.of_percentage(
            percentage, chosen.position, consist.length, service_command=chosen.service, maximum_speed=largest
        )
        return TrainData(train, consist)
    runs = supervised_train(consist, largest, service_command=chosen.service)
    factors = _factors(chosen, consist, largest)
    dry = chosen.dry if factors is None else factors[chosen.level]
    return TrainData(with_factors(runs.train, dry, chosen.wet), consist, runs, factors)


def _factors(chosen: argparse.Namespace, consist: Consist, largest: float) -> np.ndarray | None:
    """Return Kdry_rst of all levels by failures and spreads, rounded down; None without any."""
    if not (chosen.failure or chosen.spread or chosen.common):
        return None
    if chosen.dry != 1.0:
        raise BadInputError(
            "--dry states Kdry_rst, which follows from --failure, --spread and --common. Leave one out."
        )
    units = brake_units(consist, largest / 2.0, chosen.failure, chosen.spread)
    factors = rounded_down(dry_factors(units, chosen.common))
    if not factors[chosen.level]:
        raise BadInputError(
            f"At level {chosen.level} no brake force is left: Kdry_rst is 0 with these failures and spreads. "
            "Give a lower --level or smaller numbers."
        )
    return factors
