"""Bodies of a vehicle file beside those of its built-in vehicle: rows [[body]], such as a motor or a bolster."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, cast

from products.vehicle_entries import check_names, choice_of, literal, name_of, number_of, numbers_of
from rbd_model.vehicle.description import HOLDABLE, Motion, RigidBody, Sum
from readers.quantity import Quantity, by_name
from readers.text import shown

INERTIA = Quantity("inertia", "kg.m2", 1e-3, 1e8, "about its own x, y, z: roll, pitch, yaw")
#: Entries of every row that are numbers.
NUMBERS = by_name(
    Quantity("mass", "kg", 0.1, 1e6, "of the body"),
    Quantity("along", "m", -100.0, 100.0, "its centre ahead of the vehicle's middle (default: 0)"),
    Quantity("height", "m", 0.0, 6.0, "its centre above the rail"),
)
REQUIRED = ("name", "mass", "inertia", "height")


@dataclass(frozen=True)
class BodyRow:
    """A body of a file: what it becomes, and its entries as the file has them."""

    body: RigidBody
    entries: Mapping[str, Any]


def body_rows(rows: Sequence[Mapping[str, Any]]) -> tuple[BodyRow, ...]:
    """Return the bodies of a file. Raises ValueError."""
    found = []
    for number, content in enumerate(rows, 1):
        name = content.get("name")
        where = f"[[body]] {name if isinstance(name, str) and name else number}: "
        check_names(content, ["name", *NUMBERS, "inertia", "held"], where)
        for key in REQUIRED:
            if key not in content:
                raise ValueError(f"{where}{key} must be given; got none. Add it.")
        own = {key: number_of(entry, content[key], f"{where}{key}") for key, entry in NUMBERS.items() if key in content}
        inertia = numbers_of(INERTIA, content["inertia"], f"{where}inertia", 3)
        height = Sum((("wheel_radius", -1.0),), own["height"])
        name = name_of(name, where)
        body = RigidBody(
            name,
            name.replace("_", " "),
            own["mass"],
            (inertia[0], inertia[1], inertia[2]),
            own.get("along", 0.0),
            height,
            _held(content.get("held", []), where),
        )
        found.append(BodyRow(body, dict(content)))
    return tuple(found)


def _held(motions: object, where: str) -> frozenset[Motion]:
    """Return the motions that a body lacks."""
    if not isinstance(motions, list):
        raise ValueError(f"{where}held must be a list of motions; got {shown(motions)}. Put them in brackets.")
    return frozenset(cast(Motion, choice_of(HOLDABLE, motion, f"{where}held", "Choose one.")) for motion in motions)


def lines_of_bodies(rows: Sequence[BodyRow]) -> list[str]:
    """Return the lines of a file with these bodies."""
    lines: list[str] = []
    for row in rows:
        lines += ["", "[[body]]", *(f"{key} = {literal(value)}" for key, value in row.entries.items())]
    return lines
