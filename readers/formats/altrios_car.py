"""Cars of ALTRIOS (YAML): numbers by all their spellings, in the units that their names state."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from readers.formats.vehicle_rows import checked, named_number
from readers.text import FileError, shown

#: Spellings of each number of a car, the newest first.
SPELLINGS: dict[str, tuple[str, ...]] = {
    "length": ("length_meters", "length", "Length (m)"),
    "axles": ("axle_count", "Axle Count"),
    "base": ("mass_static_base_kilograms", "mass_static_base", "Mass Static Base (kg)"),
    "freight": ("mass_freight_kilograms", "mass_freight", "Mass Freight (kg)"),
    "static": ("mass_static_kilograms", "mass_static", "Mass Static Loaded (kg)"),
    "ratio": ("braking_ratio", "Braking Ratio", "Braking Ratio Loaded"),
    "rotating": ("mass_rot_per_axle_kilograms", "mass_rot_per_axle", "mass_extra_per_axle", "Mass Extra per Axle (kg)"),
    "bearing": ("bearing_res_per_axle_newtons", "bearing_res_per_axle", "Bearing Res per Axle (N)"),
    "rolling": ("rolling_ratio", "Rolling Ratio"),
    "davis_b": ("davis_b_seconds_per_meter", "davis_b", "Davis B (s/m)"),
    "area": ("cd_area_square_meters", "cd_area", "drag_area", "Cd*A (m^2)", "Drag Area Cd*A Loaded (m^2)"),
}
#: Limits of each number.
LIMITS: dict[str, tuple[float, float, str]] = {
    "length": (1.0, 1000.0, "m"),
    "axles": (1, 400, ""),
    "base": (100.0, 1e7, "kg"),
    "freight": (0.0, 1e7, "kg"),
    "static": (100.0, 1e7, "kg"),
    "ratio": (0.0, 2.0, ""),
    "rotating": (0.0, 1e5, "kg"),
    "bearing": (0.0, 1e5, "N"),
    "rolling": (0.0, 0.1, ""),
    "davis_b": (0.0, 1.0, "s/m"),
    "area": (0.0, 100.0, "m2"),
}
#: Numbers that are 0 where a car does not have them; ALTRIOS itself refuses such a car.
OPTIONAL = {"freight", "rotating", "bearing", "davis_b", "area"}


@dataclass(frozen=True)
class Car:
    """A car: its name, its numbers by the names in SPELLINGS, and those of them that its file does not have."""

    name: str
    numbers: Mapping[str, float]
    missing: tuple[str, ...] = ()

    def with_area(self, area: float) -> Car:
        """Return the car with another drag area [m2]."""
        missing = tuple(one for one in self.missing if one not in SPELLINGS["area"])
        return replace(self, numbers={**self.numbers, "area": area}, missing=missing)


def _number(read: Mapping[str, Any], what: str, source: str, default: float | None = None) -> float:
    """Return a number of a car by any spelling. Raises FileError for another unit, or if it has no default either."""
    check_units(read, {what: SPELLINGS[what]}, source)
    for name in SPELLINGS[what]:
        if read.get(name) is not None:
            low, high, unit = LIMITS[what]
            return checked(named_number(read[name], name, source), name, (low, high), unit, source)
    if default is None:
        raise FileError(f"{source} must have {SPELLINGS[what][0]}; got {shown(', '.join(map(str, read)))}. Add it.")
    return default


def check_units(read: Mapping[str, Any], fields: Mapping[str, Sequence[str]], source: str) -> None:
    """Raise FileError if a field has another unit in its name than ALTRIOS writes, as length_feet or Length (ft)."""
    known = {name for names in (*SPELLINGS.values(), *fields.values()) for name in names}
    for names in fields.values():
        begins = tuple(f"{one.partition('(')[0]}(" if "(" in one else f"{one}_" for one in names[1:])
        for name in read:
            if str(name) not in known and str(name).startswith(begins):
                raise FileError(f"{source} must have {names[0]}; got {shown(name)}. Convert it to this unit.")


def car_of(read: Mapping[str, Any], source: str) -> Car:
    """Return a car of its file. Raises FileError."""
    name = read.get("car_type", read.get("Car Type", "car"))
    numbers = {what: _number(read, what, source) for what in ("length", "axles", "ratio", "rolling")}
    numbers |= {what: _number(read, what, source, 0.0) for what in ("rotating", "bearing", "davis_b", "area")}
    if any(one in read for one in SPELLINGS["base"]):
        numbers["mass"] = _number(read, "base", source) + _number(read, "freight", source, 0.0)
    else:
        numbers["mass"] = _number(read, "static", source)
    stated = {what for what, names in SPELLINGS.items() if any(read.get(one) is not None for one in names)}
    due = OPTIONAL if "base" in stated else OPTIONAL - {"freight"}
    return Car(_printable(name), numbers, tuple(SPELLINGS[what][0] for what in due - stated))


def _printable(name: Any) -> str:
    return "".join(one if one.isprintable() else " " for one in str(name))[:60].strip() or "car"
