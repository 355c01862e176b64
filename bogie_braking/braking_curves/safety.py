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
    """Factors of a train by its tolerances: Kdry_rst and T_brake_emergency [s] of the levels 0 to 9, not rounded."""

    level: int  # in use
    factors: np.ndarray
    build_up: np.ndarray
    causes: list[Cause]  # at the level, the largest first
    failures: list[OneFailure]  # one vehicle without its brake, for each group
    vehicles: list[BrakedVehicles]


def safety_of(path: Path, consist: Consist, speed: float, build_up: float, level: int) -> Safety:
    """Return the factors of a consist by a file of tolerances.

    Takes speed [m/s], build_up [s].
    """
    tolerances, vehicles = read_tolerances(path), braked_vehicles(consist, speed)
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
    factor = safety.factors[safety.level]
    lines = ["", f"Kdry_rst at level {safety.level} is {factor:.3f} before rounding down. Instead it would be"]
    for cause in safety.causes:
        text = f"{100 * cause.value:g} %, {ENTRIES[cause.name].text}"
        lines.append(f"  {cause.without:.3f} ({cause.gain:+.3f}) without {cause.name}: {text}")
    for failure in safety.failures:
        force = 1e-3 * safety.vehicles[failure.group].force
        text = f"one vehicle of {force:.1f} kN unbraked, {100 * failure.share:.1f} % of the brake force"
        lines.append(f"  {failure.factor:.3f} ({failure.factor - factor:+.3f}) with {text}")
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
            {"name": cause.name, "value": cause.value, "Kdry_rst_without": cause.without, "gain": cause.gain}
            for cause in safety.causes
        ],
        "one_vehicle_unbraked": [
            {"force_N": safety.vehicles[failure.group].force, "share": failure.share, "Kdry_rst": failure.factor}
            for failure in safety.failures
        ],
    }
