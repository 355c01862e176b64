"""Connections of a vehicle file: rows [[connection]], and the short tables [bump_stop] and [yaw_damper].

A row is one connection element between two parts, or the same element in both bogies.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from products.vehicle_entries import check_names, choice_of, literal, name_of, number_of, numbers_of
from rbd_model.vehicle.description import (
    ANGLES,
    DIRECTIONS,
    BumpStop,
    FrictionSlider,
    RigidBody,
    SeriesDamper,
    Size,
    Springs,
    Sum,
    SuspensionElement,
    TableDamper,
    TableSpring,
    Torsion,
    Vehicle,
    fault_of,
    wheelset_name,
)
from readers.quantity import Quantity, by_name
from readers.usual import SOFTEST


@dataclass(frozen=True)
class Kind:
    """A kind of connection. Its entries are the fields of its class: a word, a number, or a list of numbers.

    optional: entries that a row may lack. If it may lack all of FORCES, one of them must be above 0.
    """

    part: type[SuspensionElement]
    text: str
    numbers: Mapping[str, Quantity]
    optional: tuple[str, ...] = ()

    @property
    def words(self) -> dict[str, tuple[str, ...]]:
        """Entries with one of some words."""
        names = [field.name for field in fields(self.part)]
        return {name: known for name, known in WORDS.items() if name in names}

    @property
    def lists(self) -> dict[str, int]:
        """Entries that are lists of numbers, and how many: 3, or 0 for any."""
        types = {field.name: str(field.type) for field in fields(self.part) if field.name in self.numbers}
        return {name: 0 if "..." in kind else 3 for name, kind in types.items() if kind.startswith("tuple")}

    @property
    def entries(self) -> list[str]:
        """Names of its entries."""
        return [*self.words, *self.numbers]


#: Entries without which springs have no force.
FORCES = ("stiffness", "damping")
#: Entries that are words.
WORDS = {"direction": DIRECTIONS, "angle": ANGLES}
STIFFNESS = Quantity("stiffness", "N/m", 0.0, 1e11, "of the spring", above_0=SOFTEST)
DAMPING = Quantity("damping", "N.s/m", 0.0, 1e9, "of the damper")
SPRING, DAMPER = replace(STIFFNESS, least=SOFTEST), replace(DAMPING, least=1.0)
TRAVEL = Quantity("travel", "m", -1.0, 1.0, "travels of the upper end over the lower one, rising")
RATE = Quantity("rate", "m/s", -10.0, 10.0, "rates of the upper end over the lower one, rising")
FORCE = Quantity("force", "N", -1e8, 1e8, "forces there")
#: Kinds of connections by their names in files. Your own kind is a further row.
KINDS: Mapping[str, Kind] = {
    "springs": Kind(
        Springs,
        "linear springs and dampers along, across and up",
        by_name(
            replace(STIFFNESS, text="along, across and up; a vertical one carries its share of the weight"),
            replace(DAMPING, text="along, across and up"),
            Quantity("inclination", "rad", -1.6, 1.6, "pitch of these axes, positive nose down (default: 0)"),
        ),
        ("stiffness", "damping", "inclination"),
    ),
    "torsion": Kind(
        Torsion,
        "torsion spring and damper, such as an anti-roll bar",
        by_name(
            Quantity("stiffness", "N.m/rad", 0.0, 1e11, "against the angle"),
            Quantity("damping", "N.m.s/rad", 0.0, 1e9, "against its rate"),
        ),
        ("stiffness", "damping"),
    ),
    "series_damper": Kind(SeriesDamper, "spring and damper in series", by_name(SPRING, DAMPER)),
    "table_spring": Kind(TableSpring, "force over the travel by points", by_name(TRAVEL, FORCE)),
    "bump_stop": Kind(
        BumpStop,
        "table_spring with a clearance, the same in both senses",
        by_name(replace(TRAVEL, least=0.0, text="travels, rising; the first is the clearance"), FORCE),
    ),
    "table_damper": Kind(
        TableDamper, "force over the rate by points, such as a damper that saturates", by_name(RATE, FORCE)
    ),
    "friction_slider": Kind(
        FrictionSlider,
        "dry friction in series with a spring, such as a wedge",
        by_name(
            SPRING,
            DAMPING,
            Quantity("capacity", "N", 0.0, 1e8, "friction force at rest"),
            Quantity("capacity_slope", "N/m", 0.0, 1e9, "its increase over vertical compression (default: 0)"),
            Quantity("slider_mass", "kg", 0.1, 1e4, "of the slider"),
        ),
        ("damping", "capacity_slope"),
    ),
}
#: Entries of every row that are numbers; those of its kind are beside them.
PLACE = by_name(
    Quantity("along", "m", -100.0, 100.0, "ahead of the bogie's or the vehicle's middle (default: the lower end)"),
    Quantity("aside", "m", -5.0, 5.0, "to the left of the middle (default: 0)"),
    Quantity("half_spacing", "m", 0.01, 5.0, "two elements, as far to the left and to the right of the middle"),
    Quantity("height", "m", 0.0, 6.0, "above the rail"),
)
#: Entries of every row that are strings.
TEXTS = ("name", "kind", "upper", "lower")
#: Short tables: what they say about a connection of the body and each frame, and the entries that they may have.
SHORT: Mapping[str, tuple[Mapping[str, str], tuple[str, ...]]] = {
    "bump_stop": ({"kind": "bump_stop", "direction": "lateral"}, ("travel", "force", "height")),
    "yaw_damper": (
        {"kind": "table_damper", "direction": "longitudinal"},
        ("rate", "force", "half_spacing", "height"),
    ),
}
#: Parts of each bogie, which stand for those of both bogies.
OF_EACH_BOGIE = ("frame", "leading_wheelset", "middle_wheelset", "trailing_wheelset")


@dataclass(frozen=True)
class ConnectionRow:
    """A connection of a file.

    `table`: the short table that states it, or "connection".
    `is_in_each_bogie`: true if it stands for one in both.
    `place` [m]: its entries of PLACE.
    `law`: fields of its class [SI].
    `entries`: as the file has them.
    """

    table: str
    name: str
    kind: str
    upper: str
    lower: str
    is_in_each_bogie: bool
    place: Mapping[str, float]
    law: Mapping[str, Any]
    entries: Mapping[str, Any]


def connection_rows(
    short: Mapping[str, Mapping[str, Any]],
    read: Sequence[Mapping[str, Any]],
    axles: int,
    bodies: Collection[str] = (),
) -> tuple[ConnectionRow, ...]:
    """Return the connections of a file: those of its short tables and its rows. bodies: names of its own.

    Raises ValueError.
    """
    known, rows = ends_of(axles) | dict.fromkeys(bodies, False), []
    for table, (stated, entries) in SHORT.items():
        if content := short.get(table):
            if axles == 2:
                raise ValueError(f"[{table}] must be left out with 2 axles, which have no bogies; got one. Remove it.")
            where = f"[{table}] "
            check_names(content, entries, where)
            whole = {"name": table, "upper": "body", "lower": "frame", **stated, **content}
            for key in entries:
                if key not in content and key != "height":
                    raise ValueError(f"{where}{key} must be given; got none. Add it.")
            rows.append(_row(table, whole, content, known, where))
    for number, content in enumerate(read, 1):
        name = content.get("name")
        where = f"[[connection]] {name if isinstance(name, str) and name else number}: "
        if "height" not in content:
            raise ValueError(f"{where}height must be given; got none. Add it.")
        rows.append(_row("connection", content, content, known, where))
    return tuple(rows)


def short_entries(table: str) -> Mapping[str, Quantity]:
    """Return the entries of a short table."""
    stated, names = SHORT[table]
    height = replace(PLACE["height"], text="above the rail (default: that of the secondary springs)")
    known = {**PLACE, **KINDS[stated["kind"]].numbers, "height": height}
    return {name: known[name] for name in names}


def ends_of(axles: int) -> dict[str, bool]:
    """Return the parts of a built-in vehicle that a connection can join, and whether a name stands for one of each
    bogie.
    """
    wheelsets = {wheelset_name(number): False for number in range(1, axles + 1)}
    if axles == 2:
        return {"frame": False, **wheelsets}
    each = {name: True for name in OF_EACH_BOGIE if name != "middle_wheelset" or axles == 6}
    return {"body": False, **each, "front_frame": False, "rear_frame": False, **wheelsets}


def _row(
    table: str, content: Mapping[str, Any], entries: Mapping[str, Any], known: Mapping[str, bool], where: str
) -> ConnectionRow:
    """Return a connection from its entries. Raises ValueError."""
    for key in TEXTS:
        if key not in content:
            raise ValueError(f"{where}{key} must be given; got none. Add it.")
    name = name_of(content["name"], where)
    kind = KINDS[choice_of(KINDS, content["kind"], f"{where}kind", "Choose one.")]
    check_names(content, [*TEXTS, *PLACE, *kind.entries], where)
    for key in kind.entries:
        if key not in content and key not in kind.optional:
            raise ValueError(f"{where}{key} must be given; got none. Add it.")
    if "aside" in content and "half_spacing" in content:
        raise ValueError(f"{where}aside must be left out beside half_spacing; got both. State one of them.")
    place = {key: number_of(entry, content[key], f"{where}{key}") for key, entry in PLACE.items() if key in content}
    law = {key: _law(kind, key, content[key], where) for key in kind.entries if key in content}
    ends, is_in_each_bogie = _ends(content, known, where)
    fault = fault_of(kind.part(name, *ends, (0.0, 0.0, 0.0), False, **law))
    if {*FORCES} <= {*kind.optional} and not any(np.any(law.get(key, 0.0)) for key in FORCES):
        fault = f"{' or '.join(FORCES)} must be above 0; got none. Give one, or remove the row."
    if fault:
        raise ValueError(f"{where}{fault}")
    return ConnectionRow(table, name, content["kind"], *ends, is_in_each_bogie, place, law, dict(entries))


def _law(kind: Kind, key: str, value: object, where: str) -> Any:
    """Return an entry of a kind as the field of its class."""
    if key in kind.words:
        return choice_of(kind.words[key], value, f"{where}{key}", "Choose one.")
    if key in kind.lists:
        return numbers_of(kind.numbers[key], value, f"{where}{key}", kind.lists[key])
    return number_of(kind.numbers[key], value, f"{where}{key}")


def _ends(content: Mapping[str, Any], known: Mapping[str, bool], where: str) -> tuple[tuple[str, str], bool]:
    """Return both ends, and whether they stand for those of each bogie. Raises ValueError."""
    upper, lower = (choice_of(known, content[key], f"{where}{key}", "Choose one.") for key in ("upper", "lower"))
    if upper == lower:
        raise ValueError(f"{where}upper and lower must be two parts; got {upper} twice. Change one of them.")
    each = [end for end in (upper, lower) if known[end]]
    others = [end for end in (upper, lower) if not known[end] and end != "body"]
    if each and others:
        raise ValueError(
            f"{where}upper and lower must be parts of one bogie; got {others[0]} beside {each[0]}, which stands for "
            f"that of each bogie. Name the single part instead of {each[0]}."
        )
    return (upper, lower), bool(each)


def connections_of(
    vehicle: Vehicle, bodies: Sequence[RigidBody], rows: Sequence[ConnectionRow], are_all: bool
) -> tuple[SuspensionElement, ...]:
    """Return the connections of a vehicle with those of a file, which replace others of the same name.

    bodies: those of the vehicle and of the file. are_all: none of the vehicle's is kept. Raises ValueError.
    """
    places: dict[str, Size] = {body.name: body.along for body in bodies}
    places |= {wheelset_name(number): wheelset.along for number, wheelset in vehicle.numbered}
    parts = [part for row in rows for part in _parts(row, places, len(vehicle.wheelsets) // 2)]
    names = [part.name for part in parts]
    for name in names:
        if names.count(name) > 1:
            raise ValueError(f"[[connection]] {name} must be there once; got it {names.count(name)} times. Rename one.")
    kept = [one for one in vehicle.connections if not are_all and one.name not in names]
    return (*kept, *parts)


def _parts(row: ConnectionRow, places: Mapping[str, Size], count: int) -> list[SuspensionElement]:
    """Return the connections of a row: one, or one of each bogie; count: wheelsets of a bogie."""
    if not row.is_in_each_bogie:
        return [_part(row, places, row.name, (row.upper, row.lower), Sum(()))]
    found = []
    for bogie, share, first in (("front", 0.5, 1), ("rear", -0.5, 1 + count)):
        wheelsets = {"leading": first, "middle": first + 1, "trailing": first + count - 1}
        own = {"frame": f"{bogie}_frame"} | {f"{key}_wheelset": wheelset_name(n) for key, n in wheelsets.items()}
        ends = own.get(row.upper, row.upper), own.get(row.lower, row.lower)
        found.append(_part(row, places, f"{bogie}_{row.name}", ends, Sum((("pivot_distance", share),))))
    return found


def _part(
    row: ConnectionRow, places: Mapping[str, Size], name: str, ends: tuple[str, str], middle: Sum
) -> SuspensionElement:
    """Return a connection; places: of the centres of all parts along the vehicle. middle: from which `along` counts."""
    along = middle + row.place["along"] if "along" in row.place else places[ends[1]]
    across = row.place.get("half_spacing", row.place.get("aside", 0.0))
    height: Size = "secondary_height"
    if "height" in row.place:
        height = Sum((("wheel_radius", -1.0),), row.place["height"])
    return KINDS[row.kind].part(name, *ends, (along, across, height), "half_spacing" in row.place, **row.law)


def lines_of_connections(rows: Sequence[ConnectionRow]) -> list[str]:
    """Return the lines of a file with these connections."""
    lines: list[str] = []
    for row in rows:
        head = "[[connection]]" if row.table == "connection" else f"[{row.table}]"
        lines += ["", head, *(f"{key} = {literal(value)}" for key, value in row.entries.items())]
    return lines


def table_of(vehicle: Vehicle) -> list[tuple[str, str, str, str]]:
    """Return name, kind, ends and place of each connection of a vehicle, as strings; heights are above the rail."""
    kinds = {kind.part: name for name, kind in KINDS.items()}
    radius = vehicle.number(vehicle.wheelsets[0].mean_radius)
    rows = []
    for part in vehicle.connections:
        x, y, z = (vehicle.number(size) for size in part.place)
        place = f"{x:.4g}, {'+-' if part.both_sides else ''}{y:.4g}, {z + radius:.4g}"
        kind = kinds.get(type(part), type(part).__name__)
        rows.append((part.name, kind, f"{part.upper} on {part.lower}", place))
    return rows
