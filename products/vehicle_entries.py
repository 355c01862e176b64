"""Entries of a vehicle file: names, units, limits; numbers with their units, read within the limits."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import Field
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
from readers.documents import is_number
from readers.quantity import Quantity, by_name, number_in
from readers.text import quoted, shown
from readers.units import different_units
from readers.usual import SOFTEST, likely_unit

#: Vehicles whose values are assumed where a file has none: their description, and their parameters.
LIKE: Mapping[str, tuple[str, Callable[[], BogieParameters]]] = {
    "coach": ("passenger coach, vehicle 1 of the Manchester benchmarks with traction rods", coach_with_traction_rods),
    "coal-wagon": ("freight wagon on two bogies of chapter 5", coal_wagon),
    "bogie": ("one body on two wheelsets, chapter 5", tables_5_1_and_5_2),
}


HEAVIEST = 1e6
#: Longest name of a connection or body.
LONGEST_PART = 40
ENTRIES = by_name(
    Quantity("axles", "1", 2, 6, "number of wheelsets: 2, 4 or 6"),
    Quantity("tare", "kg", LEAST_BODY, HEAVIEST, "mass of the empty vehicle on the rails"),
    Quantity("load", "kg", 0.0, HEAVIEST, "load in or on the body", above_0=50.0),
    Quantity("bogie_frame_mass", "kg", LEAST_FRAME, HEAVIEST, "one bogie without its wheelsets"),
    Quantity("wheelset_mass", "kg", LEAST_WHEELSET, HEAVIEST, "one wheelset"),
    Quantity("rotating_mass", "kg", LEAST_WHEELSET, HEAVIEST, "equivalent mass of all rotating parts at the rims"),
    Quantity("wheel_diameter", "m", 2 * SMALLEST_RADIUS, 2 * LARGEST_RADIUS, "at the tread"),
    Quantity("length", "m", 1.0, LONGEST_VEHICLE, "over the couplers"),
    Quantity("pivot_distance", "m", 0.5, LONGEST_VEHICLE, "between the middles of both bogies"),
    Quantity("wheel_base", "m", 0.1, LONGEST_VEHICLE, "between neighbouring axles of a bogie, or of 2 axles"),
    Quantity("body_height", "m", 0.1, 5.0, "centre of mass of the body above the rail"),
    Quantity("frame_height", "m", 0.05, 5.0, "centre of mass of a bogie frame above the rail"),
    Quantity("secondary_height", "m", 0.05, 5.0, "secondary springs above the rail"),
    Quantity("coupler_height", "m", 0.05, 5.0, "couplers above the rail"),
)
#: Entries that are heights above the rail; the set has those above the axles.
HEIGHTS = ("body_height", "frame_height", "secondary_height", "coupler_height")
#: Parameter of the set that an entry alone gives, by the entry.
PARAMETER_OF = {
    **{"bogie_frame_mass": "frame_mass", "wheel_diameter": "wheel_radius", "length": "coupler_distance"},
    **{name: name for name in ("wheelset_mass", "pivot_distance", "wheel_base", *HEIGHTS)},
}
#: Running resistance a + b v + c v^2 of the whole vehicle (Davis 1926): the FMU's parameters, and the entries.
RESISTANCE: Mapping[str, tuple[str, Quantity]] = {
    "constant": ("davis_constant", Quantity("constant", "N", 0.0, 1e6, "a")),
    "linear": ("davis_linear", Quantity("linear", "N.s/m", 0.0, 1e6, "b")),
    "quadratic": ("davis_quadratic", Quantity("quadratic", "N.s2/m2", 0.0, 1e6, "c")),
}


def parameter_entry(item: Field[Any]) -> Quantity:
    """Return the entry for a parameter of a set, by its unit and limits."""
    about = item.metadata
    whole = about["kind"] == "integer"
    above_0 = SOFTEST if about["unit"] == "N/m" else 0.0
    return Quantity(item.name, about["unit"], about["minimum"], about["maximum"], about["description"], whole, above_0)


def number_of(entry: Quantity, value: Any, name: str) -> float:
    """Return a number of a file in SI units."""
    found = number_in(value, entry.unit) if isinstance(value, str) else float(value) if is_number(value) else None
    inside = found is not None and math.isfinite(found) and entry.least <= found <= entry.most
    limits = f"an integer from {entry.least:g} to {entry.most:g}"
    if not entry.whole:
        none = "0 or " if entry.above_0 and entry.least <= 0.0 else ""
        limits = f"{none}from {max(entry.least, entry.above_0):g} to {entry.most:g}{entry.of_unit}"
    said = f"{name} must be {limits}; got {shown(value)}."
    if found is None:
        if isinstance(value, str) and "," in value:
            raise ValueError(f"{said} Write a decimal point instead of the comma.")
        units = (
            "" if entry.unit == "1" else f" Write a number with a unit of {', '.join(different_units(entry.unit)[:5])}."
        )
        raise ValueError(said + units)
    is_small = 0.0 < found < entry.above_0
    if inside and not is_small and entry.whole and found != int(found):
        raise ValueError(f"{said} Round it.")
    if inside and not is_small:
        return found
    least = entry.above_0 if is_small else entry.least
    bare = not isinstance(value, str) or not value.strip()[-1:].isalpha()
    raise ValueError(said + (likely_unit(found, entry.unit, least, entry.most) if bare else ""))


def numbers_of(entry: Quantity, value: Any, name: str, count: int = 0) -> tuple[float, ...]:
    """Return a list of numbers of a file in SI units; count: how many, 0 for any. Raises ValueError."""
    if not isinstance(value, list) or (count and len(value) != count):
        words = f"{count} numbers" if count else "numbers"
        raise ValueError(f"{name} must be a list of {words}; got {shown(value)}. Put them in brackets.")
    return tuple(number_of(entry, one, name) for one in value)


def name_of(name: object, where: str) -> str:
    """Return the name of a connection or body, with which variables of the FMU begin. Raises ValueError."""
    if isinstance(name, str) and name.isascii() and name.isidentifier() and len(name) <= LONGEST_PART:
        return name
    limit = f"name must have at most {LONGEST_PART} letters, digits and underscores, a letter first"
    raise ValueError(f"{where}{limit}; got {shown(name)}. Rename it.")


def literal(value: Any) -> str:
    """Return a text, a number or a list as TOML has it."""
    if isinstance(value, list):
        return f"[{', '.join(map(literal, value))}]"
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f") if isinstance(value, str) else repr(value)


def choice_of(choices: Collection[str], value: Any, name: str, remedy: str) -> str:
    """Return a text of a file that is one of some. Raises ValueError."""
    if not isinstance(value, str) or value not in choices:
        near = suggestion(value, choices, remedy) if isinstance(value, str) else remedy
        raise ValueError(f"{name} must be one of {', '.join(choices)}; got {shown(value)}. {near[0].upper()}{near[1:]}")
    return value


def check_names(table: Mapping[str, Any], known: Iterable[str], where: str) -> None:
    """Raise ValueError if a table has an unknown name; where: the table's name in brackets and a blank, or nothing."""
    names = list(known)
    for name in table:
        if name not in names:
            near = suggestion(name, names, f"known are {', '.join(names)}.")
            raise ValueError(f"{where}{quoted(name)} is not a known entry. {near[0].upper()}{near[1:]}")
