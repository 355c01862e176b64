"""Own parts of a vehicle file: its bodies and connections, beside those of the built-in vehicle or instead of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, cast

from products.vehicle_bodies import BodyRow, body_rows, lines_of_bodies
from products.vehicle_connections import (
    SHORT,
    ConnectionRow,
    connection_rows,
    connections_of,
    ends_of,
    lines_of_connections,
)
from products.vehicle_entries import choice_of
from rbd_model.vehicle.description import Vehicle
from readers.text import shown

#: Tables of a file in rows, and the entry at its top for the connections of the built-in vehicle.
ROWS, ENTRY = ("body", "connection"), "connections"
#: Its values: connections of the built-in vehicle beside those of the file, or those of the file alone.
BUILT_IN, OF_FILE = "built-in", "file"


@dataclass(frozen=True)
class OwnParts:
    """Bodies and connections of a file; connections replace built-in ones of the same name.

    are_all: true if the vehicle has no built-in connection.
    """

    bodies: tuple[BodyRow, ...] = ()
    connections: tuple[ConnectionRow, ...] = ()
    are_all: bool = False

    @property
    def mass(self) -> float:
        """Mass of the bodies [kg]."""
        return sum(float(cast(float, row.body.mass)) for row in self.bodies)

    @property
    def first(self) -> str:
        """Their first table in the file, as a message names it; empty: the vehicle is the built-in one."""
        if self.bodies:
            return "[[body]]"
        if not self.connections:
            return ENTRY if self.are_all else ""
        table = self.connections[0].table
        return f"[{table}]" if table in SHORT else f"[[{table}]]"

    def added_to(self, vehicle: Vehicle) -> Vehicle:
        """Return the built-in vehicle with these parts. Raises ValueError if it cannot be built."""
        bodies = (*vehicle.bodies, *(row.body for row in self.bodies))
        connections = connections_of(vehicle, bodies, self.connections, self.are_all)
        return replace(vehicle, bodies=bodies, connections=connections)

    def lines(self) -> list[str]:
        """Return the lines of a file with these parts, below its entries."""
        return [*lines_of_bodies(self.bodies), *lines_of_connections(self.connections)]


def own_parts(read: Mapping[str, Any], axles: int) -> OwnParts:
    """Return the parts of a file. Raises ValueError."""
    bodies = body_rows(_rows(read, "body"))
    for row in bodies:
        if row.body.name in ends_of(axles):
            raise ValueError(f"[[body]] {row.body.name}: name must differ from that of a built-in part. Rename it.")
    short = {table: read.get(table, {}) for table in SHORT}
    connections = connection_rows(short, _rows(read, "connection"), axles, [row.body.name for row in bodies])
    choice = choice_of((BUILT_IN, OF_FILE), read.get(ENTRY, BUILT_IN), ENTRY, "Choose one.")
    return OwnParts(bodies, connections, choice == OF_FILE)


def _rows(read: Mapping[str, Any], name: str) -> Sequence[Mapping[str, Any]]:
    found = read.get(name, [])
    if not isinstance(found, list) or not all(isinstance(row, Mapping) for row in found):
        raise ValueError(f"{name} must be in rows; got {shown(found)}. Write [[{name}]] and its entries below it.")
    return found
