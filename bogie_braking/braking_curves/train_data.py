"""Train data of the command `etcs`, from a consist or from a file of train data."""

from __future__ import annotations

import argparse
from dataclasses import dataclass, replace

import numpy as np

from bogie_braking.braking_curves.safety import Safety, safety_of
from bogie_braking.supervised import FromRuns, brake_units, supervised_train, with_factors
from products.etcs_files.any_train import etcs_train_in
from products.etcs_files.train_file import EtcsTrain
from products.supervision import Steps, SupervisedTrain, dry_factors, rounded_down
from products.supervision.conversion import MOST as LARGEST_PERCENTAGE
from products.train.consist import Consist
from products.train.foreign import consist_from
from readers.text import BadInputError

#: Largest speed by default [m/s].
LARGEST = 120.0 / 3.6


@dataclass(frozen=True)
class TrainData:
    """Train data, and their source.

    Parameters
    ----------
    train : SupervisedTrain
        Numbers of the train.
    consist : Consist or None
        The train itself; None if a file of train data gave the numbers.
    runs : FromRuns or None
        Stops that gave the numbers; None if the brake percentage gave them.
    factors : ndarray or None
        Kdry_rst of the levels 0 to 9 by failures and spreads, rounded down, if any are given.
    safety : Safety or None
        The same by a file of tolerances, with its causes.
    dry_by_level : tuple of Steps
        Kdry_rst of the levels 0 to 9, if they are known.
    source : str
        Source of the numbers in words; empty: own stops or the brake percentage.
    """

    train: SupervisedTrain
    consist: Consist | None
    runs: FromRuns | None = None
    factors: np.ndarray | None = None
    safety: Safety | None = None
    dry_by_level: tuple[Steps, ...] = ()
    source: str = ""


def train_data(chosen: argparse.Namespace, level: int) -> tuple[TrainData, float]:
    """Return train data of a file, by the brake percentage, or by own stops, and the largest speed [m/s]."""
    try:
        read = etcs_train_in(chosen.file)
        consist = None if read is not None else consist_from(chosen.file)[0]
    except ValueError as error:
        raise BadInputError(str(error)) from error
    most = None if read is None else read.train.maximum_speed
    largest = LARGEST if chosen.speed is None else chosen.speed / 3.6
    if most is not None:
        if largest > float(np.asarray(most)) * (1.0 + 1e-9) and chosen.speed is not None:
            raise BadInputError(
                f"--speed must be at most V_MAXTRAIN of the file, {3.6 * float(np.asarray(most)):g} km/h; got "
                f"{chosen.speed:g} km/h."
            )
        largest = largest if chosen.speed is not None else float(np.asarray(most))
    found = _of_file(chosen, read, level) if consist is None and read else _of_consist(chosen, consist, largest, level)
    if chosen.level is not None and found.factors is None and found.train.level is None:
        raise BadInputError(
            "--level chooses among factors of --failure, --spread, --common above 0 %, --tolerances, or of train data "
            "by level; got none of them. Leave it out."
        )
    return found, largest


def _of_file(chosen: argparse.Namespace, read: EtcsTrain, level: int) -> TrainData:
    """Return train data as a file states them."""
    given = [
        name
        for name in ("position", "service", "dry", "wet", "failure", "spread", "common", "tolerances")
        if getattr(chosen, name) not in (None, False, 0.0, 1.0)
    ]
    if given:
        raise BadInputError(
            f"--{given[0]} must be left out for train data, which state it; got it with {chosen.file}. Change the file."
        )
    return TrainData(read.at_level(level), None, dry_by_level=read.dry_by_level, source=read.name or "train data")


def _of_consist(chosen: argparse.Namespace, consist: Consist | None, largest: float, level: int) -> TrainData:
    """Return train data by the brake percentage, or by own stops."""
    assert consist is not None
    if chosen.position is not None:
        given = (chosen.dry, chosen.wet, chosen.failure, chosen.spread, chosen.common, chosen.tolerances)
        if given != (1.0, 1.0, 0.0, 0.0, 0.0, None):
            raise BadInputError("Factors act on decelerations, not on percentages. Leave them out with --position.")
        percentage = min(consist.percentage, LARGEST_PERCENTAGE)
        train = SupervisedTrain.of_percentage(
            percentage, chosen.position, consist.length, service_command=chosen.service, maximum_speed=largest
        )
        return TrainData(train, consist)
    runs = supervised_train(consist, largest, service_command=chosen.service)
    safety = _safety(chosen, consist, largest, float(runs.train.T_brake_emergency), level)
    factors = _factors(chosen, consist, largest) if safety is None else rounded_down(safety.factors)
    train = runs.train
    if safety is not None:
        train = replace(train, T_brake_emergency=float(safety.build_up[level]))
    if factors is not None and not factors[level]:
        raise BadInputError(
            f"At level {level} no brake force is left: Kdry_rst is 0 with these failures and spreads. "
            "Give a lower --level or smaller numbers."
        )
    dry = chosen.dry if factors is None else factors[level]
    by_level = () if factors is None else tuple(Steps.constant(float(one)) for one in factors)
    if safety is not None and np.ptp(safety.build_up):
        by_level = ()  # T_brake_emergency belongs to the level in use
    train = replace(with_factors(train, dry, chosen.wet), level=None if factors is None else level)
    return TrainData(train, consist, runs, factors, safety, by_level)


def _safety(chosen: argparse.Namespace, consist: Consist, largest: float, build_up: float, level: int) -> Safety | None:
    """Return factors by the file of tolerances, if there is one."""
    if chosen.tolerances is None:
        return None
    if (chosen.dry, chosen.failure, chosen.spread, chosen.common) != (1.0, 0.0, 0.0, 0.0):
        raise BadInputError(
            "--tolerances states what --dry, --failure, --spread and --common state too. Leave these out; "
            "the file has lost, spread and common for them."
        )
    return safety_of(chosen.tolerances, consist, largest / 2.0, build_up, level)


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
