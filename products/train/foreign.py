"""Consists from files of other programs: rows of an importer, fitted to the limits of a consist."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from brake_controller.distributors.uic import UicDistributor, freight, reached_pressure
from products.train.columns import NUMBERS
from products.train.consist import Consist
from products.train.consist_file import consist_of, read_consist
from readers.formats import Imported, Row
from readers.formats.trains import is_foreign, read_foreign

#: Columns without which a row would be another vehicle; a value beyond their limits is refused.
ESSENTIAL = ("kind", "count", "mass", "length", "lambda", "deceleration", "brake_force", "shoe_force", "brake")


def consist_from(path: Path) -> tuple[Consist, Imported | None]:
    """Return the consist in a file, and the account of its fields if it is of another program.

    Parameters
    ----------
    path : Path
        A consist (TOML, CSV), or a file with one of the suffixes in `readers/formats/trains.py: FORMATS`.

    Raises
    ------
    ValueError
        If the file is not a consist, or cannot be read; the message names the file, the place, and the remedy.
    """
    return imported_consist(path) if is_foreign(path) else (read_consist(path), None)


def imported_consist(path: Path) -> tuple[Consist, Imported]:
    """Return the consist in a file of another program, and the account of its fields.

    Values of columns that only refine a vehicle are left out beyond their limits, and told.

    Raises
    ------
    ValueError
        If the file cannot be read, or its vehicles are beyond the limits of a consist.
    """
    found = read_foreign(path)
    left: dict[str, None] = {}
    rows = [_fitted(row, left) for row in found.rows]
    places = [f"vehicle {row.get('name', number)}" for number, row in enumerate(rows, 1)]
    return consist_of(rows, str(path), places), replace(found, rows=rows, left=[*found.left, *left])


def _fitted(row: Row, left: dict[str, None]) -> Row:
    """Return a row without refinements beyond their limits, and tell them in `left`."""
    kept = dict(row)
    for name, value in row.items():
        if name in ESSENTIAL or name not in NUMBERS:
            continue
        if not NUMBERS[name][1] <= value <= NUMBERS[name][2]:
            unit, least, most = NUMBERS[name]
            limits = f"{least:g} to {most:g}" if unit == "1" else f"{least:g} to {most:g} {unit}"
            left[f"{name}: {value:.4g} is outside {limits}; the default is taken."] = None
            del kept[name]
    if "full_pressure" in kept and kept.get("brake", "pneumatic") == "pneumatic" and not _is_reached(kept):
        left[
            f"full_pressure: a reservoir at 5 bar does not reach {kept['full_pressure']:.4g} bar in the cylinders; the "
            "default is taken, with equal force."
        ] = None
        del kept["full_pressure"]
    return kept


def _is_reached(row: Mapping[str, Any]) -> bool:
    """Return whether the reservoir of a row reaches its cylinder pressure (Boyle)."""
    one = freight(str(row.get("position", "P")))
    if not isinstance(one, UicDistributor):
        return True
    volumes = {"auxiliary": "auxiliary_volume", "cylinder": "cylinder_volume"}
    one = replace(one, **{of: 1e-3 * row[name] for name, of in volumes.items() if name in row})
    return reached_pressure(one) > 1e5 * float(row["full_pressure"])
