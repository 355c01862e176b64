"""Forces by tables in a vehicle file: the bump stops and yaw dampers between its body and its bogie frames."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from products.vehicle_entries import check_names, number_of
from rbd_model.vehicle.description import BumpStop, Size, Sum, TableDamper, Vehicle
from rbd_model.vehicle.force_table import damper_fault, spring_fault
from readers.quantity import Quantity, by_name
from readers.text import shown

HEIGHT = Quantity("height", "m", 0.05, 5.0, "above the rail (default: that of the secondary springs)")
#: Entries of each table of a file. The first two are lists: the points of the force.
FORCE_TABLES = {
    "bump_stop": by_name(
        Quantity("travel", "m", 0.0, 1.0, "lateral travels of body over frame, rising; the first is the clearance"),
        Quantity("force", "N", 0.0, 1e8, "of the stop of a bogie at these travels, from 0 on"),
        HEIGHT,
    ),
    "yaw_damper": by_name(
        Quantity("rate", "m/s", 0.0, 10.0, "longitudinal rates of body over frame, rising from 0"),
        Quantity("force", "N", 0.0, 1e8, "of each damper at these rates, from 0 on; the last slope continues"),
        Quantity("half_spacing", "m", 0.01, 3.0, "half of the lateral distance of both dampers of a bogie"),
        HEIGHT,
    ),
}
#: Entries of numbers that a table must have.
REQUIRED = ("half_spacing",)


@dataclass(frozen=True)
class ForceTable:
    """The force of a connection of each bogie, by points [SI].

    places: travels or rates; sizes: half_spacing and height above the rail, as far as the file states them.
    """

    places: tuple[float, ...]
    forces: tuple[float, ...]
    sizes: Mapping[str, float]


def force_tables(read: Mapping[str, Mapping[str, Any]], axles: int) -> dict[str, ForceTable]:
    """Return the tables of forces of a file, by their names in it. Raises ValueError."""
    found = {}
    for table, content in read.items():
        if not content:
            continue
        if axles == 2:
            raise ValueError(f"[{table}] must be left out with 2 axles, which have no bogies; got one. Remove it.")
        found[table] = _force_table(table, content)
    return found


def _force_table(table: str, content: Mapping[str, Any]) -> ForceTable:
    entries = FORCE_TABLES[table]
    check_names(content, list(entries), f"[{table}] ")
    lists, others = list(entries)[:2], list(entries)[2:]
    for key in (*lists, *(other for other in others if other in REQUIRED)):
        if key not in content:
            raise ValueError(f"[{table}] {key} must be given; got none. Add it.")
    places, forces = (_numbers(table, key, content[key]) for key in lists)
    fault = damper_fault(places, forces) if table == "yaw_damper" else spring_fault(places, forces, False)
    if not fault and table == "bump_stop" and not places[0] > 0.0:
        fault = "travel must begin with the clearance, above 0; got 0 m. Give the travel at which the stop is met."
    if fault:
        raise ValueError(f"[{table}] {fault}")
    sizes = {key: number_of(entries[key], content[key], f"[{table}] {key}") for key in others if key in content}
    return ForceTable(places, forces, sizes)


def _numbers(table: str, key: str, value: object) -> tuple[float, ...]:
    if not isinstance(value, list):
        raise ValueError(f"[{table}] {key} must be a list of numbers; got {shown(value)}. Put it in brackets.")
    return tuple(number_of(FORCE_TABLES[table][key], one, f"[{table}] {key}") for one in value)


def with_force_tables(vehicle: Vehicle, tables: Mapping[str, ForceTable]) -> Vehicle:
    """Return a vehicle on two bogies with these connections; bump stops replace those that it has."""
    connections = [
        connection
        for connection in vehicle.connections
        if "bump_stop" not in tables or not isinstance(connection, BumpStop)
    ]
    for table, data in tables.items():
        height: Size = "secondary_height"
        if "height" in data.sizes:
            height = Sum((("wheel_radius", -1.0),), data.sizes["height"])
        for bogie, share in (("front", 0.5), ("rear", -0.5)):
            along, ends = Sum((("pivot_distance", share),)), ("body", f"{bogie}_frame")
            name, points = f"{bogie}_{table}", (data.places, data.forces)
            if table == "bump_stop":
                connections.append(BumpStop(name, *ends, (along, 0.0, height), False, "lateral", *points))
            else:
                place = along, data.sizes["half_spacing"], height
                connections.append(TableDamper(name, *ends, place, True, "longitudinal", *points))
    return replace(vehicle, connections=tuple(connections))


def rows_of_tables(tables: Mapping[str, ForceTable]) -> list[str]:
    """Return the rows of a file with these tables."""
    rows: list[str] = []
    for table, data in tables.items():
        entries = FORCE_TABLES[table]
        rows += ["", f"[{table}]"]
        for key, values in zip(entries, (data.places, data.forces), strict=False):
            texts = ", ".join(f'"{value!r} {entries[key].unit}"' for value in values)
            rows.append(f"{key} = [{texts}]")
        rows += [f'{key} = "{value!r} {entries[key].unit}"' for key, value in data.sizes.items()]
    return rows
