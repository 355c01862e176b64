"""Entries of a vehicle file: names, units, limits; numbers with their units, read within the limits."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import Field, dataclass
from typing import Any

from fmu_src.suggestion import suggestion
from rbd_model.vehicle.description import LARGEST_RADIUS, LONGEST_VEHICLE, SMALLEST_RADIUS
from rbd_model.vehicle.parameters import (
    LEAST_BODY,
    LEAST_FRAME,
    LEAST_WHEELSET,
    BogieParameters,
    coach_with_traction_rods,
    coal_wagon,
    tables_5_1_and_5_2,
)
from readers.command_line import number_in
from readers.documents import is_number
from readers.text import quoted, shown
from readers.units import different_units
from readers.usual import SOFTEST, likely_unit

#: Vehicles whose values are assumed where a file has none: their description, and their parameters.
LIKE: Mapping[str, tuple[str, Callable[[], BogieParameters]]] = {
    "coach": ("passenger coach, vehicle 1 of the Manchester benchmarks with traction rods", coach_with_traction_rods),
    "coal-wagon": ("freight wagon on two bogies of chapter 5", coal_wagon),
    "bogie": ("one body on two wheelsets, chapter 5", tables_5_1_and_5_2),
}


@dataclass(frozen=True)
class Entry:
    """A number of a vehicle file: unit of a value without one, limits in it, meaning.

    parameter: that of the set which it gives alone. above_rail: it is a height above the rail; the set has that above
    the axles. whole: it is an integer. above_0: smallest value above 0; a smaller one is in another unit.
    """

    unit: str
    least: float
    most: float
    text: str
    parameter: str = ""
    above_rail: bool = False
    whole: bool = False
    above_0: float = 0.0


HEAVIEST = 1e6
ENTRIES: Mapping[str, Entry] = {
    "axles": Entry("1", 2, 6, "number of wheelsets: 2, 4 or 6"),
    "tare": Entry("kg", LEAST_BODY, HEAVIEST, "mass of the empty vehicle on the rails"),
    "load": Entry("kg", 0.0, HEAVIEST, "load in or on the body", above_0=50.0),
    "bogie_frame_mass": Entry("kg", LEAST_FRAME, HEAVIEST, "one bogie without its wheelsets", "frame_mass"),
    "wheelset_mass": Entry("kg", LEAST_WHEELSET, HEAVIEST, "one wheelset", "wheelset_mass"),
    "rotating_mass": Entry("kg", LEAST_WHEELSET, HEAVIEST, "equivalent mass of all rotating parts at the rims"),
    "wheel_diameter": Entry("m", 2 * SMALLEST_RADIUS, 2 * LARGEST_RADIUS, "at the tread", "wheel_radius"),
    "length": Entry("m", 1.0, LONGEST_VEHICLE, "over the couplers", "coupler_distance"),
    "pivot_distance": Entry("m", 0.5, LONGEST_VEHICLE, "between the middles of both bogies", "pivot_distance"),
    "wheel_base": Entry(
        "m", 0.1, LONGEST_VEHICLE, "between neighbouring axles of a bogie, or of 2 axles", "wheel_base"
    ),
    "body_height": Entry("m", 0.1, 5.0, "centre of mass of the body above the rail", "body_height", True),
    "frame_height": Entry("m", 0.05, 5.0, "centre of mass of a bogie frame above the rail", "frame_height", True),
    "secondary_height": Entry("m", 0.05, 5.0, "secondary springs above the rail", "secondary_height", True),
    "coupler_height": Entry("m", 0.05, 5.0, "couplers above the rail", "coupler_height", True),
}
#: Running resistance a + b v + c v^2 of the whole vehicle (Davis 1926): the FMU's parameters, and the entries.
RESISTANCE: Mapping[str, tuple[str, Entry]] = {
    "constant": ("davis_constant", Entry("N", 0.0, 1e6, "a")),
    "linear": ("davis_linear", Entry("N.s/m", 0.0, 1e6, "b")),
    "quadratic": ("davis_quadratic", Entry("N.s2/m2", 0.0, 1e6, "c")),
}


def parameter_entry(item: Field[Any]) -> Entry:
    """Return the entry for a parameter of a set, by its unit and limits."""
    about = item.metadata
    whole = about["kind"] == "integer"
    above_0 = SOFTEST if about["unit"] == "N/m" else 0.0
    return Entry(about["unit"], about["minimum"], about["maximum"], about["description"], whole=whole, above_0=above_0)


def number_of(entry: Entry, value: Any, name: str) -> float:
    """Return a number of a file in SI units."""
    found: float | None = None
    if isinstance(value, str):
        found = number_in(value, entry.unit)
    elif is_number(value):
        found = float(value)
    inside = found is not None and math.isfinite(found) and entry.least <= found <= entry.most
    limits = f"{name} must be {_limits(entry)}; got {shown(value)}."
    bare = not isinstance(value, str) or not value.strip()[-1:].isalpha()
    if found is not None and 0.0 < found < entry.above_0:
        raise ValueError(limits + (likely_unit(found, entry.unit, entry.above_0, entry.most) if bare else ""))
    if found is not None and inside and not (entry.whole and found != int(found)):
        return found
    if inside:
        raise ValueError(limits + " Round it.")
    if found is None and isinstance(value, str) and "," in value:
        raise ValueError(limits + " Write a decimal point instead of the comma.")
    if found is None:
        those = different_units(entry.unit)[:5]
        raise ValueError(limits + ("" if entry.unit == "1" else f" Write a number with a unit of {', '.join(those)}."))
    raise ValueError(limits + (likely_unit(found, entry.unit, entry.least, entry.most) if bare else ""))


def _limits(entry: Entry) -> str:
    unit = "" if entry.unit == "1" else f" {entry.unit}"
    if entry.whole:
        return f"an integer from {entry.least:g} to {entry.most:g}"
    none = "0 or " if entry.above_0 and entry.least <= 0.0 else ""
    return f"{none}from {max(entry.least, entry.above_0):g} to {entry.most:g}{unit}"


def choice_of(choices: Collection[str], value: Any, name: str, remedy: str) -> str:
    """Return a text of a file that is one of some. Raises ValueError."""
    if not isinstance(value, str) or value not in choices:
        raise ValueError(f"{name} must be one of {', '.join(choices)}; got {shown(value)}. {remedy}")
    return value


def check_names(table: Mapping[str, Any], known: Iterable[str], where: str) -> None:
    """Raise ValueError if a table has an unknown name; where: the table's name in brackets and a blank, or nothing."""
    names = list(known)
    for name in table:
        if name not in names:
            near = suggestion(name, names, f"known are {', '.join(names)}.")
            raise ValueError(f"{where}{quoted(name)} is not a known entry. {near[0].upper()}{near[1:]}")
