"""The vehicle of a file on the test rig: a braked vehicle with the numbers of its data sheet."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from products.machine import DISCS, MACHINES, RESERVOIR_PRESSURE, TRACTION, Machine, OwnNumbers
from products.protection.programme import Case
from products.protection.settings import SLOWEST_BRAKE
from products.vehicle_brakes import SheetBrake
from products.vehicle_file import read_vehicle
from products.vehicle_sheet import FMU_OF_AXLES, DataSheet
from readers.text import FileError

#: End of the name of a vehicle file.
ENDING = ".toml"


def vehicle_of_file(path: Path) -> tuple[Machine, SheetBrake]:
    """Return the braked vehicle of a file (docs/vehicle_files.md), and its brake."""
    return machine_of_sheet(read_vehicle(path), str(path))


def machine_of_sheet(sheet: DataSheet, path: str = "") -> tuple[Machine, SheetBrake]:
    """Return the braked vehicle of a data sheet, and its brake.

    The rig takes from the brake its torque at the full pressure, this pressure and the application time.
    """
    path, brake = path or sheet.name, sheet.brake
    if sheet.axles not in FMU_OF_AXLES:
        raise FileError(f"{path}: axles must be 2 or 4 on the test rig; got {sheet.axles}.")
    if brake is None:
        raise FileError(f"{path} must have a [brake] on the test rig; got none. Add deceleration or another entry.")
    if brake.entries.get("friction_law", "constant") != "constant":
        law = brake.entries["friction_law"]
        raise FileError(f"{path}: [brake] friction_law must be constant on the test rig; got {law}. Leave it out.")
    if sheet.profile_files:
        raise FileError(f"{path}: profile_file must be left out on the test rig, whose rails are even; got one.")
    if own := sheet.parts.first:
        raise FileError(f"{path}: {own} must be left out on the test rig, whose connections are built in; got one.")
    if brake.full_pressure > RESERVOIR_PRESSURE:
        most = f"{RESERVOIR_PRESSURE / 1e3:g} kPa, the pressure of the rig's reservoir"
        raise FileError(f"{path}: [brake] full_pressure must be at most {most}; got {brake.full_pressure / 1e3:g} kPa.")
    if brake.application_time > SLOWEST_BRAKE:
        raise FileError(
            f"{path}: [brake] application_time must be at most {SLOWEST_BRAKE:g} s on the test rig; got "
            f"{brake.application_time:g} s."
        )
    own_numbers = OwnNumbers(sheet.name, sheet.parameters, tuple(sheet.resistance.items()))
    machine = MACHINES[FMU_OF_AXLES[sheet.axles]]()
    pressure, torque = brake.full_pressure, brake.full_torque
    return replace(
        machine, full_pressure=pressure, full_torque=torque, supply_pressure=pressure, own=own_numbers
    ), brake


def with_own_brake(cases: Sequence[Case], brake: SheetBrake) -> list[Case]:
    """Return the cases with discs if the vehicle has them; a case with discs keeps them."""
    if brake.acts_on == "treads":
        return list(cases)
    return [
        case if {DISCS, TRACTION} & set(case.equipment) else replace(case, equipment=(DISCS, *case.equipment))
        for case in cases
    ]
