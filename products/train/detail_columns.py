"""Columns of a consist that name a vehicle in detail, and back."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from products.registry import FMUS, fmu_named
from products.train.detail import Detail
from products.vehicle_sheet import DataSheet, read_sheet, unbraked
from rbd_model.levels.models import DEFAULT_DEPTH, DEFAULT_LEVEL, LEVELS
from rbd_model.train.vehicle import GRAVITY

#: Built-in vehicles with couplers, by the names of their FMUs.
BUILT_IN = ("vehicle", "coal-wagon")
#: Columns that a vehicle in detail determines.
DETERMINED = ("mass", "load", "tare", "rotating", "length", "wheel_diameter")
#: Running resistance a, b, c of a vehicle's parameters, W. J. Davis (1926).
DAVIS = ("davis_constant", "davis_linear", "davis_quadratic")


def detail_of(values: Mapping[str, Any]) -> Detail | None:
    """Return the vehicle in detail of a row, None without one. Raises ValueError, FileError."""
    if "detail" not in values:
        return None
    name = values["detail"]
    for one in DETERMINED:
        if one in values:
            raise ValueError(f"{one} must be left out with detail: it is that of the vehicle in detail. Leave it out.")
    level = int(values.get("level", DEFAULT_LEVEL)), int(values.get("contact_model", DEFAULT_DEPTH))
    if "contact_model" in values and level[0] != max(LEVELS):
        raise ValueError(
            f"contact_model has no effect at level {level[0]}. Leave it out, or set level to {max(LEVELS)}."
        )
    if name.lower().endswith(".toml"):
        sheet = read_sheet(name, _without_brake)
        if sheet.resistance and "resistance_a" in values:
            raise ValueError(f"resistance_a must be stated once; {name} has a resistance too. Leave one of both out.")
        return _of_sheet(sheet, name, *level)
    known = fmu_named(name)
    make = FMUS[known].vehicle if known in BUILT_IN else None
    if make is None:
        raise ValueError(f"detail must be coach, coal-wagon or a vehicle file, FILE.toml; got {name!r}. Correct it.")
    vehicle = make()
    return Detail(name, *level, vehicle, known, vehicle.parameters.values() | {"gravity": GRAVITY})


def _without_brake(read: Mapping[str, Any], name: str) -> DataSheet:
    """Return the vehicle of a file's content, with a note about its brake among its assumed values."""
    sheet, brake = unbraked(read, name)
    note = (
        {"brake": f"The [brake] of {name} has no effect in a train, which has the brake of its row."} if brake else {}
    )
    return replace(sheet, assumed=note)


def _of_sheet(sheet: DataSheet, name: str, level: int, contact_model: int) -> Detail:
    """Return the detail of a vehicle file at a level; its brake is that of the row."""
    stated = tuple(sheet.resistance.get(one, 0.0) for one in DAVIS) if sheet.resistance else None
    return Detail(
        name,
        level,
        contact_model,
        sheet.vehicle,
        sheet.fmu,
        sheet.parameters.values(),
        stated,  # type: ignore[arg-type]
        sheet.profile_files,
        sheet.assumed.get("brake", ""),
    )


def row_of_detail(detail: Detail | None) -> dict[str, Any]:
    """Return the columns that name a vehicle in detail."""
    if detail is None:
        return {}
    contact = {"contact_model": detail.contact_model} if detail.level == max(LEVELS) else {}
    return {"detail": detail.name, "level": detail.level} | contact
