"""Numbers and tables of railML elements."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from itertools import pairwise

import numpy as np

from readers.formats.vehicle_rows import checked
from readers.import_account import Notes
from readers.text import FileError, shown
from readers.units import SPELLINGS, different_units
from readers.xml_files import attribute, inside

#: Largest size of a number.
LARGEST = 1e12
#: Factors of the units of tables, in small letters, to km/h, N and m/s2; without a unit a table is in these.
UNITS: dict[str, dict[str, float]] = {
    quantity: {unit.lower(): factor * up / down for unit, (up, down) in SPELLINGS[quantity].items()} | {"": 1.0}
    for quantity, factor in (("speed", 3.6), ("force", 1.0), ("acceleration", 1.0))
}
UNITS["acceleration"]["m/s/s"] = 1.0
DEFAULT = {"force": "N", "acceleration": "m/s2"}
#: Most rows of a table.
MOST = 10_000


def number_of(element: ET.Element, name: str, limits: tuple[float, float], source: str) -> float | None:
    """Return the number of an attribute, None if it is missing. Raises FileError."""
    value = attribute(element, name, source, LARGEST)
    return None if value is None else checked(value, f"{name} of {element.tag}", limits, "", source)


def table_of(element: ET.Element, quantity: str, source: str, notes: Notes) -> list[tuple[float, float]]:
    """Return the rows of a valueTable inside an element: speed [km/h] and value [SI], sorted by speed."""
    table = next(inside(element, "valueTable"), None)
    if table is None:
        return []
    units = (table.get("xValueUnit", "").strip().lower(), table.get("yValueUnit", "").strip().lower())
    if units[0] not in UNITS["speed"] or units[1] not in UNITS[quantity]:
        own = " or ".join(different_units(DEFAULT[quantity])[:3])
        raise FileError(
            f"{source}: the table of {element.tag} must be over km/h or m/s, in {own}; got "
            f"{shown(' and '.join(units))}. Correct its units."
        )
    if "" in units:
        notes.assumed(f"{element.tag}: a unit of its table is missing; km/h and {DEFAULT[quantity]}.")
    found = []
    for line in inside(table, "valueLine"):
        speed = number_of(line, "xValue", (0.0, 1000.0), source)
        value = next((number_of(one, "yValue", (-1e9, 1e9), source) for one in inside(line, "value")), None)
        if speed is not None and value is not None:
            found.append((speed * UNITS["speed"][units[0]], value * UNITS[quantity][units[1]]))
    found.sort()
    if len(found) > MOST or any(a[0] == b[0] for a, b in pairwise(found)):
        raise FileError(f"{source}: the table of {element.tag} must have each speed once; got another. Correct it.")
    return found


def mean_deceleration(table: list[tuple[float, float]]) -> float | None:
    """Return the mean over the distance of a stop from the highest speed, v^2 / 2 over int v / a dv, or None."""
    if len(table) < 2 or any(value <= 0.0 for _, value in table):
        return None
    speeds = np.linspace(0.0, table[-1][0], 2001) / 3.6
    values = np.interp(3.6 * speeds, [one for one, _ in table], [one for _, one in table])
    return float(speeds[-1] ** 2 / 2 / np.trapezoid(speeds / values, speeds))


def fitted(table: list[tuple[float, float]]) -> tuple[tuple[float, float, float], float] | None:
    """Return a, b, c >= 0 of a + b v + c v^2 in SI fitted to forces over speed, and the largest error [N], or None."""
    if len(table) < 3 or any(value < 0.0 for _, value in table):
        return None
    speeds = np.array([one for one, _ in table]) / 3.6
    forces = np.array([one for _, one in table])
    for powers in ((0, 1, 2), (0, 2), (0,)):
        matrix = np.stack([speeds**power for power in powers], axis=1)
        found = np.linalg.lstsq(matrix, forces, rcond=None)[0]
        if np.all(found >= 0.0):
            whole = dict(zip(powers, found, strict=True))
            error = float(np.max(np.abs(matrix @ found - forces)))
            a, b, c = (float(whole.get(power, 0.0)) for power in (0, 1, 2))
            return (a, b, c), error
    return None
