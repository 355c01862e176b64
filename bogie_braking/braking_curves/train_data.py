"""Train data of the command `etcs`, from a consist or from a file of train data."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace

import numpy as np

from bogie_braking.braking_curves.safety import Safety, safety_of
from bogie_braking.supervised import FromRuns, brake_units, supervised_train
from products.etcs_files.train_file import EtcsTrain, etcs_train_in
from products.supervision import Steps, SupervisedTrain, dry_factors, rounded_down
from products.supervision.conversion import MOST as LARGEST_PERCENTAGE
from products.train.consist import Consist
from products.train.imported_consist import consist_from
from readers.text import BadInputError

#: Largest speed by default [m/s].
LARGEST = 120.0 / 3.6
#: Options that train data state, and that a brake percentage excludes, with their defaults.
OF_FACTORS = {"dry": 1.0, "wet": 1.0, "failure": 0.0, "spread": 0.0, "common": 0.0, "tolerances": None}
STATED = {"position": None, "service": False, **OF_FACTORS}


@dataclass(frozen=True)
class TrainData:
    """Train data, and their source."""

    train: SupervisedTrain
    consist: Consist | None  # None: a file of train data gave the numbers
    runs: FromRuns | None = None  # stops that gave the numbers; None: the brake percentage gave them
    factors: np.ndarray | None = None  # Kdry_rst of the levels 0 to 9 by failures and spreads, rounded down
    safety: Safety | None = None  # the same by a file of tolerances, with its causes
    dry_by_level: tuple[Steps, ...] = ()  # Kdry_rst of the levels 0 to 9, if they are known
    source: str = ""  # in words; empty: own stops or the brake percentage


@contextmanager
def reading() -> Iterator[None]:
    """Make any refusal of a file one of bad input."""
    try:
        yield
    except ValueError as error:
        raise BadInputError(str(error)) from error


def train_data(chosen: argparse.Namespace, level: int) -> tuple[TrainData, float]:
    """Return train data of a file, by the brake percentage, or by own stops, and the largest speed [m/s]."""
    with reading():
        read = etcs_train_in(chosen.file)
        consist = None if read is not None else consist_from(chosen.file)[0]
    largest = LARGEST if chosen.speed is None else chosen.speed / 3.6
    if read is not None and read.train.maximum_speed is not None:
        most = float(np.asarray(read.train.maximum_speed))
        if chosen.speed is None:
            largest = most
        elif largest > most * (1.0 + 1e-9):
            raise BadInputError(
                f"--speed must be at most V_MAXTRAIN of the file, {3.6 * most:g} km/h; got {chosen.speed:g} km/h."
            )
    if read is not None:
        data = _of_file(chosen, read, level)
    else:
        assert consist is not None
        data = _of_consist(chosen, consist, largest, level)
    if chosen.level is not None and data.factors is None and data.train.level is None:
        raise BadInputError(
            "--level chooses among factors of --failure, --spread, --common above 0 %, --tolerances, or of train data "
            "by level; got none of them. Leave it out."
        )
    return data, largest


def _of_file(chosen: argparse.Namespace, read: EtcsTrain, level: int) -> TrainData:
    """Return train data as a file states them."""
    for name, default in STATED.items():
        if getattr(chosen, name) != default:
            raise BadInputError(
                f"--{name} must be left out for train data, which state it; got it with {chosen.file}. Change the file."
            )
    return TrainData(read.at_level(level), None, dry_by_level=read.dry_by_level, source=read.name or "train data")


def _of_consist(chosen: argparse.Namespace, consist: Consist, largest: float, level: int) -> TrainData:
    """Return train data by the brake percentage, or by own stops."""
    if chosen.position is not None:
        if any(getattr(chosen, name) != default for name, default in OF_FACTORS.items()):
            raise BadInputError("Factors act on decelerations, not on percentages. Leave them out with --position.")
        percentage = min(consist.percentage, LARGEST_PERCENTAGE)
        train = SupervisedTrain.of_percentage(
            percentage, chosen.position, consist.length, service_command=chosen.service, maximum_speed=largest
        )
        return TrainData(train, consist)
    varies = bool(chosen.failure or chosen.spread or chosen.common)
    if chosen.tolerances is not None and (varies or chosen.dry != 1.0):
        raise BadInputError(
            "--tolerances states what --dry, --failure, --spread and --common state too. Leave these out; "
            "the file has lost, spread and common for them."
        )
    if varies and chosen.dry != 1.0:
        raise BadInputError(
            "--dry states Kdry_rst, which follows from --failure, --spread and --common. Leave one out."
        )
    runs = supervised_train(consist, largest, service_command=chosen.service)
    train = replace(runs.train, Kdry_rst=Steps.constant(chosen.dry), Kwet_rst=Steps.constant(chosen.wet))
    safety = None
    if chosen.tolerances is not None:
        safety = safety_of(chosen.tolerances, consist, largest / 2.0, float(train.T_brake_emergency), level)
        factors = rounded_down(safety.factors)
        train = replace(train, T_brake_emergency=float(safety.build_up[level]))
    elif varies:
        units = brake_units(consist, largest / 2.0, chosen.failure, chosen.spread)
        factors = rounded_down(dry_factors(units, chosen.common))
    else:
        return TrainData(train, consist, runs)
    if not factors[level]:
        raise BadInputError(
            f"At level {level} no brake force is left: Kdry_rst is 0 with these failures and spreads. "
            "Give a lower --level or smaller numbers."
        )
    by_level = tuple(Steps.constant(factor) for factor in factors.tolist())
    train = replace(train, Kdry_rst=by_level[level], level=level)
    if safety is not None and np.ptp(safety.build_up):
        by_level = ()  # T_brake_emergency belongs to the level in use
    return TrainData(train, consist, runs, factors, safety, by_level)
