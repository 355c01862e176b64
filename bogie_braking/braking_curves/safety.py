"""Kdry_rst of the command `etcs` from a file of tolerances: factors, causes, and the price of one failure."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from bogie_braking.supervised import braked_vehicles
from products.supervision import (
    BrakedVehicles,
    Cause,
    OneFailure,
    Tolerances,
    build_up_of,
    causes_of,
    factors_of,
    one_failure,
)
from products.supervision.tolerances import ENTRIES
from products.tolerance_file import read_tolerances
from products.train.consist import Consist


@dataclass(frozen=True)
class Safety:
    """Factors of a train by its tolerances.

    Parameters
    ----------
    level : int
        Confidence level in use.
    factors, build_up : ndarray
        Kdry_rst and T_brake_emergency [s] of the levels 0 to 9, shape (10), not rounded.
    causes : list of Cause
        Causes at the level, the largest first.
    failures : list of OneFailure
        One vehicle without its brake, for each group.
    vehicles : list of BrakedVehicles
        The groups.
    """

    level: int
    factors: np.ndarray
    build_up: np.ndarray
    causes: list[Cause]
    failures: list[OneFailure]
    vehicles: list[BrakedVehicles]


def safety_of(path: Path, consist: Consist, speed: float, build_up: float, level: int) -> Safety:
    """Return the factors of a consist by a file of tolerances.

    Takes speed [m/s], build_up [s].
    """
    tolerances: Tolerances = read_tolerances(path)
    vehicles = braked_vehicles(consist, speed)
    return Safety(
        level,
        factors_of(vehicles, tolerances),
        build_up_of(vehicles, tolerances, build_up),
        causes_of(vehicles, tolerances, level),
        one_failure(vehicles, tolerances, level),
        vehicles,
    )


def lines_of(safety: Safety) -> list[str]:
    """Return the table of causes, and what one failure costs."""
    own = safety.factors[safety.level]
    lines = ["", f"Kdry_rst at level {safety.level} is {own:.3f} before rounding down. Instead it would be"]
    for one in safety.causes:
        entry = ENTRIES[one.name]
        lines.append(f"  {one.without:.3f} ({one.gain:+.3f}) without {one.name}: {100 * one.value:g} %, {entry.text}")
    for failure in safety.failures:
        group = safety.vehicles[failure.group]
        text = f"one vehicle of {1e-3 * group.force:.1f} kN unbraked, {100 * failure.share:.1f} % of the brake force"
        lines.append(f"  {failure.factor:.3f} ({failure.factor - own:+.3f}) with {text}")
    if np.ptp(safety.build_up):
        lines.append(f"T_brake_emergency with delays: {safety.build_up[safety.level]:.2f} s")
    return lines


def document_of(safety: Safety) -> dict[str, Any]:
    """Return what --json prints of it."""
    return {
        "level": safety.level,
        "Kdry_rst": safety.factors.tolist(),
        "T_brake_emergency_s": safety.build_up.tolist(),
        "causes": [
            {"name": one.name, "value": one.value, "Kdry_rst_without": one.without, "gain": one.gain}
            for one in safety.causes
        ],
        "one_vehicle_unbraked": [
            {"force_N": safety.vehicles[one.group].force, "share": one.share, "Kdry_rst": one.factor}
            for one in safety.failures
        ],
    }
