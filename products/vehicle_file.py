"""Vehicles from TOML files with their brakes: `read_vehicle`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from products.vehicle_brakes import BRAKE_ENTRIES, brake_of_sheet, with_entry_names
from products.vehicle_entries import RESISTANCE, check_names
from products.vehicle_sheet import DataSheet, read_sheet, unbraked


def read_vehicle(path: str | Path) -> DataSheet:
    """Return the vehicle in a TOML file.

    Parameters
    ----------
    path : str or Path
        The file; `docs/vehicle_files.md` lists its entries.

    Returns
    -------
    DataSheet
        The vehicle, its brake, and the list of assumed values.

    Raises
    ------
    FileError
        If the file cannot be read, or an entry is unknown, missing, stated twice or outside its limits.
    """
    return read_sheet(path, sheet_of)


def sheet_of(read: Mapping[str, Any], name: str = "vehicle") -> DataSheet:
    """Return the vehicle of a file's content. Raises ValueError, as `read_vehicle` without the file's name."""
    sheet, table = unbraked(read, name)
    if not table:
        return sheet
    table = with_entry_names(table)
    check_names(table, [*BRAKE_ENTRIES, "acts_on"], "[brake] ")
    own = sheet.parameters
    turning = sheet.mass + sheet.axles * own.wheelset_pitch_inertia / own.wheel_radius**2
    running = [sheet.resistance.get(name, 0.0) for name, _ in RESISTANCE.values()]
    brake = brake_of_sheet(table, turning, sheet.axles, own.wheel_radius, running, sheet.mass)
    return replace(sheet, brake=brake, assumed={**sheet.assumed, **brake.assumed})
