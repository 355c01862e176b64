"""Consists from files of other programs: rows of an importer, fitted to the limits of a consist."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from brake_controller.distributors.uic import UicDistributor, freight, reached_pressure
from products.train.consist import Consist, TrainVehicle
from products.train.consist_columns import COUPLING, NUMBERS, si
from products.train.consist_file import consist_of, read_consist
from readers.formats.trains import is_foreign, read_foreign
from readers.import_account import Imported, Row

#: Columns without which a row would be another vehicle; a value beyond their limits is refused.
ESSENTIAL = (
    *("kind", "count", "mass", "length", "lambda", "deceleration", "brake_force", "shoe_force", "brake"),
    *("brake_weight", "net_braking_ratio"),
    *("resistance_a", "resistance_b", "resistance_c", "friction_value"),
)
#: Columns of times, whose nearest limit is taken where a value is beyond it.
NEAREST = ("fill_time", "release_time", "dead_time", "dynamic_rise")
#: Columns with which others are left out, and what these all are.
WHOLE: dict[str, tuple[str, tuple[str, ...]]] = {
    "parking_force": ("hand brake is", ("parking_compounding",)),
    "dynamic_force": ("dynamic brake is", ("dynamic_fade", "dynamic_rise", "dynamic_power")),
    "traction_force": ("motors are", ("traction_power",)),
    "traction_power": ("motors are", ("traction_force",)),
}


def consist_from(path: Path) -> tuple[Consist, Imported | None]:
    """Return the consist in a file, and the account of its fields if it is of another program."""
    return imported_consist(path) if is_foreign(path) else (read_consist(path), None)


def imported_consist(path: Path) -> tuple[Consist, Imported]:
    """Return the consist in a file of another program, and the account of its fields.

    Values of columns that only refine a vehicle are left out beyond their limits, and told; of times the nearest limit
    is taken.
    """
    found = read_foreign(path)
    rows, outside = zip(*(_fitted(row) for row in found.rows), strict=True)
    places = [f"vehicle {row.get('name', number)}" for number, row in enumerate(rows, 1)]
    consist = consist_of(list(rows), str(path), places)
    left: dict[str, None] = {}
    at = 0
    for row, those in zip(rows, outside, strict=True):
        told = _defaults(consist.vehicles[at], row)
        left |= dict.fromkeys(f"{sentence}; {told[name]}." for name, sentence in those.items())
        at += int(row.get("count", 1))
    return consist, replace(found, rows=list(rows), left=[*found.left, *left])


def _fitted(row: Row) -> tuple[Row, dict[str, str]]:
    """Return a row with refinements within their limits, and the begin of a message on each that was beyond them."""
    kept, outside = dict(row), {}
    for name, value in row.items():
        if name in ESSENTIAL or name not in NUMBERS:
            continue
        column = NUMBERS[name]
        if not column.least <= value <= column.most:
            outside[name] = f"{name}: {value:.4g} is outside {column.limits}"
            del kept[name]
            if name in NEAREST and not math.isnan(value):
                kept[name] = min(max(value, column.least), column.most)
    for one in [name for name in WHOLE if name in outside]:
        for name in WHOLE[one][1]:
            kept.pop(name, None)
            outside.pop(name, None)
    if "full_pressure" in kept and kept.get("brake", "pneumatic") == "pneumatic" and not _is_reached(kept):
        pressure = kept.pop("full_pressure")
        outside["full_pressure"] = (
            f"full_pressure: a reservoir at 5 bar does not reach {pressure:.4g} bar in the cylinders, which have equal "
            "force"
        )
    volumes = [name for name in ("auxiliary", "cylinder") if name in kept]
    if volumes and not _is_reached(kept):
        for name in volumes:
            outside[name] = f"{name}: with {kept[name]:.4g} l a reservoir at 5 bar does not fill the cylinders"
        kept = {name: value for name, value in kept.items() if name not in volumes}
    return kept, outside


def _defaults(train_vehicle: TrainVehicle, row: Row) -> dict[str, str]:
    """Return what a vehicle has in place of each refinement that is left out, as the end of a sentence."""
    numbers = {
        "rotating": 100 * train_vehicle.rotating_share,
        "full_pressure": 1e-5 * train_vehicle.distributor.full_pressure,
        "shoes": train_vehicle.brake.shoes,
    }
    if isinstance(train_vehicle.distributor, UicDistributor):
        numbers["auxiliary"] = 1e3 * train_vehicle.distributor.auxiliary_volume
        numbers["cylinder"] = 1e3 * train_vehicle.distributor.cylinder_volume
    told = dict.fromkeys(NUMBERS, "it is left out")
    told |= {name: f"the {what} left out" for name, (what, _) in WHOLE.items()}
    told |= dict.fromkeys(COUPLING, f"that of the {train_vehicle.coupler.name} coupler is taken")
    told |= {name: f"the default of {value:.4g}{NUMBERS[name].of_unit} is taken" for name, value in numbers.items()}
    return told | {name: f"{row[name]:.4g} s is taken" for name in NEAREST if name in row}


def _is_reached(row: Mapping[str, Any]) -> bool:
    """Return whether the reservoir of a row reaches its cylinder pressure (Boyle)."""
    one = freight(str(row.get("position", "P")))
    if not isinstance(one, UicDistributor):
        return True
    volumes = {f"{name}_volume": si(row, name) for name in ("auxiliary", "cylinder") if name in row}
    return reached_pressure(replace(one, **volumes)) > si(row, "full_pressure", one.full_pressure)
